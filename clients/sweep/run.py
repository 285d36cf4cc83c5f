# SPDX-License-Identifier: MIT
"""One run of a sweep: starts a daemon, waits for its end, and returns the result. Imports no other file of ours, so that it
can be sent to a worker on another machine."""
import contextlib
import errno
import hashlib
import json
import os
import resource
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

_ENDED_AS_MEANT = ("duration", "score", "limit", "client", "supervisor")
_ENDED_BY_SIGNAL = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


class Lost(Exception):
    """Something external ended the run, so it has no result and must be repeated."""


class Started:
    """The processes of the current runs, so that all can be killed. Any thread."""

    def __init__(self):
        self._lock = threading.Lock()
        self._processes = set()
        self.killed = False  # true once nothing may be started

    def start(self, words, **options):
        with self._lock:
            if self.killed:
                raise Lost("the sweep stops")
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, **options)
            self._processes.add(process)
            return process

    def end(self, process):
        """Kills `process` if it still runs."""
        if process.poll() is None:
            process.kill()
            process.wait()
        with self._lock:
            self._processes.discard(process)

    def kill(self):
        """Kills all processes, and prevents further starts."""
        with self._lock:
            self.killed = True
            for process in self._processes:
                process.kill()


def run_one(job, started=None):
    """Executes `job`, a dictionary from plan.py, and returns its result, a dictionary. Raises Lost.

    A result has the job's key and inputs, the daemon's command, `ended`, `exit` (of the daemon), `steps`, `time_s`, `hash`,
    `scores` with their `units`, for those with an `until` whether it was `met` and when (`met_s`), `logged` and the `cpu`;
    `error` is null or says what was wrong. `wall_s` is the wall time, `started` the start, `host` the machine."""
    began, started_at = time.monotonic(), time.time()
    result = empty_result(job)
    inputs = job["inputs"]
    words = job["words"] + ["--summary", "/dev/stdout", "--with-process", str(os.getpid())]
    recording = None
    if job["record"] != "none":
        os.makedirs(job["recordings"], exist_ok=True)
        recording = os.path.join(job["recordings"], f"part-{job['key']}.run")
        _remove(recording)  # left by a lost run
        words += ["--record", recording]
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as heard:
        try:
            code, ended, told = _run(words, job, said, heard, started or Started())
        except Lost:
            if recording:
                _remove(recording)
            raise
        text, client_text = _content(said), _content(heard)
    if code != 0 and os.strerror(errno.ENOSPC) in text:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    changed = take_summary(told, result) + _changed_files(job)
    result["exit"] = code
    if ended and ended[0] == "client failed" and result["ended"] in _ENDED_AS_MEANT:
        ended = None  # the client failed after the end of the run, while the daemon was closing its files
    if ended:
        result["ended"] = ended[0]
        result["error"] = ended[1]
        if ended[0] == "client failed" and client_text:
            result["error"] += ": " + client_text.splitlines()[-1].strip()
    elif code != 0:
        result["error"] = last_words(text) or f"coopdyn ended with exit code {code}"
        if inputs["memory_limit_mib"]:
            result["error"] += f" (--memory-limit gives it {inputs['memory_limit_mib']} MiB)"
    if changed and not result["error"]:
        result["error"] = f"{', '.join(changed)}: not what it was when the sweep began: run the same command again"
    if recording and os.path.exists(recording):
        if job["record"] == "all" or result["error"]:
            os.replace(recording, os.path.join(job["recordings"], job["key"] + ".run"))
        else:
            os.remove(recording)
    return dict(result, **where_and_when(began, started_at))


def where_and_when(began, started_at):
    """The data of a run that differ each time, so are not part of its result."""
    return {"wall_s": round(time.monotonic() - began, 6), "host": socket.gethostname(),
            "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(started_at))}


def empty_result(job):
    """The initial result of a run."""
    return dict(job["inputs"], key=job["key"], command=shlex.join(job["words"]), ended=None, exit=None, steps=None, time_s=None, hash=None,
                scores={}, units={}, met={}, met_s={}, logged={}, cpu=None, error=None)


def _content(file):
    file.seek(0)
    return file.read().decode(errors="replace").strip()


def _remove(file):
    try:
        os.remove(file)
    except FileNotFoundError:
        pass


def _run(words, job, said, heard, started):
    """Runs the daemon. Returns its exit code, None or (how it ended, the error), and its standard output."""
    inputs = job["inputs"]
    limit = time.monotonic() + inputs["time_limit_s"] if inputs["time_limit_s"] else None
    client = None
    daemon = started.start(words, stdout=subprocess.PIPE, stderr=said, start_new_session=True)
    told = []
    reader = threading.Thread(target=lambda: told.append(daemon.stdout.read()))
    try:
        if inputs["memory_limit_mib"]:
            most = inputs["memory_limit_mib"] << 20
            resource.prlimit(daemon.pid, resource.RLIMIT_AS, (most, most))
        ended = None
        if inputs["client"]:
            client, ended = _start_client(daemon, job, heard, started)
        reader.start()
        if client:
            ended = _wait_for_client(daemon, client, limit)
        reader.join(None if limit is None else max(0.0, limit - time.monotonic()))  # Popen.wait() with a timeout would poll
        if reader.is_alive():
            ended = ("time limit", f"it took longer than {inputs['time_limit_s']:g} s: see --time-limit")
        else:
            daemon.wait()
    finally:
        for process in (client, daemon):
            if process:
                started.end(process)
        if reader.ident:
            reader.join()
        daemon.stdout.close()
    if ended is None and -daemon.returncode in _ENDED_BY_SIGNAL:
        raise Lost(f"the daemon got signal {-daemon.returncode}")
    return daemon.returncode, ended, told[0]


def _start_client(daemon, job, heard, started):
    """Starts the client once the daemon is ready. Returns the client and None, or None and the error."""
    for line in daemon.stdout:
        words = line.decode().split()
        if words[:1] == ["ready"]:
            server = words[1].partition("=")[2]
            command = [word.replace("{server}", server).replace("{seed}", str(job["inputs"]["seed"])) for word in shlex.split(job["inputs"]["client"])]
            environment = dict(os.environ, COOPDYN_SERVER=server, COOPDYN_SEAT="")
            try:
                return started.start(command, env=environment, stdout=heard, stderr=heard), None
            except OSError as error:
                daemon.terminate()
                return None, ("client failed", f"{command[0]} cannot be started: {error.strerror}")
    return None, None  # the daemon did not start; its output says why


def _wait_for_client(daemon, client, limit):
    """Waits until the client or the daemon has ended. After the client's end, shuts the daemon down in order."""
    try:
        while daemon.poll() is None:
            try:
                code = client.wait(0.02)
            except subprocess.TimeoutExpired:
                if limit is not None and time.monotonic() > limit:
                    return None  # the wait for the daemon reports it
                continue
            try:
                daemon.wait(0.5)  # the run may have ended, and then the client
            except subprocess.TimeoutExpired:
                daemon.terminate()
                daemon.wait()
                if code != 0:
                    return ("client failed", f"the client ended with exit code {code}")
                return ("client", None)
    finally:
        if client.poll() is None:
            try:
                client.wait(1)  # it notices that its daemon has ended
            except subprocess.TimeoutExpired:
                pass
    return None


def take_summary(told, result):
    """Copies the summary, the JSON in the daemon's output, to `result`; a killed daemon has none. Returns the names of digests
    that differ from the planned ones."""
    try:
        summary = json.loads(told[told.index(b"{"):])
    except ValueError:
        return []
    for key in ("ended", "steps", "time_s", "hash", "cpu"):
        result[key] = summary.get(key)
    for key in ("scores", "logged"):
        result[key] = {one["name"]: one["value"] for one in summary.get(key, [])}
    result["units"] = {one["name"]: one["unit"] for one in summary["scores"]}
    for key in ("met", "met_s"):
        result[key] = {one["name"]: one[key] for one in summary["scores"] if one["until"]}
    planned = {name: value for name, value in result["digests"].items() if not name.startswith(("client ", "input "))}
    return sorted({name for name, _ in planned.items() ^ summary["digests"].items()})


def _changed_files(job):
    """The files of the client and of --input that have changed since the sweep began."""
    changed = []
    for name, path in job["own_files"].items():
        with contextlib.suppress(OSError), open(path, "rb") as stream:
            if hashlib.sha256(stream.read()).hexdigest()[:16] != job["inputs"]["digests"][name]:
                changed.append(name)
    return changed


def last_words(text):
    lines = [line for line in text.splitlines() if "error" in line] or text.splitlines()[-1:]
    return "\n".join(lines[:20])


def run_file(file, number, folder):
    """A task of a Slurm array: runs the jobs in line `number` of `file`; writes each result once, to a file in `folder`."""
    with open(file, encoding="utf-8") as stream:
        jobs = json.loads(stream.read().splitlines()[number])
    for job in jobs:
        target = os.path.join(folder, job["key"] + ".json")
        if os.path.exists(target):
            continue
        try:
            result = run_one(job)
        except Lost as lost:
            print(f"{job['key']}: {lost}", file=sys.stderr)
            continue
        part = f"{target}.{os.getpid()}.part"
        _remove(part)  # left by a killed task
        with open(part, "x", encoding="utf-8") as stream:
            stream.write(json.dumps(result))
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, target)


if __name__ == "__main__":
    run_file(sys.argv[1], int(sys.argv[2]), sys.argv[3])
