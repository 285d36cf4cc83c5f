# SPDX-License-Identifier: MIT
"""One graded run: a private simulator in lockstep, and the submission's program in the sandbox. Its end is reported in a sentence."""
import contextlib
import errno
import os
import resource
import select
import signal
import subprocess
import tempfile
import time

import run
from sandbox import Watch

kKept_bytes = 32 << 10  # of the output's beginning, and again of its end
kFlood_bytes = 16 << 20
kDaemon_bytes = 4 << 30
kDaemonFile_bytes = 4 << 30
kStart_s, kGrace_s, kStop_s = 120, 1.0, 20
kTick_ms = 50
kChunk = 64 << 10
kByItself = ("score", "limit", "duration", "supervisor")  # ends of a run that nobody stops


class Output:
    """The beginning and the end of a program's output."""

    def __init__(self):
        self.count, self._head, self._tail = 0, b"", b""

    def add(self, chunk):
        self.count += len(chunk)
        room = kKept_bytes - len(self._head)
        self._head += chunk[:room]
        self._tail = (self._tail + chunk[room:])[-kKept_bytes:] if len(chunk) > room else self._tail

    @property
    def is_binary(self):
        return any(byte < 32 and byte not in b"\a\b\t\n\v\f\r\x1b" for byte in self._head + self._tail)

    def text(self):
        left_out = self.count - len(self._head) - len(self._tail)
        return shown(self._head) + (f"\n… {left_out:,} bytes left out …\n" if left_out else "") + shown(self._tail)

    def last_line(self):
        lines = [line.strip() for line in shown(self._tail or self._head).splitlines() if line.strip()]
        return lines[-1][-300:] if lines else ""


def shown(data):
    """Bytes as text: what cannot be printed stands as \\x…."""
    return printable(data.decode("utf-8", "backslashreplace").replace("\r\n", "\n"))


def printable(text):
    return "".join(c if c in "\n\t" or c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def in_words(count):
    return f"{count >> 20} MiB" if count >= 1 << 20 else f"{count} bytes"


class BoxRun:
    """A daemon and its client, until both have ended. `reason`: why the client was stopped: None, time, clock, memory, flood."""

    def __init__(self, job, started):
        self._job, self._started = job, started
        self.output, self.told, self.reason, self.code = Output(), b"", None, None
        self._client = self._daemon = None

    def go(self, said):
        words = self._job["sandbox"].daemon_words(self._job["words"] + ["--summary", "/dev/stdout", "--with-process", str(os.getpid())])
        environment = {name: value for name, value in os.environ.items() if not name.startswith("COOPDYN_") or name == "COOPDYN_PATH"}
        self._daemon = self._started.start(words, stdout=subprocess.PIPE, stderr=said, start_new_session=True, env=environment)
        for what, most in ((resource.RLIMIT_DATA, kDaemon_bytes), (resource.RLIMIT_FSIZE, kDaemonFile_bytes)):
            with contextlib.suppress(ProcessLookupError, ValueError, PermissionError):
                resource.prlimit(self._daemon.pid, what, (most, most))
        try:
            server = self._wait_until_ready()
            if server:
                self._drive(server)
            self._end_daemon()
        finally:
            for process in (self._client, self._daemon):
                if process:
                    self._end(process)
        return self._daemon.returncode

    def _end(self, process):
        if self._job["sandbox"].who == "none" and process is self._client:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
        self._started.end(process)
        process.stdout.close()

    def _hear(self, timeout_s):
        """Reads the daemon's next output; False at its end."""
        poll = select.poll()
        poll.register(self._daemon.stdout, select.POLLIN)
        if not poll.poll(timeout_s * 1000):
            return True
        chunk = os.read(self._daemon.stdout.fileno(), kChunk)
        self.told += chunk
        return bool(chunk)

    def _wait_until_ready(self):
        limit = time.monotonic() + kStart_s
        while time.monotonic() < limit:
            for line in self.told.splitlines():
                words = line.decode(errors="replace").split()
                if words[:1] == ["ready"] and b"\n" in self.told[self.told.index(b"ready"):]:
                    return words[1].partition("=")[2]
            if not self._hear(limit - time.monotonic()):
                return None
        return None

    def _drive(self, server):
        job = self._job
        self._client = client = job["sandbox"].start(self._started.start, self._daemon.pid, job["values"], job["folder"], job["clients"], server, job["command"])
        os.set_blocking(client.stdout.fileno(), False)
        watch = Watch(client.pid, job["values"])
        limit = time.monotonic() + job["values"]["clock"]
        poll, ended, output = select.poll(), os.pidfd_open(client.pid), client.stdout.fileno()
        over = False
        try:
            for one in (ended, output, self._daemon.stdout.fileno()):
                poll.register(one, select.POLLIN)
            while self.reason is None and not over:
                ready = {one for one, _ in poll.poll(kTick_ms)}
                if output in ready and not self._read(output):
                    poll.unregister(output)
                if ended in ready:
                    self.code = client.wait()
                    break
                over = self._daemon.stdout.fileno() in ready and not self._hear(0)
                self.reason = self.reason or watch.look() or ("clock" if time.monotonic() > limit else None)
            if over:  # the client notices, and may still print something
                select.select([ended], [], [], kGrace_s)
            if self.reason is None:
                self._read(output)
        finally:
            os.close(ended)

    def _read(self, output):
        """Reads the client's output; False at its end."""
        while self.reason is None:
            try:
                chunk = os.read(output, kChunk)
            except BlockingIOError:
                return True
            if not chunk:
                return False
            self.output.add(chunk)
            if self.output.count > kFlood_bytes:
                self.reason = "flood"
        return True

    def _end_daemon(self):
        """Shuts the daemon down in order, so that its recording is complete. First waits for a run whose score may just end it."""
        limit = time.monotonic() + (kGrace_s / 2 if self.reason is None else 0)
        if self._client and self.reason:
            self._client.kill()
        while self._hear(max(0, limit - time.monotonic())):
            if time.monotonic() >= limit:
                break
        else:
            limit = 0
        if limit:
            self._daemon.terminate()
            limit = time.monotonic() + kStop_s
        while time.monotonic() < limit and self._hear(max(0, limit - time.monotonic())):
            pass
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._daemon.wait(kStop_s)


def carry_out(job, started):
    """Executes a job; returns its result, a dictionary for results.json. Raises run.Lost.

    `sentence` says how the run ended; a `void` run earns nothing; `trouble` is a failure of ours, not of the submission."""
    for path in (job["part"], job["recording"]):
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
    os.makedirs(os.path.dirname(job["recording"]), exist_ok=True)
    one, began, started_at = BoxRun(job, started), time.monotonic(), time.time()
    with tempfile.TemporaryFile() as said:
        code = one.go(said)
        said.seek(0)
        log = said.read(1 << 20).decode(errors="replace")
    if code != 0 and os.strerror(errno.ENOSPC) in log:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    if started.killed:
        raise run.Lost("the grading stops")
    found = {"digests": {}}
    run.take_summary(one.told, found)
    result = {name: found.get(name) for name in ("steps", "time_s", "hash")}
    result.update(key=job["key"], label=job["label"], hidden=job["hidden"], seed=None if job["hidden"] else job["seed"],
                  scores=found.get("scores", {}), units=found.get("units", {}), met_s=found.get("met_s", {}), met=found.get("met", {}),
                  ended=one.reason or ("client" if found.get("ended") not in kByItself else found["ended"]), recording=None, trouble=None)
    if found.get("steps") is None:
        result["trouble"] = "The simulator failed: " + (run.last_words(log) or f"it ended with exit code {code}") + "."
    elif os.path.exists(job["part"]):
        os.replace(job["part"], job["recording"])
        result["recording"] = os.path.relpath(job["recording"], job["out"])
    result["void"], result["sentence"] = judge(one, result, code, log, job)
    result["output"] = "" if job["hidden"] else one.output.text()
    return dict(result, **run.where_and_when(began, started_at))


def judge(one, result, code, log, job):
    """(void, sentence)."""
    values, said, over = job["values"], "" if job["hidden"] else one.output.last_line(), result["ended"] in kByItself
    if result["trouble"]:
        return True, result["trouble"]
    if one.reason == "flood":
        return True, f"The program printed more than {in_words(kFlood_bytes)}."
    if one.reason == "memory":
        return True, f"The program took more than {in_words(values['memory'])} of memory."
    if one.reason == "time" or (one.code == 128 + signal.SIGXCPU and not over):
        return True, f"The program took more than {values['time']:g} s of processor time: the run had not ended after {result['time_s']:g} s."
    if one.reason == "clock":
        return True, f"The program did not end: the run was at {result['time_s']:g} s after {values['clock']:g} s by the clock."
    if one.output.is_binary:
        return True, f"The program printed bytes that are not text ({in_words(one.output.count)})."
    if code == 4:
        return True, "The run failed: " + (run.last_words(log) or "a body was frozen") + "."
    if one.code not in (0, None) and not over:
        return True, failed(one.code if one.code > 0 else 128 - one.code, said, values)
    if not result["steps"]:
        return True, "The program ended before the first step: it never drove." + (f" It said: {said}" if said else "")
    if over and result["ended"] == "score":
        return False, f"The goal was reached at {result['time_s']:g} s."
    if over:
        return False, f"The run reached its end, {result['time_s']:g} s."
    return False, f"The program ended at {result['time_s']:g} s."


def failed(code, said, values):
    if "without the token" in said:
        return "The program tried to change the world or the run: a submission drives its robots and nothing else."
    if code == 128 + signal.SIGXFSZ:
        return f"The program wrote a file of more than {in_words(values['disk'])}."
    if code > 128:
        with contextlib.suppress(ValueError):
            return f"The program was ended by signal {code - 128} ({signal.Signals(code - 128).name})." + (f" It said: {said}" if said else "")
    return f"The program ended with exit code {code}" + (f": {said}" if said else ".")
