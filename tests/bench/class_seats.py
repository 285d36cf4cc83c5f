# SPDX-License-Identifier: MIT
"""Figures of a class (`coopdyn host`): start and wake of seats, memory, real time beside thirty programs or a hostile seat, seats per core.

COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/class_seats.py [start] [python] [octave] [hostile] [cores [SCENARIO ...]]
`python`: thirty Python programs at 50 Hz on the same machine; `octave`: 15 of each. Keep the machine quiet.
"""
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench"), str(ROOT / "tests" / "host")]
from classes import Host, until  # noqa: E402
from measure import cpu_s  # noqa: E402
from neighbours_test import HostileSeat  # noqa: E402

PYTHON = """
import sys, time, coopdyn
sim = coopdyn.connect(sys.argv[1], seat=sys.argv[2], pin=sys.argv[3])
r = sim.robot("robot1")
print("up", flush=True)
begin, rounds = time.monotonic(), 0
while time.monotonic() < begin + float(sys.argv[4]):
    r.set_velocity(0.2 if min(r.get_distances()) > 0.3 else 0, 0.5)
    sim.step(2)
    rounds += 1
print(rounds / (time.monotonic() - begin))
"""
OCTAVE = """
addpath('{clients}'); sim = coopdyn.connect('{server}', 'seat', '{seat}', 'pin', '{pin}'); r = sim.robot('robot1');
printf('up\\n'); fflush(stdout); begin = tic; rounds = 0;
while toc(begin) < {duration_s}
  if min(r.get_distances()) > 0.3, r.set_velocity(0.2, 0.5); else, r.set_velocity(0, 0.5); end
  sim.step(2); rounds = rounds + 1;
end
printf('%g\\n', rounds / toc(begin));
"""


def pss_mb(pid):
    return sum(int(line.split()[1]) for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines() if line.startswith("Pss:")) / 1024


class Class:
    """A class of `count` seats in a scenario, all of them running in real time."""

    def __init__(self, scenario, count):
        self.names = [f"s{i:02}" for i in range(count)]
        self.host = Host((ROOT / "scenarios" / f"{scenario}.scenario").read_text(), students=self.names)

    def __enter__(self):
        self.started_s = [self.timed(self.host.status, name) for name in self.names]
        for name in self.names:
            module = self.host.module(name, "/simulation")
            module.must("set_mode realtime")
            module.close()
        self.daemons = [self.host.daemon(name) for name in self.names]
        return self

    def __exit__(self, *_):
        self.host.end()

    @staticmethod
    def timed(do, *args):
        begin = time.monotonic()
        do(*args)
        return time.monotonic() - begin

    def used_s(self):
        return sum(cpu_s(daemon) for daemon in self.daemons if os.path.exists(f"/proc/{daemon}"))

    def watch(self, duration_s):
        """Real-time factors by seat over the time, and the CPU use of all daemons and of the host, in cores."""
        before, own, begin = self.used_s(), cpu_s(self.host.process.pid), time.monotonic()
        factors = {name: [] for name in self.names}
        while time.monotonic() < begin + duration_s:
            time.sleep(1)
            for name, tile in self.host.tiles().items():
                factors[name].append(tile.get("rtf", 0))
        took_s = time.monotonic() - begin
        return factors, (self.used_s() - before) / took_s, (cpu_s(self.host.process.pid) - own) / took_s


def say_factors(label, factors, daemons, host, memory_mb):
    medians = [statistics.median(values) for values in factors.values()]
    print(f"{label}: real-time factor median {statistics.median(medians):.3f}, least seat {min(medians):.3f}, worst second "
          f"{min(map(min, factors.values())):.3f}; {statistics.median(memory_mb):.1f} MB a seat (PSS, most {max(memory_mb):.1f}); daemons together "
          f"{100 * daemons:.0f} % of a core, host {100 * host:.1f} %", flush=True)


def say_times(label, times_s):
    print(f"{label}: median {statistics.median(times_s):.3f} s, most {max(times_s):.3f} s (30 seats of classroom, one after the other)", flush=True)


def start():
    with Class("classroom", 30) as room:
        say_times("start of a seat", room.started_s)
        time.sleep(20)
        say_factors("thirty seats that nobody drives", *room.watch(10), list(map(pss_mb, room.daemons)))
        room.host.order(do="aside", seats=room.names)
        until(lambda: not any(map(room.host.daemon, room.names)))
        say_times("wake of a seat that was put aside after 30 s", [room.timed(room.host.status, name) for name in room.names])

        def kill(name):
            os.kill(room.host.daemon(name), signal.SIGKILL)
            until(lambda: answered(name))

        def answered(name):
            try:
                return room.host.status(name)
            except OSError:  # passed to the daemon that was killed
                return None
        say_times("back after kill -9", [room.timed(kill, name) for name in room.names])


def programs(octave, duration_s=40):
    with Class("classroom", 30) as room:
        server, roll, running = f"127.0.0.1:{room.host.port}", room.host.roll(), []
        for index, seat in enumerate(room.names):
            pin = roll[seat]["pin"]
            if index < octave:
                text = OCTAVE.format(clients=ROOT / "clients" / "matlab", server=server, seat=seat, pin=pin, duration_s=duration_s + 15)
                words = ["octave", "--no-gui", "--norc", "--no-history", "--eval", text]
            else:
                words = [sys.executable, "-c", PYTHON, server, seat, pin, str(duration_s + 15)]
            running.append(subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                            env=dict(os.environ, PYTHONPATH=str(ROOT / "clients" / "python"))))
        for program in running:
            program.stdout.readline()
        say_factors(f"thirty programs, {octave} in Octave", *room.watch(duration_s), list(map(pss_mb, room.daemons)))
        rates_hz = [float(program.communicate()[0]) for program in running]
        print(f"  rounds of the programs: median {statistics.median(rates_hz):.1f} Hz, least {min(rates_hz):.1f} Hz (50 wanted)")


def hostile():
    """Thirty seats, one of which does everything wrong (tests/host/neighbours_test.py)."""
    with Class("classroom", 30) as room:
        enemy = HostileSeat(room.host, room.names[-1])
        factors, *use = room.watch(40)
        enemy.stop()
        del factors[room.names[-1]]
        say_factors("29 seats beside a hostile one", factors, *use, list(map(pss_mb, room.daemons[:-1])))


def cores(*scenarios):
    """All seats on one core: as many as 93 % of it would serve, by the use of two."""
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    for scenario in scenarios or ("classroom", "corridor", "maze", "lamps", "reach", "walk", "arena20", "swarm100", "swarm1000"):
        with Class(scenario, 2) as room:
            time.sleep(2)
            each = room.watch(5)[1] / 2
        count = max(1, min(80, int(0.93 / each)))
        with Class(scenario, count) as room:
            time.sleep(4)
            say_factors(f"{scenario}, {100 * each:.1f} % of a core a seat, {count} seats on one core", *room.watch(8), list(map(pss_mb, room.daemons)))


def main():
    words = sys.argv[1:] or ["start", "python", "octave", "hostile", "cores"]
    for index, word in enumerate(words):
        if word == "cores":
            return cores(*words[index + 1:])
        {"start": start, "python": lambda: programs(0), "octave": lambda: programs(15),
         "hostile": hostile}[word]()
    return None


if __name__ == "__main__":
    main()
