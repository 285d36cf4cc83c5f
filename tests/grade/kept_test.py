# SPDX-License-Identifier: MIT
"""More submissions into the same OUT: earlier ones stay in all tables, and nobody takes the place of another."""
import json
import subprocess
import unittest

import grade_case  # noqa: F401  (finds the modules)
import submissions
from grade_case import ASSIGNMENT, BINARY, DRIVE, LIMIT_S, GradeCase


class KeptTest(GradeCase):
    def names(self, entries, known):
        found = submissions.named([submissions.Candidate("", name, identity) for name, identity in entries], known)
        return [one.name for one in found]

    def text(self, name):
        with open(self.path("out", name), encoding="utf-8") as stream:
            return stream.read()

    def test_a_late_submission_joins_those_that_were_graded(self):
        self.submit("subs/Ana_11_assignsubmission_file", DRIVE)
        self.submit("subs/Ben_12_assignsubmission_file", "", "other.py")
        self.grade_all("--submissions", "subs")
        before = {row["name"]: row for row in self.table()}
        done = self.grade_all(self.submit("late/Cem_13_assignsubmission_file", DRIVE), "--format", "autolab")
        self.assertEqual(json.loads(done.stdout.splitlines()[-1]), {"scores": {"way": 10.0}})
        after = {row["name"]: row for row in self.table()}
        self.assertEqual(sorted(after), ["Ana", "Ben", "Cem"])
        self.assertEqual({name: after[name] for name in before}, before)
        self.assertEqual(after["Ben"]["sentence"], "main.py is missing.")
        page = self.text("index.html")
        self.assertIn("3 submissions, 1 seed", page)
        for name in after:
            self.assertIn(f"<a href='{name}/index.html'>", page)
        self.assertEqual([one["extra_data"]["name"] for one in json.loads(self.text("results.json"))["submissions"]], sorted(after))

    def test_comments_for_moodle_are_the_same_after_a_late_submission(self):
        self.submit("subs/Ana_11_assignsubmission_file", DRIVE.replace("0.3", "0.06"))
        self.grade_all("--submissions", "subs", "--format", "moodle")
        [ana] = self.table(file="moodle.csv")
        self.assertIn("All points from 0.15 m on", ana["Feedback comments"])
        self.grade_all(self.submit("late/Cem_13_assignsubmission_file", DRIVE), "--format", "moodle")
        self.assertEqual([row for row in self.table(file="moodle.csv") if row["Full name"] == "Ana"], [ana])

    def test_results_of_another_text_of_the_assignment_are_named_and_not_mixed_in(self):
        self.grade_all(self.submit("ana", DRIVE))
        self.write("lane.assignment", ASSIGNMENT.replace("points 10", "points 9"))
        done = self.grade_all(self.submit("ben", DRIVE))
        self.assertRegex(done.stderr, "another text of the assignment.*: ana. Grade these again")
        self.assertEqual([row["name"] for row in self.table()], ["ben"])
        self.assertIn("another text of the assignment", self.text("index.html"))
        self.grade_all(self.path("ana"))
        self.assertEqual([row["of"] for row in self.table()], ["9.0", "9.0"])

    def test_who_is_deleted_leaves_the_tables_and_the_others_stay(self):
        self.grade_all(self.submit("ana", DRIVE), self.submit("ben", DRIVE))
        self.assertEqual(self.run_words("--forget", "out/ana").returncode, 0)
        self.grade_all(self.submit("cem", DRIVE))
        self.assertEqual([row["name"] for row in self.table()], ["ben", "cem"])

    def test_one_submission_graded_for_gradescope_has_its_file_beside_others(self):
        self.grade_all(self.submit("ana", DRIVE))
        self.grade_all(self.submit("ben", DRIVE), "--format", "gradescope")
        self.assertEqual(json.loads(self.text("results.json")), self.result("ben"))

    def test_the_metadata_beside_a_late_submission_of_gradescope_names_it(self):
        self.write("subs/submission_metadata.yml", "submission_777:\n  :submitters:\n  - :name: Ana Lovelace\n    :sid: a77\n")
        self.submit("subs/submission_777", DRIVE)
        for found in (submissions.find([self.path("subs/submission_777")], []), submissions.find([], [self.path("subs")])):
            self.assertEqual([(one.name, one.id) for one in found], [("Ana Lovelace", "a77")])

    def test_students_of_the_same_name_keep_their_places(self):
        known = {"Ana": "1", "Ana 2": "2"}
        self.assertEqual(self.names([("Ana", "2")], known), ["Ana 2"])
        self.assertEqual(self.names([("Ana", "3")], known), ["Ana 3"])
        self.assertEqual(self.names([("Ana", "1"), ("ana", "3")], known), ["Ana", "ana 3"])
        self.assertEqual(self.names([("Ana", "")], {"Ana": ""}), ["Ana"])

    def test_entries_that_are_no_submissions_are_named(self):
        self.submit("subs/ana", DRIVE)
        self.write("subs/readme.txt", "hello")
        self.write("subs/.hidden", "")
        self.write("subs/submission_metadata.yml", "")
        done = self.grade_all("--submissions", "subs")
        self.assertRegex(done.stderr, r"subs: passed over readme.txt: a submission is a folder, a .zip")

    def test_moodle_without_numbers_says_what_is_missing_and_finds_rows_by_name(self):
        self.submit("subs/Bob", DRIVE)
        self.write("sheet.csv", 'Identifier,"Full name",Grade,"Last modified (grade)","Feedback comments"\nParticipant 9,Bob,,-,\nParticipant 8,Eva,,-,\n')
        words = ["--submissions", "subs", "--format", "moodle"]
        done = self.grade_all(*words)
        self.assertRegex(done.stderr, "numbers are not known of Bob, .*--worksheet FILE.csv")
        self.assertEqual([row["Identifier"] for row in self.table(file="moodle.csv")], [""])
        self.submit("subs/Cem", DRIVE)
        done = self.grade_all(*words, "--worksheet", "sheet.csv")
        self.assertEqual([(row["Identifier"], row["Grade"]) for row in self.table(file="moodle.csv")], [("Participant 9", "10.0"), ("Participant 8", "")])
        self.assertRegex(done.stderr, "has no row, or several, for Cem: ")

    def test_a_reader_that_goes_ends_an_appeal_quietly(self):
        self.grade_all(self.submit("ana", DRIVE))
        appeal = subprocess.Popen([BINARY, "grade", "--appeal", self.path("out/ana")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        appeal.stdout.close()
        self.assertEqual(appeal.stderr.read(), "")
        appeal.stderr.close()
        self.assertEqual(appeal.wait(LIMIT_S), 141)


if __name__ == "__main__":
    unittest.main()
