# SPDX-License-Identifier: MIT
"""Runs a student's program for `coopdyn host`, in the sandbox of grading: run_program.py NAME PROGRAM.py MEMORY_MIB. Its standard
input is a socket of packets to the host. It sends

    L and a descriptor   a listening socket: who connects to it is the student's program
    O and a text         what the program printed: UTF-8 without control characters but tabs and line ends
    E and JSON           the end, {"sentence", "error": true if that is the program's fault, "line": of the program, or 0}

and ends the program when the host ends the connection, as it does when it dies. Nothing that the program writes is kept."""
import codecs
import ctypes
import contextlib
import json
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import time

kHere = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(kHere, "..", "grade"), os.path.join(kHere, "..", "sweep")]

import sandbox  # noqa: E402
import seccomp  # noqa: E402
from box_run import in_words, kFlood_bytes, printable  # noqa: E402

kFolder, kSocket = "/program", "/run/coopdyn.sock"
kProgram = kFolder + "/program.py"
kBegin, kClient = sandbox.kClients + "/begin.py", sandbox.kClients + "/python/coopdyn.py"
kRun_bytes, kDisk_bytes = 64 << 10, 32 << 20  # of the folder of the socket; of each folder in which the program may write
kProcesses = 32  # and threads
kProcessor_s, kClock_s = 3600, 2 * 3600
kLook_ms = 50  # at what it printed: a program that prints more than it may has to wait
kPipe_bytes = 64 << 10
kPacket_bytes = 16 << 10
kTail = 4000  # characters, in which the error is looked for
kOpened = 4 * sandbox.kFiles  # of begin.py: more than the descriptors that all programs together may have under way (unix(7))
kLeast_share = 0.05  # of the machine's memory, which must be left
kSetChildSubreaper = 36  # prctl(2)
kLessOfTheProcessors = "10"  # the nice value of the box among all others, autogroup in sched(7)
kError = re.compile(r'^\s*File "%s", line (\d+)' % re.escape(kProgram), re.MULTILINE)
kCannotAsk = ". A program here cannot ask with input()."


class Box:
    """The process of bubblewrap with the program in it. `out`: the socket through which begin.py sends its own."""

    def __init__(self, name, program, memory_bytes):
        self.values = {"time": kProcessor_s, "disk": kDisk_bytes, "memory": memory_bytes, "processes": kProcesses}
        self.out, inside = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with contextlib.ExitStack() as files:
            files.enter_context(inside)
            passed = [inside.fileno()]

            def keep(descriptor):
                files.callback(os.close, descriptor)
                passed.append(descriptor)
                return str(descriptor)

            def content(data):
                read, write = os.pipe()  # which holds as much
                with os.fdopen(write, "wb") as stream:
                    stream.write(data)
                return keep(read)

            words = self._words(name, program, keep, content, str(inside.fileno()))
            other = {"user": sandbox.kNobody, "group": sandbox.kNobody, "extra_groups": []} if sandbox.is_root() else {}
            self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd="/", start_new_session=True,
                                            pass_fds=passed, env={"PATH": os.environ.get("PATH", "/usr/bin:/bin")}, **other)
        os.set_blocking(self.process.stdout.fileno(), False)

    def _words(self, name, program, keep, content, inside):
        given = dict(sandbox.environment("unix:" + kSocket, kFolder, sandbox.kClients), USER=name, MPLBACKEND="Agg")
        words = [*sandbox.machine(given), *hidden(program), "--unshare-net", *sandbox.kernel_folders(), "--ro-bind", "/dev/null", "/dev/zero", "--size", str(kRun_bytes), "--tmpfs", os.path.dirname(kSocket)]
        for folder in (sandbox.kHome, kFolder):
            words += ["--size", str(kDisk_bytes), "--tmpfs", folder]
        for user, text in sandbox.kUsers.items():
            words += ["--file", content(text.encode()), "/etc/" + user]
        for path, there in ((program, kProgram), (os.path.join(kHere, "begin.py"), kBegin), (os.path.join(kHere, "..", "python", "coopdyn.py"), kClient)):
            words += ["--file", keep(os.open(path, os.O_RDONLY)), there]
        words += ["--chdir", kFolder, "--remount-ro", "/proc", "--remount-ro", "/dev", "--remount-ro", "/"]
        filter_ = seccomp.program(seccomp.kLocal)
        words += ["--seccomp", content(filter_)] if filter_ else []
        return [*words, "--", *sandbox.limits(self.values, kOpened), f"--nproc={kProcesses + 2}", "python3", "-I", "-S", kBegin, inside, kSocket, "python3", kProgram]

    def give_way(self):
        """Its processes get less of the processors than others."""
        for one in sandbox.children_of(self.process.pid):
            with contextlib.suppress(OSError), open(f"/proc/{one}/autogroup", "w", encoding="ascii") as stream:
                stream.write(kLessOfTheProcessors)

    def end(self):
        """Ends all processes of the box, also one that has freed itself of bubblewrap: it is our child then."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGSTOP)  # it must not make another one meanwhile
        for one in sandbox.children_of(os.getpid())[1:]:
            with contextlib.suppress(ProcessLookupError):
                os.kill(one, signal.SIGKILL)
        self.process.wait()


class Talk:
    """What the program prints, on its way to the host."""

    def __init__(self, host):
        self._host, self._decoder = host, codecs.getincrementaldecoder("utf-8")("backslashreplace")
        self.count, self.tail = 0, ""

    def add(self, data, final=False):
        self.count += len(data)
        text = printable(self._decoder.decode(data, final).replace("\r\n", "\n").replace("\r", "\n"))
        self.tail = (self.tail + text)[-kTail:]
        most = kPacket_bytes // 4
        for start in range(0, len(text), most):
            self._host.send(b"O" + text[start:start + most].encode())

    def last_line(self):
        lines = [line.strip() for line in self.tail.splitlines() if line.strip()]
        return lines[-1][-300:] if lines else ""


class ProgramRun:
    """A program until its end."""

    def __init__(self, host, box):
        self._host, self._box, self._talk = host, box, Talk(host)
        self._entered = False  # begin.py has run
        self._reason, self._code = None, None

    def go(self):
        watch, limit = sandbox.Watch(self._box.process.pid, self._box.values), time.monotonic() + kClock_s
        poll, ended = select.poll(), os.pidfd_open(self._box.process.pid)
        for one in (ended, self._host.fileno(), self._box.out.fileno()):
            poll.register(one, select.POLLIN)
        look = 0.0
        while self._reason is None and self._code is None:
            ready = {one for one, _ in poll.poll(kLook_ms)}
            if self._box.out.fileno() in ready:
                self._take_door(poll)
            if self._host.fileno() in ready:
                self._reason = "stop"
            elif ended in ready:
                self._code = self._box.process.wait()
            else:
                self._reason = watch.look() or ("clock" if time.monotonic() > limit else None)
                if time.monotonic() >= look and is_machine_full():
                    self._reason = "machine"
            if time.monotonic() >= look or self._code is not None:
                self._read()
                look = time.monotonic() + kLook_ms / 1000
        os.close(ended)
        self._box.end()
        self._read()
        self._talk.add(b"", final=True)

    def _take_door(self, poll):
        data, descriptors, _, _ = socket.recv_fds(self._box.out, 1, 1)
        poll.unregister(self._box.out)
        if data and descriptors:
            self._entered = True
            self._box.give_way()
            socket.send_fds(self._host, [b"L"], descriptors)
        for one in descriptors:
            os.close(one)

    def _read(self):
        with contextlib.suppress(BlockingIOError):
            self._talk.add(os.read(self._box.process.stdout.fileno(), kPipe_bytes))
        if self._talk.count > kFlood_bytes and self._reason is None and self._code is None:
            self._reason = "flood"

    def outcome(self):
        sentence, error = self._sentence()
        lines = kError.findall(self._talk.tail) if error and self._code == 1 else []
        return {"sentence": sentence, "error": error, "line": int(lines[-1]) if lines else 0}

    def _sentence(self):
        most = {"memory": in_words(self._box.values["memory"]) + " of memory", "time": f"{kProcessor_s} s of processor time", "clock": f"{kClock_s // 3600} h"}
        if self._reason == "stop":
            return "The program was stopped.", False
        if self._reason == "flood":
            return f"The program printed more than {in_words(kFlood_bytes)}, so it was stopped: print less often.", True
        if self._reason == "machine":
            return "The server has hardly any memory left, so the program was stopped.", True
        reason = "time" if self._code == 128 + signal.SIGXCPU else self._reason
        if reason:
            return f"The program took more than {most[reason]}, so it was stopped.", True
        if not self._entered:
            return no_box(self._talk.last_line() or f"exit code {self._code}"), True
        if self._code == 0:
            return "The program has ended.", False
        return failed(self._code, self._talk.last_line()), True


def hidden(program):
    """Options that hide the folder of the class where it lies in one that the box shows: a box of a host that is not root could read it."""
    folder = os.path.realpath(os.path.join(os.path.dirname(program), "..", ".."))
    shown = any(os.path.commonpath([folder, os.path.realpath(path)]) == os.path.realpath(path) for path in ("/usr", *sandbox.kSystem))
    return ["--tmpfs", folder] if shown else []


def is_machine_full():
    with open("/proc/meminfo", encoding="ascii") as stream:
        kib = {line.split(":")[0]: int(line.split()[1]) for line in stream}
    return kib.get("MemAvailable", kib["MemTotal"]) < kLeast_share * kib["MemTotal"]


def no_box(why):
    return f"Programs cannot run on this server, because their sandbox cannot be made: {why}. Tell your teacher."


def failed(code, last):
    if code == 1 and last:
        return f"The program ended with an error: {last}" + (kCannotAsk if last.startswith("EOFError") else "")
    if code in (128 + signal.SIGKILL, 128 + signal.SIGXFSZ):
        return "The program was ended by the system: it killed itself, or took more memory or disk than it may."
    if code < 0:
        return "The program was ended by the system, with its sandbox."
    if code > 128:
        with contextlib.suppress(ValueError):
            return f"The program was ended by signal {code - 128} ({signal.Signals(code - 128).name})."
    return f"The program ended with exit code {code}."


def main():
    ctypes.CDLL(None).prctl(kSetChildSubreaper, 1, 0, 0, 0)
    with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w", encoding="ascii") as stream:
        stream.write("1000")  # if the machine has no memory left, a program is the first to go
    name, program, memory_bytes = sys.argv[1], sys.argv[2], int(sys.argv[3]) << 20
    host = socket.socket(fileno=os.dup(0))
    missing = [package for tool, package in (("bwrap", "bubblewrap"), ("prlimit", "util-linux")) if not shutil.which(tool)]
    if missing:
        outcome = {"sentence": no_box(f"the server needs apt-get install {' '.join(missing)}"), "error": True, "line": 0}
    else:
        box = Box(name, program, memory_bytes)
        run = ProgramRun(host, box)
        try:
            run.go()
        except ConnectionError:  # the host has died
            return box.end()
        outcome = run.outcome()
    with contextlib.suppress(ConnectionError):
        host.send(b"E" + json.dumps(outcome, ensure_ascii=False).encode())
    return None


if __name__ == "__main__":
    main()
