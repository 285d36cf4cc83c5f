# SPDX-License-Identifier: MIT
"""Teams of the Python client against the real daemon."""
import math
import os
import re
import subprocess
import sys
import threading
import unittest

import harness
import coopdyn
from cases import DaemonTestCase
from harness import swarm_of

SINGLE = "[ROBOT_1]\ntype single\nname robot1\nposition -2 -2\n"


class TeamTestCase(DaemonTestCase):
    options = ("--no-http", "--no-render")


class Lockstep(TeamTestCase):
    def test_a_swarm_of_the_scenario_steps_and_is_read(self):
        sim = self.connect(self.start("swarm100"))
        team = sim.team("swarm1")
        self.assertEqual((team.n, team.names[:2], team.ids[:2]), (100, ["mini_1", "mini_2"], [1, 2]))
        before = team.read()
        s = before
        for k in range(20):
            s = team.step([(0.1, 0.0)] * team.n, timeout=60)
            self.assertEqual(s.step, k + 1)
        self.assertEqual((s.pose.shape, s.distances.shape), ((100, 3), (100, 24)))
        self.assertEqual(team.read().pose, s.pose)
        moved = [math.dist(a[:2], b[:2]) for a, b in zip(before.pose, s.pose)]
        self.assertAlmostEqual(sorted(moved)[50], 0.02, delta=0.002)  # 0.1 m/s for 0.2 s

    def test_the_team_does_what_single_robots_would(self):
        daemon = self.start(swarm_of(6))
        V = [(0.02 * (i + 1), 0.3 - 0.1 * i) for i in range(6)]
        with coopdyn.connect(daemon.server) as sim:
            sim.reset(3)
            robots = [sim.robot(f"mini_{i + 1}") for i in range(6)]
            for k in range(50):
                for r, (v, w) in zip(robots, V):
                    r.set_velocity(v, w)
                sim.step(timeout=60)
            singly = sim.hash()
        sim = self.connect(daemon)
        sim.reset(3)
        team = sim.team("mini")
        for k in range(50):
            team.step(V, timeout=60)
        self.assertEqual(sim.hash(), singly)

    def test_rows_are_what_the_robots_say(self):
        sim = self.connect(self.start(swarm_of(5)))
        team = sim.team()
        team.select("wheels", "pose", "targets", "distances", "neighbours", "compass", neighbours=3)
        s = team.step((0.1, 0.3), timeout=60)
        for i, name in enumerate(team.names):
            r = sim.robot(name)
            self.assertEqual(s.pose[i], tuple(r.get_pose())[:3])
            self.assertEqual(s.distances[i], tuple(r.get_distances()))
            self.assertEqual(s.wheels[i], tuple(r.get_wheels()))
            self.assertEqual(s.compass[i], (r.get_compass(),))
            self.assertEqual(r.get_compass(), r.get_pose().heading)
            self.assertEqual(r.sense().compass, r.get_compass())
            self.assertEqual(s.targets[i], tuple(r.get_target("red")))
            nearest = sorted(r.get_neighbours(), key=lambda o: o.distance)[:3]
            seen = [x for o in nearest for x in (o.id, o.distance, o.bearing)] + [0, math.inf, math.nan] * (3 - len(nearest))
            self.assertEqual([str(float(x)) for x in seen], [str(x) for x in s.neighbours[i]])

    def test_speeds_beyond_the_limit_are_told(self):
        team = self.connect(self.start(swarm_of(3))).team()
        self.assertEqual(team.step([(0.1, 0), (9, 0), (9, 9)], timeout=60).text, "limited 2 robots")

    def test_a_robot_beside_the_team_steps_with_it(self):
        sim = self.connect(self.start(swarm_of(4, SINGLE)))
        r = sim.robot("robot1")
        team = sim.team()
        self.assertEqual(team.n, 4)
        for k in range(10):
            r.set_velocity(0.2, 0)
            self.assertEqual(team.step((0.1, 0), timeout=60).step, k + 1)
        sim.step(5, timeout=60)
        self.assertEqual((sim.steps, team.read().step), (15, 15))
        self.assertGreater(r.get_pose().x, -2)

    def test_messages_go_from_robot_to_robot(self):
        text = swarm_of(2, "area 0 0 1 1\n")
        sim = self.connect(self.start(text))
        first, second = sim.robot("mini_1"), sim.robot("mini_2")
        self.assertEqual([o.name for o in first.get_neighbours()], ["mini_2"])
        first.send_message([1, -2.5])
        for k in range(20):
            sim.step(timeout=60)
            heard = second.get_messages()
            if heard:
                break
        self.assertEqual([(m.id, m.values) for m in heard], [(1, [1.0, -2.5])])
        self.assertEqual((heard[0].distance, heard[0].bearing), second.get_neighbours()[0][2:])

    def test_a_robot_freed_by_the_teacher_leaves_the_team_which_says_so(self):
        daemon = self.start(swarm_of(3))
        team = self.connect(daemon).team()
        teacher = self.connect(daemon, name="teacher")
        teacher.call("/simulation", "release_robot", text="mini_2")
        with self.assertRaises(coopdyn.Error) as caught:
            team.step([(0.1, 0)] * 3, timeout=60)
        self.assertIn("mini_2", caught.exception.text)
        self.assertEqual(team.names, ["mini_1", "mini_3"])
        teacher.robot("mini_2")
        waiting = threading.Thread(target=lambda: teacher.step(timeout=60))
        waiting.start()
        self.assertEqual(len(team.step([(0.1, 0)] * 2, timeout=60).pose), 2)
        waiting.join()

    def test_running_twice_takes_the_team_over(self):
        daemon = self.start(swarm_of(3))
        old_sim = coopdyn.connect(daemon.server, name="ana")
        self.addCleanup(old_sim.close)
        old = old_sim.team("swarm1")
        old.step((0.1, 0), timeout=60)
        team = self.connect(daemon, name="ana").team("swarm1")
        self.assertEqual(team.step((0.1, 0), timeout=60).step, 2)
        with self.assertRaises(coopdyn.Error) as caught:
            old.step((0.1, 0), timeout=60)
        self.assertEqual(caught.exception.code, 6)
        self.assertIn('sim.team("swarm1") takes it again', caught.exception.text)

    def test_a_robot_of_somebody_else_is_told(self):
        daemon = self.start(swarm_of(3))
        self.connect(daemon, name="ben").robot("mini_2")
        sim = self.connect(daemon, name="ana")
        with self.assertRaises(coopdyn.Error) as caught:
            sim.team("swarm1")
        self.assertEqual(caught.exception.code, 6)
        self.assertRegex(caught.exception.text, "mini_2.*ben")
        self.assertEqual(sim.team().names, ["mini_1", "mini_3"])

    def test_unknown_names_are_told(self):
        with self.assertRaises(coopdyn.Error) as caught:
            self.connect(self.start(swarm_of(3))).team(["mini_1", "minni_2"])
        self.assertEqual(caught.exception.code, 10)
        self.assertIn("mini_2", caught.exception.text)

    def test_after_a_timeout_the_next_reply_is_the_right_one(self):
        daemon = self.start(swarm_of(3, SINGLE))
        sim = self.connect(daemon)
        team = sim.team("swarm1")
        with self.assertRaises(coopdyn.Error) as caught:
            team.step((0.1, 0), timeout=0.1)
        self.assertEqual(caught.exception.code, 11)
        self.assertIn("robot1 (no client)", caught.exception.text)
        sim.robot("robot1")
        for k in range(5):
            s = team.step((0.1, 0), timeout=60)
            self.assertEqual((s.step, s.pose), (sim.steps, team.read().pose))

    def test_another_scenario_has_other_rows(self):
        sim = self.connect(self.start(swarm_of(4)))
        team = sim.team("mini")
        team.step((0.1, 0), timeout=60)
        sim.load_scenario(swarm_of(2))
        s = team.step((0.1, 0), timeout=60)
        self.assertEqual((s.step, s.pose.shape, team.n), (1, (2, 3), 2))
        sim.load_scenario(harness.scenario_of(1))
        with self.assertRaises(coopdyn.Error) as caught:
            team.step((0.1, 0), timeout=60)
        self.assertEqual(caught.exception.code, 10)

    def test_after_a_load_a_team_is_at_once_whom_it_means_now(self):
        sim = self.connect(self.start(swarm_of(4)))
        for n in (4, 2, 3):
            sim.load_scenario(swarm_of(n))
            for names in (None, "mini"):
                team = sim.team(names)
                self.assertEqual((team.n, len(team.names), len(team.ids)), (n, n, n))
                self.assertEqual(team.step([(0.1, 0)] * team.n, timeout=60).pose.shape, (n, 3))
                team.close()

    def test_after_a_load_a_team_that_is_not_used_any_more_takes_nobody(self):
        sim = self.connect(self.start(swarm_of(4)))
        old = sim.team()
        old.step((0.1, 0), timeout=60)
        sim.load_scenario(swarm_of(2))
        team = sim.team("swarm1")
        self.assertEqual(team.step((0.1, 0), timeout=60).pose.shape, (2, 3))
        with self.assertRaises(coopdyn.Error) as caught:
            old.step((0.1, 0), timeout=60)
        self.assertIn("belongs to your team swarm1" if caught.exception.code == 6 else "free", caught.exception.text)

    def test_robots_of_a_large_swarm_are_all_listed(self):
        sim = self.connect(self.start(swarm_of(600, floor=40)))
        names = sim.robots()
        self.assertEqual((len(names), names[0], names[599]), (600, "mini_1", "mini_600"))
        team = sim.team()
        self.assertEqual(team.names, names)
        self.assertEqual(team.step((0.1, 0.0), timeout=60).distances.shape[0], 600)


class Program(TeamTestCase):
    def test_swarm_spreads(self):
        daemon = self.start("swarm100")
        run = subprocess.run([sys.executable, str(harness.ROOT / "clients" / "python" / "swarm.py"), "swarm1"], timeout=110,
                             text=True, capture_output=True, env=dict(os.environ, COOPDYN_SERVER=daemon.server))
        self.assertEqual(run.returncode, 0, run.stderr)
        said = re.fullmatch(r"100 robots went ([\d.]+) m on average in 10.00 s\n", run.stdout)
        self.assertGreater(float(said.group(1)), 0.3)


class OtherModes(TeamTestCase):
    def test_a_step_is_waited_for_in_real_time_and_free(self):
        for mode in ("realtime", "free"):
            with self.subTest(mode):
                sim = self.connect(self.start(swarm_of(3, SINGLE, mode)))
                r, team = sim.robot("robot1"), sim.team()
                last = -1
                for k in range(5):
                    r.set_velocity(0.2, 0)
                    s = team.step((0.1, 0), timeout=60)
                    self.assertGreater(s.step, last)
                    last = s.step
                sim.step(2, timeout=60)
                self.assertGreaterEqual(sim.steps, last + 2)
                team.stop()

    def test_a_mode_switched_by_somebody_else_neither_hangs_nor_spins(self):
        daemon = self.start(swarm_of(3))
        team, teacher = self.connect(daemon).team(), self.connect(daemon, name="teacher")
        for mode in ("realtime", "lockstep", "free", "lockstep"):
            teacher.set_mode(mode)
            steps = [team.step((0.1, 0), timeout=60).step for k in range(4)]
            self.assertEqual(steps, sorted(set(steps)))

    def test_closing_stops_the_team(self):
        daemon = self.start(swarm_of(2, mode="realtime"))
        sim, other = self.connect(daemon, name="ana"), self.connect(daemon, name="ben")
        team = sim.team()
        team.step((0.2, 0), timeout=60)
        team.close()
        mine = other.team()
        mine.select("wheels")
        s = mine.step(timeout=60)
        for k in range(200):
            s = mine.step(timeout=60)
            if max(abs(x) for row in s.wheels for x in row[2:]) < 1e-3:
                break
        self.assertLess(max(abs(x) for row in s.wheels for x in row[2:]), 1e-3)


if __name__ == "__main__":
    unittest.main()
