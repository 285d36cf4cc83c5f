# SPDX-License-Identifier: MIT
"""Starts a class with `coopdyn host` on free ports and exchanges exact bytes with it."""
import csv
import http.client
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "daemon"))
import harness  # noqa: E402
from harness import BINARY, LIMIT_S, until  # noqa: E402,F401


class Seat(harness.Connection):
    """A connection to the class's port for programs, after its SEAT line."""

    def __init__(self, host, name, pin=None, language="", source=None):
        self.host = host
        self.buffer = b""
        self.socket = host.dial(source)
        self.write(f"SEAT {name} {host.pin(name) if pin is None else pin} {language}".rstrip() + "\n")
        self.said = self.read_line()

    def open(self, module):
        """Makes it a text connection to the module."""
        self.write(f"OPEN {module}\n")
        answer = self.read_line()
        assert answer == "ok", answer
        return self

    send, receive, ask, must = harness.Text.send, harness.Text.receive, harness.Text.ask, harness.Text.must


class Host:
    """`coopdyn host` and its folder; a context manager that ends it and all its daemons."""

    def __init__(self, lesson=None, *options, students=("ana", "ben"), folder=None, port="0"):
        self.own = tempfile.TemporaryDirectory() if folder is None else None
        self.folder = Path(folder or self.own.name)
        if folder is None:
            (self.folder / "class").mkdir()
            lines = [f"{name},{1000 + 111 * i}" for i, name in enumerate(students)]
            (self.folder / "list.csv").write_text("seat,pin\n" + "\n".join(lines) + "\n")
            (self.folder / "test.scenario").write_text(lesson or harness.scenario())
        self.words = [BINARY, "host", str(self.folder / "test.scenario"), "--folder", str(self.folder / "class"), *options]
        self.start(port, "--class", str(self.folder / "list.csv"))

    def start(self, port="0", *more):
        self.log = open(self.folder / "host.log", "ab")
        self.process = subprocess.Popen([*self.words, "--port", port, *more], stdout=subprocess.PIPE, stderr=self.log)
        ready = next((line.decode() for line in self.process.stdout if line.startswith(b"ready ")), None)
        assert ready, (self.folder / "host.log").read_text()
        self.port = int(re.search(r"names=\S+:(\d+)", ready).group(1))
        self.http_port = int(re.search(r"http=http://\S+:(\d+)/", ready).group(1))
        self.token = (self.folder / "class" / "token").read_text().strip()

    def roll(self):
        with open(self.folder / "class" / "class.csv", newline="") as file:
            return {row["seat"]: row for row in csv.DictReader(file)}

    def pin(self, name):
        return self.roll()[name]["pin"]

    def dial(self, source=None):
        import socket
        return socket.create_connection(("127.0.0.1", self.port), LIMIT_S, (source, 0) if source else None)

    def seat(self, name, *args, **named):
        return Seat(self, name, *args, **named)

    def module(self, name, module):
        return Seat(self, name).open(module)

    def fetch(self, method, path, body=None, headers=None, raw=False):
        """(status, text, headers) of one request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.http_port, timeout=LIMIT_S)
        given = dict(headers or {})
        if body is not None:
            given.setdefault("Content-Type", "application/json")
            body = json.dumps(body)
        connection.request(method, path, body, given)
        answer = connection.getresponse()
        read = answer.read()
        connection.close()
        return answer.status, read if raw else read.decode(), answer.headers

    def as_student(self, name):
        return {"Cookie": f"coopdyn_{name}={self.roll()[name]['link']}"}

    def as_teacher(self):
        return {"Cookie": f"coopdyn_wall={self.token}"}

    def order(self, **order):
        status, text, _ = self.fetch("POST", "/wall/class/do", order, self.as_teacher())
        assert status == 200, (status, text)

    def tiles(self):
        status, text, _ = self.fetch("GET", "/wall/class/seats", headers=self.as_teacher())
        assert status == 200, text
        return {tile["seat"]: tile for tile in json.loads(text)["seats"]}

    def tile(self, name, condition):
        """Waits until the condition holds for a seat's tile; returns the tile."""
        return until(lambda: next((tile for tile in [self.tiles()[name]] if condition(tile)), None))

    def me(self, name):
        status, text, _ = self.fetch("GET", f"/s/{name}/class/me", headers=self.as_student(name))
        assert status == 200, text
        return json.loads(text)

    def status(self, name):
        module = self.module(name, "/simulation")
        status = json.loads(module.must("get_status").text)
        module.close()
        return status

    def daemon(self, name):
        """The process id of a seat's daemon; 0: none."""
        mine = str(self.folder / "class" / "seats" / name / "door").encode()
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                words = Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if mine in words:
                return int(pid)
        return 0

    def await_other_daemon(self, name, old):
        """Waits until the seat has a new daemon to which the host passes connections."""
        until(lambda: self.daemon(name) not in (0, old) and self.tiles()[name]["daemon"] == "running")

    def kill(self):
        """Kills the host as a power cut would, but not the daemons."""
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.log.close()

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(LIMIT_S)
        self.process.stdout.close()
        self.log.close()
        return code

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        code = self.end()
        left = [name for name in self.roll() if self.daemon(name)]
        for name in left:
            os.kill(self.daemon(name), signal.SIGKILL)
        said = (self.folder / "host.log").read_text(errors="replace")
        if kind is not None:
            for log in sorted((self.folder / "class" / "seats").glob("*/daemon.log")):
                print(log.parent.name, log.read_text(errors="replace")[-1500:])
            print(said[-3000:])
        if self.own:
            self.own.cleanup()
        if kind is None:
            assert code == 0, f"exit code {code}\n{said[-3000:]}"
            assert not left, f"daemons that the host left behind: {left}"
