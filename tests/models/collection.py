#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Loads every model and world of collections, runs 10 s, and prints the tables of docs/models.md.

Usage: collection.py COOPDYN FOLDER... : each a collection, called OWNER+NAME, which is also its search path.
"""
import collections
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile
import time

RUNS = "loads and runs"
LONGEST_S = 120


def files(folder):
    for root, folders, names in sorted(os.walk(folder)):
        folders[:] = sorted(name for name in folders if name not in (".git", "random_urdfs"))
        chosen = [n for n in sorted(names) if n.endswith((".sdf", ".urdf", ".world"))]
        # A model's folder may keep versions for old programs: the newest counts.
        if "model.sdf" in chosen:
            chosen = [n for n in chosen if not re.match(r"model-\d", n)]
        yield from filter(os.path.exists, (os.path.join(root, name) for name in chosen))


def cause_of(text):
    """A message without what differs from model to model."""
    text = re.sub(r"^.*?: error: ", "", text)
    text = re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", "N", re.sub(r"'[^']*'|\[[^\]]*\]", "…", text))
    return re.split(r" \(looked|: add it|; known are|; did you", text)[0].replace("|", "\\|")


def run(binary, file, folder):
    """What came of it, and how long it took, s."""
    with open(file, encoding="utf-8", errors="replace") as stream:
        is_world = "<world" in stream.read()
    with tempfile.TemporaryDirectory() as scratch:
        target, summary = file, os.path.join(scratch, "summary.json")
        if not is_world:
            target = os.path.join(scratch, "one.scenario")
            with open(target, "w", encoding="utf-8") as stream:
                stream.write(f"[FLOOR]\nsize 200 200\n[ROBOT_1]\ntype {file}\nposition 0 0\n")
        command = [binary, "serve", target, "--mode", "free", "--no-net", "--no-render", "--duration", "10", "--summary", summary]
        started = time.monotonic()
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, errors="replace",
                                  env=dict(os.environ, COOPDYN_PATH=folder))
        except subprocess.TimeoutExpired:
            return f"no end within {LONGEST_S} s", LONGEST_S
        took_s = time.monotonic() - started
        lines = (done.stdout + done.stderr).splitlines()
        errors = [line for line in lines if ": error: " in line]
        if done.returncode < 0:
            return f"CRASH by signal {-done.returncode}", took_s
        if errors or not os.path.exists(summary):
            return cause_of((errors or lines or ["?"])[0]), took_s
        with open(summary, encoding="utf-8") as stream:
            ended = json.load(stream)
        return "loads, but a body is frozen in motion" if ended["frozen"] else RUNS, took_s


def main():
    binary, folders = os.path.abspath(sys.argv[1]), [os.path.abspath(folder) for folder in sys.argv[2:]]
    causes = collections.defaultdict(list)
    times = []
    print("| collection | files | load and run | longest, with the run |\n|---|---|---|---|")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for folder in folders:
            found = list(files(folder))
            results = list(pool.map(lambda file, folder=folder: run(binary, file, folder), found))
            for file, (result, took_s) in zip(found, results):
                times.append((took_s, os.path.relpath(file, folder)))
                if result != RUNS:
                    causes[result].append(os.path.relpath(file, folder))
            name = os.path.basename(folder).replace("+", "/")
            good = sum(result == RUNS for result, _ in results)
            longest_s = max((took_s for _, took_s in results), default=0)
            print(f"| [{name}](https://github.com/{name}) | {len(found)} | {good} | {longest_s:.1f} s |", flush=True)
    print("\n| what coopdyn says | files | for example |\n|---|---|---|")
    for cause, names in sorted(causes.items(), key=lambda item: -len(item[1])):
        print(f"| {cause[:160]} | {len(names)} | `{names[0]}` |")
    print("\nLongest: " + ", ".join(f"`{name}` {took_s:.1f} s" for took_s, name in sorted(times, reverse=True)[:3]))


if __name__ == "__main__":
    main()
