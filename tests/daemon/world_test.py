"""/world over raw sockets: live edits are exact and ordered, and can be repeated and undone."""
import json
import math
import random
import tempfile
import unittest
from pathlib import Path

from harness import BOX, Daemon, scenario, until
from recording import SANITIZED, Play, RecordingTestCase, equal_steps, tool

ROOT = Path(__file__).parents[2]
ROOM = BOX + "[WALL_1]\ntype box\nsize 4 0.2 0.5\nposition 0 -3\n[BALL_1]\ntype sphere\nsize 0.3\nposition 4 4\nmass 0.5\n"
CRATE = "insert [CRATE_*] | type box | size 0.4 0.4 0.4 | position {} {} | mass 2 | color orange"


def paused(text=None, *options, **more):
    return Daemon(None if "name" in more else text or scenario(1, extra=ROOM), "--paused", "--no-render", *options, **more)


def listed(world):
    return json.loads(world.must("list").text)


class EditTest(unittest.TestCase):
    def test_insert_puts_things_robots_targets_and_lights_and_tells_their_ids(self):
        with paused() as daemon:
            world = daemon.text("/world")
            reply = world.must("insert [BOX_2] type box | size 1 1 1 | position 5 5 | [ROBOT_*] | type minibot | position -4 4 "
                               "| [TARGET] | green 1 1 | [LIGHT_1] | position 0 0 3")
            self.assertEqual(reply.params, [4, 1000002, 2000002])
            self.assertEqual(reply.text, "BOX_2 robot2 green_target_2")
            now = listed(world)
            self.assertEqual([thing["name"] for thing in now["things"]], ["BOX_1", "WALL_1", "BALL_1", "BOX_2"])
            self.assertEqual([robot["name"] for robot in now["robots"]], ["robot1", "robot2"])
            self.assertEqual(now["lights"][0]["position"], [0, 0, 3])

    def test_an_inserted_robot_is_driven_like_any_other(self):
        with Daemon(scenario(1), "--no-render") as daemon:
            daemon.text("/world").must("insert [ROBOT_*] type coopbot | position 0 5")
            motors = [daemon.text(f"/robot{number}/motors") for number in (1, 2)]
            for _ in range(20):
                for each in motors:
                    each.send("set_velocity 0.3 0")
                steps = [each.receive().step for each in motors]
            self.assertEqual(steps, [20, 20])
            self.assertGreater(daemon.text("/robot2/pose").must("get_pose").data[0], 0.02)

    def test_a_robot_that_was_freed_of_its_controller_stays_with_its_client(self):
        text = scenario(1, robot_extra={1: "controller diffuse"})
        with Daemon(text, "--no-render", "--mode", "lockstep") as daemon:
            daemon.text("/simulation").must("release_robot robot1")
            motors = daemon.text("/robot1/motors")
            first = motors.must("set_velocity 0.2 0").step
            daemon.text("/world").must(CRATE.format(5, 5))
            self.assertEqual(motors.must("set_velocity 0.2 0").step, first + 1)

    def test_a_controller_takes_its_new_options(self):
        text = scenario(1, robot_extra={1: "controller diffuse speed=0.2"})
        with Daemon(text, "--no-render", "--mode", "lockstep", "--paused") as daemon:
            simulation, pose = daemon.text("/simulation"), daemon.text("/robot1/pose")

            def way():
                before = pose.must("get_pose").data[:2]
                simulation.must("step 20")
                return math.dist(before, pose.must("get_pose").data[:2])

            way()
            self.assertAlmostEqual(way(), 0.2 * 20 * 0.01, delta=0.004)
            daemon.text("/world").must("set robot1 controller diffuse speed=0.05")
            way()
            self.assertAlmostEqual(way(), 0.05 * 20 * 0.01, delta=0.002)

    def test_a_client_that_waits_for_a_step_waits_on_while_others_edit(self):
        with Daemon(scenario(2), "--no-render") as daemon:
            first, second = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            first.send_to_wait("set_velocity 0.2 0")
            daemon.text("/world").must(CRATE.format(5, 5))
            second.must("set_velocity 0.2 0")
            self.assertEqual(first.receive().step, 1)

    def test_who_waits_for_a_robot_that_is_removed_is_told(self):
        with Daemon(scenario(2), "--no-render") as daemon:
            first, second = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            first.send_to_wait("set_velocity 0.2 0")
            daemon.text("/world").must("remove robot1")
            reply = first.receive()
            self.assertEqual((reply.error, reply.text), (5, "the robot was taken out of the world"))
            self.assertEqual(second.must("set_velocity 0.2 0").step, 1)

    def test_what_cannot_be_is_refused_in_words_and_changes_nothing(self):
        with paused() as daemon:
            world = daemon.text("/world")
            before = daemon.status()["hash"], listed(world)
            for line, error, words in (
                    ("insert [BOX_1] type box | size 1 1 1 | position 5 5", 7, "give it another name"),
                    ("insert [X] type box | size 1 1 1 | position 0 0", 5, "would stand"),
                    ("insert [X] type bax | size 1 1 1 | position 5 5", 7, "(insert):2: error"),
                    ("insert [FLOOR] size 3 3", 7, "load_scenario"),
                    ("insert", 2, "[BOX_*]"),
                    ("insert [ROBOT_*] type coopbott | position 5 5", 7, "did you mean 'coopbot'"),
                    ("remove BOX_11", 10, "did you mean BOX_1?"),
                    ("remove (77)", 10, "there is no 77"),
                    ("set_pose BOX_1 0 -3 0.2", 5, "inside WALL_1"),
                    ("set_pose BOX_1 3 3 -1", 5, "below the floor"),
                    ("set_pose BOX_1 3 3 1 1 1", 4, "quaternion"),
                    ("set BOX_1 colour", 7, "needs a value"),
                    ("set BOX_1 weight 3", 7, "unknown word 'weight'"),
                    ("set FLOOR color red", 5, "save, edit the text and load it"),
                    ("rename BOX_1 WALL_1", 5, "the name WALL_1 is taken"),
                    ("rename BOX_1 robot_7", 7, "another name"),
                    ("rename robot1 world", 7, "module of the simulator"),
                    ("undo", 5, "nothing to undo"),
                    ("redo", 5, "nothing to redo")):
                reply = world.ask(line)
                self.assertEqual(reply.error, error, f"{line}: {reply}")
                self.assertIn(words, reply.text, line)
            self.assertEqual(before, (daemon.status()["hash"], listed(world)))

    def test_set_changes_any_key_and_a_thing_keeps_standing_on_the_floor(self):
        with paused() as daemon:
            world = daemon.text("/world")
            world.must("set BOX_1 size 0.3 0.3 0.6 | mass 4 | color 0 1 0 | friction 0.5")
            box = listed(world)["things"][0]
            self.assertEqual((box["size"], box["mass"], box["color"], box["friction"]), ([0.3, 0.3, 0.6], 4, [0, 1, 0], 0.5))
            self.assertAlmostEqual(box["position"][2], 0.3)
            world.must("set BOX_1 bounce 0.5 | rolling_friction 0.01 | velocity 0 1 0")
            box = listed(world)["things"][0]
            self.assertEqual((box["bounce"], box["rolling_friction"], box["velocity"], box["turn_rate"]), (0.5, 0.01, [0, 1, 0], [0, 0, 0]))
            self.assertIn("velocity 0 1 0\n", world.must("save").text)
            world.must("set BOX_1 color 1 0 0")  # it flies on
            self.assertEqual(listed(world)["things"][0]["velocity"], [0, 1, 0])
            world.must("set BOX_1 position 1 1 0.3")  # it is put there at rest
            self.assertEqual(listed(world)["things"][0]["velocity"], [0, 0, 0])
            world.must("set robot1 color red")
            world.must("set red color blue | position 1 2 0.5")
            self.assertEqual(listed(world)["targets"][0]["name"], "blue_target_1")
            self.assertEqual(listed(world)["targets"][0]["position"], [1, 2, 0.5])

    def test_pick_tells_what_a_ray_meets(self):
        with paused() as daemon:
            world = daemon.text("/world")
            reply = world.must("pick 0.9 0.1 5 0 0 -1")
            self.assertEqual((reply.text, reply.params), ("BOX_1", [1]))
            self.assertAlmostEqual(reply.data[3], 4.7)
            self.assertEqual(world.must("pick 0 0 5 0 0 -1").params, [1000001])
            self.assertEqual(world.must("pick 9 9 5 0 0 -1").text, "floor")
            self.assertEqual(world.must("pick 0 0 5 0 0 1").params, [-1])


class UndoTest(unittest.TestCase):
    def test_ten_thousand_random_edits_undone_give_the_first_hash(self):
        edits = 1_000 if SANITIZED else 10_000
        chance = random.Random(7)
        with paused(scenario(2, extra=ROOM)) as daemon:
            world = daemon.text("/world")
            first, done, crates, kept = daemon.status()["hash"], 0, 0, []
            while done < edits:
                x, y = chance.uniform(-18, 18), chance.uniform(-18, 18)
                kind = chance.randrange(6)
                if kind == 0 and len(kept) < 40:
                    line = CRATE.format(x, y)
                elif kind == 1 and len(kept) > 10:
                    line = f"remove {chance.choice(kept)}"
                elif kind == 2:
                    line = f"set_pose {chance.choice(kept + ['robot1', 'robot2', 'WALL_1', 'BALL_1'])} {x} {y} 0.2501 {chance.uniform(-3, 3)}"
                elif kind == 3:
                    line = f"set {chance.choice(kept + ['BOX_1'])} size {chance.uniform(0.1, 0.6)} 0.4 0.4 | mass {chance.choice((0, 1, 2))}"
                elif kind == 4:
                    line = f"set {chance.choice(kept + ['robot1'])} color {chance.random()} 0 1"
                else:
                    line = f"set_pose red_target_1 {x} {y} 0.3"
                reply = world.ask(line)
                self.assertIn(reply.error, (0, 5), f"{line}: {reply}")  # 5: it would overlap
                if reply.error != 0:
                    continue
                done += 1
                if line.startswith("insert"):
                    kept.append(reply.text)
                elif line.startswith("remove"):
                    kept.remove(line.split()[1])
            changed = daemon.status()["hash"]
            self.assertNotEqual(first, changed)
            for _ in range(done):
                world.must("undo")
            self.assertEqual(daemon.status()["hash"], first)
            for _ in range(done):
                world.must("redo")
            self.assertEqual(daemon.status()["hash"], changed)

    def test_a_reset_takes_all_edits_back_and_redo_makes_them_again(self):
        with paused() as daemon:
            world, simulation = daemon.text("/world"), daemon.text("/simulation")
            start = daemon.status()["hash"]
            world.must(CRATE.format(5, 5))
            world.must("remove WALL_1")
            edited = daemon.status()["hash"]
            simulation.must("reset")
            self.assertEqual(daemon.status()["hash"], start)
            world.must("redo")
            world.must("redo")
            self.assertEqual(daemon.status()["hash"], edited)

    def test_undo_after_steps_brings_back_what_was_removed(self):
        with paused(scenario(1, extra=ROOM, mode="free")) as daemon:
            world, simulation = daemon.text("/world"), daemon.text("/simulation")
            ball = listed(world)["things"][2]
            world.must("remove BALL_1")
            self.assertEqual(simulation.must("step 50").step, 50)
            world.must("undo")
            self.assertEqual(listed(world)["things"][2], ball)


class SaveTest(unittest.TestCase):
    def test_the_saved_text_loads_to_the_same_hash(self):
        text = scenario(2, extra=ROOM, mode="realtime") + "[ARM]\ntype box\nsize 0.2 0.2 0.2\nposition -5 -5\n"
        with paused(text) as daemon:
            world, simulation = daemon.text("/world"), daemon.text("/simulation")
            world.must("insert [ROBOT_*] type humanoid | position 8 8 | [BOX_*] | type box | size 0.31 0.3 0.3 | position 7.77 1.23 "
                       "| orientation 0.1 0.2 0.3 | mass 1.7 | texture checker")
            world.must("set_pose BOX_1 3.3 0.1 0.15 1.234567")
            world.must("remove ARM")
            world.must("set_pose robot2 -3 7 0 2.5")
            saved, edited = world.must("save").text, daemon.status()["hash"]
            binary = daemon.binary("/simulation")
            reply = binary.ask(108, text=saved)
            self.assertEqual(reply.error, 0, reply)
            self.assertEqual(daemon.status()["hash"], edited)
            self.assertEqual(world.must("save").text.split("\n", 1)[1], saved.split("\n", 1)[1])

    def test_the_saved_text_keeps_the_task_and_the_view(self):
        task = "[TASK]\ntitle Go\ntext Drive.\ntext - slowly\ntext - gently\nhint Look.\ncounts 2 points\n"
        for view in ("[VIEW]\nfrom top\n", "[VIEW]\neye 3 -2 2\nlook 0 0 0.5\n"):
            with paused("[FLOOR]\nsize 4 4\n" + task + view) as daemon:
                saved = daemon.text("/world").must("save").text
                self.assertIn("\n" + task + "\n" + view, saved)
                self.assertEqual(daemon.binary("/simulation").ask(108, text=saved).error, 0)
                self.assertEqual(daemon.text("/world").must("save").text.split("\n", 1)[1], saved.split("\n", 1)[1])

    def test_the_saved_text_finds_models_of_files_and_of_sdf_worlds_from_anywhere(self):
        with tempfile.TemporaryDirectory(prefix="my robots; #1 ") as folder:
            model = (ROOT / "robots" / "minibot" / "model.sdf").read_text()
            Path(folder, "bot.sdf").write_text(model)
            inner = model[model.index("<model"):model.index("</sdf>")]
            Path(folder, "two.world").write_text(f'<sdf version="1.9" xmlns:coopdyn="https://coopdyn.dev/sdf"><world name="two">{inner}</world></sdf>')
            Path(folder, "path.scenario").write_text("[ROBOT_1]\ntype bot.sdf\nposition 1 1\n")
            for name in ("path.scenario", "two.world"):
                with paused(None, name=str(Path(folder, name))) as daemon:
                    saved, begun = daemon.text("/world").must("save").text, daemon.status()["hash"]
                    self.assertEqual(daemon.binary("/simulation").ask(108, text=saved).error, 0, "over a socket, too")
                with tempfile.TemporaryDirectory() as other:
                    Path(other, "again.scenario").write_text(saved)
                    with paused(None, name=str(Path(other, "again.scenario"))) as daemon:
                        self.assertEqual(daemon.status()["hash"], begun, name)
                        self.assertEqual(daemon.text("/world").must("save").text.split("\n", 1)[1], saved.split("\n", 1)[1])

    def test_a_world_that_has_run_loads_too(self):
        with paused(scenario(2, extra=ROOM, mode="free")) as daemon:
            simulation = daemon.text("/simulation")
            simulation.must("step 300")
            saved = daemon.text("/world").must("save").text
            reply = daemon.binary("/simulation").ask(108, text=saved)
            self.assertEqual((reply.error, reply.text), (0, ""))


class RecordedTest(RecordingTestCase):
    def run_with_edits(self, *options):
        """Drives two robots, and edits the world in between; returns the last hash."""
        with Daemon(scenario(2, extra=ROOM), "--record", self.file, "--no-render", *options) as daemon:
            robots = [daemon.text(f"/robot{i}/motors") for i in (1, 2)]
            world, simulation = daemon.text("/world"), daemon.text("/simulation")
            edits = {10: CRATE.format(1.5, 2.0), 20: "set_pose BALL_1 1.2 0.1 0.6", 30: "remove WALL_1",
                     40: "insert [ROBOT_*] type turtle | position 5 5 | sync no", 50: "undo", 60: "redo", 70: "remove BOX_1",
                     80: "set CRATE_1 mass 0.1 | size 0.6 0.6 0.2", 90: "rename CRATE_1 plate", 100: "undo",
                     110: "insert [BOX_9] type box | size 1 1 1 | position -6 6 | texture checker", 120: "remove robot3"}
            for k in range(150):
                for robot in robots:
                    robot.send("set_wheel_speeds 4 3.5")
                for robot in robots:
                    self.assertEqual(robot.receive().error, 0)
                if k in edits:
                    world.must(edits[k])
            return daemon.status()["hash"]

    def test_a_run_with_edits_verifies(self):
        self.run_with_edits()
        self.assertEqual(equal_steps(self.file), 150)

    def test_two_runs_with_the_same_edits_have_equal_hashes_and_threads_do_not_matter(self):
        first = self.run_with_edits()
        self.file = self.folder / "again.run"
        self.assertEqual(self.run_with_edits("--threads", "2"), first)

    def test_a_playback_shows_the_edited_world_and_refuses_edits(self):
        self.run_with_edits()
        with Play(self.file, "--paused", "--no-render") as daemon:
            world, playback = daemon.text("/world"), daemon.text("/playback")
            names = lambda: [thing["name"] for thing in listed(world)["things"]]
            self.assertEqual(names(), ["BOX_1", "WALL_1", "BALL_1"])
            playback.must("seek 0.45")
            self.assertEqual(names(), ["BOX_1", "BALL_1", "CRATE_1"])
            self.assertEqual(len(listed(world)["robots"]), 3)
            playback.must("seek 1.5")
            self.assertEqual(names(), ["BALL_1", "CRATE_1", "BOX_9"])
            for line in ("insert [A] type box | size 1 1 1 | position 5 5", "undo", "remove BOX_1"):
                reply = world.ask(line)
                self.assertEqual(reply.error, 5)
                self.assertIn("branch", reply.text)

    def test_a_playback_brings_up_the_robots_that_come_and_go(self):
        self.run_with_edits()
        with Play(self.file, "--paused", "--no-render") as daemon:
            playback = daemon.text("/playback")
            lookup = daemon.raw()

            def is_there():
                lookup.write("NAME_SERVER query /robot3/pose\n")
                lines = [lookup.read_line()]
                while "end of message" not in lines[-1]:
                    lines.append(lookup.read_line())
                return any(line.startswith("registration") for line in lines)

            self.assertFalse(is_there())
            playback.must("seek 0.45")
            until(is_there)
            self.assertEqual(daemon.text("/robot3/pose").must("get_pose").step, 45)
            playback.must("seek 0")
            until(lambda: not is_there())

    def test_a_branch_goes_on_from_an_edited_world_with_the_recorded_hash(self):
        last = self.run_with_edits()
        code, said = tool("verify", self.file)
        self.assertEqual(code, 0, said)
        with Daemon(None, "--from", f"{self.file}@end", "--no-render", name="") as daemon:
            self.assertEqual(daemon.status()["hash"], last)
            self.assertEqual(daemon.text("/world").must("get_world").data[0], 3)


if __name__ == "__main__":
    unittest.main()
