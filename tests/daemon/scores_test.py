"""Scores of whole runs: in the summary, in get_status, at the end of a run, in its recording and its branches; and --set."""
import json
import math
import sys
import unittest
from pathlib import Path

from harness import Daemon
from recording import RecordingTestCase, equal_steps, rows, tool

sys.path.insert(0, str(Path(__file__).parents[2] / "clients" / "python"))
import coopdyn  # noqa: E402

SWARM = """[SIMULATION]
mode free
[FLOOR]
size 8 8
[WALL_1]
type box
size 0.2 6 0.5
position 2 0
[TARGET]
red -2 0
[SWARM_1]
type minibot
count 10
controller diffuse speed=0.2
fidelity rolling
[SCORE_1]
kind reach
target red
within 1
[SCORE_2]
kind distance
[SCORE_3]
kind nearest
[SCORE_4]
kind coverage
cell 0.5
"""


class SwarmTestCase(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.scenario = self.folder / "swarm.scenario"
        self.scenario.write_text(SWARM)
        self.summary = self.folder / "summary.json"

    def run_to(self, *options, duration=3):
        """The summary of a run without sockets."""
        code, said = tool("serve", self.scenario, "--no-net", "--no-render", "--summary", self.summary, "--duration", duration,
                          *options)
        self.assertEqual(code, 0, said)
        return json.loads(self.summary.read_text())

    def scores(self, *options, **more):
        return {score["name"]: score["value"] for score in self.run_to(*options, **more)["scores"]}


class ScoresTest(SwarmTestCase):
    def test_the_summary_has_them_in_the_order_of_the_file(self):
        told = self.run_to()
        self.assertEqual([score["name"] for score in told["scores"]], ["reach", "distance", "nearest", "coverage"])
        self.assertEqual([score["unit"] for score in told["scores"]], ["", "m", "m", "m2"])
        self.assertTrue(all(score["met"] is None for score in told["scores"]))

    def test_they_are_those_that_the_recorded_poses_give(self):
        told = self.scores("--record", self.file)
        path = coopdyn.read_run(str(self.file))
        lengths = []
        for k in range(1, 11):
            pose = path.pose(f"swarm1_{k}")
            lengths.append(sum(math.hypot(pose[i + 1][0] - pose[i][0], pose[i + 1][1] - pose[i][1]) for i in range(len(pose) - 1)))
        self.assertAlmostEqual(told["distance"], sum(lengths) / 10, places=3)
        reached = sum(any(math.hypot(x + 2, y) <= 1 for x, y, *_ in path.pose(f"swarm1_{k}")) for k in range(1, 11))
        self.assertEqual(told["reach"], reached)

    def test_until_ends_the_run_at_the_very_step(self):
        told = self.run_to("--set", "SCORE_5.kind=time", "--set", "SCORE_5.until=>= 0.5", "--record", self.file)
        self.assertEqual((told["ended"], told["steps"], told["scores"][4]["met"], told["scores"][4]["met_s"]), ("score", 50, True, 0.5))
        self.assertTrue(all(score["met_s"] is None for score in told["scores"][:4]))
        self.assertEqual(rows(self.file, "SELECT max(step) FROM step"), [(50,)])
        self.assertEqual(equal_steps(self.file), 50)

    def test_a_limit_ends_the_run_unmet(self):
        told = self.run_to("--set", "SCORE_1.until=all", "--set", "SCORE_1.limit=0.25")
        self.assertEqual((told["ended"], told["steps"], told["scores"][0]["met"], told["scores"][0]["met_s"]), ("limit", 25, False, None))

    def test_threads_and_recording_change_nothing(self):
        plain = self.run_to()
        for options in (("--threads", "2"), ("--record", self.file)):
            other = self.run_to(*options)
            self.assertEqual((other["hash"], other["scores"]), (plain["hash"], plain["scores"]))

    def test_scores_do_not_change_the_run(self):
        plain = self.run_to()["hash"]
        self.scenario.write_text(SWARM[:SWARM.index("[SCORE_1]")])
        self.assertEqual(self.run_to()["hash"], plain)
        self.assertEqual(self.run_to("--set", "SCORE_1.kind=collisions")["hash"], plain)

    def test_a_branch_goes_on_with_the_scores_of_its_run(self):
        whole = self.run_to("--record", self.file)
        code, said = tool("serve", "--from", f"{self.file}@1.37", "--mode", "free", "--no-net", "--no-render", "--duration", "3",
                          "--summary", self.summary)
        self.assertEqual(code, 0, said)
        told = json.loads(self.summary.read_text())
        self.assertEqual((told["hash"], told["scores"]), (whole["hash"], whole["scores"]))

    def test_a_robot_that_runs_into_a_wall_collides_once(self):
        self.scenario.write_text("[SIMULATION]\nmode lockstep\n[WALL_1]\ntype box\nsize 0.2 2 0.5\nposition 1 0\n"
                                 "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n[SCORE_1]\nkind collisions\n")
        with Daemon(None, "--no-render", name=str(self.scenario)) as daemon:
            with coopdyn.connect(daemon.names[1]) as sim:
                self.assertEqual(sim.scores(), {"collisions": 0})
                motors = daemon.text("/robot1/motors")
                for _ in range(300):
                    motors.must("set_velocity 0.5 0")
                self.assertEqual(sim.scores(), {"collisions": 1})

    def test_a_recording_of_a_run_that_counts_collisions_verifies(self):
        told = self.run_to("--set", "SCORE_5.kind=collisions", "--record", self.file)
        self.assertEqual(equal_steps(self.file), told["steps"])

    def test_a_reset_begins_them_anew_and_clients_see_them(self):
        with Daemon(None, "--no-render", "--paused", name=str(self.scenario)) as daemon:
            with coopdyn.connect(daemon.names[1]) as sim:
                begun = sim.scores()
                self.assertEqual(begun["distance"], 0)
                daemon.text("/simulation").must("step 100")
                self.assertGreater(sim.scores()["distance"], 0)
                sim.log("energy", 3.5)
                code, said = tool("status", "--server", "%s:%d" % daemon.names)
                self.assertEqual(code, 0)
                self.assertRegex(said, r"score distance: [\d.]+ m\n")
                self.assertIn("logged energy: 3.5 at 1.000 s", said)
                sim.reset()
                self.assertEqual(sim.scores(), begun)

    def test_the_end_of_the_run_says_why_and_what_comes_after_it_is_not_logged(self):
        self.scenario.write_text(SWARM + "until > 0\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 3\n")
        with Daemon(None, "--no-render", "--mode", "lockstep", "--set", "SCORE_1.kind=time", "--set", "SCORE_1.target=", "--set", "SCORE_1.within=",
                    "--set", "SCORE_1.until=>= 0.1", "--set", "SCORE_4.until=", name=str(self.scenario)) as daemon:
            with coopdyn.connect(daemon.names[1]) as sim:
                eva = sim.robot("eva")
                with self.assertRaises(coopdyn.Error) as ended:
                    while True:
                        eva.set_velocity(0.1, 0)
                        sim.step()
                self.assertIn("the run has ended: the score time is 0.1 s: the run has reached its goal", ended.exception.text)
                with self.assertRaises(coopdyn.Error):
                    sim.log("late", 1)
                with self.assertRaisesRegex(coopdyn.Error, "the run has ended: the score time is 0.1 s"):
                    eva.set_velocity(0.1, 0)
                    sim.step()


    def test_a_run_that_ends_by_its_scenario_stands_until_a_reset(self):
        ends = {"[SIMULATION]\nduration 0.2\n": "it has reached its duration", "[SCORE_1]\nkind time\nuntil >= 0.2\n": "the score time is 0.2 s"}
        for text, why in ends.items():
            self.scenario.write_text(text + "[ROBOT_1]\ntype coopbot\nname eva\nposition 0 3\n")
            with Daemon(None, "--no-render", "--mode", "lockstep", name=str(self.scenario)) as daemon, \
                    coopdyn.connect(daemon.names[1]) as sim:
                for _ in range(2):
                    eva = sim.robot("eva")
                    with self.assertRaisesRegex(coopdyn.Error, f"the run has ended: {why}.*: reset starts it again"):
                        while True:
                            eva.set_velocity(0.1, 0)
                            sim.step()
                    status = daemon.status()
                    self.assertEqual((status["state"], status["step"]), ("ended", 20))
                    self.assertIn(why.removeprefix("it "), status["ended"])
                    for line in ("run", "step 1"):
                        self.assertIn("reset starts it again", daemon.text("/simulation").ask(line).text)
                    sim.reset()
                    self.assertEqual((daemon.status()["state"], daemon.status()["ended"]), ("waiting", None))
                sim.end_run("that is enough")
                self.assertEqual(daemon.status()["ended"], "a client ends the run: that is enough")


class SetTest(SwarmTestCase):
    def test_settings_hold_after_a_reload(self):
        with Daemon(None, "--no-render", "--paused", "--set", "SWARM_1.count=3", name=str(self.scenario)) as daemon:
            self.assertEqual(daemon.status()["robot_count"], 3)
            daemon.text("/simulation").must("reload")
            self.assertEqual(daemon.status()["robot_count"], 3)

    def test_a_recording_has_its_settings(self):
        told = self.run_to("--set", "SWARM_1.count=3", "--record", self.file)
        self.assertEqual(told["robots"], 3)
        self.assertGreater(equal_steps(self.file), 0)

    def test_check_takes_settings_and_tells_what_is_wrong_with_them(self):
        code, said = tool("check", self.scenario, "--set", "SWARM_1.count=3")
        self.assertEqual((code, said.split()[1]), (0, "3"))
        code, said = tool("check", self.scenario, "--set", "SWARM_1.cuont=3", "--set", "SWARM1.count=3")
        self.assertEqual(code, 1)
        self.assertIn("--set SWARM_1.cuont=3: error: unknown word 'cuont' in [SWARM_1]; did you mean 'count'?", said)
        self.assertIn("--set SWARM1.count=3: error: the scenario has no section [SWARM1]; did you mean 'SWARM_1'?", said)

    def test_what_a_setting_makes_is_wrong_at_the_setting(self):
        code, said = tool("check", self.scenario, "--set", "SCORE_9.kind=reach")
        self.assertEqual(code, 1)
        self.assertIn("--set SCORE_9.kind=reach: error: [SCORE_9] needs 'target'", said)
        code, said = tool("check", "arena20", "--set", "FLOOR.friction=0.5")
        self.assertRegex(said, r"--set FLOOR.friction=0.5: error: the floor is that of the world, \S*arena.world:\d+, whose keys --set does not change")

    def test_a_world_takes_none(self):
        code, said = tool("check", "corridor.world", "--set", "WALL_1.size=1 1 1")
        self.assertEqual(code, 1)
        self.assertIn("settings are for scenarios", said)

    def test_a_moment_of_a_recording_takes_none(self):
        code, said = tool("serve", "--from", "a.run@1", "--set", "A.b=1")
        self.assertEqual(code, 2)
        self.assertIn("leave --set out", said)


if __name__ == "__main__":
    unittest.main()
