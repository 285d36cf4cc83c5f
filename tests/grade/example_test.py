# SPDX-License-Identifier: MIT
"""coopdyn grade from end to end: the example, results, pages, formats of other systems, and appeals."""
import csv
import json
import os
import re
import shutil
import signal
import sqlite3
import struct
import subprocess
import time
import unittest
import zlib

import grade_case  # noqa: F401  (finds the modules)
import engines
import film
from grade_case import ASSIGNMENT, BINARY, DRIVE, LIMIT_S, GradeCase

HALF = DRIVE.replace("0.3", "0.06")


def picture(*rows):
    """A gray PNG."""
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    return film.kSignature + film.chunk(b"IHDR", head) + film.chunk(b"IDAT", data) + film.chunk(b"IEND", b"")


class ExampleTest(GradeCase):
    def test_the_example_is_graded_tried_and_appealed(self):
        self.assertEqual(self.run_words("--example", "maze").returncode, 0)
        done = self.grade("maze/maze.assignment", "maze/reference", "maze/weak")
        self.assertIn("10 runs, 10 to do", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^reference: 10 of 10 points$")
        rows = {row["name"]: row for row in self.table()}
        self.assertEqual(float(rows["reference"]["points"]), 10)
        self.assertTrue(0 < float(rows["weak"]["points"]) < 2, rows)
        with open(self.path("out/weak/index.html"), encoding="utf-8") as stream:
            page = stream.read()
        self.assertIn("src='data:image/png;base64,", page)
        self.assertIn("Be faster: turn while you drive", page)
        self.assertFalse(re.search(r"(src|href)='(?!data:)", page))
        tried = self.run_words("maze/maze.assignment", "--try", "maze/weak")
        self.assertEqual(tried.returncode, 0, tried.stderr)
        self.assertRegex(tried.stdout, r"(?s)seed 1 .*seed 3 .*points on the visible seeds; 2 hidden ones count, too")
        before = {name: self.result(name) for name in ("reference", "weak")}
        again = self.grade("maze/maze.assignment", "maze/reference", "maze/weak", "--no-film")
        self.assertIn("10 runs, 0 to do", again.stdout)
        self.assertEqual(before, {name: self.result(name) for name in before})
        for path in ("out/reference", "out/weak/results.json"):
            heard = self.run_words("--appeal", path)
            self.assertEqual(heard.returncode, 0, heard.stdout + heard.stderr)
            self.assertEqual(len(re.findall(r"(?m)^(?:seed|hidden) \d: same: the recording repeats bit by bit", heard.stdout)), 5)
            self.assertEqual(len(re.findall(r"(?m)^(?:seed|hidden) \d: same: the program drives it to the same hash", heard.stdout)), 5)

    def test_points_are_the_mean_of_all_seeds_and_say_what_to_improve(self):
        self.write("lane.assignment", ASSIGNMENT.replace("seeds 1", "seeds 1..2\nhidden_seeds 1"))
        self.run_words("--new-key", "lane.key")
        self.grade_all(self.submit("half", HALF))
        result = self.result("half")
        runs = result["extra_data"]["runs"]
        self.assertEqual([one["label"] for one in runs], ["seed 1", "seed 2", "hidden 1"])
        self.assertAlmostEqual(result["score"], sum(one["points"] for one in runs) / 3, places=3)
        self.assertTrue(2 < result["score"] < 5, result["score"])
        [test] = result["tests"]
        self.assertEqual((test["name"], test["max_score"], test["score"]), ("way", 10, result["score"]))
        self.assertRegex(test["output"], "^way: .* of 10 points. Reached: 0.05.* m on average. All points from 0.15 m on. Drive along x.$")

    def test_hidden_seeds_and_their_recordings_are_beside_what_is_handed_back(self):
        self.write("lane.assignment", ASSIGNMENT.replace("duration", "hidden_seeds 1\nduration"))
        self.assertRegex(self.grade_all(self.submit("good", DRIVE), code=1).stderr, "--new-key .*lane.key makes one")
        self.run_words("--new-key", "teacher.key")
        self.grade_all(self.path("good"), "--key", "teacher.key")
        self.assertEqual(sorted(os.listdir(self.path("out/good"))), ["index.html", "results.json", "seed-1.run", "submission.tar"])
        self.assertEqual(os.listdir(self.path("out/hidden/good")), ["hidden-1.run"])
        self.assertIsNone(self.runs("good")[1]["seed"])
        self.grade_all(self.path("good"), "--key", "teacher.key", "--show-hidden")
        self.assertIsInstance(self.runs("good")[1]["seed"], int)

    def test_one_submission_has_gradescopes_file_where_it_looks_for_it(self):
        self.grade_all(self.submit("good", DRIVE), "--format", "gradescope")
        with open(self.path("out/results.json"), encoding="utf-8") as stream:
            result = json.load(stream)
        self.assertEqual(result, self.result("good"))
        self.assertEqual((result["score"], result["visibility"], result["tests"][0]["score"]), (10, "visible", 10))

    def test_autolab_reads_the_last_line(self):
        done = self.grade_all(self.submit("good", DRIVE), "--format", "autolab")
        self.assertEqual(json.loads(done.stdout.splitlines()[-1]), {"scores": {"way": 10.0}})
        self.assertIn("takes one submission", self.grade_all(self.path("good"), self.submit("half", HALF), "--format", "autolab", code=1).stderr)

    def test_moodle_gets_a_worksheet(self):
        self.submit("handed/Ana Lovelace_12345_assignsubmission_file", DRIVE)
        self.write("sheet.csv", '\ufeffIdentifier,"Full name",Grade,"Last modified (grade)","Feedback comments"\nParticipant 12345,"Ana Lovelace",,-,\nParticipant 9,Bob,7,-,late\n')
        words = ["--submissions", "handed", "--format", "moodle"]
        self.grade_all(*words)
        [row] = self.table(file="moodle.csv")
        self.assertEqual((row["Identifier"], row["Full name"], row["Grade"]), ("Participant 12345", "Ana Lovelace", "10.0"))
        self.grade_all(*words, "--worksheet", "sheet.csv")
        self.assertEqual([(row["Grade"], row["Feedback comments"]) for row in self.table(file="moodle.csv")], [("10.0", "All points."), ("7", "late")])

    def test_what_has_a_result_is_not_run_again_unless_something_has_changed(self):
        self.submit("good", DRIVE)
        self.assertIn("1 run, 1 to do", self.grade_all(self.path("good")).stdout)
        self.assertIn("1 run, 0 to do", self.grade_all(self.path("good")).stdout)
        self.assertIn("1 run, 1 to do", self.grade_all(self.path("good"), "--again").stdout)
        self.submit("good", DRIVE + "# changed\n")
        self.assertIn("1 run, 1 to do", self.grade_all(self.path("good")).stdout)
        self.write("lane.assignment", ASSIGNMENT.replace("points 10", "points 9"))
        self.assertIn("1 run, 1 to do", self.grade_all(self.path("good")).stdout)
        os.remove(self.path("out/good/seed-1.run"))
        self.assertIn("1 run, 1 to do", self.grade_all(self.path("good")).stdout)

    def test_ctrl_c_ends_all_and_the_same_command_does_the_rest(self):
        self.write("lane.assignment", ASSIGNMENT.replace("seeds 1", "seeds 1..40"))
        self.submit("good", DRIVE)
        words = [BINARY, "grade", self.assignment, self.path("good"), "--no-film", "--out", self.path("out")]
        began = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, cwd=self.folder, text=True)
        end = time.monotonic() + LIMIT_S
        while not os.path.exists(self.path("out/results.jsonl")) or not os.path.getsize(self.path("out/results.jsonl")):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        began.send_signal(signal.SIGINT)
        said = began.communicate(timeout=LIMIT_S)[1]
        self.assertEqual(began.returncode, 130, said)
        self.assertIn("The same command does what is missing", said)
        while subprocess.run(["pgrep", "-f", self.folder], capture_output=True, check=False).returncode == 0:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        done = self.grade_all(self.path("good"))
        left = int(re.search(r"40 runs, (\d+) to do", done.stdout)[1])
        self.assertTrue(0 < left < 40, left)
        self.assertEqual(len(self.runs("good")), 40)

    def test_runs_that_end_just_when_all_is_stopped_keep_nobody_waiting(self):
        def carry_out(job, started):
            started.kill()
            return job

        engine = engines.local([{"key": "1"}, {"key": "2"}], 1, carry_out)
        self.assertEqual(next(engine)["key"], "1")
        with self.assertRaises(KeyboardInterrupt):
            next(engine)

    def appeal(self, code, *patterns):
        done = self.run_words("--appeal", "out/good")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        for pattern in patterns:
            self.assertRegex(done.stdout, pattern)

    def test_an_appeal_finds_a_changed_recording(self):
        self.grade_all(self.submit("good", DRIVE))
        shutil.copy(self.path("out/good/seed-1.run"), self.path("kept.run"))
        with sqlite3.connect(self.path("out/good/seed-1.run")) as file:
            self.assertEqual(file.execute("update step set hash = hash + 1 where step = 50").rowcount, 1)
        file.close()
        self.appeal(1, "(?m)^seed 1: differs: the recording does not repeat: .*", "Something differs")
        shutil.copy(self.path("kept.run"), self.path("out/good/seed-1.run"))
        self.appeal(0, "The grade stands")
        os.remove(self.path("out/good/seed-1.run"))
        self.appeal(1, "its recording good/seed-1.run is gone")

    def test_an_appeal_finds_changed_points(self):
        self.grade_all(self.submit("good", HALF))
        with open(self.path("out/good/results.json"), encoding="utf-8") as stream:
            text = stream.read()
        result = json.loads(text)
        for change, pattern in ((lambda r: r.update(score=10), "the mean of the runs is"),
                                (lambda r: r["extra_data"]["runs"][0].update(points=10), "its scores earn .* points, the result says 10"),
                                (lambda r: r["extra_data"]["runs"][0]["scores"].update(way=0.2), "the recording has the scores"),
                                (lambda r: r["extra_data"]["runs"][0].update(hash="0" * 16), "the result says 0000000000000000")):
            changed = json.loads(text)
            change(changed)
            self.write("out/good/results.json", json.dumps(changed))
            self.appeal(1, pattern)
        self.assertEqual(result["extra_data"]["runs"][0]["steps"], 50)

    def test_an_appeal_tells_a_program_that_chance_drives(self):
        self.grade_all(self.submit("good", "import random\n" + DRIVE.replace("0.3", "random.random()")))
        self.appeal(1, "seed 1: same: the recording repeats bit by bit", "seed 1: differs: the program drives it to another hash.*chance.*recorded run counts")

    def test_what_is_stored_of_a_submission_can_be_deleted(self):
        self.grade_all(self.submit("good", DRIVE), self.submit("half", HALF))
        done = self.run_words("--forget", "out/good")
        self.assertEqual(done.returncode, 0, done.stderr)
        left = [name for root, folders, files in os.walk(self.path("out")) for name in [*folders, *files]]
        self.assertNotIn("good", left)
        with open(self.path("out/results.jsonl"), encoding="utf-8") as stream:
            self.assertEqual(len(stream.readlines()), 1)
        self.assertEqual(self.run_words("--forget", "out").returncode, 1)

    def test_wrong_use_is_said_with_exit_code_2(self):
        for words in ([], ["lane.assignment"], ["--try", "x"], ["--new-key", "a", "--example", "b"], ["lane.assignment", "x", "--worksheet", "y"],
                      ["lane.assignment", "x", "--jobs", "0"], ["lane.assignment", "x", "--format", "blackboard"]):
            done = self.run_words(*words)
            self.assertEqual(done.returncode, 2, words)
            self.assertIn("coopdyn grade --help", done.stderr)

    def test_a_run_that_nothing_ends_is_refused(self):
        self.write("lane.assignment", ASSIGNMENT.replace("duration 1s\n", ""))
        self.assertRegex(self.grade_all(self.submit("good", DRIVE), code=1).stderr, "nothing ends a run: add `duration 60s`")

    def test_a_program_of_the_command_that_is_not_there_is_told_before_anything_runs(self):
        self.write("lane.assignment", ASSIGNMENT.replace("python3 {", "pythn9 {"))
        self.assertRegex(self.grade_all(self.submit("good", DRIVE), code=1).stderr, "the command's program pythn9 is not in")

    def test_a_program_may_start_others_and_write_its_own_files(self):
        self.submit("shell", DRIVE, "drive.py")
        self.submit("shell", "import os, subprocess, sys\nopen('/tmp/note', 'w').write('x' * 1000)\nassert os.environ['HOME'] == '/tmp'\n"
                    "subprocess.run([sys.executable, '/submission/drive.py'], check=True)\n")
        self.grade_all(self.path("shell"))
        self.assertEqual(self.result("shell")["score"], 10)

    def test_the_graders_umask_makes_no_difference(self):
        self.submit("good", DRIVE.replace("import coopdyn\n", "import coopdyn\nimport own.part\n"))
        self.submit("good", "x = 1\n", "own/part.py")
        self.grade_all(self.path("good"), umask=0o077)
        self.assertEqual(self.result("good")["score"], 10)

    def test_pictures_make_an_animated_png(self):
        made = film.animated([picture([0, 1], [2, 3]), picture([4, 5], [6, 7])], 8)
        kinds = [(kind, data) for kind, data in film.chunks_of(made)]
        self.assertEqual([kind for kind, _ in kinds], [b"IHDR", b"acTL", b"fcTL", b"IDAT", b"fcTL", b"fdAT", b"IEND"])
        self.assertEqual(struct.unpack(">II", kinds[1][1]), (2, 0))
        self.assertEqual([struct.unpack(">I", kinds[k][1][:4])[0] for k in (2, 4, 5)], [0, 1, 2])
        self.assertEqual(zlib.decompress(kinds[5][1][4:]), b"\0\4\5\0\6\7")
        self.assertEqual([struct.unpack(">HH", kinds[k][1][20:24]) for k in (2, 4)], [(1, 8), (2, 1)])


if __name__ == "__main__":
    unittest.main()
