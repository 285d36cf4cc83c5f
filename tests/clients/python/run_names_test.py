# SPDX-License-Identifier: MIT
"""A recording may be called anything that a file can be called."""
import os
import pathlib
import tempfile
import unittest

from cases import DaemonTestCase, FakeTestCase

NAME = "my lesson ü"


class NamesOfRuns(FakeTestCase):
    def setUp(self):
        self.daemon = self.start()
        self.sim = self.connect(self.daemon)

    def test_a_name_with_blanks_goes_there_and_comes_back(self):
        self.assertEqual(self.sim.record(NAME), NAME + ".run")
        self.assertEqual(self.sim.stop_recording(),
                         (NAME + ".run", f"http://127.0.0.1:{self.daemon.port}/runs/my%20lesson%20%C3%BC.run"))

    def test_without_a_page_there_is_the_name_alone(self):
        self.daemon.page = False
        self.sim.record(NAME)
        self.assertEqual(self.sim.stop_recording(), (NAME + ".run", ""))

    def test_a_recording_of_such_a_name_is_fetched(self):
        with tempfile.TemporaryDirectory() as folder:
            for given, kind in ((NAME, ".run"), (NAME + ".run", ".run"), (NAME, ".mat")):
                file = self.sim.fetch_run(given, os.path.join(folder, "copy" + kind))
                self.assertEqual(pathlib.Path(file).read_text(encoding="utf-8"), f"/runs/{NAME}{kind}")

    def test_what_is_no_name_is_refused(self):
        for wrong in ("", "  ", 7, None):
            self.assert_error(3, lambda: self.sim.fetch_run(wrong), "the name of a recording is a text")
        self.assert_error(3, lambda: self.sim.record(7), "the name of a recording is a text, not 7")


class NamesOfRunsOfTheDaemon(DaemonTestCase):
    def test_a_recording_that_the_command_line_named_is_ended(self):
        with tempfile.TemporaryDirectory() as folder:
            sim = self.connect(self.start("classroom", "--record", os.path.join(folder, NAME + ".run")))
            self.assertEqual(sim.stop_recording(), (NAME + ".run", ""))


if __name__ == "__main__":
    unittest.main()
