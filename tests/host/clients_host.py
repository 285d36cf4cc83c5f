# SPDX-License-Identifier: MIT
"""A class for a test of clients: the real host with two seats, ana (PIN 0912) and ben (7305)."""
import json
import os
import pathlib
import re
import select
import signal
import socket
import subprocess
import tempfile
import unittest
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIMIT_S = 60
PINS = {"ana": "0912", "ben": "7305"}


def free_ports():
    """The first of two ports of which nobody has either."""
    while True:
        with socket.create_server(("127.0.0.1", 0)) as names, socket.socket() as pages:
            port = names.getsockname()[1]
            try:
                pages.bind(("127.0.0.1", port + 1))
                return port
            except (OSError, OverflowError):
                pass


class Host:
    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        folder = pathlib.Path(self.folder.name)
        (folder / "list.csv").write_text("name,pin\n" + "".join(f"{s.title()},{p}\n" for s, p in PINS.items()), encoding="utf-8")
        self.seats = folder / "class" / "seats"
        self.log = open(folder / "log", "w+", encoding="utf-8")
        self.process = subprocess.Popen(
            [os.environ["COOPDYN_BINARY"], "host", "classroom", "--class", str(folder / "list.csv"), "--port", str(free_ports()),
             "--folder", str(folder / "class")], stdout=subprocess.PIPE, stderr=self.log, text=True)
        readable, _, _ = select.select([self.process.stdout], [], [], LIMIT_S)
        found = re.match(r"ready names=(\S+) http=(\S+) seats=2", self.process.stdout.readline() if readable else "")
        said = (folder / "log").read_text(encoding="utf-8")
        if not found:
            self.stop()
            raise AssertionError("the host did not get ready: " + said)
        self.server, self.page = found.groups()
        self.token = re.search(r"token (\w+)", said).group(1)

    def stop(self):
        self.process.terminate()
        try:
            self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()
        self.log.close()
        self.folder.cleanup()

    def tile(self, seat):
        """What the wall shows of a seat."""
        request = urllib.request.Request(self.page + "wall/class/seats", headers={"Authorization": f"Bearer {self.token}"})
        with urllib.request.urlopen(request, timeout=LIMIT_S) as answer:
            return next(tile for tile in json.load(answer)["seats"] if tile["seat"] == seat)

    def kill_daemon(self, seat):
        """Kills the daemon of a seat, and waits for its end."""
        door = str(self.seats / seat / "door").encode()
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if b"serve" in words and door in words:
                pid = int(process.name)
                handle = os.pidfd_open(pid)
                os.kill(pid, signal.SIGKILL)
                select.select([handle], [], [], LIMIT_S)
                os.close(handle)
                return
        raise AssertionError("the seat has no daemon")


class HostTestCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.host = Host()
        cls.addClassCleanup(cls.host.stop)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.variables = dict(os.environ, COOPDYN_ROOT=str(ROOT), PYTHONPATH=str(ROOT / "clients" / "python"),
                              COOPDYN=os.environ["COOPDYN_BINARY"], COOPDYN_SERVER=self.host.server)
        for name in ("COOPDYN_SEAT", "DISPLAY"):
            self.variables.pop(name, None)
