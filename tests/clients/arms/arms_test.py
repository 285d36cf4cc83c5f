# SPDX-License-Identifier: MIT
"""Python, Octave and C++ drive an arm by the same program. CLIENT_SQUARE and ARM_PROGRAM name the programs in C++."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python"))
import harness  # noqa: E402

ARM = "[SIMULATION]\nmode {mode}\n[FLOOR]\nsize 6 6 0.1\n[ROBOT_1]\ntype {arm}\nname arm1\nposition 0 0\n"
CLIENTS = harness.ROOT / "clients"
LIMIT_S = 600
LOCKSTEP_MM = 1.0


def octave(folder, code):
    return ["octave", "--no-gui", "--norc", "--eval", f"addpath('{CLIENTS / 'matlab'}'); addpath('{folder}'); {code}"]


def run(command, mode, arm="lwa"):
    """The output of a program that drives an arm of a private daemon."""
    with harness.Daemon(ARM.format(mode=mode, arm=arm), "--no-http", "--no-render") as daemon:
        env = dict(os.environ, COOPDYN_SERVER=daemon.server, PYTHONPATH=str(CLIENTS / "python"))
        env.pop("DISPLAY", None)
        done = subprocess.run(list(map(str, command)), env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=LIMIT_S)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.stdout}{done.stderr}")
    return done.stdout


class Square:
    def drawn(self, mode, arm="lwa"):
        """The simulated time of the drawing [s], and its greatest error [mm]."""
        out = run(self.command(), mode, arm)
        return map(float, re.search(r"a square of 0.2 m in ([\d.]+) s, at most ([\d.]+) mm off", out).groups())

    def assert_square(self, arm="lwa"):
        time_s, off_mm = self.drawn("lockstep", arm)
        self.assertAlmostEqual(time_s, 8, delta=0.1)
        self.assertLess(off_mm, LOCKSTEP_MM)

    def test_the_shipped_example_draws_its_square_within_a_millimetre_in_lockstep(self):
        self.assert_square()

    def test_and_ends_it_in_real_time(self):
        time_s, _ = self.drawn("realtime")  # a program that the machine keeps waiting cuts corners
        self.assertGreaterEqual(time_s, 7.9)


class Python(Square, unittest.TestCase):
    def command(self):
        return [sys.executable, CLIENTS / "python" / "square.py", "arm1"]


    def test_every_arm_that_comes_with_the_program_draws_it(self):
        for arm in ("irb120", "mh5", "mobile_arm"):
            with self.subTest(arm):
                self.assert_square(arm)


class Octave(Square, unittest.TestCase):
    def command(self):
        return octave(HERE, "square('arm1');")


class Cpp(Square, unittest.TestCase):
    def command(self):
        return [os.environ["CLIENT_SQUARE"], "arm1"]


class SameProgram(unittest.TestCase):
    def test_every_kind_of_command_does_the_same_in_the_three_languages(self):
        python = run([sys.executable, HERE / "arm_program.py"], "lockstep").splitlines()
        self.assertRegex(python[-1], r"^hash [0-9a-f]{16} \d+$")
        self.assertEqual(python, run([os.environ["ARM_PROGRAM"]], "lockstep").splitlines())
        self.assertEqual(python, run(octave(HERE, "arm_program"), "lockstep").splitlines())

    def test_and_in_real_time_it_ends_where_it_does_in_lockstep(self):
        lockstep = self.readings(run([sys.executable, HERE / "arm_program.py"], "lockstep"))
        for command in ([sys.executable, HERE / "arm_program.py"], [os.environ["ARM_PROGRAM"]], octave(HERE, "arm_program")):
            now = self.readings(run(command, "realtime"))
            self.assertEqual(now["modes"], lockstep["modes"])
            self.assertEqual(now["compliance"], lockstep["compliance"])
            for what in ("target", "direct", "tool"):
                for here, there in zip(now[what], lockstep[what]):
                    self.assertAlmostEqual(float(here), float(there), delta=0.02, msg=what)

    @staticmethod
    def readings(out):
        return {line.split()[0]: line.split()[1:] for line in out.splitlines()}


if __name__ == "__main__":
    unittest.main()
