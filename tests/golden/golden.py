# SPDX-License-Identifier: MIT
"""The hash of each shipped scenario, experiment and robot after STEPS steps, against hashes.json: one on every machine.

Usage: golden.py PROGRAM [--only NAME] [--write] [--as plain|other] [--under "qemu-x86_64 -cpu Conroe"]
`plain` is one thread; `other` has everything that must not change the hash: two threads, 64 robot threads, a recording, an open
page, spectators, and a processor that hides its features from libm. A client drives the robots without a loaded controller, by
their readings.
"""
import argparse
import concurrent.futures
import contextlib
import json
import math
import os
import pathlib
import re
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients" / "python"))
import coopdyn  # noqa: E402

HASH = re.compile("[0-9a-f]{16}")
STEPS, ROUND, CROWD_ROUND = 1500, 5, 50
SEED = "3"
HIDDEN = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
CROWD = 50  # more robots than these are driven as one team


def scenario_of(robot):
    """A robot among things that it runs into."""
    return (f"[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 20 20\n[ROBOT_1]\ntype {robot}\nposition 0 0\n"
            "[TARGET]\nred 2 0.5\n"
            "[OBJECT_1]\ntype box\nsize 0.4 0.4 0.6\nposition 1.2 0.3 0\n"
            "[OBJECT_2]\ntype sphere\nsize 0.2\nposition 0.6 -0.7 0.1\nmass 0.1\n")


def entries():
    """{name: argument of `serve`}; for a robot the text of a scenario."""
    found = {f"scenarios/{path.name}": str(path) for path in sorted((ROOT / "scenarios").glob("*")) if path.suffix in (".scenario", ".xml")}
    return found | {f"robots/{path.name}": scenario_of(path.name) for path in sorted((ROOT / "robots").iterdir()) if path.is_dir()}


def has_one(name, parts):
    return any(part in name for part in parts.split(",") if part)


def numbers(reading):
    """All finite numbers in nested tuples."""
    for value in reading:
        if isinstance(value, (int, float)):
            if math.isfinite(value):
                yield value
        elif isinstance(value, dict):
            yield from numbers(value.values())
        elif value is not None and not isinstance(value, str):
            yield from numbers(value)


def read_hashes(file, names):
    """{name: hash} for exactly `names`; otherwise exits with a message."""
    try:
        hashes = json.loads(file.read_bytes())
    except (OSError, ValueError) as error:
        sys.exit(f"{file} cannot be read ({error}): get it back from the repository")
    if not isinstance(hashes, dict) or not all(isinstance(value, str) and HASH.fullmatch(value) for value in hashes.values()):
        sys.exit(f"{file} is damaged: it has to be an object of names and hashes of 16 hex digits: get it back from the repository")
    if wrong := sorted(hashes.keys() ^ names):
        sys.exit(f"{file} has not the names of what ships ({', '.join(wrong)}): write it anew with --write")
    return hashes


def choose(names, only, without):
    for word in filter(None, [*only.split(","), *without.split(",")]):
        if not any(word in name for name in names):
            sys.exit(f"--only, --without: no entry has {word} in its name: {', '.join(sorted(names))}")
    chosen = [name for name in names if has_one(name, only or name) and not has_one(name, without)]
    return chosen or sys.exit("--only, --without: nothing is left to be compared")


def lean(reading):
    """A number in [0, 1) that depends on every bit of a reading."""
    return sum(numbers(reading)) * 64 % 1


class Driver:
    """Drives one robot by its readings, so that the hash depends on every number of its sensors."""

    def __init__(self, sim, status):
        self.robot = sim.robot(status["name"])
        kinds = [(module["type"], module["name"].split("/")[-1]) for module in status["modules"]]
        self.has_wheels = any(kind == "motors" for kind, _ in kinds)
        self.groups = [self.robot.joints(name) for kind, name in kinds if kind == "joints"]
        self.ranges = [list(zip(limits.lower, limits.upper)) for limits in (group.get_limits() for group in self.groups)]
        self.muscles = [self.robot.muscles() for kind, _ in kinds if kind == "muscles"]
        self.thrusters = [self.robot.thrusters() for kind, _ in kinds if kind == "thrusters"]

    def command(self, k):
        part = lean(self.robot.sense())
        if self.has_wheels:
            self.robot.set_velocity(0.15 + 0.1 * part, 0.4 * (part - 0.5))
        for group, ranges in zip(self.groups, self.ranges):
            middle = [(least + most) / 2 if math.isfinite(least + most) else 0 for least, most in ranges]
            group.set_positions([x + 0.3 * ((k // 20 + j) % 3 - 1) + 0.05 * part for j, x in enumerate(middle)])
        for muscles in self.muscles:
            muscles.set_activations([0.5 * ((k // 10 + j) % 2) + 0.2 * part for j in range(len(muscles))])
        for thrusters in self.thrusters:
            thrusters.set_thrusts([0.2 * most * part for most in thrusters.get_limits()[0]])


class Crowd:
    """Drives robots with wheels as one team."""

    def __init__(self, sim):
        self.team = sim.team()
        self.reading = self.team.read()

    def command(self, k):
        rows = [lean(row) for row in zip(self.reading.pose, self.reading.distances)]
        self.reading = self.team.step([(0.1 + 0.1 * part, 0.4 * (part - 0.5)) for part in rows])


def open_page(url):
    """The socket of a page that shows poses and reads them."""
    place = urllib.parse.urlsplit(url)
    page = socket.create_connection((place.hostname, place.port))
    page.sendall(f"GET /ws HTTP/1.1\r\nHost: {place.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                 f"Sec-WebSocket-Key: {'A' * 22}==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
    ask = b'{"type":"poses","rate":30}'
    page.sendall(bytes([0x81, 0x80 | len(ask)]) + bytes(4) + ask)  # masked with zeros
    head = page.recv(1 << 16)
    if b" 101 " not in head:
        raise SystemExit(f"{url} is no page: {head[:80]}")

    def read():
        with contextlib.suppress(OSError):
            while page.recv(1 << 16):
                pass
    threading.Thread(target=read, daemon=True).start()
    return page


class Daemon:
    """A daemon that runs one entry, in its own folder."""

    def __init__(self, program, given, other, *options):
        self.folder = tempfile.TemporaryDirectory()
        options = ["--port", "0", "--no-render", "--log-level", "error", *options]
        self.program, self.recording = program, None
        environment = dict(os.environ)
        if given:
            options += ["--seed", SEED]
        if other:
            self.recording = os.path.join(self.folder.name, "golden.run")
            options += ["--threads", "2", "--robot-threads", "64", "--record", self.recording]
            environment |= HIDDEN
        if "\n" in given:
            path = pathlib.Path(self.folder.name, "golden.scenario")
            path.write_text(given, encoding="utf-8")
            given = str(path)
        self.summary = pathlib.Path(self.folder.name, "summary.json")
        self.process = subprocess.Popen([*program, "serve", *filter(None, [given]), *options, "--summary", str(self.summary)], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True, env=environment, start_new_session=True)
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{given} does not start: try {' '.join(program)} serve {given} {' '.join(options)}")
        ready = dict(word.split("=", 1) for word in line.split()[1:])
        self.server = ready["names"]
        self.page = open_page(ready["http"]) if other else None

    def __enter__(self):
        return self

    def end_hash(self):
        self.process.wait()
        return json.loads(self.summary.read_text())["hash"]

    def check_recording(self):
        """Verifies a recording made with hidden features on the full processor."""
        self.stop()
        if self.recording:
            subprocess.run([*self.program, "verify", self.recording], stdout=subprocess.DEVNULL, check=True)

    def stop(self):
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGTERM)  # proot, which may run it, takes no notice
        self.process.wait()

    def __exit__(self, *_):
        self.stop()
        if self.page:
            self.page.close()
        self.process.stdout.close()
        self.folder.cleanup()


def driven_hash(sim, robots):
    """The hash after STEPS steps driven by a client."""
    crowd = len(robots) > CROWD
    drivers = [Crowd(sim)] if crowd else [Driver(sim, robot) for robot in robots]
    sim.run()
    while sim.steps < STEPS:
        for driver in drivers:
            driver.command(sim.steps)
        if sim.steps < STEPS:
            sim.step(min(CROWD_ROUND if crowd else ROUND, STEPS - sim.steps))
    return sim.hash()


def hash_of(program, given, other):
    with Daemon(program, given, other, "--mode", "lockstep", "--paused") as daemon:
        sim = coopdyn.connect(daemon.server)
        status = sim.status()
        if other:
            watched = [robot["name"] for robot in status["robots"] if any(module["type"] == "pose" for module in robot["modules"])]
            spectators = [coopdyn.connect(daemon.server, watch=True).robot(name) for name in watched[:3]]
            for spectator in spectators:
                spectator.subscribe("pose")
        if any(robot["participates"] for robot in status["robots"]):
            result = driven_hash(sim, [robot for robot in status["robots"] if robot["participates"]])
            daemon.check_recording()
            return result
    to_the_end = ["--mode", "free", "--speed", "0", "--steps", str(STEPS)]
    with Daemon(program, given, other, *to_the_end) as daemon:
        result = daemon.end_hash()
        daemon.check_recording()
        if other:  # continues from the middle on the full processor
            with Daemon(program, "", False, "--from", f"{daemon.recording}@#{STEPS // 2}", *to_the_end) as later:
                return result if later.end_hash() == result else f"{result}, from the middle another"
        return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--only", default="", help="entries whose name has one of these, with commas between")
    parser.add_argument("--without", default="", help="but for these")
    parser.add_argument("--as", dest="how", choices=("plain", "other"), default="plain")
    parser.add_argument("--under", default="", help="what runs the program, as qemu-x86_64")
    parser.add_argument("--write", action="store_true", help="write hashes.json, if the hashes are to change")
    parser.add_argument("--hashes", type=pathlib.Path, default=ROOT / "tests" / "golden" / "hashes.json", help="the file")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    given = parser.parse_args()
    shipped = entries()
    chosen = {name: shipped[name] for name in choose(shipped, given.only, given.without)}
    golden = {} if given.write else read_hashes(given.hashes, shipped.keys())
    program = [*shlex.split(given.under), given.program]
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        hashes = dict(zip(chosen, pool.map(lambda what: hash_of(program, what, given.how == "other"), chosen.values())))
    if given.write:
        kept = json.loads(given.hashes.read_text()) if len(hashes) < len(shipped) else {}
        kept = {name: value for name, value in kept.items() if name in shipped}
        given.hashes.write_text(json.dumps(kept | hashes, indent=1, sort_keys=True) + "\n")
        return 0
    differ = [name for name in chosen if hashes[name] != golden[name]]
    for name in differ:
        print(f"{name}: {hashes[name]}, not {golden[name]}")
    print(f"{len(chosen) - len(differ)} equal, {len(differ)} differ")
    return bool(differ)


sys.exit(main())
