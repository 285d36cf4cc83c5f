# SPDX-License-Identifier: MIT
"""The examples of docs/controllers.md compile and run."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BINARY = Path(os.environ["COOPDYN_BINARY"])
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)


def blocks(language):
    text = (ROOT / "docs" / "controllers.md").read_text()
    return [body for kind, body in BLOCK.findall(text) if kind == language]


class ControllersDocsTestCase(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_shell(self, script, **kwargs):
        env = {**os.environ, "PATH": f"{BINARY.parent}:{os.environ['PATH']}"}
        done = subprocess.run(["bash", "-ec", script], cwd=self.folder, env=env, text=True, capture_output=True, **kwargs)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def drive(self, controller):
        """Runs a robot with the controller for half a second of simulated time."""
        (self.folder / "try.scenario").write_text(
            f"[FLOOR]\nsize 20 20 0.1\n[SWARM_1]\ntype minibot\ncount 4\n{controller}\n")
        output = self.run_shell("coopdyn serve try.scenario --mode free --duration 0.5 --no-net --summary out.json")
        self.assertNotRegex(output, r"crash|cannot|stopped|error")

    def test_the_first_controller_in_ten_minutes(self):
        output = self.run_shell(blocks("sh")[0])
        self.assertTrue((self.folder / "wander" / "wander.so").exists(), output)
        self.assertNotRegex(output, r"warning|crash|cannot|error")

    def test_the_whole_controller_in_cpp(self):
        (self.folder / "clients").symlink_to(ROOT / "clients")
        (self.folder / "circle.cc").write_text(blocks("cpp")[0])
        self.run_shell(blocks("sh")[1].replace("g++ ", "g++ -Wall -Wextra -Werror "))
        self.drive("controller circle radius=0.3")

    def test_the_controller_of_channels(self):
        (self.folder / "clients").symlink_to(ROOT / "clients")
        (self.folder / "circle.cc").write_text(blocks("cpp")[1])
        self.run_shell(blocks("sh")[1].replace("g++ ", "g++ -Wall -Wextra -Werror "))
        self.drive("controller circle")

    def test_the_swarm_of_a_sample(self):
        line = re.search(r"^controller .*$", blocks("")[0], re.M).group()
        self.drive(line)

    def test_the_supervisor_of_a_scenario(self):
        self.assertIn(blocks("")[1], (ROOT / "scenarios" / "race.scenario").read_text())

    def test_the_supervisor_in_cpp(self):
        (self.folder / "clients").symlink_to(ROOT / "clients")
        (self.folder / "kickoff.cc").write_text(blocks("cpp")[2])
        self.run_shell(blocks("sh")[1].replace("g++ ", "g++ -Wall -Wextra -Werror ").replace("circle", "kickoff"))
        (self.folder / "try.scenario").write_text(
            "[SIMULATION]\nsupervisor kickoff field=0.5\n[FLOOR]\nsize 9 9\n"
            "[BALL_1]\ntype sphere\nsize 0.2\nmass 1\nposition 0.6 0 0.1\n")
        self.run_shell("coopdyn serve try.scenario --mode free --duration 0.5 --no-net --summary out.json")
        told = json.loads((self.folder / "out.json").read_text())
        self.assertEqual((told["ended"], told["steps"]), ("supervisor", 3))
        self.assertEqual({one["name"]: one["value"] for one in told["logged"]}["outs"], 3)

    def test_no_other_blocks(self):
        self.assertEqual([len(blocks(kind)) for kind in ("", "sh", "cpp")], [2, 3, 3])


if __name__ == "__main__":
    unittest.main()
