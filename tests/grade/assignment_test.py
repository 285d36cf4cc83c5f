# SPDX-License-Identifier: MIT
"""The text of an assignment: mistakes, seeds, points."""
import os
import tempfile
import unittest

import grade_case  # noqa: F401  (finds the modules)
import assignment as assignments
from grade_case import ASSIGNMENT
from plan import Wrong

KEY, OTHER = bytes(range(32)), bytes(32)


class AssignmentTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = os.path.join(folder.name, "lane.assignment")
        with open(os.path.join(folder.name, "lane.scenario"), "w", encoding="utf-8") as stream:
            stream.write("[FLOOR]\nsize 8 8\n")

    def read(self, text, scores=("way", "arrived", "arrived met")):
        with open(self.file, "w", encoding="utf-8", newline="") as stream:
            stream.write(text)
        return assignments.read(self.file, [], lambda scenario: list(scores))

    def mistakes(self, text):
        with self.assertRaises(Wrong) as caught:
            self.read(text)
        return str(caught.exception).replace(self.file + ":", "").splitlines()

    def points(self, lines, **measures):
        return self.read(ASSIGNMENT.partition("[POINTS_1]")[0] + "[POINTS_1]\n" + lines).points[0].of(measures)

    def test_a_right_text_is_read_with_units_comments_and_line_ends(self):
        read = self.read(ASSIGNMENT.replace("seeds 1", "seeds = 1..3   # three").replace("memory 128MiB", "MEMORY: 1GiB").replace("\n", "\r\n"))
        self.assertEqual((read.values["seeds"], read.values["memory"], read.values["time"], read.values["files"]), ([1, 2, 3], 1 << 30, 5.0, ["main.py"]))
        self.assertEqual((read.title, read.most, os.path.basename(read.scenario)), ("lane", 10.0, "lane.scenario"))

    def test_all_mistakes_are_told_at_once_with_what_to_write(self):
        told = self.mistakes("""title first
[ASSIGNMENT]
scenari lane
comand python3
seeds 3..1
memory lots
hidden_seeds -1
files ../key
time
time 5s
time 6s
[POINT_1]
score way
[POINTS_2]
score wy
from 1
to 1
points 0
colour red
""")
        wanted = ["1: error: this line stands before the first section", "2: error: .ASSIGNMENT. needs the key scenario",
                  "2: error: .ASSIGNMENT. needs the key command",
                  "3: error: there is no key 'scenari' in this section: did you mean scenario", "4: error: .*did you mean command",
                  "5: error: seeds 3..1: .*smaller number first", "6: error: memory lots: .*for example 512MiB", "7: error: hidden_seeds -1: .*whole number from 0",
                  "8: error: files ../key: .*in the submission's folder", "9: error: time has no value", "11: error: time stands twice",
                  r"12: error: there is no section .POINT_1.: did you mean .POINTS_1", "17: error: from and to are the same",
                  "18: error: points 0: .*above 0", "19: error: there is no key 'colour' in this section: write one of score"]
        self.assertEqual(len(told), len(wanted), told)
        for line, pattern in zip(told, wanted):
            self.assertRegex(line, "^" + pattern)

    def test_an_unknown_score_names_the_nearest_one(self):
        self.assertRegex(self.mistakes(ASSIGNMENT.replace("score way", "score wai"))[0], r"^13: error: the scenario has no score wai: did you mean way\?")

    def test_an_unknown_scenario_is_told(self):
        self.assertRegex(self.mistakes(ASSIGNMENT.replace("lane.scenario", "nowhere"))[0], "^2: error: there is no scenario nowhere")

    def test_a_command_without_the_submission_or_with_an_unknown_word_is_refused(self):
        for command, words in (("python3 main.py", r"\{submission\}"), ("python3 {submission}/main.py {seed}", r"has \{seed\}")):
            self.assertRegex(self.mistakes(ASSIGNMENT.replace("python3 {submission}/main.py", command))[0], "^3: error: .*" + words)

    def test_points_go_by_a_straight_line_and_stop_at_both_ends(self):
        for value, earned in ((-1, 0), (0, 0), (0.5, 2), (1, 4), (7, 4)):
            self.assertAlmostEqual(self.points("score way\nfrom 0\nto 1\npoints 4", way=value), earned)

    def test_points_may_go_downwards(self):
        for value, earned in ((70, 0), (60, 0), (45, 1), (30, 2), (10, 2)):
            self.assertAlmostEqual(self.points("score arrived met\nfrom 60s\nto 30s\npoints 2", **{"arrived met": value}), earned)

    def test_a_value_that_is_not_there_earns_nothing(self):
        self.assertEqual(self.points("score arrived met\nfrom 60s\nto 30s\npoints 2", **{"arrived met": None}), 0)

    def test_points_that_need_a_score_are_earned_with_it_alone(self):
        lines = "score way\nneeds arrived\nfrom 0\nto 1\npoints 4"
        self.assertEqual([self.points(lines, way=1, arrived=arrived) for arrived in (0, None, 1)], [0, 0, 4])

    def test_hidden_seeds_are_made_from_the_key_and_the_text(self):
        read = self.read(ASSIGNMENT + "\n", ).seeds(KEY)
        self.assertEqual(read, [("seed 1", 1, False)])
        text = ASSIGNMENT.replace("duration", "hidden_seeds 3\nduration")
        hidden = [seed for _, seed, _ in self.read(text).seeds(KEY)[1:]]
        self.assertEqual(hidden, [seed for _, seed, _ in self.read(text).seeds(KEY)[1:]])
        self.assertEqual(len(set(hidden)), 3)
        self.assertTrue(all(0 <= seed < 1 << 31 for seed in hidden))
        self.assertFalse(set(hidden) & {seed for _, seed, _ in self.read(text).seeds(OTHER)})
        self.assertFalse(set(hidden) & {seed for _, seed, _ in self.read(text.replace("points 10", "points 9")).seeds(KEY)})

    def test_hidden_seeds_are_hmac_sha256(self):
        import hashlib
        import hmac
        made = hmac.new(KEY, b"coopdyn grade abc 2", hashlib.sha256).hexdigest()
        self.assertEqual(assignments.hidden_seed(KEY, "abc", 2), int(made[:8], 16) >> 1)

    def test_a_new_key_is_its_owners_alone_and_overwrites_nothing(self):
        path = os.path.join(os.path.dirname(self.file), "a.key")
        assignments.new_key(path)
        self.assertEqual(os.stat(path).st_mode & 0o777, 0o600)
        self.assertEqual(len(assignments.read_key(path)), 32)
        with self.assertRaisesRegex(Wrong, "is there already"):
            assignments.new_key(path)


if __name__ == "__main__":
    unittest.main()
