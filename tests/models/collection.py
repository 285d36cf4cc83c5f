#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Loads every model and world of collections, runs each for 10 s, and prints the tables of docs/models.md.

Usage: collection.py [--rows ROWS.jsonl] COOPDYN FOLDER... : each FOLDER is a collection, called OWNER+NAME, and its search path.
Needs the program xacro on the PATH, or .xacro files count as refused. An .xacro without links (macros) is not counted.
"""
import argparse
import collections
import concurrent.futures
import json
import math
import os
import re
import signal
import sqlite3
import subprocess
import tempfile
import threading

RUNS = "loads and runs"
NO_ROBOT = "holds macros alone"
LONGEST_S = 120
POSES_EVERY_S = 0.1
# Nobody commands a motor, so a model that moves farther or faster, or sinks deep into the floor, does not stand.
FAR_M, FAST_M_PER_S, DEEP_M = 20, 5, 0.5


def text_of(file):
    with open(file, encoding="utf-8", errors="replace") as stream:
        return stream.read()


def is_one(file):
    """Whether a file is a complete model or world."""
    name = os.path.basename(file)
    if not os.path.exists(file):
        return False
    if name.endswith(".sdf"):  # except SDF's own schema
        return re.match(r"\s*(<!--.*?-->\s*)*<element\b", text_of(file), re.S) is None
    if name.endswith((".urdf", ".world")):
        return True
    if name.endswith(".xacro"):
        return re.search(r"<robot\b[^>]*\sname\s*=", text_of(file)) is not None
    # MuJoCo's files include others that have the same root.
    return name.endswith(".xml") and re.search(r"<mujoco\b.*<worldbody\b", text_of(file), re.S) is not None


def files(folder):
    for root, folders, names in sorted(os.walk(folder)):
        folders[:] = sorted(name for name in folders if name not in (".git", "random_urdfs"))
        # A model's folder may keep versions for old programs: the newest counts.
        if "model.sdf" in names:
            names = [n for n in names if not re.match(r"model-\d", n)]
        yield from filter(is_one, (os.path.join(root, name) for name in sorted(names)))


def cause_of(text):
    """A message without its model-specific parts."""
    text = re.sub(r"^.*?: error: ", "", text)
    text = re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", "N", re.sub(r"'[^']*'|\[[^\]]*\]", "…", text))
    return re.split(r" \(looked|: add it|; known are|; did you", text)[0].replace("|", "\\|")


def positions(blob):
    """The position of each body by index, m (docs/formats.md, run files)."""
    unit_m = 2 ** blob[0] * 1e-6
    for at in range(1, len(blob), 18):
        bits = int.from_bytes(blob[at:at + 18], "little")
        axes = ((bits >> shift) & (1 << 27) - 1 for shift in (0, 27, 54))
        yield [(n - (1 << 27) if n >> 26 else n) * unit_m for n in axes]


def links_without_shape(texts):
    """Links without a shape: nothing can support them, so they fall, in Gazebo too."""
    solid, bare = set(), set()
    for text in texts:
        for name, link in re.findall(r'<link\b[^>]*\bname="([^"]*)"(.*?)(?=<link\b|$)', text, re.S):
            (solid if "<collision" in link else bare).add(name)
    return bare - solid


def unsound(run, has_floor):
    """The reason why the recorded model does not stand, or None."""
    with sqlite3.connect(run) as data:
        names = [name for name, in data.execute("SELECT name FROM body WHERE scene = 1 ORDER BY place")]
        bare = links_without_shape(text for text, in data.execute("SELECT content FROM text"))
        rows = data.execute("SELECT time_ns, poses FROM step WHERE poses NOT NULL ORDER BY step").fetchall()
    if len(rows) < 3:
        return None
    (_, first), (t1_ns, before), (t2_ns, last) = rows[0], rows[-2], rows[-1]
    for name, start, near, end in zip(names, *map(positions, (first, before, last))):
        if re.split(r"::|\.", name)[-1] in bare:
            continue
        speed = math.dist(near, end) / ((t2_ns - t1_ns) * 1e-9)
        if has_floor and end[2] < -DEEP_M and end[2] < start[2] - DEEP_M:
            return f"loads, but is below the floor: {name} at {end[2]:.1f} m"
        if speed > FAST_M_PER_S:
            return f"loads, but moves on its own: {name} with {speed:.1f} m/s"
        if math.dist(start, end) > FAR_M:
            return f"loads, but goes away: {name} by {math.dist(start, end):.0f} m"
    return None


def call(command, environment):
    """Exit code, output, and seconds of processor time, which other programs do not affect."""
    with tempfile.TemporaryFile("w+", errors="replace") as said:
        process = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, env=environment)
        killer = threading.Timer(LONGEST_S, process.kill)
        killer.start()
        _, status, used = os.wait4(process.pid, 0)
        killer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return process.returncode, said.read().splitlines(), used.ru_utime + used.ru_stime


def run(binary, file, folder):
    """The result, the seconds of the check, and the output."""
    is_model = not file.endswith(".xml") and "<world" not in text_of(file)
    with tempfile.TemporaryDirectory() as scratch:
        target, summary, recorded = file, os.path.join(scratch, "summary.json"), os.path.join(scratch, "poses.run")
        if is_model:
            target = os.path.join(scratch, "one.scenario")
            with open(target, "w", encoding="utf-8") as stream:
                stream.write(f"[FLOOR]\nsize 200 200\n[ROBOT_1]\ntype {file}\nposition 0 0\n")
        command = [binary, "serve", target, "--mode", "free", "--no-net", "--no-render", "--duration", "10",
                   "--summary", summary, "--record", recorded, "--record-what", "poses", "--record-every", str(POSES_EVERY_S)]
        environment = dict(os.environ, COOPDYN_PATH=folder, ROS_PACKAGE_PATH=folder, XDG_CACHE_HOME=scratch)
        _, _, check_s = call([binary, "check", file], environment)
        code, lines, _ = call(command, environment)
        errors = [line for line in lines if ": error: " in line]
        if code == -signal.SIGKILL:
            return f"no end within {LONGEST_S} s", check_s, lines
        if code < 0:
            return f"CRASH by signal {-code}", check_s, lines
        if any("the file holds macros alone" in line for line in errors):
            return NO_ROBOT, check_s, lines
        if errors or not os.path.exists(summary):
            return cause_of((errors or lines or ["?"])[0]), check_s, lines
        with open(summary, encoding="utf-8") as stream:
            ended = json.load(stream)
        result = "loads, but a body is frozen in motion" if ended["frozen"] else unsound(recorded, is_model) or RUNS
        return result, check_s, lines


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--rows", help="write what came of each file here, a JSON object a line")
    options.add_argument("binary")
    options.add_argument("folders", nargs="+")
    given = options.parse_args()
    binary, folders = os.path.abspath(given.binary), [os.path.abspath(folder) for folder in given.folders]
    causes = collections.defaultdict(list)
    times = []
    rows = open(given.rows, "w", encoding="utf-8") if given.rows else None
    print("| collection | files | load and run | longest check |\n|---|---|---|---|")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for folder in folders:
            all_results = zip(files(folder), pool.map(lambda file, folder=folder: run(binary, file, folder), files(folder)))
            found = good = 0
            longest_s = 0
            for file, (result, check_s, lines) in all_results:
                name = os.path.relpath(file, folder)
                if rows:
                    rows.write(json.dumps({"folder": folder, "file": name, "result": result, "check_s": round(check_s, 2),
                                           "said": lines[:8] + [line for line in lines if ": error: " in line][:3]}) + "\n")
                    rows.flush()
                if result == NO_ROBOT:
                    continue
                found += 1
                good += result == RUNS
                longest_s = max(longest_s, check_s)
                times.append((check_s, name, os.path.getsize(file)))
                if result != RUNS:
                    causes[re.sub(r": \S+ (at|with|by) .*", "", result)].append(name)
            name = os.path.basename(folder).replace("+", "/")
            print(f"| [{name}](https://github.com/{name}) | {found} | {good} | {longest_s:.1f} s |", flush=True)
    print("\n| what coopdyn says | files | for example |\n|---|---|---|")
    for cause, names in sorted(causes.items(), key=lambda item: -len(item[1])):
        print(f"| {cause[:160]} | {len(names)} | `{names[0]}` |")
    print("\nLongest: " + ", ".join(f"`{name}` ({size / 1e6:.1f} MB) {check_s:.1f} s"
                                    for check_s, name, size in sorted(times, reverse=True)[:3]))


if __name__ == "__main__":
    main()
