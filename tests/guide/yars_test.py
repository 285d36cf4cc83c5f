# SPDX-License-Identifier: MIT
"""The experiments shown in docs/yars.md are valid, and the one in grammar 0.8 moves as the page says."""
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from guide_test import BINARY, BLOCK, ROOT, Reader

EXPERIMENTS = [body for kind, body in BLOCK.findall((ROOT / "docs" / "yars.md").read_text()) if kind == "xml"]


class YarsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_the_examples_are_checked_without_a_word(self):
        self.assertEqual([re.search(r"<(robots|movables)>", text).group(1) for text in EXPERIMENTS], ["robots", "movables"])
        for text in EXPERIMENTS:
            file = self.folder / "example.xml"
            file.write_text(text)
            done = subprocess.run([BINARY, "check", file], capture_output=True, text=True, timeout=100)
            self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
            self.assertNotIn("warning", done.stdout)

    def test_the_muscle_of_the_example_lifts_the_arm(self):
        (self.folder / "arm.xml").write_text(EXPERIMENTS[0])
        reader = Reader(self.folder)
        self.addCleanup(reader.close)
        reader.serve("coopdyn serve arm.xml --mode lockstep --channel-port 0")
        angles = [float(reader.run(["coopdyn", "call", "/arm/channel", "set_motors", "(100)", pull]).split()[-3])
                  for pull in ("0", "1")]
        self.assertGreater(angles[0], 0.9)  # it has fallen on its stop
        self.assertLess(angles[1], 0.5)


if __name__ == "__main__":
    unittest.main()
