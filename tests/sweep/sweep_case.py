# SPDX-License-Identifier: MIT
"""Shared by tests of sweeps: a scenario, and `coopdyn sweep` of it."""
import json
import os
import tempfile
import unittest

import engines

BINARY = os.environ.get("COOPDYN_BINARY", "build/release/coopdyn")
ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))

SCENARIO = """[FLOOR]
size 8 8
[SWARM_1]
type single
name r
count 3
spacing 0.9
controller diffuse
fidelity rolling
[SCORE_1]
name way
kind distance
[SCORE_2]
name hits
kind collisions
"""
TABLE = ["--set", "SWARM_1.count=2,4", "--controller", "diffuse speed=0.1,0.2", "--duration", "0.5"]


class SweepCase(unittest.TestCase):
    """A folder with a scenario, and the files that a sweep of it writes."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.scenario = self.write("lesson.scenario", SCENARIO)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as stream:
            stream.write(text)
        return self.path(name)

    def words(self, *words, out="out"):
        return [BINARY, "sweep", self.scenario, *words, "--out", self.path(out)]

    def sweep(self, *words, out="out", code=0, **given):
        done = engines.answers(self.words(*words, out=out), cwd=self.folder, **given)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def lines(self, out="out"):
        with open(os.path.join(self.path(out), "results.jsonl"), encoding="utf-8") as stream:
            return sorted(stream.read().splitlines())

    def results(self, out="out"):
        return [json.loads(line) for line in self.lines(out)]

    def refused(self, *words, code=1):
        done = self.sweep(*words, code=code)
        return done.stderr.strip()

    def finished(self):
        try:
            return self.lines()
        except FileNotFoundError:
            return []
