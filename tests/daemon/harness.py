"""Starts the real daemon on free ports and exchanges exact bytes with it. Uses none of our client libraries.

Nothing waits for a fixed time: every wait is for bytes, for the end of a process, or for a condition that is polled, with a
generous limit that only a hang reaches.
"""
import fcntl
import functools
import json
import os
import re
import shlex
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BINARY = os.environ.get("COOPDYN_BINARY", "build/release/coopdyn")
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # the tests send it, and nohup would make the programs ignore it
LIMIT_S = 60
BOX = "[BOX_1]\ntype box\nsize 0.3 0.3 0.3\nposition 0.9 0.1\nmass 1\n"


class Reply:
    """One message: error, text, command, params, data."""

    def __init__(self, error, text, command, params, data):
        self.error, self.text, self.command, self.params, self.data = error, text, command, params, data

    @property
    def time_s(self):
        return self.data[-2]

    @property
    def step(self):
        return int(self.data[-1])

    def __repr__(self):
        return f"Reply({self.error} {self.text!r} {self.command} {self.params} {self.data})"


_TEXT = re.compile(r'^(-?\d+) "((?:[^"\\]|\\.)*)" (-?\d+) (.*)$', re.S)
_UNESCAPED = {"n": "\n", "r": "\r", "t": "\t", '"': '"', "\\": "\\"}


def parse_line(line):
    """Parses the full form of the text encoding."""
    match = _TEXT.match(line)
    assert match, f"not a full form: {line!r}"
    text = re.sub(r"\\(.)", lambda m: _UNESCAPED[m.group(1)], match.group(2))
    words = match.group(4).split()
    count = int(words[0])
    params = [int(word) for word in words[1:1 + count]]
    data = [float(word) for word in words[2 + count:]]
    assert len(data) == int(words[1 + count]), line
    return Reply(int(match.group(1)), text, int(match.group(3)), params, data)


def frame(command, params=(), data=(), text=""):
    """A binary frame, without the magic."""
    raw = text.encode()
    body = struct.pack("<iiIII", 0, command, len(raw), len(params), len(data)) + raw
    body += struct.pack(f"<{len(params)}i", *params) + struct.pack(f"<{len(data)}d", *data)
    return struct.pack("<I", len(body)) + body


class Connection:
    """A socket with a buffer. Every read times out after LIMIT_S."""

    def __init__(self, address):
        self.socket = socket.create_connection(address, timeout=LIMIT_S)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.buffer = b""

    def write(self, data):
        self.socket.sendall(data if isinstance(data, bytes) else data.encode())

    def _more(self):
        chunk = self.socket.recv(65536)
        if not chunk:
            raise EOFError(f"closed by the daemon; unread: {self.buffer!r}")
        self.buffer += chunk

    def read_exactly(self, count):
        while len(self.buffer) < count:
            self._more()
        out, self.buffer = self.buffer[:count], self.buffer[count:]
        return out

    def read_line(self):
        while b"\n" not in self.buffer:
            self._more()
        line, self.buffer = self.buffer.split(b"\n", 1)
        return line.decode().rstrip("\r")

    def read_to_end(self):
        """Reads all bytes until the daemon closes."""
        try:
            while True:
                self._more()
        except (EOFError, ConnectionResetError):
            return self.buffer

    def has_bytes(self):
        """True if bytes can be read immediately."""
        if self.buffer:
            return True
        self.socket.setblocking(False)
        try:
            self.buffer += self.socket.recv(65536)
        except BlockingIOError:
            return False
        finally:
            self.socket.settimeout(LIMIT_S)
        return bool(self.buffer)

    def close(self):
        self.socket.close()


class Text(Connection):
    """A text connection to a module through OPEN on the name port, or directly to its port."""

    def __init__(self, daemon, module, direct=False):
        if direct:
            super().__init__(("127.0.0.1", daemon.module_port(module)))
        else:
            super().__init__(daemon.names)
            self.write(f"OPEN {module}\n")
            answer = self.read_line()
            assert answer == "ok", answer

    def send(self, line):
        self.write(line + "\n")

    def receive(self):
        """The next message that is not a comment."""
        while True:
            line = self.read_line()
            if line and not line.startswith("#"):
                return parse_line(line)

    def ask(self, line):
        self.send(line)
        return self.receive()

    def send_to_wait(self, line):
        """Sends a request that must wait for a robot; returns once it waits, so it has arrived and is unanswered."""
        self.send("verbose")
        self.send(line)
        said = ""
        while not said.startswith("# waiting for "):
            said = self.read_line()
            assert not said or said.startswith("#"), f"{line} was answered: {said}"

    def must(self, line):
        reply = self.ask(line)
        assert reply.error == 0, f"{line}: {reply}"
        return reply


class Binary(Connection):
    def __init__(self, daemon, module):
        super().__init__(daemon.names)
        self.write(f"OPEN {module}\n")
        assert self.read_line() == "ok"
        self.write(b"CDS1")

    def send(self, command, params=(), data=(), text=""):
        self.write(frame(command, params, data, text))

    def receive(self):
        size = struct.unpack("<I", self.read_exactly(4))[0]
        body = self.read_exactly(size)
        error, command, t, m, n = struct.unpack("<iiIII", body[:20])
        assert size == 20 + t + 4 * m + 8 * n
        text = body[20:20 + t].decode()
        params = list(struct.unpack(f"<{m}i", body[20 + t:20 + t + 4 * m]))
        return Reply(error, text, command, params, list(struct.unpack(f"<{n}d", body[20 + t + 4 * m:])))

    def ask(self, command, params=(), data=(), text=""):
        self.send(command, params, data, text)
        return self.receive()


def scenario(robots=1, extra="", mode="lockstep", robot_extra=None):
    """The text of a scenario with robots in a row, two metres apart, and a red target."""
    text = f"[SIMULATION]\nmode {mode}\nstep 0.01\n[FLOOR]\nsize 40 40 0.1\n[TARGET]\nred 3 0 0.3\n"
    for index in range(1, robots + 1):
        more = (robot_extra or {}).get(index, "")
        text += f"[ROBOT_{index}]\ntype coopbot\nname robot{index}\nposition 0 {2 * (index - 1)} 0\n{more}\n"
    return text + extra


class Daemon:
    """`coopdyn serve` (or another `verb` that serves) on free ports; a context manager that shuts it down and checks its exit
    code. `name`: instead of the scenario's text; "": neither. `before_exec` is called in the new process."""

    def __init__(self, text=None, *options, name=None, env=None, expect_exit=0, verb="serve", before_exec=None):
        self.folder = tempfile.TemporaryDirectory()
        self.expect_exit = expect_exit
        self.connections = []
        if name is None:
            path = Path(self.folder.name) / "test.scenario"
            path.write_text(text if text is not None else scenario())
            name = str(path)
        self.stderr_path = Path(self.folder.name) / "stderr"
        self.stderr_file = open(self.stderr_path, "wb")
        command = [BINARY, verb, *([name] if name else []), "--port", "0", *options]
        if "--no-http" not in options and "--http" not in options:
            command.append("--no-http")
        command = [word for word in command if word != "--http"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.stderr_file,
                                        env={**os.environ, **(env or {})}, preexec_fn=before_exec)
        self.ready = next((line.decode() for line in self.process.stdout if line.startswith(b"ready ")), None)
        if self.ready is None:
            self.process.wait()
            raise AssertionError(f"no ready line: {shlex.join(map(str, command))}\n{self.stderr()}")
        names = re.search(r"names=(\S+)", self.ready).group(1)
        self.names = None
        if names != "off":
            host, port = names.rsplit(":", 1)
            self.names = (host.strip("[]"), int(port))
        self.http = re.search(r"http=(\S+)", self.ready).group(1)

    def stderr(self):
        return self.stderr_path.read_text(errors="replace")

    def keep(self, connection):
        self.connections.append(connection)
        return connection

    def text(self, module, direct=False):
        return self.keep(Text(self, module, direct))

    def binary(self, module):
        return self.keep(Binary(self, module))

    def raw(self, module=None):
        """A raw connection to a module's own port; without a module, to the name port."""
        return self.keep(Connection(("127.0.0.1", self.module_port(module)) if module else self.names))

    def module_port(self, module):
        connection = Connection(self.names)
        connection.write(f"NAME_SERVER query {module}\n")
        match = re.match(r"registration name \S+ ip (\S+) port (\d+) type tcp", connection.read_line())
        connection.close()
        return int(match.group(2))

    def status(self):
        connection = Text(self, "/simulation")
        reply = connection.must("get_status")
        connection.close()
        return json.loads(reply.text)

    def awaited(self, for_s=0):
        """The robots that lockstep has waited for (at most 20), for at least for_s."""
        return [robot["robot"] for robot in self.status()["awaiting"] if robot["seconds"] >= for_s]

    def open_files(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def threads(self):
        return len(os.listdir(f"/proc/{self.process.pid}/task"))

    def end(self, signum=signal.SIGTERM):
        """Ends the daemon; returns its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signum)
        try:
            return self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        code = self.end()
        for connection in self.connections:
            connection.close()
        self.process.stdout.close()
        self.stderr_file.close()
        said = self.stderr()
        self.folder.cleanup()
        if kind is None:
            assert code == self.expect_exit, f"exit code {code}\n{said[-6000:]}"
        else:
            print(f"exit code {code}\n{said[-3000:]}")


def set_address(interface, address):
    """Sets the address of an interface of this network namespace and brings it up."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as handle:
        name = interface.encode().ljust(16, b"\0")
        packed = struct.pack("=HH4s8x", socket.AF_INET, 0, socket.inet_aton(address))
        fcntl.ioctl(handle, 0x8916, name + packed)  # SIOCSIFADDR
        fcntl.ioctl(handle, 0x8914, name + struct.pack("=h", 0x1 | 0x40) + bytes(14))  # SIOCSIFFLAGS: up, running


def run_in_new_network(*command, env=None):
    """Runs a Python command in a new network namespace; returns its output. It begins with set_address("lo", …)."""
    unshare = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
    done = subprocess.run([*unshare, sys.executable, *map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          timeout=10 * LIMIT_S, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **(env or {})})
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout.decode()}")
    return done.stdout.decode()


def with_own_ports(test):
    """Decorates a test that needs certain ports: runs it in a new network namespace, where no other program uses them."""
    @functools.wraps(test)
    def run(self):
        if os.environ.get("COOPDYN_TEST_NETWORK") == self.id():
            set_address("lo", "127.0.0.1")
            test(self)
        else:
            run_in_new_network("-m", "unittest", self.id(), env={"COOPDYN_TEST_NETWORK": self.id()})
    return run


def until(condition, limit_s=LIMIT_S):
    """Polls until the condition returns a true value, and returns that."""
    end = time.monotonic() + limit_s
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < end, "the awaited condition did not come"
