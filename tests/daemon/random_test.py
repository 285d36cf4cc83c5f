"""[RANDOM] of scenarios: each seed has its own world, also at a reset, in recordings and in the output of check."""
import re
import sys
import unittest
from pathlib import Path

from harness import Daemon
from recording import RecordingTestCase, equal_steps, tool

sys.path.insert(0, str(Path(__file__).parents[2] / "clients" / "python"))
import coopdyn  # noqa: E402

ROOM = """[SIMULATION]
mode free
[FLOOR]
size 8 8
[WALL_1]
type box
size 3 0.2 0.5
position 0 0
[BOX_1]
type box
size 0.3 0.3 0.3
position 1 1
mass 1
[BOX_2]
type box
size 0.3 0.3 0.3
position 2 1
mass 1
[ROBOT_1]
type coopbot
position -2 0
[ROBOT_2]
type coopbot
position -3 0
[SWARM_1]
type minibot
count 5
controller diffuse speed=0.1
fidelity rolling
[RANDOM]
ROBOT_1.position     uniform -2 2  uniform -2 2
ROBOT_1.orientation  uniform -180deg 180deg
ROBOT_2.position     uniform -2 2  uniform -2 2
BOX_1.position       uniform -2 2  uniform -2 2
BOX_1.size           normal 0.3 0.05  0.2  uniform 0.1 0.3
BOX_1.color          choice red green blue
BOX_1.mass           uniform 0.5 2
BOX_2.position       uniform -2 2  uniform -2 2
BOX_2.friction       uniform 0.2 1
SWARM_1.controller   diffuse speed=uniform 0.1 0.2
"""


class RandomTestCase(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.scenario = self.folder / "room.scenario"
        self.scenario.write_text(ROOM)

    def daemon(self, *options):
        return Daemon(None, "--no-render", "--paused", *options, name=str(self.scenario))


class SeedsTest(RandomTestCase):
    def test_check_warns_of_a_seed_that_draws_what_cannot_be(self):
        self.scenario.write_text(ROOM + "BOX_2.mass choice 1 -1\n")
        seeds = {tool("check", self.scenario, "--set", f"SIMULATION.seed={seed}")[0] for seed in range(1, 9)}
        self.assertEqual(seeds, {0, 1})
        good = next(seed for seed in range(1, 9) if tool("check", self.scenario, "--set", f"SIMULATION.seed={seed}")[0] == 0)
        self.assertRegex(tool("check", self.scenario, "--set", f"SIMULATION.seed={good}")[1],
                         r"warning: with seed \d+: 'mass' must be at least 0, not -1")


class ResetTest(RandomTestCase):
    def test_each_seed_has_a_world_and_always_the_same(self):
        with self.daemon() as daemon, coopdyn.connect(daemon.names[1]) as sim:
            simulation = daemon.text("/simulation")
            begun = sim.hash()
            hashes = {1: begun}
            for seed in (2, 3, 4, 2, 1, 3):
                simulation.must(f"reset {seed}")
                self.assertEqual(hashes.setdefault(seed, sim.hash()), sim.hash())
            self.assertEqual(len(set(hashes.values())), 4)
            simulation.must("step 20")
            self.assertNotEqual(sim.hash(), hashes[3])
            simulation.must("reset")
            self.assertEqual(sim.hash(), hashes[3])
            simulation.must("reset 3")
            self.assertEqual(sim.hash(), hashes[3])

    def test_it_is_the_world_that_a_start_with_this_seed_has(self):
        def after(daemon, *commands):
            with daemon, coopdyn.connect(daemon.names[1]) as sim:
                for command in commands:
                    daemon.text("/simulation").must(command)
                return sim.hash()

        started = after(self.daemon("--seed", "7"), "step 30")
        self.assertEqual(after(self.daemon(), "reset 7", "step 30"), started)
        self.assertEqual(after(self.daemon("--seed", "5"), "step 3", "reset 7", "step 30"), started)

    def test_clients_of_robots_stay(self):
        with self.daemon() as daemon:
            motors = daemon.text("/robot1/motors")
            motors.must("set_velocity 0.1 0")
            for seed in (2, 3):
                daemon.text("/simulation").must(f"reset {seed}")
                motors.must("set_velocity 0.1 0")

    def test_nothing_stands_in_anything_for_fifty_seeds(self):
        with self.daemon() as daemon, coopdyn.connect(daemon.names[1]) as sim:
            simulation = daemon.text("/simulation")
            hashes = set()
            for seed in range(1, 51):
                simulation.must(f"reset {seed}")  # it checks that nothing stands in anything
                hashes.add(sim.hash())
            self.assertEqual(len(hashes), 50)

    def test_a_reset_is_no_reload(self):
        with self.daemon() as daemon, coopdyn.connect(daemon.names[1]) as sim:
            simulation = daemon.text("/simulation")
            simulation.must("reset 2")
            before = sim.hash()
            self.scenario.write_text("[ROBOT_1]\ntype coopbot\nposition 0 0\n")
            simulation.must("reset 1")
            simulation.must("reset 2")
            self.assertEqual(sim.hash(), before)

    def test_what_cannot_be_built_changes_nothing(self):
        self.scenario.write_text("[BOX_1]\ntype box\nsize 1 1 1\nposition 0 0 1\nmass 1\n"
                                 "[RANDOM]\nBOX_1.position 0 0 choice 1 1000000\n")
        with self.daemon("--seed", str(self.good_seed())) as daemon, coopdyn.connect(daemon.names[1]) as sim:
            simulation = daemon.text("/simulation")
            refused = 0
            for seed in range(1, 20):
                before = sim.hash()
                said = simulation.ask(f"reset {seed}")
                if said.error != 0:
                    refused += 1
                    self.assertIn("room.scenario:7: error: 'position'", said.text)
                    self.assertEqual(sim.hash(), before)
            self.assertGreater(refused, 0)
            self.assertLess(refused, 19)

    def good_seed(self):
        for seed in range(1, 20):
            code, _ = tool("check", self.scenario, "--set", f"SIMULATION.seed={seed}")
            if code == 0:
                return seed
        self.fail("no seed is good")


class RecordTest(RandomTestCase):
    def test_a_recorded_run_with_resets_verifies(self):
        with self.daemon("--record", self.file) as daemon:
            simulation = daemon.text("/simulation")
            motors = daemon.text("/robot1/motors")
            for command in ("step 20", "reset 7", "step 30", "reset", "step 10", "reset 3", "step 15"):
                simulation.must(command)
                motors.must("set_velocity 0.2 0.1")
        runs = sorted(self.folder.glob("*.run"))
        self.assertEqual(len(runs), 4)
        self.assertEqual(sorted(equal_steps(run) for run in runs), [10, 15, 20, 30])

    def test_a_branch_goes_on_and_is_reset(self):
        with self.daemon("--record", self.file, "--seed", "7") as daemon, coopdyn.connect(daemon.names[1]) as sim:
            simulation = daemon.text("/simulation")
            simulation.must("step 20")
            seven = sim.hash()
            simulation.must("reset 3")
            three = sim.hash()
        with Daemon(None, "--no-render", "--paused", "--from", f"{self.file}@0.2", name="") as daemon:
            with coopdyn.connect(daemon.names[1]) as sim:
                self.assertEqual(sim.hash(), seven)
                daemon.text("/simulation").must("reset 3")
                self.assertEqual(sim.hash(), three)
                self.scenario.unlink()
                daemon.text("/simulation").must("reset 7")
                daemon.text("/simulation").must("step 20")
                self.assertEqual(sim.hash(), seven)


class CheckTest(RandomTestCase):
    def test_it_prints_each_key_with_its_value(self):
        code, said = tool("check", self.scenario, "--set", "SIMULATION.seed=7")
        self.assertEqual(code, 0, said)
        lines = said.splitlines()
        self.assertEqual(len(lines), 11, said)
        self.assertRegex(lines[7], r"^  BOX_1\.mass uniform 0\.5 2: [0-9.]+ for seed 7$")
        self.assertRegex(lines[10], r"^  SWARM_1\.controller diffuse speed=uniform 0\.1 0\.2: diffuse speed=0\.1[0-9]+ for seed 7$")
        self.assertEqual(tool("check", self.scenario, "--set", "SIMULATION.seed=7")[1], said)
        self.assertNotEqual(tool("check", self.scenario)[1], said)

    def test_mistakes_are_told_at_once(self):
        self.scenario.write_text(ROOM + "BOX_2.size unifrom 1 2\nBOX_3.mass uniform 1 2\n")
        code, said = tool("check", self.scenario)
        self.assertEqual(code, 1)
        self.assertEqual(len(re.findall(r"room\.scenario:\d+: error: ", said)), 2, said)

    def test_a_setting_makes_a_key_random(self):
        code, said = tool("check", self.scenario, "--set", "RANDOM.WALL_1.color=choice red blue")
        self.assertEqual(code, 0, said)
        self.assertIn("WALL_1.color choice red blue: ", said)


if __name__ == "__main__":
    unittest.main()
