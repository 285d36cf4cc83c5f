"""Playback of recordings: reading works as in the run, driving only after a branch."""
import math
import random
import tempfile
import unittest
from pathlib import Path

from harness import BOX, Daemon, scenario, until
from recording import Play, equal_steps, tool

STEPS = 100
STEP_S = 0.01
ROBOTS = ("robot1", "robot2")
WORLD = scenario(2, extra=BOX)
# Positions are recorded to 1 um, headings to 1.9e-6 rad; speeds are their differences; readings are computed from these poses.
NEAR_M, NEAR_RAD, NEAR_RANGE_M = 2e-6, 4e-6, 5e-5
NEAR_M_S, NEAR_RAD_S = 4e-4, 1e-3


def wheels(step, robot):
    """The command of a robot for a step."""
    chance = random.Random(1000 * step + robot)
    return f"set_wheel_speeds {chance.uniform(0, 6)!r} {chance.uniform(0, 6)!r}"


class Client:
    """Drives and reads the two robots over raw sockets."""

    def __init__(self, daemon):
        self.motors = [daemon.text(f"/{robot}/motors") for robot in ROBOTS]
        self.poses = [daemon.text(f"/{robot}/pose") for robot in ROBOTS]
        self.distances = [daemon.text(f"/{robot}/distance") for robot in ROBOTS]

    def drive(self, first, last):
        """Drives steps first … last in lockstep."""
        for step in range(first, last + 1):
            for robot, motors in enumerate(self.motors):
                motors.send(wheels(step, robot))
            for motors in self.motors:
                reply = motors.receive()
                assert reply.error == 0 and reply.step == step, reply

    def sees(self):
        """Step, time, poses and distances."""
        poses = [pose.must("get_pose") for pose in self.poses]
        distances = [distance.must("get_distances") for distance in self.distances]
        return poses[0].step, poses[0].time_s, [reply.data[:-2] for reply in poses], [reply.data[:-2] for reply in distances]


class PlaybackTest(unittest.TestCase):
    """A recorded run, and the readings of its client."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.file = Path(folder.name) / "lesson.run"
        cls.seen, cls.hashes = {}, {}
        with Daemon(WORLD, "--record", cls.file) as daemon:
            client = Client(daemon)
            for step in range(0, STEPS + 1):
                if step > 0:
                    client.drive(step, step)
                cls.seen[step] = client.sees()
                if step % 10 == 0:
                    cls.hashes[step] = daemon.status()["hash"]

    def expect_sight(self, client, step):
        """Expects the client's readings to equal those of the run after this step."""
        now_step, time_s, poses, distances = client.sees()
        live_step, live_time_s, live_poses, live_distances = self.seen[step]
        self.assertEqual((now_step, time_s), (live_step, live_time_s))
        for pose, live in zip(poses, live_poses):
            self.assertEqual(len(pose), len(live))
            self.assertLess(math.dist(pose[:2], live[:2]), NEAR_M)
            self.assertLess(abs(math.remainder(pose[2] - live[2], math.tau)), NEAR_RAD)
            self.assertLess(abs(pose[3] - live[3]), NEAR_M_S)
            self.assertLess(abs(pose[4] - live[4]), NEAR_RAD_S)
        for readings, live in zip(distances, live_distances):
            self.assertEqual(len(readings), len(live))
            for one, other in zip(readings, live):
                self.assertTrue(one == other or abs(one - other) < NEAR_RANGE_M, (one, other))


class ReadingTest(PlaybackTest):
    def test_what_reads_tells_what_it_told_in_the_run(self):
        with Play(self.file, "--paused") as daemon:
            client, playback = Client(daemon), daemon.text("/playback")
            for step in (0, 37, 100, 1, 99, 50):
                reply = playback.must(f"seek {STEP_S * step!r}")
                self.assertEqual(reply.step, step)
                self.expect_sight(client, step)
                if step % 10 == 0:
                    self.assertEqual(daemon.status()["hash"], self.hashes[step])

    def test_a_time_between_steps_is_the_one_before_and_outside_the_nearest_end(self):
        with Play(self.file, "--paused") as daemon:
            playback = daemon.text("/playback")
            for time_s, step in ((0.4251, 42), (0.4299, 42), (-3, 0), (99, STEPS)):
                self.assertEqual(playback.must(f"seek {time_s}").step, step)

    def test_it_tells_what_is_played(self):
        with Play(self.file, "--paused", "--at", "0.3") as daemon:
            reply = daemon.text("/playback").must("get_playback")
            self.assertEqual(reply.text, "lesson.run")
            self.assertEqual(reply.params[:3], [0, 0, 0])
            self.assertEqual([round(value, 9) for value in reply.data[:4]], [0, STEPS * STEP_S, 0.3, 1])

    def test_commands_to_actuators_are_refused(self):
        with Play(self.file, "--paused") as daemon:
            motors, simulation = daemon.text("/robot1/motors"), daemon.text("/simulation")
            for connection, line in ((motors, "set_velocity 0.1 0"), (motors, "set_wheel_speeds 1 1"), (motors, "claim"),
                                     (simulation, "set_mode free"), (simulation, "set_step 0.02"),
                                     (simulation, "load_scenario empty")):
                reply = connection.ask(line)
                self.assertEqual(reply.error, 5, (line, reply))
                self.assertIn("playing a recording", reply.text)

    def test_a_live_run_has_no_playback(self):
        with Daemon(scenario(1)) as daemon:
            playback = daemon.text("/playback")
            for line in ("get_playback", "seek 1", "play", "pause", "step 1", "set_speed 2", "set_loop 1", "branch"):
                self.assertEqual(playback.ask(line).error, 5, line)


class StatusTest(PlaybackTest):
    def lines(self, daemon):
        """The lines of `coopdyn status` about speed and recordings."""
        code, said = tool("status", "--server", "%s:%d" % daemon.names)
        self.assertEqual(code, 0, said)
        return [line for line in said.splitlines() if line.startswith(("speed", "playing", "recording"))]

    def test_a_playback_is_named_with_its_speed(self):
        with Play(self.file, "--paused", "--speed", "-2.5", "--at", "0.5") as daemon:
            self.assertEqual(self.lines(daemon), ["speed: -2.5 times real time", "playing lesson.run"])

    def test_a_recording_is_named_while_it_is_written(self):
        with tempfile.TemporaryDirectory() as folder:
            with Daemon(scenario(1), "--record", Path(folder) / "new.run") as daemon:
                self.assertEqual(self.lines(daemon), ["speed: no limit", "recording to new.run"])
                daemon.text("/recorder").must("stop")
                daemon.text("/simulation").must("set_speed 3")
                self.assertEqual(self.lines(daemon), ["speed: 3 times real time"])


class TimeTest(PlaybackTest):
    def test_steps_go_on_and_back(self):
        with Play(self.file, "--paused", "--at", "0.5") as daemon:
            client, playback = Client(daemon), daemon.text("/playback")
            for steps, reached in ((1, 51), (5, 56), (-1, 55), (-50, 5), (-50, 0), (1000, STEPS)):
                self.assertEqual(playback.must(f"step {steps}").step, reached)
            playback.must("step -3")
            self.expect_sight(client, STEPS - 3)

    def test_it_plays_to_its_end_and_says_so(self):
        with Play(self.file, "--paused") as daemon:
            playback = daemon.text("/playback")
            playback.must("play 4")
            until(lambda: playback.must("get_playback").data[2] == STEPS * STEP_S)
            until(lambda: playback.must("get_playback").params[0] == 0)
            until(lambda: daemon.status()["events"])
            self.assertEqual([event["text"] for event in daemon.status()["events"]], ["the recording has ended"])

    def test_backwards_it_shows_every_step_in_turn(self):
        with Play(self.file, "--paused", "--at", "1") as daemon:
            playback, simulation = daemon.text("/playback"), daemon.text("/simulation")
            playback.must("set_speed -0.1")  # so slow that its end is far for a machine that stops it now and then
            simulation.write("ping\n" + "ready\n" * (STEPS + 1))  # one more than it shows
            self.assertEqual(simulation.receive().step, STEPS)
            playback.must("play")
            shown = [simulation.receive().step for _ in range(11)]
            self.assertGreater(shown[-1], 0)
            playback.must("set_speed -4")
            until(lambda: playback.must("get_playback").params[0] == 0)
            self.assertEqual(playback.must("get_playback").data[2], 0)
            playback.must(f"step {STEPS}")  # a ready that came too late for step 0 waits
            while (step := simulation.receive().step) < STEPS:
                shown.append(step)
            self.assertEqual(shown, sorted(set(shown), reverse=True))

    def test_in_a_loop_it_begins_again(self):
        with Play(self.file, "--loop", "--speed", "20") as daemon:
            playback = daemon.text("/playback")
            self.assertEqual(playback.must("get_playback").params[1], 1)
            laps, last = 0, 0
            while laps < 3:
                now = playback.must("ready").step
                laps += now < last
                last = now
            playback.must("set_loop 0")
            until(lambda: playback.must("get_playback").params[0] == 0)

    def test_the_simulations_own_commands_drive_it_too(self):
        with Play(self.file, "--paused", "--at", "0.5", "--speed", "0.001") as daemon:  # so slow that its end is far
            simulation, playback = daemon.text("/simulation"), daemon.text("/playback")
            self.assertEqual(simulation.must("step 2").step, 52)
            simulation.must("run")
            self.assertEqual(playback.must("get_playback").params[0], 1)
            simulation.must("pause")
            self.assertEqual(playback.must("get_playback").params[0], 0)
            self.assertEqual(simulation.must("reset").step, 0)


class BranchTest(PlaybackTest):
    def test_a_branch_with_the_same_commands_gives_the_same_hashes(self):
        with Play(self.file, "--paused") as daemon:
            playback = daemon.text("/playback")
            reply = playback.must("branch 0.43")
            self.assertEqual(daemon.status()["step"], 43)
            self.assertEqual(playback.ask("get_playback").error, 5, reply)
            daemon.text("/simulation").must("run")
            client = Client(daemon)
            for step in range(50, STEPS + 1, 10):
                client.drive(44 if step == 50 else step - 9, step)
                self.assertEqual(daemon.status()["hash"], self.hashes[step])

    def test_with_other_commands_it_goes_its_own_way(self):
        with Play(self.file, "--paused", "--at", "0.7") as daemon:
            daemon.text("/playback").must("branch")
            daemon.text("/simulation").must("run")
            client = Client(daemon)
            for motors in client.motors:
                motors.send("set_velocity 0 0")
            for motors in client.motors:
                self.assertEqual(motors.receive().step, 71)

    def test_serve_goes_on_from_a_moment(self):
        for when, step in (("0.43", 43), ("start", 0), ("end", STEPS)):
            with Daemon(None, "--from", f"{self.file}@{when}", name="") as daemon:
                self.assertEqual(daemon.status()["step"], step)
                self.assertEqual(daemon.status()["mode"], "lockstep")
                client = Client(daemon)
                self.expect_sight(client, step)
                end = max(STEPS, step + 1)
                client.drive(step + 1, end)
                if step < STEPS:
                    self.assertEqual(daemon.status()["hash"], self.hashes[STEPS])

    def test_a_branch_can_be_recorded_and_verified(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "branch.run"
            with Daemon(None, "--from", f"{self.file}@0.5", "--record", file, name="") as daemon:
                Client(daemon).drive(51, 80)
            self.assertEqual(equal_steps(file), 30)


class GrowingTest(unittest.TestCase):
    def test_a_second_daemon_plays_a_run_that_is_being_recorded(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "lesson.run"
            with Daemon(WORLD, "--record", file) as live:
                driver, recorder = Client(live), live.text("/recorder")
                driver.drive(1, 50)
                until(lambda: recorder.must("get_recording").data[4] > 0)  # bytes: the file can be read
                with Play(file, "--paused") as daemon:
                    playback, watcher = daemon.text("/playback"), Client(daemon)
                    until(lambda: playback.must("seek 0.5").step == 50)
                    self.assertEqual(playback.must("get_playback").params[2], 1, "growing")
                    driver.drive(51, 90)
                    until(lambda: playback.must("seek 0.9").step == 90)
                    for one, other in zip(watcher.sees()[2], driver.sees()[2]):
                        self.assertLess(math.dist(one[:2], other[:2]), NEAR_M)


class OpenTest(PlaybackTest):
    """A live daemon plays a recording while its own run is suspended."""

    def live(self):
        """A daemon at step 40 of the same run, whose folder of recordings has lesson.run; and its client."""
        daemon = Daemon(WORLD, "--recordings", self.file.parent)
        self.enterContext(daemon)
        client = Client(daemon)
        client.drive(1, 40)
        return daemon, client

    def test_a_live_daemon_plays_a_recording_and_goes_on_where_it_was(self):
        daemon, client = self.live()
        playback = daemon.text("/playback")
        playback.must("open lesson")
        playback.must("pause")
        playback.must("seek 0.9")
        self.expect_sight(client, 90)
        self.assertEqual(client.motors[0].ask(wheels(41, 0)).error, 5)
        playback.must("close")
        self.assertEqual(daemon.status()["step"], 40)
        self.assertEqual(daemon.status()["hash"], self.hashes[40])
        self.assertIsNone(daemon.status()["playback"])
        client.drive(41, 60)
        self.assertEqual(daemon.status()["hash"], self.hashes[60])

    def test_it_goes_on_live_from_the_recording_too(self):
        daemon, client = self.live()
        playback = daemon.text("/playback")
        playback.must("open lesson.run")
        playback.must("branch 0.5")
        daemon.text("/simulation").must("run")
        client.drive(51, 70)
        self.assertEqual(daemon.status()["hash"], self.hashes[70])
        self.assertEqual(playback.ask("close").error, 5)

    def test_opening_a_recording_again_begins_it_anew(self):
        daemon, client = self.live()
        playback = daemon.text("/playback")
        playback.must("open lesson")
        playback.must("pause")
        playback.must("seek 0.9")
        self.assertLess(playback.must("open lesson").step, 90)
        playback.must("close")
        self.assertEqual(daemon.status()["hash"], self.hashes[40])

    def test_what_cannot_be_played_leaves_the_run_alone(self):
        daemon, client = self.live()
        playback = daemon.text("/playback")
        (self.file.parent / "torn.run").write_text("no recording")
        self.assertEqual(playback.ask("open nothing").error, 10)
        self.assertEqual(playback.ask("open torn").error, 5)
        self.assertEqual(playback.ask("open ../lesson").error, 10)
        self.assertEqual(playback.ask("close").error, 5)
        client.drive(41, 50)
        self.assertEqual(daemon.status()["hash"], self.hashes[50])

    def test_a_run_that_is_recorded_is_not_put_aside(self):
        daemon, client = self.live()
        recorder, playback = daemon.text("/recorder"), daemon.text("/playback")
        recorder.must("start mine")
        refused = playback.ask("open lesson")
        self.assertEqual(refused.error, 5)
        self.assertIn("/recorder stop", refused.text)
        recorder.must("stop")
        playback.must("open lesson")

    def test_a_daemon_that_only_plays_has_no_run_to_go_back_to(self):
        with Play(self.file, "--paused") as daemon:
            reply = daemon.text("/playback").ask("close")
            self.assertEqual(reply.error, 5)
            self.assertIn("branch", reply.text)


if __name__ == "__main__":
    unittest.main()
