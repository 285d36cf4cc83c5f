# SPDX-License-Identifier: MIT
"""The lines that `coopdyn check` prints for a model drive it: Python, MATLAB (in Octave) and YARP."""
from __future__ import annotations

import json
import os
import pathlib
import re
import select
import socket
import subprocess
import sys
import tempfile
import unittest
from typing import Any, Dict

import harness

BINARY = os.path.abspath(os.environ["COOPDYN_BINARY"])
INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>'
BOX = '<collision><geometry><box size="0.4 0.4 0.1"/></geometry></collision>'
FOREIGN = f"""<robot name="door">
  <link name="base">{INERTIAL}{BOX}</link>
  <link name="lid">{INERTIAL}</link>
  <joint name="the hinge" type="revolute"><parent link="base"/><child link="lid"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="0.1" effort="30" velocity="1.5"/></joint>
</robot>
"""


def check(model: str) -> Dict[str, Any]:
    done = subprocess.run([BINARY, "check", "--json", model], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
    report = json.loads(done.stdout)
    assert report["verdict"] == "runs" and done.returncode == 0, (report, done.stderr)
    return report


class Served:
    """A daemon started by the line for `serve`, on free ports."""

    def __init__(self, line: str) -> None:
        assert line.startswith("coopdyn serve ") and line.endswith("\n"), line
        self.process = subprocess.Popen(["sh", "-c", f'exec "$0" {line[len("coopdyn "):-1]} --port 0', BINARY], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        assert self.process.stdout is not None
        readable, _, _ = select.select([self.process.stdout], [], [], harness.LIMIT_S)
        ready = ""
        while readable and not ready.startswith("ready "):
            ready = self.process.stdout.readline() or "ready "
        self.server = ready.split("names=")[1].split()[0]

    def __enter__(self) -> "Served":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        self.process.wait(harness.LIMIT_S)
        assert self.process.stdout is not None
        self.process.stdout.close()


class LinesTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.foreign = os.path.join(folder.name, "my door.urdf")
        pathlib.Path(self.foreign).write_text(FOREIGN, encoding="utf-8")
        robots = harness.ROOT / "robots"
        self.models = [self.foreign, str(robots / "lwa" / "model.sdf"), str(robots / "turtle" / "model.sdf")]

    def run_program(self, command: list, server: str) -> str:
        env = dict(os.environ, COOPDYN_SERVER=server, PYTHONPATH=str(harness.ROOT / "clients" / "python"), PYTHONDONTWRITEBYTECODE="1")
        env.pop("DISPLAY", None)
        done = subprocess.run(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def assert_has_moved(self, said: str) -> None:
        """Expects the first number of the output, a joint's position or the robot's x, to be nonzero."""
        number = re.search(r"-?\d+\.\d+(e-?\d+)?", said)
        assert number is not None, said
        self.assertGreater(abs(float(number.group())), 0.005, said)

    def test_the_lines_for_python_move_it(self) -> None:
        for model in self.models:
            drive = check(model)["drive"]
            with self.subTest(model), Served(drive["serve"]) as served:
                self.assert_has_moved(self.run_program([sys.executable, "-c", drive["python"]], served.server))

    def test_the_lines_for_matlab_move_it(self) -> None:
        for model in self.models:
            drive = check(model)["drive"]
            with self.subTest(model), Served(drive["serve"]) as served:
                code = f"addpath('{harness.ROOT}/clients/matlab');\n" + drive["matlab"]
                self.assert_has_moved(self.run_program(["octave", "--no-gui", "--norc", "--quiet", "--eval", code], served.server))

    def test_the_line_for_yarp_is_answered_with_ok(self) -> None:
        for model in self.models:
            drive = check(model)["drive"]
            with self.subTest(model), Served(drive["serve"]) as served:
                words = re.fullmatch(r"yarp conf 127\.0\.0\.1 10000\necho '(.+)' \| yarp rpc (\S+)\n", drive["yarp"])
                assert words is not None, drive["yarp"]
                host, port = served.server.rsplit(":", 1)
                with socket.create_connection((host, int(port)), timeout=harness.LIMIT_S) as names, names.makefile("rw") as stream:
                    stream.write(f"NAME_SERVER query {words.group(2)}\n")
                    stream.flush()
                    registered = stream.readline().split()
                self.assertEqual(registered[0], "registration", registered)
                with socket.create_connection((registered[4], int(registered[6])), timeout=harness.LIMIT_S) as rpc, \
                        rpc.makefile("rw") as stream:
                    stream.write(f"CONNECT me\nd\n{words.group(1)}\n")
                    stream.flush()
                    self.assertIn("Welcome", stream.readline())
                    self.assertIn("[ok]", stream.readline())


if __name__ == "__main__":
    unittest.main()
