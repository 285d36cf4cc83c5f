"""./start as a newcomer runs it: it results in a driving robot, and prints the address of its page."""
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.request
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / "build" / "release" / "coopdyn"
LIMIT_S = 500


class StartTest(unittest.TestCase):
    def start(self, *arguments):
        process = subprocess.Popen(["./start", *arguments], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
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
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)["data"][:2]

    def check_that_it_drives_and_ends(self, process, url):
        with urllib.request.urlopen(url, timeout=60) as page:
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

    def test_what_it_builds_loads_every_shipped_scenario(self):
        for controller in PROGRAM.parent.glob("controllers/*.so"):
            controller.unlink()  # the tests' own builds made them
        _, url, _ = self.start("empty", "--no-render")
        names = sorted(path.stem for path in ROOT.glob("scenarios/*.scenario"))
        self.assertGreaterEqual(len(names), 15)
        server = f"127.0.0.1:{int(url.rstrip('/').rsplit(':', 1)[1]) - 1}"
        for name in names:
            with self.subTest(name):
                done = subprocess.run([PROGRAM, "load", name, "--server", server], stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True)
                self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_port_that_is_given_is_used(self):
        port = 20000 + 32 * (os.getpid() % 256)  # another for each process
        process, url, _ = self.start("--port", str(port))
        self.assertIn(f":{port + 1}/", url)
        self.check_that_it_drives_and_ends(process, url)

    def test_wrong_use_is_refused_before_the_build(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("start", "server/app/serve_options.cc", "scenarios/classroom.scenario", "worlds/empty.world"):
                (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, Path(folder) / name)
            for arguments, why in ((["--port"], "a port is"), (["--port", "x"], "a port is"), (["--port=70000"], "a port is"),
                                   (["--port", "12000", "--port", "12001"], "--port is given twice"),
                                   (["classroom", "--prot", "12000"], "no option --prot"), (["clasroom"], "no scenario clasroom")):
                done = subprocess.run(["./start", *arguments], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                      text=True)
                self.assertEqual((done.returncode, done.stdout), (2, ""), arguments)
                self.assertRegex(done.stderr, rf"\A./start: [^\n]*{why}[^\n]*\n\Z")
            done = subprocess.run(["./start", "--help"], cwd=folder, stdout=subprocess.PIPE, text=True)
            self.assertIn("Usage: ./start [SCENARIO]", done.stdout)

    def test_a_port_that_is_busy_is_refused_before_the_build(self):
        with socket.socket() as busy:
            busy.bind(("127.0.0.1", 0))
            busy.listen()
            port = str(busy.getsockname()[1])
            if int(port) > 65000:
                self.skipTest("that is no port of ours")
            done = subprocess.run(["./start", "--port", port], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(f"port {port} is busy", done.stderr)

    def test_a_busy_port_moves_it_to_another_block(self):
        with socket.socket() as busy:
            try:
                busy.bind(("127.0.0.1", 10000))
                busy.listen()
            except OSError:
                pass  # another program listens: equally good
            process, url, said = self.start()
            self.assertIn("Port 10000 is busy", said)
            self.assertNotIn(":10001/", url)
            self.check_that_it_drives_and_ends(process, url)


if __name__ == "__main__":
    unittest.main()
