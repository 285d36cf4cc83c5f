# SPDX-License-Identifier: MIT
"""Teams carry bars and keep formations, with ten seeds each, and repeat bit for bit."""
import json
import math
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BINARY, Daemon
from recording import SANITIZED, tool, verify

SEEDS = range(1, 2 if SANITIZED else 11)
CRADLE_M = 0.3  # height on which a bar rests
TEAM = "[SIMULATION]\nmode lockstep\n[ROBOT_1]\ntype team2\nname a\nposition 0 0\n"
SPACING = {5: (1.0, 1.0), 3: (1.04, 0.6)}  # along, across


class TeamsTestCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_of(self, scenario, duration_s, *options, name="a.run"):
        """Runs a scenario in simulated time without sockets; returns the summary."""
        file = self.folder / "summary.json"
        done = subprocess.run([BINARY, "serve", scenario, "--mode", "free", "--speed", "0", "--no-net", "--no-render", "--duration",
                               str(duration_s), "--summary", str(file), "--record", str(self.folder / name), "--force", *options],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        return json.loads(file.read_text())

    def table(self):
        """The recording's moments as dictionaries of numbers."""
        tool("export", "a.run", "--to", "csv", "--force", cwd=self.folder)
        lines = [line for line in (self.folder / "a.csv").read_text().splitlines() if not line.startswith("#")]
        names = lines[0].split(",")
        cells = (dict(zip(names, line.split(","))) for line in lines[1:])
        return [row for row in cells if row[names[2]] != "" and any(row[n] for n in names if n.endswith(".x_m"))]


def number(row, name, what):
    return float(row[f"{name}.{what}"])


def errors(row, count):
    """The distance of each follower from its place in the leader's frame."""
    along, across = SPACING[count]
    x, y, heading = (number(row, "robot1", what) for what in ("x_m", "y_m", "heading_rad"))
    found = []
    for k in range(1, count):
        rank = (k + 1) // 2
        place = (-along * rank, across * rank if k % 2 == 1 else -across * rank)
        at = (x + math.cos(heading) * place[0] - math.sin(heading) * place[1],
              y + math.sin(heading) * place[0] + math.cos(heading) * place[1])
        found.append(math.dist(at, (number(row, f"robot{k + 1}", "x_m"), number(row, f"robot{k + 1}", "y_m"))))
    return found


class Transport(TeamsTestCase):
    def test_both_bars_arrive_in_the_far_corner_and_are_never_dropped_in_ten_seeds(self):
        for seed in SEEDS:
            with self.subTest(seed=seed):
                self.run_of("transport_loaded", 60, "--seed", str(seed), "--record-every", "0.1")
                table = self.table()
                for team in ("team1", "team2"):
                    heights = [number(row, f"{team}_bar", "z_m") for row in table]
                    self.assertGreater(len(heights), 500)
                    self.assertGreater(min(heights), CRADLE_M + 0.02, team)
                    start, end = ([number(row, f"{team}_bar", axis) for axis in ("x_m", "y_m")] for row in (table[0], table[-1]))
                    self.assertLess(max(start), -2, team)
                    self.assertGreater(min(end), 2, team)

    def together(self, commands):
        """Sends each motors module its line, then reads the replies."""
        for motors, line in commands:
            motors.send(line)
        for motors, _ in commands:
            self.assertEqual(motors.receive().error, 0)

    def test_a_bar_that_is_pulled_by_6_cm_moves_both_supports_by_3(self):
        with Daemon(TEAM, "--no-render") as daemon:
            leader, helper = (daemon.text(f"/a_{name}/motors") for name in ("leader", "helper"))
            for line, steps in (("set_velocity 0.1 0", 60), ("stop", 200)):
                self.together([(leader, line), (helper, "stop")])
                self.together([(leader, f"ready {steps - 1}"), (helper, f"ready {steps - 1}")])
            driven = (daemon.text("/a_leader/pose").must("get_pose").data[0]
                      - daemon.text("/a_helper/pose").must("get_pose").data[0] - 1.2)
            self.assertAlmostEqual(driven, 0.06, delta=0.01)
            for name, side in (("leader", -1), ("helper", 1)):
                x, y, angle = daemon.text(f"/a_{name}/support").must("get_support").data[:3]
                self.assertAlmostEqual(x, side * driven / 2, delta=0.004)
                self.assertAlmostEqual(y, 0, delta=0.004)
                self.assertAlmostEqual(angle, 0, delta=0.03)

    def test_a_leader_that_drives_on_alone_drops_the_bar(self):
        with Daemon(TEAM, "--no-render", "--record", str(self.folder / "a.run")) as daemon:
            leader, helper = (daemon.text(f"/a_{name}/motors") for name in ("leader", "helper"))
            self.together([(leader, "set_velocity 0.5 0"), (helper, "stop")])
            self.together([(leader, "ready 60"), (helper, "ready 60")])
            x, y, angle = daemon.text("/a_helper/support").must("get_support").data[:3]
            self.assertGreater(x, 0.03)  # the bar has pulled it
            self.assertLess(x, 0.065)  # to its stop
            self.assertAlmostEqual(y, 0, delta=0.01)
            self.assertAlmostEqual(angle, 0, delta=0.05)
            self.together([(leader, "ready 400"), (helper, "ready 400")])
        heights = [number(row, "a_bar", "z_m") for row in self.table()]
        self.assertGreater(min(heights[:50]), CRADLE_M + 0.02)
        self.assertLess(heights[-1], CRADLE_M - 0.05)


class Formations(TeamsTestCase):
    def holds(self, scenario, count, duration_s):
        for seed in SEEDS:
            with self.subTest(seed=seed):
                self.run_of(scenario, duration_s, "--seed", str(seed), "--record-every", "0.1")
                table = self.table()
                # Up to there nobody is nearer than 1.2 m to an obstacle.
                open_floor = [row for row in table if number(row, "robot1", "x_m") < -1.6]
                self.assertGreater(len(open_floor), 30)
                self.assertLess(max(max(errors(row, count)) for row in open_floor), 0.1)
                end = [number(table[-1], "robot1", axis) for axis in ("x_m", "y_m")]
                self.assertLess(math.dist(end, (6, 0)), 0.5)
                self.assertLess(max(errors(table[-1], count)), 0.1)

    def test_five_robots_keep_an_inverted_v_and_reach_the_target_in_ten_seeds(self):
        self.holds("formation_loaded", 5, 90)

    def test_three_robots_keep_a_triangle_and_reach_the_target_in_ten_seeds(self):
        self.holds("triangle_loaded", 3, 60)


class Repeatable(TeamsTestCase):
    def test_any_number_of_threads_gives_the_same_hash(self):
        hashes = {self.run_of("transport_loaded", 8, "--threads", str(threads))["hash"] for threads in (1, 2, 4)}
        self.assertEqual(len(hashes), 1)

    def test_a_recorded_run_is_verified(self):
        self.run_of("transport_loaded", 8)
        self.assertIn("equal", verify(self.folder / "a.run"))

    def test_a_branch_goes_on_as_the_run_did(self):
        whole = self.run_of("transport_loaded", 8)["hash"]
        file = self.folder / "summary.json"
        subprocess.run([BINARY, "serve", "--from", f"{self.folder / 'a.run'}@5", "--mode", "free", "--speed", "0", "--no-net",
                        "--no-render", "--duration", "8", "--summary", str(file)], check=True, timeout=120,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.assertEqual(json.loads(file.read_text())["hash"], whole)

    def drive(self, daemon, motors, order):
        """Drives forty steps in lockstep in which the four robots' commands arrive in this order; returns the hash."""
        for step in range(40):
            for name in order:
                motors[name].send(f"set_velocity 0.2 {0.1 * (step % 3)}")
            for name in order:
                self.assertEqual(motors[name].receive().error, 0)
        return daemon.status()["hash"]

    def test_the_order_of_commands_does_not_matter_and_a_reset_starts_again(self):
        names = ["team1_leader", "team1_helper", "team2_leader", "team2_helper"]
        with Daemon(name="transport") as daemon:
            motors = {name: daemon.text(f"/{name}/motors") for name in names}
            first = self.drive(daemon, motors, names)
            daemon.text("/simulation").must("reset")
            self.assertEqual(self.drive(daemon, motors, names[::-1]), first)


if __name__ == "__main__":
    unittest.main()
