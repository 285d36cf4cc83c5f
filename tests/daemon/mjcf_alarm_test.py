# SPDX-License-Identifier: MIT
"""The program that reads MuJoCo files exits after two minutes, even if its file never arrives and nobody ends it."""
import os
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BINARY

PROGRAM = Path(BINARY).resolve().with_name("coopdyn-mjcf")


@unittest.skipUnless(PROGRAM.exists(), "libmujoco-dev was not there when coopdyn was built")
class AlarmTest(unittest.TestCase):
    def test_it_waits_for_nothing_longer_than_two_minutes(self):
        with tempfile.TemporaryDirectory() as folder:
            pipe = Path(folder) / "pipe.xml"
            os.mkfifo(pipe)
            with subprocess.Popen([str(PROGRAM), str(pipe), f"{folder}/meshes", "m/"]) as reader, open(pipe, "wb"):
                self.assertEqual(reader.wait(timeout=600), -signal.SIGALRM)


if __name__ == "__main__":
    unittest.main()
