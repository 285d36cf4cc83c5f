# SPDX-License-Identifier: MIT
"""read_run of foreign or damaged files: an error that says what is wrong, never wrong numbers."""
import os
import pathlib
import re
import sqlite3
import unittest

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn
import run_file as rf
from run_cases import ReadRunTestCase


class ForeignAndDamaged(ReadRunTestCase):
    def write_changed(self, statement):
        self.write_two()
        db = sqlite3.connect(self.path)
        db.execute(statement)
        db.commit()
        db.close()

    def test_a_file_that_is_not_there_is_error_10(self):
        error = self.error_of(lambda: coopdyn.read_run("nowhere.run"))
        self.assertEqual(error.code, 10)
        self.assertIn("nowhere.run", error.text)

    def test_foreign_files_are_told_from_recordings(self):
        for content in (b"", b"[FLOOR]\nsize 4 4 0.1\n" * 100, bytes(4096)):
            pathlib.Path(self.path).write_bytes(content)
            error = self.error_of(lambda: coopdyn.read_run(self.path))
            self.assertEqual(error.code, 7)
            self.assertIn("no recording", error.text)
        os.remove(self.path)
        other = sqlite3.connect(self.path)
        other.execute("CREATE TABLE meta(key, value)")
        other.commit()
        other.close()
        self.assertIn("no recording", self.error_of(lambda: coopdyn.read_run(self.path)).text)

    def test_a_newer_format_says_where_to_get_a_reader(self):
        rf.close(rf.create(self.path, user_version=3))
        error = self.error_of(lambda: coopdyn.read_run(self.path))
        self.assertEqual(error.code, 5)
        self.assertIn("was recorded in format 3 by a newer coopdyn", error.text)

    def test_an_older_format_is_to_be_recorded_again(self):
        rf.close(rf.create(self.path, user_version=1))
        error = self.error_of(lambda: coopdyn.read_run(self.path))
        self.assertEqual(error.code, 5)
        self.assertIn("was recorded in format 1 by an older coopdyn", error.text)
        self.assertIn("record it again", error.text)

    def test_a_format_that_never_was_is_damage(self):
        rf.close(rf.create(self.path, user_version=-1))
        error = self.error_of(lambda: coopdyn.read_run(self.path))
        self.assertEqual(error.code, 7)
        self.assertIn("its format is -1", error.text)

    def test_bytes_that_do_not_add_up_are_an_error_that_names_the_step(self):
        self.write_two()
        for column, call in (("poses", lambda run: run.pose("robot2")), ("channels", lambda run: run.reading("robot2", "channels")),
                             ("distances", lambda run: run.reading("robot2", "distances")),
                             ("targets", lambda run: run.reading("robot2", "targets")),
                             ("commands", lambda run: run.commands("robot2"))):
            with self.subTest(column):
                db = sqlite3.connect(self.path)
                whole = db.execute(f"SELECT {column} FROM step WHERE step = 12").fetchone()[0]
                db.execute(f"UPDATE step SET {column} = ? WHERE step = 12", (whole[:-1],))
                db.commit()
                error = self.error_of(lambda: call(coopdyn.read_run(self.path)))
                self.assertEqual(error.code, 7)
                self.assertIn("step 12", error.text)
                db.execute(f"UPDATE step SET {column} = ? WHERE step = 12", (whole,))
                db.commit()
                db.close()
                call(coopdyn.read_run(self.path))

    def test_values_of_a_wrong_kind_are_an_error(self):
        for statement in ("UPDATE step SET hash = 'x'", "UPDATE step SET time_ns = NULL", "UPDATE robot SET body = 'x'",
                          "UPDATE robot SET body = 1000", "UPDATE robot SET body = -7", "UPDATE robot SET p_x = 'x'",
                          "UPDATE meta SET value = 'x' WHERE key = 'seed'", "DELETE FROM meta", "DROP TABLE event",
                          "UPDATE step SET poses = 7", "UPDATE step SET commands = 7", "UPDATE robot SET q_w = NULL, q_x = 2",
                          "UPDATE robot SET sensors = 'x'", "UPDATE robot SET sensors = -3"):
            with self.subTest(statement):
                self.write_changed(statement)
                error = self.error_of(lambda: self.read_all(coopdyn.read_run(self.path)))
                os.remove(self.path)
                self.assertEqual(error.code, 7, error)

    def test_a_truncated_or_overwritten_file_is_an_error_or_reads_never_anything_else(self):
        self.write_two(steps=400)
        whole = pathlib.Path(self.path).read_bytes()
        wrong = 0
        for k in range(60):
            cut = whole[: len(whole) * k // 60] if k % 2 else bytearray(whole)
            if not k % 2:
                at = (k * 7919 + 100) % (len(whole) - 4000)
                cut[at : at + 4000] = bytes([k * 5 % 256]) * 4000
            pathlib.Path(self.path).write_bytes(bytes(cut))
            try:
                self.read_all(coopdyn.read_run(self.path))
            except coopdyn.Error as e:
                self.assertTrue(e.text)
                wrong += 1
        self.assertGreater(wrong, 30)

    def test_steps_and_poses_that_are_not_there_are_an_error(self):
        for statement, said in (("DELETE FROM step WHERE step = 10", "steps are missing"),
                                ("DELETE FROM step WHERE step = 11", "steps are missing"),
                                ("INSERT INTO meta VALUES ('last_step', 13)", "steps are missing"),
                                ("INSERT INTO meta VALUES ('last_step', 11)", "steps are missing"),
                                ("UPDATE step SET poses = NULL WHERE step = 11", "the poses of step 11 are missing"),
                                ("UPDATE step SET poses = NULL WHERE step = 12", "the poses of step 12 are missing")):
            with self.subTest(statement):
                self.write_changed(statement)
                error = self.error_of(lambda: coopdyn.read_run(self.path).pose("robot1"))
                os.remove(self.path)
                self.assertEqual(error.code, 7)
                self.assertIn(said, error.text)

    def test_a_row_with_the_number_of_another_hides_none(self):
        self.write_two(steps=60)
        whole = pathlib.Path(self.path).read_bytes()
        changed, times = re.subn(rb"\x1e(?=.\x00\x04\x06)", b"\x7f", whole, flags=re.DOTALL)  # of the row of step 30
        self.assertEqual(times, 1)
        pathlib.Path(self.path).write_bytes(changed)
        error = self.error_of(lambda: coopdyn.read_run(self.path).pose("robot1"))
        self.assertIn("step 31 comes after step 127", error.text)

    def test_a_damaged_page_never_hides_rows(self):
        self.write_two(steps=60)
        db = sqlite3.connect(self.path, isolation_level=None)
        db.execute("DELETE FROM event")
        db.executemany("INSERT INTO event VALUES (?, ?, ?, 'note', ?)", ((k, k, k * 10**7, "n" * 40) for k in range(1, 60)))
        last = db.execute("SELECT max(step) FROM step").fetchone()[0]
        db.execute("INSERT INTO meta VALUES ('ends', ?)", (f"step {last} 1, event 59 2",))
        db.execute("PRAGMA page_size = 1024")
        db.execute("VACUUM")
        db.close()
        whole = pathlib.Path(self.path).read_bytes()
        counts = self.counts(coopdyn.read_run(self.path))
        wrong = 0
        for at in range(0, len(whole), 1024):
            for how in ("zero", "flip", "fewer cells", "one cell less"):
                page = bytearray(whole)
                if how == "zero":
                    page[at : at + 1024] = bytes(1024)
                elif how == "flip":
                    page[at : at + 1024] = bytes(b ^ 255 for b in page[at : at + 1024])
                else:
                    page[at + 4] = page[at + 4] // 2 if how == "fewer cells" else max(0, page[at + 4] - 1)
                pathlib.Path(self.path).write_bytes(bytes(page))
                try:
                    found = self.counts(coopdyn.read_run(self.path))
                except coopdyn.Error as e:
                    self.assertIn(self.path, e.text)
                    wrong += 1
                    continue
                self.assertEqual(found, counts, (at // 1024 + 1, how))
        self.assertGreater(wrong, 100)

    @staticmethod
    def counts(run):
        return [len(rows) for rows in (run.steps, run.events, run.names, run.pose(run.names[0]), run.commands(run.names[0]))]

    @staticmethod
    def read_all(run):
        for name in run.names:
            run.pose(name), run.pose_3d(name), run.commands(name), run.joints(name)
            for what in ("distances", "targets", "channels"):
                run.reading(name, what)
        return run.time, run.steps, run.hash, run.events, run.scenario, run.info


if __name__ == "__main__":
    unittest.main()
