# SPDX-License-Identifier: MIT
"""Shared by tests of grading: a folder with a fast assignment, and `coopdyn grade` of it."""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest

BINARY = os.environ.get("COOPDYN_BINARY", "build/release/coopdyn")
ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
LIMIT_S = 300
for folder in ("clients/sweep", "clients/grade"):
    sys.path.insert(0, os.path.join(ROOT, folder))

SCENARIO = """[SIMULATION]
step 20ms
[FLOOR]
size 8 8
[ROBOT_1]
type coopbot
name eva
position 0 0
[SCORE_1]
name way
kind travelled
"""
ASSIGNMENT = """[ASSIGNMENT]
scenario lane.scenario
command python3 {submission}/main.py
files main.py
seeds 1
duration 1s
time 5s
clock 300s
memory 128MiB
disk 8MiB
processes 8
[POINTS_1]
score way
from 0
to 0.15
points 10
text Drive along x.
"""
DRIVE = """import coopdyn
sim = coopdyn.connect()
eva = sim.robot("eva")
while sim.time < 2:
    eva.set_velocity(0.3, 0)
    sim.step()
"""


class GradeCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.write("lane.scenario", SCENARIO)
        self.assignment = self.write("lane.assignment", ASSIGNMENT)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w", encoding="utf-8") as stream:
            stream.write(text)
        return self.path(name)

    def submit(self, name, text, file="main.py"):
        self.write(f"{name}/{file}", text)
        return self.path(name)

    def run_words(self, *words, **given):
        return subprocess.run([BINARY, "grade", *words], capture_output=True, text=True, timeout=LIMIT_S, check=False, **{"cwd": self.folder, **given})

    def grade(self, *words, out="out", code=0, **given):
        done = self.run_words(*words, "--out", self.path(out), **given)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def grade_all(self, *submissions, **given):
        return self.grade(self.assignment, *submissions, "--no-film", **given)

    def result(self, name, out="out"):
        with open(self.path(out, name, "results.json"), encoding="utf-8") as stream:
            return json.load(stream)

    def runs(self, name, out="out"):
        return self.result(name, out)["extra_data"]["runs"]

    def table(self, out="out", file="grades.csv"):
        with open(self.path(out, file), newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))
