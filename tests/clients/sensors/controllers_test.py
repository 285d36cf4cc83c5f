# SPDX-License-Identifier: MIT
"""The clients' sample programs with sensors: they follow a ball by a camera and a wall by a lidar, and balance by an IMU. Tests in
lockstep check their performance. In real time a busy machine may delay a program, so that the robot falls, or loses the wall or the
ball: there the program must only move the robot and reach its end. CLIENT_BALL, CLIENT_WALL and CLIENT_PENDULUM name those in C++."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python"))
import harness  # noqa: E402
import coopdyn  # noqa: E402

CLIENTS = harness.ROOT / "clients"
LIMIT_S = 600
MOVED = ("--set", "SCORE_1.kind=distance")


def drive(language, program, mode, *arguments, codes=(0,)):
    """The program's output, and the final status of the world."""
    if language == "python":
        command = [sys.executable, str(CLIENTS / "python" / f"{program}.py"), *arguments]
    elif language == "cpp":
        command = [os.environ[f"CLIENT_{program.upper()}"], *arguments]
    else:
        quoted = ", ".join([f"'{arguments[0]}'", *arguments[1:]]) if arguments else ""
        command = ["octave", "--no-gui", "--norc", "--eval", f"addpath('{CLIENTS / 'matlab'}'); {program}({quoted});"]
    options = MOVED if program == "ball" else (*MOVED, "--no-render")
    with harness.Daemon(program, "--no-http", "--mode", mode, *options) as daemon:
        env = dict(os.environ, COOPDYN_SERVER=daemon.server, PYTHONPATH=str(CLIENTS / "python"))
        env.pop("DISPLAY", None)
        done = subprocess.run(command, env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=LIMIT_S)
        if done.returncode not in codes:
            raise AssertionError(f"{command}: {done.stdout}{done.stderr}")
        with coopdyn.connect(daemon.server, watch=True) as sim:
            return done.stdout, sim.status()


class Controllers:
    language = ""

    @staticmethod
    def figures_of(out):
        return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", out.split(" ", 1)[1])]

    def figures(self, program, mode, *arguments):
        out, _ = drive(self.language, program, mode, *arguments)
        return self.figures_of(out), out

    def check_in_real_time(self, program, count, least_s, *arguments):
        """The program prints `count` figures, after at least `least_s` of simulated time in which it has moved its robot."""
        out, status = drive(self.language, program, "realtime", *arguments, codes=(0, 1))  # 1: it fell, or saw no ball
        self.assertEqual(len(self.figures_of(out)), count, out)
        self.assertEqual((status["mode"], status["scores"][0]["value"] > 0), ("realtime", True), out)
        self.assertGreaterEqual(status["time_s"], least_s)

    def test_the_pendulum_gets_up_and_goes_a_metre_in_lockstep(self):
        (way, most), out = self.figures("pendulum", "lockstep")
        self.assertAlmostEqual(way, 1, delta=0.01, msg=out)
        self.assertLess(most, 6, out)

    def test_and_the_same_program_runs_in_real_time(self):
        self.check_in_real_time("pendulum", 2, 14)

    def test_the_wall_follower_keeps_its_distance_in_lockstep(self):
        (within, wanted, share, least), out = self.figures("wall", "lockstep", "robot1", "60")
        self.assertEqual((within, wanted), (0.1, 0.5))
        self.assertGreaterEqual(share, 80, out)
        self.assertGreater(least, 0.2, out)

    def test_and_follows_in_real_time(self):
        self.check_in_real_time("wall", 4, 5, "robot1", "5")

    def test_the_camera_keeps_the_ball_in_sight_in_lockstep(self):
        (share, pictures, distance, bearing), out = self.figures("ball", "lockstep", "robot1", "15")
        self.assertEqual(pictures, 1500)
        self.assertGreaterEqual(share, 80, out)
        self.assertAlmostEqual(distance, 1.05, delta=0.1, msg=out)  # the ball drives on: it trails by speed / APPROACH
        self.assertAlmostEqual(bearing, 0, delta=10, msg=out)

    def test_and_looks_for_the_ball_in_real_time(self):
        self.check_in_real_time("ball", 4, 5, "robot1", "5")


class Python(Controllers, unittest.TestCase):
    language = "python"


class Octave(Controllers, unittest.TestCase):
    language = "octave"


class Cpp(Controllers, unittest.TestCase):
    language = "cpp"


class SameController(unittest.TestCase):
    def run_of(self, *arguments):
        out, status = drive(*arguments)
        return out, status["hash"]

    def test_the_three_languages_drive_alike_to_the_last_bit(self):
        for program, arguments in (("pendulum", ()), ("wall", ("robot1", "10")), ("ball", ("robot1", "5"))):
            with self.subTest(program):
                python = self.run_of("python", program, "lockstep", *arguments)
                self.assertRegex(python[1], r"^[0-9a-f]{16}$")
                for language in ("octave", "cpp"):
                    self.assertEqual(self.run_of(language, program, "lockstep", *arguments), python, language)


if __name__ == "__main__":
    unittest.main()
