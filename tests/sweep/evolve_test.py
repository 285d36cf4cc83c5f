# SPDX-License-Identifier: MIT
"""coopdyn sweep evolve: a gait improves, reproducibly, and nothing runs twice."""
import csv
import os
import tempfile
import unittest

import engines

BINARY = os.environ.get("COOPDYN_BINARY", "build/release/coopdyn")
DOG = ["--controller", "gait knee_offset=0.4 swing_offset=0.3", "--vary", "swing=0.05..0.5", "--vary", "knee=0..0.6", "--vary",
       "frequency=0.5..2", "--start", "swing=0.1", "--start", "knee=0.1", "--start", "frequency=1", "--duration", "2"]


class EvolveTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = os.path.join(folder.name, "dogs")

    def evolve(self, *words, code=0):
        done = engines.answers([BINARY, "sweep", "evolve", "dog", *words, "--out", self.out], cwd=os.path.dirname(self.out))
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def read(self, name):
        with open(os.path.join(self.out, name), encoding="utf-8") as stream:
            return stream.read()

    def test_the_score_becomes_better_and_the_same_command_goes_on(self):
        small = [*DOG, "--score", "travelled", "--needs", "standing", "--children", "4", "--parents", "2"]
        first = self.evolve(*small, "--generations", "1")
        self.assertIn("generation 1: travelled ", first.stdout)
        runs = self.read("results.jsonl")
        self.evolve(*small, "--generations", "4")
        self.assertTrue(self.read("results.jsonl").startswith(runs))
        best = [float(row["travelled"]) for row in csv.DictReader(self.read("evolved.csv").splitlines())]
        self.assertEqual(len(best), 4)
        self.assertEqual(best, sorted(best))
        self.assertGreater(best[-1], 1.1 * best[0])
        story, runs = self.read("evolved.csv"), self.read("results.jsonl")
        self.evolve(*small, "--generations", "4")
        self.assertEqual(self.read("evolved.csv"), story)
        self.assertEqual(self.read("results.jsonl"), runs)

    def test_the_help_of_sweep_names_it(self):
        self.assertIn("sweep evolve", engines.answers([BINARY, "sweep", "--help"], cwd=os.path.dirname(self.out)).stdout)

    def test_mistakes_are_told(self):
        few = ["--generations", "1", "--children", "1"]
        self.assertIn("dog has no score speed: it has standing, travelled", self.evolve(*DOG, *few, "--score", "speed", code=1).stderr)
        self.assertIn("--vary takes NAME=LEAST..MOST", self.evolve("--vary", "swing=1", "--score", "travelled", code=1).stderr)
        self.assertIn("must be less", self.evolve("--vary", "swing=2..1", "--score", "travelled", code=1).stderr)
        self.assertIn("name the controller", self.evolve("--vary", "swing=0..1", "--score", "travelled", code=1).stderr)
        twice = self.evolve(*few, "--controller", "gait swing=0.1", "--vary", "swing=0..1", "--score", "travelled", code=1).stderr
        self.assertIn("swing is in --controller and in --vary: leave one out", twice)
        twice = self.evolve(*few, "--set", "FLOOR.friction=1", "--vary", "floor.friction=0.1..1", "--score", "travelled", code=1).stderr
        self.assertIn("floor.friction is in --set and in --vary: leave one out", twice)
        twice = self.evolve(*DOG, "--vary", "swing=0..1", "--score", "travelled", code=1).stderr
        self.assertIn("swing is in two --vary: leave one out", twice)
        for start, why in (("swing", "--start takes NAME=VALUE"), ("swing=much", "--start takes NAME=VALUE"), ("swnig=1", "--start swnig=1: no --vary has swnig")):
            self.assertIn(why, self.evolve("--controller", "gait", "--vary", "swing=0..1", "--score", "travelled", "--start", start, code=1).stderr)
        self.assertIn("unknown option", self.evolve(*few, "--controller", "gait", "--vary", "swnig=0..1", "--score", "travelled", code=1).stderr
                      .replace("has no option", "unknown option"))


if __name__ == "__main__":
    unittest.main()
