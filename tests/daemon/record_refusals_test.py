"""Existing files are not overwritten, and impossible recordings are reported immediately."""
import shutil
import unittest

from harness import Daemon, scenario, until
from recording import RecordingTestCase, change, rows, tool


class RefusalsTest(RecordingTestCase):
    def record(self):
        """A run of a few steps, closed."""
        with Daemon(scenario(1), "--record", self.file) as daemon:
            motors = daemon.text("/robot1/motors")
            for _ in range(5):
                motors.must("set_wheel_speeds 2 3")

    def serve(self, *words):
        return tool("serve", *words, "--no-net", "--no-http", "--no-render", "--duration", "0.1", "--mode", "free")

    def test_a_folder_is_no_file_to_record_to(self):
        for folder in (str(self.folder), f"{self.folder}/"):
            code, said = self.serve("empty", "--record", folder)
            self.assertEqual(code, 1, said)
            self.assertIn("is a folder: write the name of a file", said)

    def test_no_name_is_wrong_use(self):
        code, said = self.serve("empty", "--record", "")
        self.assertEqual(code, 2, said)
        self.assertIn("--record lesson1.run", said)

    def test_a_branch_without_a_time_is_wrong_use(self):
        self.record()
        code, said = self.serve("--from", self.file)
        self.assertEqual(code, 2, said)
        self.assertIn("lesson1.run@12.5", said)

    def test_a_folder_that_cannot_be_made_is_wrong_use(self):
        self.file.write_text("no folder")
        for folder in (self.file, self.file / "runs"):
            code, said = self.serve("empty", "--recordings", folder)
            self.assertEqual(code, 2, said)
            self.assertIn("--recordings runs", said)

    def test_a_time_outside_the_recording_is_not_played(self):
        self.record()
        for time, where in (("-1", "before the begin"), ("99", "beyond the end")):
            code, said = tool("play", self.file, "--at", time, "--port", "0", "--no-http", "--no-render")
            self.assertEqual(code, 1, said)
            self.assertIn(where, said)

    def test_the_run_that_is_gone_on_from_is_not_overwritten(self):
        self.record()
        code, said = self.serve("--from", f"{self.file}@end", "--record", self.file, "--force")
        self.assertEqual(code, 1, said)
        self.assertIn("would overwrite the recording that --from reads", said)
        self.assertEqual(len(rows(self.file, "SELECT step FROM step")), 6)

    def test_a_branch_keeps_its_seed(self):
        self.record()
        code, said = self.serve("--from", f"{self.file}@end", "--seed", "5")
        self.assertEqual(code, 2, said)
        self.assertIn("leave --seed out", said)

    def test_a_file_that_another_daemon_records_is_not_overwritten(self):
        with Daemon(scenario(1), "--record", self.file) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.must("set_wheel_speeds 2 3")
            recorder = daemon.text("/recorder")
            until(lambda: self.file.exists() and recorder.must("get_recording").data[4] > 0)
            code, said = self.serve("empty", "--record", self.file, "--force")
            self.assertEqual(code, 1, said)
            self.assertIn("is being recorded by another program", said)
            motors.must("set_wheel_speeds 3 2")
        self.assertEqual(len(rows(self.file, "SELECT step FROM step")), 3)

    def test_an_export_does_not_replace_its_recording(self):
        self.record()
        for form in ("csv", "mat"):
            code, said = tool("export", self.file, "--to", form, "--out", self.file, "--force")
            self.assertEqual(code, 1, said)
            self.assertIn("is the recording itself", said)

    def test_a_recording_is_found_by_its_bare_name(self):
        self.record()
        code, said = tool("info", self.folder / "lesson")
        self.assertEqual(code, 0, said)
        self.assertIn("lesson.run", said)

    def test_two_runs_of_different_scenarios_are_told_apart(self):
        self.record()
        other = self.folder / "other.run"
        shutil.copy(self.file, other)
        change(other, "UPDATE text SET content = content || '\n# another' WHERE kind = 'scenario'")
        _, said = tool("verify", self.file, other)
        self.assertIn("their scenarios differ", said)


if __name__ == "__main__":
    unittest.main()
