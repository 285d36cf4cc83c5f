"""Figures of the whole daemon, one line each: start, memory, idle CPU, real time, lockstep from Python and Octave, the end.

COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/measure.py [start memory idle realtime overload python octave end]
Machines are noisy: uses medians of several runs, and CPU time where possible.
"""
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "daemon"), str(ROOT / "clients" / "python")]
from harness import BINARY, Daemon, scenario, until  # noqa: E402

TICK_S = 1 / os.sysconf("SC_CLK_TCK")


def cpu_s(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) * TICK_S


def rss_kb(pid):
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1])
    return 0


def start():
    times = []
    for _ in range(9):
        begin = time.monotonic()
        with Daemon(None, "--http", name="classroom"):
            times.append(time.monotonic() - begin)
    print(f"start to ready, classroom: {statistics.median(times):.3f} s (median of 9)")


def robots(count):
    side = 10
    text = "[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 100 100 0.1\n[TARGET]\nred 3 1 0.3\n"
    for i in range(count):
        text += f"[ROBOT_{i + 1}]\ntype coopbot\nname robot{i + 1}\nposition {2 * (i % side)} {2 * (i // side)}\n"
    return text


def memory():
    with Daemon(robots(1)) as one, Daemon(robots(101), "--robot-threads", "101") as many:
        small, large = rss_kb(one.process.pid), rss_kb(many.process.pid)
    print(f"memory: {small / 1024:.1f} MB with one robot, {(large - small) / 100:.0f} kB for each further one (own threads)")


def idle():
    with Daemon(None, "--http", name="classroom") as daemon:
        daemon.status()
        begin, used = time.monotonic(), cpu_s(daemon.process.pid)
        time.sleep(10)
        share = (cpu_s(daemon.process.pid) - used) / (time.monotonic() - begin)
    print(f"idle in real time at 100 Hz, nobody connected: {100 * share:.2f} % of one core")


def realtime():
    for speed in (1, 0.5, 4):
        with Daemon(scenario(1, mode="realtime"), "--speed", str(speed)) as daemon:
            clock = daemon.binary("/simulation")
            clock.ask(2)
            late, first = [], None
            while True:
                reply = clock.ask(2)
                now = time.monotonic()
                if first is None:
                    first = (now, reply.time_s)
                late.append((now - first[0]) - (reply.time_s - first[1]) / speed)
                if now - first[0] >= 10:
                    break
            drift_ms = 1000 * (late[-1] - statistics.median(late[:50]))
            late.sort()
            p99_ms = 1000 * (late[int(0.99 * len(late))] - late[0])
            print(f"real time at speed {speed}: drift over 10 s {drift_ms:+.2f} ms, 99th percentile of lateness {p99_ms:.2f} ms, "
                  f"{len(late)} steps seen, {daemon.status()['late_periods']} periods skipped")


CLIENT = """
import sys
import coopdyn
sim = coopdyn.connect(sys.argv[1], timeout=60)
r = sim.robot(sys.argv[2])
while True:
    t, d = r.get_target("red"), r.get_distances()
    thought = sum(k * k for k in range(8000))  # about half a millisecond
    r.set_velocity(0.3 * min(1, min(d)), 1.5 * t.bearing + 0.4 * (min(d[:5]) < 0.5))
    sim.step(2)
"""


def overload():
    """Fifty Python programs beside the daemon, each driving a robot at 50 Hz: more than two cores can handle."""
    count, seconds = 50, 20
    with Daemon(robots(count).replace("lockstep", "realtime"), "--no-render") as daemon:
        server = f"127.0.0.1:{daemon.names[1]}"
        env = {**os.environ, "PYTHONPATH": str(ROOT / "clients" / "python")}
        clients = [subprocess.Popen([sys.executable, "-c", CLIENT, server, f"robot{i + 1}"], env=env) for i in range(count)]
        until(lambda: all(robot["owner"] for robot in daemon.status()["robots"]), 120)
        time.sleep(2)

        def moment():
            status = daemon.status()
            return time.monotonic(), status["time_s"], status["late_periods"], sum(cpu_s(client.pid) for client in clients)

        first = moment()
        time.sleep(seconds)
        wall_s, simulated_s, late, used_s = (after - before for before, after in zip(first, moment()))
        for client in clients:
            client.kill()
            client.wait()
    print(f"real time beside {count} Python programs at 50 Hz: {100 * (1 - simulated_s / wall_s):.2f} % of simulated time lost, "
          f"{late} periods skipped; the programs take {100 * used_s / wall_s:.0f} % of a core")


def python():
    import coopdyn
    rates = []
    for _ in range(5):
        with Daemon(scenario(1)) as daemon:
            with coopdyn.connect(f"127.0.0.1:{daemon.names[1]}") as sim:
                r = sim.robot("robot1")
                r.sense("red")
                begin = time.monotonic()
                for _ in range(5000):
                    r.set_velocity(0.2, 0.3)
                    sim.step()
                    r.sense("red")
                rates.append(5000 / (time.monotonic() - begin))
    print(f"lockstep, Python client: {statistics.median(rates):.0f} steps/s (command, all readings of one robot)")


def octave():
    program = ("sim = coopdyn.connect(); r = sim.robot('robot1'); r.sense('red'); t = tic; for k = 1:3000, "
               "r.set_velocity(0.2, 0.3); sim.step(); s = r.sense('red'); end; printf('%.0f\\n', 3000 / toc(t)); sim.close();")
    rates = []
    for _ in range(3):
        with Daemon(scenario(1)) as daemon:
            done = subprocess.run(["octave", "--no-gui", "--norc", "--quiet", "--eval",
                                   f"addpath('{ROOT}/clients/matlab'); {program}"], stdout=subprocess.PIPE,
                                  stderr=subprocess.DEVNULL, env={**os.environ, "COOPDYN_SERVER": f"127.0.0.1:{daemon.names[1]}"})
            rates.append(float(done.stdout.split()[-1]))
    print(f"lockstep, Octave client: {statistics.median(rates):.0f} steps/s (command, all readings of one robot)")


def end():
    times = []
    for _ in range(7):
        with Daemon(None, name="arena20") as daemon:
            daemon.text("/simulation").must("set_mode free")
            begin = time.monotonic()
            daemon.end(signal.SIGTERM)
            times.append(time.monotonic() - begin)
    print(f"SIGTERM to exit, 20 robots in free mode: {1000 * statistics.median(times):.0f} ms (median of 7)")


if __name__ == "__main__":
    print(f"binary: {BINARY}")
    for name in sys.argv[1:] or ["start", "memory", "idle", "realtime", "overload", "python", "octave", "end"]:
        globals()[name]()
