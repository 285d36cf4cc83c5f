# SPDX-License-Identifier: MIT
"""coopdyn grade --class: from what the seats of a class handed in to the results on their pages."""
import json
import os
import sys
import unittest

import grade_case  # noqa: F401  (finds the modules)
from grade_case import ASSIGNMENT, DRIVE, ROOT, SCENARIO, GradeCase

sys.path.append(os.path.join(ROOT, "tests", "host"))
from classes import Host  # noqa: E402

HALF = DRIVE.replace("0.3", "0.06")


class ClassTest(GradeCase):
    def setUp(self):
        super().setUp()
        self.write("class/class.csv", "seat,name,pin,group,link\nana,Ana Lima,1000,1,a\nben,Ben Okafor,1111,1,b\n")

    def hand_in(self, seat, time, text, file="program.py"):
        self.write(f"class/seats/{seat}/handed-in/{time}/{file}", text)

    def result_text(self, seat, time):
        with open(self.path("class/seats", seat, "handed-in", time, "result.txt"), encoding="utf-8") as stream:
            return stream.read()

    def grade_class(self, *words, **given):
        return self.grade_all("--class", "class", *words, **given)

    def test_the_newest_hand_in_is_graded_under_seat_and_name(self):
        self.hand_in("ana", "20261129-221236", "raise SystemExit(1)\n")
        self.hand_in("ana", "20261130-090000", HALF)
        self.hand_in("ana", "20261130-090000", "no part of the program", "recording.run")
        done = self.grade_class()
        [row] = self.table()
        self.assertEqual((row["name"], row["id"]), ("Ana Lima", "ana"))
        self.assertTrue(2 < float(row["points"]) < 5, row)
        self.assertIn("nothing handed in by Ben Okafor (ben)", done.stdout)

    def test_the_result_stands_beside_the_hand_in(self):
        self.hand_in("ana", "20261129-221236", HALF)
        self.hand_in("ben", "20261129-221300", DRIVE)
        self.assertIn("result.txt beside 2 hand-ins", self.grade_class().stdout)
        self.assertRegex(self.result_text("ana", "20261129-221236"), r"^lane: [234][.\d]* of 10 points.\nTo improve: way: .* of 10 points. Reached: .*Drive along x.\n$")
        self.assertEqual(self.result_text("ben", "20261129-221300"), "lane: 10 of 10 points.\n")

    def test_a_program_that_fails_and_a_hand_in_without_one_get_a_sentence(self):
        self.hand_in("ana", "20261129-221236", "raise ValueError\n")
        self.hand_in("ben", "20261129-221300", "", "recording.run")
        self.grade_class()
        self.assertRegex(self.result_text("ana", "20261129-221236"), r"^lane: 0 of 10 points.\nThe program .*\n")
        self.assertRegex(self.result_text("ben", "20261129-221300"), r"^lane: 0 of 10 points.\nThere is no program in what was handed in: write one in the tab Program")

    def test_a_second_grading_runs_only_what_is_new_and_keeps_the_rows(self):
        self.hand_in("ana", "20261129-221236", DRIVE)
        self.grade_class()
        self.hand_in("ben", "20261130-090000", DRIVE)
        self.assertIn("2 runs, 1 to do", self.grade_class().stdout)
        self.assertEqual([row["id"] for row in self.table()], ["ana", "ben"])
        self.write("class/class.csv", "seat;name\nben;Ben Okafor\n")
        self.grade_class()
        self.assertEqual([row["id"] for row in self.table()], ["ana", "ben"])

    def test_a_seat_that_the_class_no_longer_has_is_passed_over_and_named(self):
        self.hand_in("ana", "20261129-221236", DRIVE)
        self.hand_in("eva", "20261129-221236", DRIVE)
        self.assertIn("passed over eva: class.csv has no such seat", self.grade_class().stdout)
        self.assertEqual([row["id"] for row in self.table()], ["ana"])

    def test_an_assignment_without_files_takes_the_file_of_its_command(self):
        self.write("lane.assignment", ASSIGNMENT.replace("files main.py\n", "").replace("/main.py", "/drive.py"))
        self.hand_in("ana", "20261129-221236", DRIVE)
        self.grade_class()
        self.assertEqual(self.result_text("ana", "20261129-221236"), "lane: 10 of 10 points.\n")

    def test_an_assignment_that_wants_more_than_a_program_is_refused(self):
        self.write("lane.assignment", ASSIGNMENT.replace("files main.py", "files main.py map.txt"))
        self.hand_in("ana", "20261129-221236", DRIVE)
        self.assertRegex(self.grade_class(code=1).stderr, "wants main.py and map.txt, and a seat hands in one Python program: .*`files main.py`")

    def test_a_folder_that_is_no_class_is_refused(self):
        self.assertRegex(self.grade_all("--class", "nowhere", code=1).stderr, "--class nowhere: .*Name the folder that `coopdyn host` has made")
        self.write("class/class.csv", "name\nAna Lima\n")
        self.assertRegex(self.grade_class(code=1).stderr, "has no seat and name")
        self.write("class/class.csv", "seat,name\n../ana,Ana Lima\n")
        self.assertRegex(self.grade_class(code=1).stderr, "a seat's name has a-z")

    def test_a_class_that_handed_in_nothing_is_told(self):
        self.assertRegex(self.grade_class(code=1).stderr, "nothing to grade")

    def test_a_hand_in_that_is_a_link_is_refused(self):
        self.write("secret.py", DRIVE)
        os.makedirs(self.path("class/seats/ana/handed-in/20261129-221236"))
        os.symlink(self.path("secret.py"), self.path("class/seats/ana/handed-in/20261129-221236/program.py"))
        self.grade_class()
        self.assertRegex(self.result_text("ana", "20261129-221236"), "0 of 10 points.\nIt cannot be read")

    def test_a_student_hands_in_on_the_page_and_reads_the_result_there(self):
        with Host(lesson=SCENARIO, students=("ana",)) as host:
            student = host.as_student("ana")
            version = json.loads(host.fetch("GET", "/s/ana/class/program", headers=student)[1])["version"]
            for address, body in (("program", {"text": DRIVE, "base": version}), ("hand-in", {})):
                status, said, _ = host.fetch("POST", f"/s/ana/class/{address}", body, student)
                self.assertEqual(status, 200, said)
            self.assertNotIn("result", host.me("ana")["handed_in"][0])
            self.grade_all("--class", str(host.folder / "class"))
            [handed_in] = host.me("ana")["handed_in"]
            self.assertEqual(handed_in["result"], "lane: 10 of 10 points.\n")


if __name__ == "__main__":
    unittest.main()
