# SPDX-License-Identifier: MIT
"""The messages to a program when another client resets the world or loads a scenario, and when it never calls step()."""
import contextlib
import io
import threading
import unittest

import harness
import coopdyn
from cases import RESET, DaemonTestCase, FakeTestCase


class AReset(FakeTestCase):
    def started(self, mode, robots=1):
        """A program that has driven robot1 for some steps, and another client."""
        self.daemon = self.start(mode=mode, robots=robots)
        self.sim, self.other = self.connect(self.daemon), self.connect(self.daemon, name="other")
        self.r = self.sim.robot(1)
        for _ in range(3):
            self.r.set_velocity(0.1, 0)
            self.sim.step(timeout=60)

    def assert_reset(self, call):
        with self.assertRaises(coopdyn.WorldReset) as caught:
            call()
        e = caught.exception
        self.assertIsInstance(e, coopdyn.Error)
        self.assertEqual((e.code, e.name), (5, "reset"))
        self.assertEqual(e.text, RESET)

    def hold_time(self):
        """Makes later resets leave the world at step 0."""
        with self.daemon.lock:
            self.daemon.state = "paused"

    def test_between_two_steps_of_lockstep_is_noticed_by_the_next_step(self):
        self.started(mode=1)
        self.other.reset()
        self.r.set_velocity(0.5, 0)
        self.assert_reset(lambda: self.sim.step(timeout=60))

    def test_is_noticed_by_the_next_reading_before_an_old_command_runs(self):
        self.started(mode=1)
        self.other.reset()
        self.r.set_velocity(0.5, 0)
        self.assert_reset(self.r.get_pose)
        self.sim.step(timeout=60)
        self.assertEqual((self.sim.steps, self.r.get_pose().forward), (1, 0.0))

    def test_is_noticed_by_a_reading_in_real_time(self):
        self.started(mode=0)
        self.hold_time()
        self.other.reset()
        self.assert_reset(self.r.get_distances)

    def test_is_noticed_by_all_readings_of_one_step(self):
        self.started(mode=0)
        self.r.sense()
        self.hold_time()
        self.other.reset()
        self.assert_reset(self.r.sense)

    def test_is_noticed_by_a_command_in_real_time(self):
        self.started(mode=0)
        self.hold_time()
        self.other.reset()
        self.assert_reset(lambda: self.r.set_velocity(0.1, 0))

    def test_is_told_once_and_the_program_can_start_over(self):
        for mode in (0, 1):
            with self.subTest(mode=mode):
                self.started(mode)
                self.other.reset()
                self.assert_reset(lambda: [self.sim.step(timeout=60) for _ in range(2)])
                for _ in range(4):
                    self.r.set_velocity(0.1, 0)
                    self.sim.step(timeout=60)
                self.assertEqual(self.r.get_pose().forward, 0.1)

    def test_ends_a_raw_call_that_waits(self):
        self.daemon = self.start(mode=1, robots=2)
        sim, other = self.connect(self.daemon), self.connect(self.daemon, name="other")
        r = sim.robot(1)
        call = lambda: r.call("motors", "set_velocity", data=[0.1, 0])
        self.assertEqual(self.reset_in(call, self.daemon, other), [(5, RESET)])

    def test_of_our_own_is_no_error(self):
        self.started(mode=1)
        for again in (self.sim.reset, self.sim.reload, lambda: self.sim.load_scenario("again"),
                      lambda: self.sim.call("/simulation", "reset")):
            again()
            self.assertEqual(self.r.get_pose().x, 0)
            for _ in range(3):
                self.sim.step(timeout=60)
        self.assertEqual(self.sim.steps, 3)

    def test_is_told_to_a_team(self):
        daemon = self.start(mode=1, robots=2)
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        team = sim.team()
        for call in (lambda: team.step((0.1, 0), timeout=60), team.read):
            for _ in range(3):
                team.step((0.1, 0), timeout=60)
            other.reset()
            self.assert_reset(call)
        self.assertEqual(team.step((0.1, 0), timeout=60).step, 1)

    def test_does_not_end_a_program_that_only_watches(self):
        self.started(mode=1)
        watch = self.connect(self.daemon, watch=True).robot(1)
        self.assertGreater(watch.get_pose().x, 0)
        self.other.reset()
        self.assertEqual(watch.get_pose().x, 0)

    def test_pushed_readings_of_before_are_no_error(self):
        self.started(mode=1)
        self.r.subscribe("pose")
        for _ in range(3):
            self.sim.step(timeout=60)
        self.sim.reset()
        self.sim.step(timeout=60)
        self.assertEqual([self.r.next(timeout=60).step for _ in range(4)], [4, 5, 6, 1])
        self.r.get_pose()


class ALoad(DaemonTestCase):
    def waiting_step_and(self, load):
        """The error of a waiting step when `load` runs."""
        daemon = self.start(harness.scenario_of(2))
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        r = sim.robot("robot1")
        raised = []

        def wait():
            try:
                r.set_velocity(0.1, 0)
                sim.step(timeout=60)
            except coopdyn.Error as e:
                raised.append(e)

        thread = threading.Thread(target=wait)
        thread.start()
        while [a.robot for a in other.waiting()] != ["robot2"]:
            pass
        load(other)
        thread.join()
        self.assertEqual([type(e) for e in raised], [coopdyn.WorldReset], raised)
        return sim, r, raised[0].text

    def test_of_the_same_scenario_says_so_and_the_robot_drives_on(self):
        sim, r, said = self.waiting_step_and(lambda other: other.reload())
        self.assertRegex(said, "scenario .* was loaded: run your program again, or catch this to start over")
        sim.set_participants(["robot1"])
        r.set_velocity(0.1, 0)
        sim.step(timeout=60)
        self.assertEqual(sim.steps, 1)

    def test_without_the_robot_says_which_is_missing(self):
        without = harness.scenario_of(1).replace("robot1", "carl")
        sim, r, said = self.waiting_step_and(lambda other: other.load_scenario(without))
        self.assertIn("which has no robot1; there are: carl", said)
        for call in (r.get_pose, r.get_wheels, r.sense, lambda: r.set_velocity(0, 0)):
            self.assert_error(10, call, "the scenario that was loaded has no robot1; there are: carl")
        sim.robot("carl").set_velocity(0.1, 0)
        sim.step(timeout=60)

    def test_between_two_steps_names_the_scenario_and_the_robot_that_is_missing(self):
        for notices in (lambda sim, r: r.get_pose(), lambda sim, r: r.get_wheels(), lambda sim, r: r.sense(),
                        lambda sim, r: sim.step(timeout=60), lambda sim, r: r.next(timeout=60)):
            daemon = self.start("formation", "--mode", "lockstep")
            sim, other = self.connect(daemon), self.connect(daemon, name="other")
            robots = [sim.robot(k) for k in range(1, 6)]
            robots[1].get_pose()
            robots[1].sense()
            sim.step(timeout=60)
            robots[1].subscribe("pose")
            robots[1].sense()  # readings in the step's reply
            other.load_scenario("classroom")
            with self.assertRaises(coopdyn.WorldReset) as caught:
                notices(sim, robots[1])
            self.assertIn("scenario classroom was loaded, which has no robot2, robot3, robot4, robot5; there are: robot1",
                          caught.exception.text)
            robots[0].set_velocity(0.1, 0)
            sim.step(timeout=60)

    def test_between_two_steps_is_noticed_by_a_step_that_waits_for_others(self):
        self.notices_after(0.1)
        daemon = self.start("classroom", "--mode", "lockstep")
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        r = sim.robot("robot1")
        for change, said in ((lambda: other.load_scenario("formation"), "scenario formation was loaded: run your program again"),
                             (lambda: other.load_scenario("formation"), "was"), (other.reset, RESET)):
            sim.set_participants(["robot1"])
            r.set_velocity(0.1, 0)
            sim.step(timeout=60)
            other.set_participants([])
            change()
            r.set_velocity(0.1, 0)
            with self.assertRaises(coopdyn.WorldReset) as caught:
                sim.step(timeout=60)
            self.assertIn(said, caught.exception.text)
        sim.set_participants(["robot1"])
        sim.step(timeout=60)
        self.assertIn(sim.steps, (1, 2))  # the command that waited may still have run

    def test_of_another_scenario_with_the_robot_is_named_by_the_next_reading(self):
        daemon = self.start("formation", "--mode", "lockstep")
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        robots = [sim.robot(k) for k in range(1, 6)]
        sim.step(timeout=60)
        other.load_scenario("fig4")
        with self.assertRaises(coopdyn.WorldReset) as caught:
            robots[0].get_pose()
        self.assertIn("scenario fig4 was loaded", caught.exception.text)


class TimeThatGoesBackInAPlayback(DaemonTestCase):
    def test_is_no_reset(self):
        recorder = self.start("classroom", "--mode", "lockstep")
        sim = self.connect(recorder)
        r = sim.robot(1)
        name = sim.record("lesson")
        for _ in range(20):
            r.set_velocity(0.1, 0)
            sim.step(timeout=60)
        sim.stop_recording()
        player = self.start(str(recorder.recordings / name), "--paused")
        viewer, other = self.connect(player), self.connect(player, name="other")
        seen = viewer.robot(1)
        other.seek(0.15)
        later = seen.get_pose()
        other.seek(0.05)
        self.assertLess(seen.get_pose().x, later.x)


class ALoopWithoutSteps(FakeTestCase):
    WORDS = "coopdyn: 200 commands to robot1 without a step"

    def said_after(self, sim, commands):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            commands(sim.robot(1))
        return said.getvalue()

    def test_is_told_so_once_in_lockstep(self):
        sim = self.connect(self.start(mode=1))
        said = self.said_after(sim, lambda r: [r.set_velocity(0.1, 0) for _ in range(1000)])
        self.assertEqual(said.count("coopdyn: "), 1, said)
        self.assertIn(f"{self.WORDS}, nothing moves: write sim.step() at the end of your loop", said)

    def test_is_told_so_in_real_time_if_it_runs_faster_than_time(self):
        daemon = self.start(mode=0)
        with daemon.lock:
            daemon.state = "paused"
        said = self.said_after(self.connect(daemon), lambda r: [r.set_velocity(0.1, 0) for _ in range(500)])
        self.assertEqual(said.count(f"{self.WORDS}, your loop runs faster than time"), 1, said)

    def test_is_not_told_so_if_it_lets_time_go_by(self):
        daemon = self.start(mode=0)
        with daemon.lock:
            daemon.state = "paused"

        def slowly(r):
            for _ in range(500):
                r.set_velocity(0.1, 0)
                with daemon.lock:
                    daemon._advance()

        self.assertEqual(self.said_after(self.connect(daemon), slowly), "")

    def test_is_not_told_so_if_it_steps(self):
        sim = self.connect(self.start(mode=1))

        def well(r):
            for _ in range(5):
                for _ in range(100):
                    r.set_velocity(0.1, 0)
                sim.step(timeout=60)

        self.assertEqual(self.said_after(sim, well), "")


if __name__ == "__main__":
    unittest.main()
