# SPDX-License-Identifier: MIT
"""golden.py reports in one line that its hashes are damaged or do not match the shipped entries, before it starts a program."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

GOLDEN = pathlib.Path(__file__).with_name("golden.py")
HASHES = json.loads(GOLDEN.with_name("hashes.json").read_text())
ONE = "scenarios/empty.scenario"


class GoldenTest(unittest.TestCase):
    def refused(self, content, *options):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "hashes.json")
            if content is not None:
                file.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
            done = subprocess.run([sys.executable, GOLDEN, "no-program", "--hashes", file, *(options or ("--only", ONE))],
                                  capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done)
        return done.stderr

    def test_damaged_files(self):
        damaged = [None, b"", b'{"a":', b"\xff\xfe", [], None, {ONE: 5}, {ONE: None}, {ONE: "12"}, {ONE: "x" * 16}]
        for content in damaged:
            self.assertIn("hashes.json", self.refused(content))

    def test_hashes_of_what_ships_no_more_or_not_yet(self):
        self.assertIn("scenarios/gone.scenario", self.refused(HASHES | {"scenarios/gone.scenario": "0" * 16}))
        self.assertIn(ONE, self.refused({name: value for name, value in HASHES.items() if name != ONE}))

    def test_a_name_that_nothing_has(self):
        self.assertIn("no_such", self.refused(HASHES, "--only", f"{ONE},no_such"))
        self.assertIn("no_such", self.refused(HASHES, "--without", "no_such"))
        self.assertIn("nothing is left", self.refused(HASHES, "--only", ONE, "--without", "scenarios"))


if __name__ == "__main__":
    unittest.main()
