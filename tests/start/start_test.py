"""./start as a newcomer runs it: it ends with a driving robot and an address that shows it."""
import json
import os
import re
import signal
import socket
import subprocess
import time
import unittest
import urllib.request
from pathlib import Path

ROOT = Path(__file__).parents[2]
LIMIT_S = 500


class StartTest(unittest.TestCase):
    def start(self):
        process = subprocess.Popen(["./start"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                   start_new_session=True)
        self.addCleanup(self.end, process)
        said = ""
        for line in process.stdout:
            said += line
            match = re.search(r"Watch it at (http://\S+/)", line)
            if match:
                return process, match.group(1), said
        self.fail(said)

    def end(self, process):
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        process.stdout.close()

    def pose(self, url):
        body = json.dumps({"module": "/robot1/pose", "command": "get_pose"}).encode()
        request = urllib.request.Request(url + "api/call", body, {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)["data"][:2]

    def check_that_it_drives_and_ends(self, process, url):
        with urllib.request.urlopen(url, timeout=30) as page:
            self.assertIn(b"<html", page.read())
        first = self.pose(url)
        deadline = time.monotonic() + LIMIT_S
        while abs(self.pose(url)[0] - first[0]) + abs(self.pose(url)[1] - first[1]) < 0.3:
            self.assertLess(time.monotonic(), deadline, "the robot does not drive")
        os.killpg(process.pid, signal.SIGINT)
        process.stdout.read()
        self.assertEqual(process.wait(LIMIT_S), 0)
        with self.assertRaises(OSError):
            urllib.request.urlopen(url, timeout=5)

    def test_it_ends_with_a_robot_that_drives_and_a_page(self):
        process, url, _ = self.start()
        self.check_that_it_drives_and_ends(process, url)

    def test_a_busy_port_moves_it_to_another_block(self):
        with socket.socket() as busy:
            try:
                busy.bind(("127.0.0.1", 10000))
                busy.listen()
            except OSError:
                pass  # somebody else is there: as good
            process, url, said = self.start()
            self.assertIn("Port 10000 is busy", said)
            self.assertNotIn(":10001/", url)
            self.check_that_it_drives_and_ends(process, url)


if __name__ == "__main__":
    unittest.main()
