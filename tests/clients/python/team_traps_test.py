# SPDX-License-Identifier: MIT
"""Failures between a team and the daemon, produced by the scripted daemon."""
import array
import gc
import math
import os
import unittest

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn
from cases import RESET, FakeTestCase


class Speeds(FakeTestCase):
    def setUp(self):
        self.daemon = self.start(mode=1, robots=3)
        self.team = self.connect(self.daemon).team()

    def sent(self):
        return [data for module, command, _, data in self.daemon.received if (module, command) == ("/swarm", 110)]

    def test_every_way_to_write_them_sends_the_same(self):
        rows = [(0.1, 0.2), (0.3, 0.4), (0.5, 0.6)]
        flat = array.array("d", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
        for V in (rows, [list(row) for row in rows], iter(rows), flat, list(flat),
                  memoryview(flat), memoryview(flat).cast("B").cast("d", (3, 2))):
            self.team.step(V)
            self.assertEqual(self.sent()[-1], tuple(flat))
        self.team.step(array.array("i", [0, 1, 2, 3, 4, 5]))
        self.assertEqual(self.sent()[-1], (0, 1, 2, 3, 4, 5))

    def test_one_row_is_for_all(self):
        for V in ((0.1, 0.2), [[0.1, 0.2]], array.array("d", [0.1, 0.2])):
            self.team.step(V)
            self.assertEqual(self.sent()[-1], (0.1, 0.2) * 3)

    def test_none_keeps_them(self):
        self.team.step((0.25, 0))
        s = self.team.step()
        self.assertEqual(self.sent()[-1], ())
        self.assertEqual([x for x, _, _ in s.pose], [0.005] * 3)

    def test_they_are_checked_before_anything_is_written(self):
        before = len(self.daemon.received)
        for V, code, says in (([(1, 2), (3, 4)], 3, "V is 2 x 2, the team has 3 robots; write 3 x 2"),
                              ([(1, 2), (3, math.nan), (5, 6)], 4, "row 1 of V (robot2) must be finite, not 3.0, nan"),
                              ((1, math.inf), 4, "V must be finite, not 1.0, inf"),
                              ([(1, 2), (3,), (5, 6)], 3, "V is 3 x 2 at most"),
                              ([(1, 2, 3)] * 3, 3, "V is 3 x 3"), ([], 3, "V is 0 numbers"), (5, 3, "of numbers only"),
                              ([("a", 1)] * 3, 3, "one row [forward, turn] for each robot"), (range(5), 3, "V is 5 numbers"),
                              (memoryview(b"0123").cast("B", (2, 2)), 3, "V is 2 x 2")):
            with self.subTest(says):
                self.assert_error(code, lambda: self.team.step(V), says)
        self.assert_error(4, lambda: self.team.step_wheels([(1, 2), (3, 4), (5, -math.inf)]), "row 2 of W (robot3)")
        self.assert_error(3, lambda: self.team.select(), "nothing was chosen")
        self.assertEqual(len(self.daemon.received), before)
        self.assert_error(4, lambda: self.team.select("poses"), "there is no reading poses", "there are: pose, distances")


class Readings(FakeTestCase):
    def setUp(self):
        self.sim = self.connect(self.start(mode=1, robots=3))
        self.team = self.sim.team()

    def test_rows_are_tuples_of_numbers(self):
        s = self.team.step((1, 0))
        self.assertEqual((s.step, s.time), (1, 0.01))
        self.assertEqual((s.pose.shape, s.distances.shape), ((3, 3), (3, 11)))
        self.assertEqual(list(s.pose), [(0.01, 0.0, 0.0), (0.01, 1.0, 0.0), (0.01, 2.0, 0.0)])
        self.assertEqual(s.pose[-1], (0.01, 2.0, 0.0))
        self.assertEqual(s.pose[1:], list(s.pose)[1:])
        self.assertEqual(s.distances[0][5], 3.99)
        self.assertEqual(s.distances[0], tuple(self.sim.robot("robot1").get_distances()))
        with self.assertRaises(IndexError):
            s.pose[3]

    def test_only_what_was_chosen_exists(self):
        self.team.select("targets", "wheels")
        s = self.team.read()
        self.assertEqual(s.targets[0][:2], (2.0, 0.0))
        self.assertEqual(s.wheels.shape, (3, 4))
        with self.assertRaises(AttributeError) as caught:
            s.pose
        self.assertIn("team.select('targets', 'wheels', 'pose')", str(caught.exception))

    def test_the_next_step_leaves_them_alone(self):
        first = self.team.step((1, 0))
        self.team.step()
        self.assertEqual(first.pose[0][0], 0.01)

    def test_arrays_share_the_memory(self):
        s = self.team.step((1, 0))
        view = s.distances.__array_interface__
        numbers = memoryview(view["data"])
        (rows, columns), (down, along), at = view["shape"], view["strides"], view["offset"]
        read = [[numbers[(at + i * down + j * along) // 8] for j in range(columns)] for i in range(rows)]
        self.assertEqual([tuple(row) for row in read], list(s.distances))
        self.assertEqual(view["typestr"][1:], "f8")


class Interrupted(FakeTestCase):
    def test_after_a_timeout_the_next_reply_is_the_right_one(self):
        daemon = self.start(mode=1, robots=3)
        sim = self.connect(daemon)
        team = sim.team(["robot1", "robot2"])
        self.assert_error(11, lambda: team.step((0.1, 0), timeout=0.1), "0.1 s", "robot3 (no client)")
        third = sim.robot("robot3")
        for k in range(3):
            third.set_velocity(0.5, 0)
            s = team.step((0.2, 0), timeout=60)
            self.assertEqual(s.step, sim.steps)
        self.assertEqual([r.v for r in daemon.robots], [0.2, 0.2, 0.5])

    def test_after_ctrl_c_the_next_reply_is_the_right_one(self):
        daemon = self.start(mode=1, robots=2)
        team = self.connect(daemon).team("robot1")
        self.interrupt(daemon, lambda: daemon.robots[0].command is not None, lambda: team.step((0.1, 0)))
        self.assertEqual(len(team.read().pose), 1)
        self.assertEqual([r.owner is not None for r in daemon.robots], [True, False])

    def test_an_error_is_raised_and_the_team_goes_on(self):
        daemon = self.start(mode=1, robots=3)
        sim = self.connect(daemon)
        team, third = sim.team(["robot1", "robot2"]), sim.robot("robot3")
        for refused in ("robot2", "", "robot3", ""):
            daemon.refuse = refused
            third.set_velocity(0.3, 0)
            if refused:
                self.assert_error(4, lambda: team.step((0.1, 0), timeout=60), "refused", refused)
            else:
                team.step((0.2, 0), timeout=60)
        self.assertEqual([r.v for r in daemon.robots], [0.2, 0.2, 0.3])

    def test_replies_that_come_byte_by_byte_are_whole(self):
        daemon = self.start(mode=1, robots=2, dribble=True)
        team = self.connect(daemon).team()
        for k in range(3):
            s = team.step((0.1, 0))
            self.assertEqual((s.step, s.distances.shape), (k + 1, (2, 11)))
        team.select("pose")
        self.assertEqual(list(team.step().pose), list(team.read().pose))

    def test_a_daemon_that_dies_is_named(self):
        daemon = self.start(mode=1, robots=2)
        team = self.connect(daemon).team()
        team.step()
        daemon.stop()
        self.assert_error(-1, team.step, "is the daemon still running?")

    def test_a_long_wait_says_once_whom_for(self):
        daemon = self.start(mode=1, robots=2)
        team, other = self.connect(daemon).team("robot1"), self.connect(daemon, name="other", watch=True)
        self.notices_after(0.02)
        words = "coopdyn: waiting for robot2 (no client)"
        said = self.said_until(team.step, words, lambda: other.set_mode("realtime"))
        self.assertEqual(said.count(words), 1, said)


class RunningTwice(FakeTestCase):
    def test_the_same_client_name_takes_over(self):
        daemon = self.start(mode=1, robots=3)
        old = self.connect(daemon).team()
        old.step((0.5, 0))
        sim = self.connect(daemon)
        team = sim.team()
        self.assertEqual(team.names, ["robot1", "robot2", "robot3"])
        self.assert_error(6, lambda: old.step((0.7, 0)), "taken over", "sim.team() takes it again")
        self.assert_error(6, old.read)  # not taken back by itself
        old.close()  # must not stop the robots of the new one
        self.assertEqual(team.step(timeout=60).step, 2)
        self.assertEqual([r.v for r in daemon.robots], [0.5] * 3)

    def test_another_program_is_told_who_owns_a_robot(self):
        daemon = self.start(robots=3)
        self.connect(daemon, name="ana").team(["robot1", "robot3"])
        ben = self.connect(daemon, name="ben")
        self.assert_error(6, lambda: ben.team(["robot2", "robot3"]), "the team with robot3 cannot be driven: robot3 is owned by ana")
        self.assertEqual(ben.team().names, ["robot2"])

    def test_a_team_of_others_than_before_lets_the_former_go(self):
        daemon = self.start(robots=3)
        self.connect(daemon).team()
        team = self.connect(daemon).team("robot2")
        self.assertEqual(team.names, ["robot2"])
        self.assertEqual([r.owner is None for r in daemon.robots], [True, False, True])

    def test_a_robot_that_was_taken_away_is_told_once_and_the_rest_goes_on(self):
        daemon = self.start(mode=0, robots=3)
        team = self.connect(daemon).team()
        daemon.robots[1].owner = None
        self.assert_error(3, lambda: team.step([(0.1, 0)] * 3, timeout=60), "6 numbers for 2 robots")
        self.assertEqual(team.names, ["robot1", "robot3"])
        self.assertEqual(len(team.step([(0.1, 0)] * 2, timeout=60).pose), 2)

    def test_after_a_timeout_a_team_of_all_that_were_free_is_the_same(self):
        daemon = self.start(mode=1, robots=3)
        other = self.connect(daemon, name="other")
        third = other.robot("robot3")
        team = self.connect(daemon).team()
        self.assert_error(11, lambda: team.step(timeout=0.1))
        other.close()
        self.assert_error(11, lambda: team.step(timeout=0.1), "robot3 (no client)")
        self.assertEqual((team.names, third.name), (["robot1", "robot2"], "robot3"))

    def test_two_teams_of_one_program_do_not_take_each_other_over(self):
        daemon = self.start(mode=1, robots=3)
        sim = self.connect(daemon)
        first, second = sim.team("robot1"), sim.team(["robot2", "robot3"])
        first.step((0.1, 0))
        second.step((0.2, 0))
        self.assertEqual([r.v for r in daemon.robots], [0.1, 0.2, 0.2])
        self.assertEqual(sim.steps, 2)
        self.assertIs(sim.team("robot1")._link, first._link)
        again = self.connect(daemon)
        self.assertEqual([again.team("robot1").n, again.team(["robot2", "robot3"]).step().step], [1, 3])

    def test_a_team_that_is_closed_stops_and_can_be_taken_by_others(self):
        daemon = self.start(mode=1, robots=2)
        sim = self.connect(daemon, name="ana")
        team = sim.team()
        team.step((0.3, 0))
        team.close()
        self.assertEqual([(r.v, r.owner) for r in daemon.robots], [(0.0, None)] * 2)
        self.assert_error(5, team.step, "was given up")
        other = self.connect(daemon, name="ben").team()
        other.step((0.3, 0))
        other.release()
        self.assertEqual([(r.v, r.owner) for r in daemon.robots], [(0.3, None)] * 2)
        self.assertEqual(sim.team().n, 2)

    def test_closing_the_sim_stops_and_frees_its_teams(self):
        daemon = self.start(robots=2)
        with coopdyn.connect(daemon.server) as sim:
            team = sim.team()
            team.step((0.3, 0))
        self.assertEqual([(r.v, r.owner) for r in daemon.robots], [(0.0, None)] * 2)
        self.assert_error(-1, team.step, "closed")

    def test_dropped_teams_close_their_sockets_without_the_garbage_collector(self):
        daemon = self.start(robots=2)
        before = len(os.listdir("/proc/self/fd"))
        gc.disable()
        try:
            sim = coopdyn.connect(daemon.server)
            team = sim.team()
            s = team.step((0.1, 0))
            del sim, team
            for t in daemon.threads[2:]:
                t.join(60)
            self.assertEqual(len(os.listdir("/proc/self/fd")), before)
        finally:
            gc.enable()
        self.assertEqual(len(s.pose), 2)

    def test_a_watcher_has_no_team(self):
        self.assert_error(5, self.connect(self.start(), watch=True).team, "only watches")

    def test_names_that_cannot_be_are_told(self):
        sim = self.connect(self.start())
        self.assert_error(3, lambda: sim.team([]), "sim.team()")
        self.assert_error(3, lambda: sim.team("  "), "no names")
        self.assert_error(10, lambda: sim.team(["a/b"]), "'a/b' is not the name of a robot or swarm")


class WithSingleRobots(FakeTestCase):
    def test_a_step_of_the_team_is_one_of_the_single_robots_too(self):
        daemon = self.start(mode=1, robots=3)
        sim = self.connect(daemon)
        r, team = sim.robot("robot1"), sim.team()
        self.assertEqual(team.names, ["robot2", "robot3"])
        for k in range(3):
            r.set_velocity(0.5, 0)
            s = team.step((0.1 * (k + 1), 0), timeout=60)
            self.assertEqual((s.step, r.sense().step), (k + 1, k + 1))
        self.assertEqual(team.step((0, 0), timeout=60).step, 4)  # without a command the single robot keeps its speed
        self.assertEqual([r.v for r in daemon.robots], [0.5, 0.0, 0.0])

    def test_a_step_of_the_sim_is_one_of_the_team_which_keeps_its_speeds(self):
        daemon = self.start(mode=1, robots=3)
        sim = self.connect(daemon)
        team, r = sim.team(["robot1", "robot2"]), sim.robot("robot3")
        team.step([(0.1, 0), (0.2, 0)], timeout=60)
        r.set_velocity(0.3, 0)
        sim.step(timeout=60)
        sim.step(3, timeout=60)
        self.assertEqual(sim.steps, 5)
        self.assertEqual([r.v for r in daemon.robots], [0.1, 0.2, 0.3])
        self.assertEqual(team.read().step, 5)

    def test_in_real_time_each_goes_on(self):
        daemon = self.start(mode=0, robots=2)
        sim = self.connect(daemon)
        r, team = sim.robot(1), sim.team()
        last = -1
        for k in range(3):
            r.set_velocity(0.5, 0)
            s = team.step((0.1, 0), timeout=60)
            self.assertGreater(s.step, last)
            last = s.step
        sim.step(2, timeout=60)
        self.assertGreaterEqual(sim.steps, last + 2)
        self.assertEqual([r.v for r in daemon.robots], [0.5, 0.1])

    def test_a_robot_of_the_team_can_be_read_but_not_driven_singly(self):
        sim = self.connect(self.start(mode=1, robots=2))
        team = sim.team()
        r = sim.robot("robot2")
        self.assertEqual(r.get_pose().y, 1.0)
        self.assert_error(5, lambda: r.set_velocity(1, 0), "robot2 is driven by its team")
        team.step((0.1, 0), timeout=60)
        team.close()
        sim.robot("robot2").set_velocity(0.1, 0)

    def test_a_reset_by_somebody_else_ends_the_wait_and_the_loop_goes_on(self):
        daemon = self.start(mode=1, robots=2)
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        team = sim.team("robot1")
        self.assertEqual(self.reset_in(lambda: team.step((0.1, 0)), daemon, other), [(5, RESET)])
        sim.team("robot2")
        self.assertEqual(team.step((0.1, 0), timeout=60).step, 1)

    def test_after_a_load_the_team_is_asked_for_again(self):
        daemon = self.start(mode=1, robots=3)
        sim = self.connect(daemon)
        team = sim.team()
        del daemon.robots[2]
        sim.load_scenario("smaller")
        self.assertEqual(len(team.step((0.1, 0), timeout=60).pose), 2)
        self.assertEqual(team.names, ["robot1", "robot2"])

    def test_after_a_load_by_somebody_else_the_rows_are_those_there_are(self):
        daemon = self.start(mode=1, robots=3)
        team = self.connect(daemon).team()
        del daemon.robots[2]
        s = team.read()
        self.assertEqual((s.pose.shape, team.n, len(team)), ((2, 3), 2, 2))


class ModuleNeighbours(FakeTestCase):
    def test_a_robot_without_it_says_so(self):
        r = self.connect(self.start()).robot(1)
        for call in (r.get_neighbours, r.get_messages, lambda: r.send_message([1])):
            self.assert_error(5, call, "robot1 has no module neighbours", "minibot")
        self.assert_error(5, r.get_compass, "robot1 has no module compass", "minibot")
        self.assertIsNone(r.sense().compass)

    def test_messages_are_checked_before_anything_is_written(self):
        daemon = self.start()
        r = self.connect(daemon).robot(1)
        before = len(daemon.received)
        for values, code in (([], 3), (range(9), 3), ([math.nan], 4), (["a"], 3), (None, 3)):
            self.assert_error(code, lambda v=values: r.send_message(v))
        self.assertEqual(len(daemon.received), before)


if __name__ == "__main__":
    unittest.main()
