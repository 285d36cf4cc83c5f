#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Loads every model of a folder, runs 1,000 steps of 10 ms, and prints the tables of docs/models.md.

Usage: collection.py COOPDYN FOLDER [FOLDER of the search path ...]
"""
import collections
import os
import re
import subprocess
import sys
import tempfile

STEPS_S = 10
RUNS = "loads and runs"


def files(folder):
    for root, _, names in sorted(os.walk(folder)):
        chosen = [n for n in sorted(names) if n.endswith((".sdf", ".urdf"))]
        # A model's folder may keep versions for old programs: the newest counts.
        if "model.sdf" in chosen:
            chosen = [n for n in chosen if not re.match(r"model-\d", n)]
        for name in chosen:
            yield os.path.join(root, name)


def said(text, folder):
    """What the program said of a model, without the path of the one who asked and what is no word of it."""
    text = text.replace(folder.rstrip("/") + "/", "")
    return re.sub(r"^.*?: error: ", "", text).replace("|", "\\|")


def shorten(text):
    """A message without what differs from model to model."""
    return re.sub(r"'[^']*'", "'…'", re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", "N", text))


def run(command, path):
    environment = dict(os.environ, COOPDYN_PATH=path)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, env=environment, errors="replace")
    except subprocess.TimeoutExpired:
        return 99, "error: no end within 120 s"
    return done.returncode, done.stdout + done.stderr


def main():
    binary, folder = sys.argv[1], sys.argv[2]
    path = ":".join(sys.argv[2:])
    rows, groups = [], collections.Counter()
    for file in files(folder):
        name = os.path.relpath(file, folder)
        with tempfile.TemporaryDirectory() as scratch:
            scenario = os.path.join(scratch, "one.scenario")
            with open(scenario, "w", encoding="utf-8") as stream:
                stream.write(f"[SIMULATION]\nmode free\nspeed 0\n[FLOOR]\nsize 200 200\n[ROBOT_1]\ntype {file}\nposition 0 0\n")
            target = file if "<world" in open(file, encoding="utf-8", errors="replace").read() else scenario
            code, text = run([binary, "serve", target, "--no-net", "--no-render", "--duration", str(STEPS_S),
                              "--log-level", "warning"], path)
        errors = [line for line in text.splitlines() if ": error: " in line]
        if code < 0:
            result = f"CRASH by signal {-code}"
        elif code != 0 or errors:
            result = said(errors[0] if errors else (text.strip().splitlines() or ["?"])[-1], folder)
        elif code == 4 or "nothing frozen" not in text:
            result = "loads, but a body is frozen in motion"
        else:
            result = RUNS
        groups[shorten(result)] += 1
        rows.append((name, result))
    print(f"| what | models |\n|---|---|")
    for result, count in groups.most_common():
        print(f"| {result} | {count} |")
    print("\nLoad and run: " + ", ".join(f"`{name}`" for name, result in rows if result == RUNS))
    print("\n| model | what coopdyn says |\n|---|---|")
    for name, result in rows:
        if result != RUNS:
            print(f"| `{name}` | `{result}` |")


if __name__ == "__main__":
    main()
