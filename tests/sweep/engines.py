# SPDX-License-Identifier: MIT
"""A Dask cluster and a Slurm cluster of one machine, started and ended by a test."""
import contextlib
import os
import shutil
import signal
import socket
import subprocess
import time


HELD = []  # sockets that reserve ports until these tests end


def held_port():
    """A port without a listener that only a program that asks for it can use."""
    holder = socket.socket()
    holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # so that this program may listen
    holder.bind(("127.0.0.1", 0))
    HELD.append(holder)
    return holder.getsockname()[1]


def until(condition, what, limit_s=60):
    """Waits until condition() is true."""
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"not within {limit_s} s: {what}")
        time.sleep(0.05)


def answers(words, **given):
    return subprocess.run(words, capture_output=True, text=True, check=False, **given)


def children(pid):
    """The child processes of `pid`."""
    found = set()
    for task in os.listdir(f"/proc/{pid}/task"):
        with contextlib.suppress(OSError), open(f"/proc/{pid}/task/{task}/children", encoding="ascii") as stream:
            found.update(stream.read().split())
    return found


@contextlib.contextmanager
def processes():
    """A list of processes; ends them and their children's groups at exit."""
    every = []
    try:
        yield every
    finally:
        for process in reversed(every):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)
        for process in every:
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def start(words, log, **given):
    with open(log, "ab") as stream:
        return subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=stream, stderr=stream, start_new_session=True, **given)


class Dask:
    """A scheduler on a free port. `workers`: their processes."""

    def __init__(self, folder, every):
        self.address = f"tcp://127.0.0.1:{held_port()}"
        self.workers = []
        self._folder, self._every = folder, every
        port = self.address.rpartition(":")[2]
        every.append(start(["dask-scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"], os.path.join(folder, "scheduler.log")))
        for _ in range(2):
            self.add_worker()

    def add_worker(self):
        name = f"worker{len(self.workers)}"
        place = os.path.join(self._folder, name)
        worker = start(["dask-worker", self.address, "--nthreads", "1", "--no-dashboard", "--local-directory", place], place + ".log")
        self.workers.append(worker)
        self._every.append(worker)


def start_slurm(folder, every):
    """Starts munged, slurmctld and slurmd in `folder`; returns the environment that Slurm's commands need."""
    def path(name):
        return os.path.join(folder, name)

    os.chmod(folder, 0o755)
    host = socket.gethostname().partition(".")[0]
    with open(path("munge.key"), "wb") as stream:
        stream.write(os.urandom(1024))
    os.chmod(path("munge.key"), 0o600)
    for name in ("state", "spool"):
        os.mkdir(path(name))
    with open(path("slurm.conf"), "w", encoding="utf-8") as stream:
        stream.write(f"""ClusterName=coopdyn
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={held_port()}
SlurmdPort={held_port()}
AuthType=auth/munge
AuthInfo=socket={path("munge.socket")}
SlurmUser=root
StateSaveLocation={path("state")}
SlurmdSpoolDir={path("spool")}
SlurmctldPidFile={path("slurmctld.pid")}
SlurmdPidFile={path("slurmd.pid")}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MinJobAge=10
NodeName=node1 NodeHostname={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=main Nodes=node1 Default=YES State=UP
""")
    environment = dict(os.environ, SLURM_CONF=path("slurm.conf"))
    every.append(start([shutil.which("munged", path="/usr/sbin:/sbin"), "--foreground", "--force", "--socket", path("munge.socket"), "--key-file", path("munge.key"),
                        "--pid-file", path("munged.pid"), "--log-file", path("munged.log"), "--seed-file", path("munged.seed")], path("munged.out")))
    until(lambda: os.path.exists(path("munge.socket")), "munged listens")
    for words in (["/usr/sbin/slurmctld", "-D", "-i"], ["/usr/sbin/slurmd", "-D", "-N", "node1"]):
        every.append(start(words, path(os.path.basename(words[0]) + ".log"), env=environment))
    until(lambda: "idle" in answers(["sinfo", "--noheader", "--format=%T"], env=environment).stdout, "Slurm's node is idle")
    return environment
