# SPDX-License-Identifier: MIT
"""The sandbox in which a submission runs, by bubblewrap. Submission and simulator share a network namespace with nothing else in it. The
submission sees the machine's programs and libraries, read-only, and its own folder."""
import functools
import os
import shutil
import subprocess
import sys
import time

import seccomp
from plan import Wrong

kNobody = 65534
kFolder, kClients, kHome = "/submission", "/coopdyn", "/tmp"
kSystem = ("/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32", "/opt")
kSettings = ("alternatives", "fonts", "java", "ld.so.cache", "ld.so.conf", "ld.so.conf.d", "localtime", "matplotlibrc", "nsswitch.conf", "octave", "python3",
             "timezone")
kUsers = {"passwd": f"nobody:x:{kNobody}:{kNobody}::{kHome}:/bin/sh\n", "group": f"nogroup:x:{kNobody}:\n"}  # instead of the machine's
kShared_bytes = 16 << 20  # of /dev/shm
kFiles = 256  # open files per process
kMostOfFile_bytes = 1 << 30  # if the sandbox has no own disk
# The mathematics of libc, numpy and OpenBLAS round differently with newer instructions: without these a program computes the same on all
# x86-64 processors.
kSameBits = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F", "OPENBLAS_CORETYPE": "Prescott",
             "NPY_DISABLE_CPU_FEATURES": "AVX2,FMA3,AVX512F,AVX512CD,AVX512_SKX,AVX512_CLX,AVX512_CNL,AVX512_ICL"}
kHere = os.path.dirname(os.path.abspath(__file__))
kTicks = os.sysconf("SC_CLK_TCK")
kPage_bytes = os.sysconf("SC_PAGE_SIZE")


@functools.lru_cache(None)
def options_of_bwrap():
    return subprocess.run(["bwrap", "--help"], capture_output=True, text=True, check=False).stdout


def environment(server, submission, clients):
    """The environment variables of a submission's program; nothing of the grader's environment."""
    return {
        "PATH": "/usr/local/bin:/usr/bin:/bin", "HOME": kHome, "TMPDIR": kHome, "LANG": "C.UTF-8", "USER": "nobody", "COOPDYN_SERVER": server,
        "PYTHONPATH": os.path.join(clients, "python"), "OCTAVE_PATH": os.path.join(clients, "matlab"), "MATLABPATH": os.path.join(clients, "matlab"),
        "PYTHONDONTWRITEBYTECODE": "1", "PYTHONHASHSEED": "0", "PYTHONUNBUFFERED": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
        "PWD": submission, **(kSameBits if os.uname().machine == "x86_64" else {}),
    }


def limits(values, files=kFiles):
    """Of each process, as words before its command. RLIMIT_DATA, as RLIMIT_AS also counts what is only reserved."""
    cpu_s = int(values["time"]) + 1
    disk = values["disk"]
    return ["prlimit", f"--cpu={cpu_s}:{cpu_s + 1}", f"--data={values['memory']}", f"--fsize={disk}", f"--nofile={files}", "--core=1"]  # 1: not even for a handler of the machine, core(5)


class Sandbox:
    """Runs submissions on this machine. `who`: root, user, or none (--no-sandbox)."""

    def __init__(self, who):
        self.who = who

    def daemon_words(self, words):
        """The command of the simulator in its own network namespace. The process becomes the daemon."""
        if self.who == "none":
            return words
        return [sys.executable, "-I", "-S", os.path.join(kHere, "netns.py"), self.who, *words]

    def start(self, started, daemon, values, folder, clients, server, command):
        """Starts the program in `folder`, which drives the robots of the process `daemon`, by `started(words, **options)`."""
        read, write = os.pipe()
        try:
            os.write(write, seccomp.program(seccomp.kNetwork))
            os.close(write)
            words = self._words(daemon, values, folder, clients, server, command, read)
            return started(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True, cwd="/", pass_fds=[read])
        finally:
            os.close(read)

    def _words(self, daemon, values, folder, clients, server, command, filter_):
        own, seen = (folder, clients) if self.who == "none" else (kFolder, kClients)
        given = environment(server, own, seen)
        command = [word.replace("{submission}", own).replace("{server}", server) for word in command]
        if self.who == "none":
            return ["env", "-i", "-C", own, *(f"{name}={value}" for name, value in given.items()), *limits(values), *command]
        words = [*self._enter(daemon), *box(values, folder, clients, given)]
        words += ["--seccomp", str(filter_)] if seccomp.program(seccomp.kNetwork) else []
        return [*words, "--", *limits(values), f"--nproc={values['processes'] + 2}", *command]

    def _enter(self, daemon):
        """The command that enters the daemon's network; as root it also changes the user, because root's processes are not limited."""
        if self.who == "root":
            return ["nsenter", f"--target={daemon}", "--net", f"--setuid={kNobody}", f"--setgid={kNobody}"]
        return ["nsenter", f"--target={daemon}", "--user", "--net", "--preserve-credentials"]

    def try_out(self, clients):
        """Runs a program that does nothing. Returns what went wrong, empty if nothing did."""
        values = {"time": 10, "disk": 1 << 20, "memory": 256 << 20, "processes": 1, "reads": []}
        waiter = subprocess.Popen(self.daemon_words(["sh", "-c", "echo ready; read line"]), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True)
        try:
            if waiter.stdout.readline().strip() != "ready":
                return waiter.stderr.read().strip().rpartition("\n")[2]
            probe = self.start(subprocess.Popen, waiter.pid, values, clients, clients, "", ["true"])
            said = probe.communicate()[0].decode(errors="replace").strip()
            return "" if probe.returncode == 0 else said.rpartition("\n")[2] or f"exit code {probe.returncode}"
        finally:
            waiter.communicate("\n")

    def may_read(self, folder):
        """Lets the sandbox, and no other user, read `folder`."""
        if self.who == "root":
            os.chown(folder, -1, kNobody)
            os.chmod(folder, 0o750)


def machine(given):
    """The beginning of each box: nothing of the machine but programs, libraries and their settings, and the variables `given`."""
    words = ["bwrap", "--unshare-user", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try", "--die-with-parent", "--new-session",
             "--uid", str(kNobody), "--gid", str(kNobody), "--hostname", "sandbox", "--clearenv"]
    if "--disable-userns" in options_of_bwrap():
        words.append("--disable-userns")
    for name, value in given.items():
        words += ["--setenv", name, value]
    words += ["--ro-bind", "/usr", "/usr"]
    for path in kSystem:
        if os.path.islink(path):
            words += ["--symlink", os.readlink(path), path]
        elif os.path.isdir(path):
            words += ["--ro-bind", path, path]
    for name in kSettings:
        words += ["--ro-bind-try", f"/etc/{name}", f"/etc/{name}"]
    return words


def kernel_folders():
    return ["--proc", "/proc", "--dev", "/dev", "--size", str(kShared_bytes), "--tmpfs", "/dev/shm"]


def box(values, folder, clients, given):
    words = machine(given)
    for name in kUsers:
        words += ["--ro-bind", os.path.join(clients, name), f"/etc/{name}"]
    for path in values["reads"]:
        words += ["--ro-bind", path, path]
    words += [*kernel_folders(), "--size", str(values["disk"]), "--tmpfs", kHome]
    words += ["--ro-bind", clients, kClients, "--ro-bind", folder, kFolder, "--chdir", kFolder, "--remount-ro", "/proc", "--remount-ro", "/dev", "--remount-ro", "/"]
    return words


def is_root():
    """True for the machine's root, whose number of processes the kernel never limits."""
    with open("/proc/self/uid_map", encoding="ascii") as stream:
        return os.geteuid() == 0 and stream.read().split()[:2] == ["0", "0"]


def choose(wanted, clients):
    """The sandbox for this machine. Raises Wrong if none can be made."""
    if not wanted:
        return Sandbox("none")
    for name, package in (("bwrap", "bubblewrap"), ("nsenter", "util-linux"), ("prlimit", "util-linux")):
        if not shutil.which(name):
            raise Wrong(f"the sandbox needs {name}: apt-get install {package}. --no-sandbox runs submissions with your rights: only for your own")
    found = Sandbox("root" if is_root() else "user")
    said = found.try_out(clients)
    if not said:
        return found
    raise Wrong(f"the sandbox cannot be made on this machine: {said}. Containers often forbid it. In one that holds a single submission and nothing "
                "secret, --no-sandbox grades without it")


def children_of(process):
    """The process and all its descendants."""
    waiting, found = [process], []
    while waiting:
        one = waiting.pop()
        found.append(one)
        try:
            for task in os.listdir(f"/proc/{one}/task"):
                with open(f"/proc/{one}/task/{task}/children", encoding="ascii") as stream:
                    waiting += map(int, stream.read().split())
        except OSError:
            pass
    return found


def proportional_bytes(process):
    """The proportional set size of a process: memory shared with others counts in part."""
    try:
        with open(f"/proc/{process}/smaps_rollup", encoding="ascii") as stream:
            return sum(int(line.split()[1]) << 10 for line in stream if line.startswith("Pss:"))
    except (OSError, ValueError):
        return 0


class Watch:
    """Watches the resources that a process and its descendants use together, as rlimits hold only for single processes."""

    kEvery_s = 0.1

    def __init__(self, process, values):
        self._process, self._values, self._next = process, values, time.monotonic() + self.kEvery_s

    def look(self):
        """The limit that they exceed; None if none."""
        if time.monotonic() < self._next:
            return None
        ticks = resident = 0
        every = children_of(self._process)
        for one in every:
            try:
                with open(f"/proc/{one}/stat", encoding="ascii", errors="replace") as stream:
                    fields = stream.read().rpartition(")")[2].split()
                ticks += sum(map(int, fields[11:15]))
                resident += int(fields[21]) * kPage_bytes
            except (OSError, IndexError):
                pass
        self._next = time.monotonic() + self.kEvery_s
        if resident > self._values["memory"] and sum(map(proportional_bytes, every)) > self._values["memory"]:
            return "memory"
        return "time" if ticks / kTicks > self._values["time"] else None

