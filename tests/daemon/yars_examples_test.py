# SPDX-License-Identifier: MIT
"""The shipped examples of the YARS paper behave as docs/yars.md says: dogs and walkers walk, a biped steps, a lamp is found, goals are
scored; and each run repeats exactly."""
import json
import unittest

from recording import RecordingTestCase, tool


class ExamplesTest(RecordingTestCase):
    def run_once(self, name, duration, *options):
        """The summary of a run without sockets, with its scores and logs by name."""
        summary = self.folder / "summary.json"
        code, said = tool("serve", name, "--no-net", "--no-render", "--mode", "free", "--speed", 0, "--duration", duration,
                          "--summary", summary, *options)
        self.assertEqual(code, 0, said)
        told = json.loads(summary.read_text())
        told["scores"] = {score["name"]: score["value"] for score in told["scores"]}
        told["logged"] = {logged["name"]: logged["value"] for logged in told["logged"]}
        return told

    def same_twice(self, name, duration, *options):
        first, second = (self.run_once(name, duration, *options) for _ in range(2))
        self.assertEqual(first["hash"], second["hash"])
        self.assertEqual(first["scores"], second["scores"])
        return first

    def walks(self, name, least_m, duration=10):
        for seed in (1, 2):
            scores = self.same_twice(name, duration, "--seed", seed)["scores"]
            self.assertGreater(scores["travelled"], least_m)
            self.assertEqual(scores["standing"], 1)

    def test_the_dog_walks(self):
        self.walks("dog", 1)

    def test_walkers_of_four_six_and_eight_legs_walk(self):
        for legs in (4, 6, 8):
            with self.subTest(legs):
                self.walks(f"octavio{legs}", 0.6)

    def test_the_biped_steps_around_its_boom(self):
        for seed in (1, 2):
            told = self.same_twice("runbot", 5, "--seed", seed)
            self.assertGreaterEqual(told["logged"]["runbot.steps"], 5)
            self.assertGreater(told["scores"]["distance"], 0.5)

    def test_the_seeker_finds_the_lamp_of_most_seeds_and_learns(self):
        runs = [self.run_once("seeker", 60, "--seed", seed) for seed in range(1, 9)]
        self.assertGreaterEqual(sum(run["scores"]["found"] for run in runs), 6)
        self.assertGreater(max(run["logged"]["seeker.weights"] for run in runs), 0)
        self.assertEqual(len({run["hash"] for run in runs}), len(runs))
        self.same_twice("seeker", 5)

    def test_goals_are_made(self):
        goals = 0
        for seed in range(1, 11):
            scores = self.run_once("soccer", 20, "--seed", seed)["scores"]
            goals += scores["blue_goals"] + scores["red_goals"]
        self.assertGreaterEqual(goals, 3)
        self.same_twice("soccer", 5)


if __name__ == "__main__":
    unittest.main()
