"""The shipped robots with joints: they stand, hold and move as their READMEs say."""
import math
import random
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients" / "python"))
import coopdyn  # noqa: E402

ARMS = {"lwa": (7, 5.0), "irb120": (6, 3.0), "mh5": (6, 5.0)}  # joints, payload in kg
STEADY = [*ARMS, "mobile_arm", "quadruped", "car"]


def robots(*entries, more=""):
    """A scenario: (type, lines) for each robot, 3 m apart along y; they are called r1, r2, ..."""
    text = "[FLOOR]\nsize 60 60\n" + more
    for number, (kind, lines) in enumerate(entries, 1):
        text += f"[ROBOT_{number}]\ntype {kind}\nname r{number}\n"
        if "position" not in lines:
            text += f"position 0 {3 * (number - 1)}\n"
        text += lines + "\n"
    return text


def lean(pose):
    """The angle of a robot's z axis from the vertical."""
    w, x, y, z = pose[3:]
    return math.acos(max(-1, min(1, 1 - 2 * (x * x + y * y))))


class RobotsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.runs = 0

    def serve(self, text, seconds, *options):
        """Runs a scenario to its end without sockets; returns the recording's file."""
        self.runs += 1
        scenario = self.folder / "robots.scenario"
        scenario.write_text(text)
        file = self.folder / f"{self.runs}.run"
        done = subprocess.run([BINARY, "serve", scenario, "--mode", "free", "--duration", str(seconds), "--no-net", "--record", file,
                               "--scenarios", self.folder, *options], capture_output=True, text=True, timeout=4 * LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("nothing frozen", done.stderr)
        return file

    def run_to_the_end(self, text, seconds, *options):
        return coopdyn.read_run(self.serve(text, seconds, *options))

    def loaded(self, arm, payload_kg):
        """Another type: the arm with a ball of that mass in its tool."""
        kind = f"{arm}_loaded"
        text = (ROOT / "robots" / arm / "model.sdf").read_text()
        moment = 0.4 * payload_kg * 0.05**2
        at = re.search(r'<link name="tool">\s*<pose>(\S+ \S+ \S+) ', text).group(1)
        ball = (f'<link name="load"><pose>{at} 0 0 0</pose><inertial><mass>{payload_kg}</mass><inertia><ixx>{moment}</ixx><iyy>{moment}</iyy>'
                f'<izz>{moment}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>'
                '<joint name="grip" type="fixed"><parent>tool</parent><child>load</child></joint>')
        folder = self.folder / "robots" / kind
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.sdf").write_text(text.replace("</model>", ball + "</model>").replace(f'name="{arm}"', f'name="{kind}"'))
        return kind

    def test_each_stands_for_ten_seconds(self):
        for kind in STEADY:
            with self.subTest(robot=kind):
                run = self.run_to_the_end(robots((kind, "")), 10)
                first, last = run.pose_3d("r1")[0], run.pose_3d("r1")[-1]
                self.assertLess(math.dist(first[:3], last[:3]), 2e-3, "it drifts by 2 mm at most")
                self.assertLess(lean(last), math.radians(0.5))
                joints = run.joints("r1")
                row = run.reading("r1", "channels")[-1]
                for joint, position in zip(joints, row):
                    self.assertLess(abs(position), math.radians(0.2), joint)

    def hold(self, arm, kind, most_rad):
        """Twenty random postures; 2 m above the floor, so that only gravity is in the way."""
        count = ARMS[arm][0]
        chance = random.Random(7)
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots((kind, "position 0 0 2")), "--scenarios", str(self.folder)) as daemon:
            module = daemon.text("/r1/arm")
            limits = module.must("get_limits").data[:4 * count]
            for _ in range(20):
                wanted = [chance.uniform(0.8 * limits[4 * i], 0.8 * limits[4 * i + 1]) for i in range(count)]
                module.must("set_positions " + " ".join(map(repr, wanted)))
                for _ in range(40):
                    module.must("ready 50")
                    if all(module.must("get_motion").params):
                        break
                module.must("ready 50")
                there = module.must("get_joints").data[0:3 * count:3]
                self.assertLess(max(abs(a - b) for a, b in zip(wanted, there)), most_rad, (wanted, there))

    def test_each_arm_holds_twenty_postures(self):
        for arm in ARMS:
            with self.subTest(robot=arm):
                self.hold(arm, arm, math.radians(0.1))

    def test_each_arm_holds_twenty_postures_with_its_payload(self):
        for arm, (_, payload_kg) in ARMS.items():
            with self.subTest(robot=arm):
                self.hold(arm, self.loaded(arm, payload_kg), math.radians(0.5))

    def test_two_copies_of_an_arm_answer_on_their_own_names(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("irb120", ""), ("irb120", ""))) as daemon:
            one, other = daemon.text("/r1/arm"), daemon.text("/r2/arm")
            one.send("set_positions_direct (1) 0.01")
            other.send("set_positions_direct (1) -0.02")
            one.receive()
            other.receive()
            self.assertAlmostEqual(one.must("get_joints (1)").data[0], 0.01, delta=1e-3)
            self.assertAlmostEqual(other.must("get_joints (1)").data[0], -0.02, delta=1e-3)

    def test_axis_six_of_the_irb120_turns_400_degrees_both_ways(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("irb120", ""))) as daemon:
            arm = daemon.text("/r1/arm")
            for degrees in (400, -400):
                arm.must(f"set_positions (6) {math.radians(degrees)}")
                for _ in range(40):
                    arm.must("ready 50")
                    if all(arm.must("get_motion (6)").params):
                        break
                self.assertAlmostEqual(math.degrees(arm.must("get_joints (6)").data[0]), degrees, delta=0.1)

    def test_a_mobile_arm_has_two_modules_that_two_programs_may_hold(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("mobile_arm", ""))) as daemon:
            motors, arm = daemon.text("/r1/motors"), daemon.text("/r1/arm")
            for _ in range(100):
                motors.send("set_velocity 0.2 0")
                arm.send("set_velocities (1) 0.5")
                self.assertEqual((motors.receive().error, arm.receive().error), (0, 0))
            self.assertGreater(daemon.text("/r1/pose").must("get_pose").data[0], 0.15)
            self.assertAlmostEqual(arm.must("get_joints (1)").data[0], 0.5, delta=0.02)

    def test_a_reset_begins_the_same_run_again(self):
        text = "[SIMULATION]\nmode lockstep\n" + robots(("irb120", ""), ("quadruped", ""))
        with Daemon(text) as daemon:
            arm, legs, simulation = daemon.text("/r1/arm"), daemon.text("/r2/legs"), daemon.text("/simulation")
            hashes = []
            for _ in range(2):
                arm.send("set_positions (2 3) 0.5 -0.5")
                legs.send("set_positions (2 3) 0.2 -0.2")
                arm.receive()
                legs.receive()
                arm.send("ready 50")
                legs.send("ready 50")
                arm.receive()
                legs.receive()
                hashes.append(daemon.status()["hash"])
                simulation.must("reset")
            self.assertEqual(hashes[0], hashes[1])


if __name__ == "__main__":
    unittest.main()
