# SPDX-License-Identifier: MIT
"""Failures between a program and the daemon, produced by the scripted daemon."""
import contextlib
import gc
import io
import os
import socket
import subprocess
import sys
import threading
import traceback
import unittest

import harness
import coopdyn
from cases import RESET, FakeTestCase


class RunningTwice(FakeTestCase):
    def test_the_same_client_name_takes_over(self):
        daemon = self.start(mode=1)
        old = self.connect(daemon)
        old_robot = old.robot("robot1")
        new = self.connect(daemon)
        new_robot = new.robot("robot1")
        new_robot.set_velocity(0.1, 0)
        new.step()
        self.assertEqual(new.steps, 1)
        old_robot.set_velocity(0.5, 0)
        self.assert_error(6, old.step, "taken over", 'sim.robot("robot1")')
        self.assert_error(6, lambda: old_robot.set_velocity(0.5, 0))  # not taken back by itself
        new.step()
        old.close()  # must not stop the robot of the new one
        self.assertEqual(new_robot.get_pose().forward, 0.1)

    def test_another_program_is_told_who_owns_the_robot(self):
        daemon = self.start()
        self.connect(daemon, name="ana").robot(1)
        self.assert_error(6, lambda: self.connect(daemon, name="ben").robot(1), "robot1", "ana", "watch=True")

    def test_a_second_process_runs_after_the_first_has_died(self):
        daemon = self.start(mode=1)
        program = ("import coopdyn\nsim = coopdyn.connect()\nr = sim.robot(1)\nr.set_velocity(0.1, 0)\nsim.step()\n"
                   "print(sim.steps)\nimport os; os._exit(3)")
        env = dict(os.environ, COOPDYN_SERVER=daemon.server, PYTHONPATH=str(harness.ROOT / "clients" / "python"))
        for steps in (1, 2):
            run = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True, timeout=60)
            self.assertEqual((run.stdout.strip(), run.returncode), (str(steps), 3), run.stderr)

    def test_dropped_objects_close_their_sockets_without_the_garbage_collector(self):
        daemon = self.start()
        before = len(os.listdir("/proc/self/fd"))
        gc.disable()
        try:
            sim = coopdyn.connect(daemon.server)
            r = sim.robot(1)
            r.get_pose(), r.sense(), r.subscribe("pose")
            ours = len([c for c in daemon.connections if c.module])
            del sim
            r.get_pose()  # a robot works without its sim
            del r
            with daemon.lock:  # the peers notice the close
                self.assertTrue(daemon.lock.wait_for(lambda: all(not x.every for x in daemon.connections), 10))
        finally:
            gc.enable()
        self.assertGreaterEqual(ours, 4)
        for t in daemon.threads[2:]:
            t.join(10)
        self.assertEqual(len(os.listdir("/proc/self/fd")), before)

    def test_a_robot_freed_by_the_teacher_is_not_taken_back(self):
        daemon = self.start(mode=1)
        sim = self.connect(daemon)
        r = sim.robot(1)
        self.connect(daemon, name="teacher").call("/simulation", "release_robot", text="robot1")
        r.set_velocity(0.1, 0)
        self.assert_error(6, sim.step, "freed by the teacher")
        self.assertIsNone(daemon.robots[0].owner)
        sim.robot(1)
        self.assertIsNotNone(daemon.robots[0].owner)


class TwoThreads(FakeTestCase):
    def test_on_one_sim_at_the_same_time_are_told_the_rule(self):
        daemon = self.start(mode=1, robots=2)
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        r, theirs = sim.robot(1), other.robot(2)
        stepping = threading.Thread(target=sim.step)
        stepping.start()
        with daemon.lock:
            self.assertTrue(daemon.lock.wait_for(lambda: daemon.robots[0].command is not None, 60))
        for call in (r.get_pose, sim.step, sim.status, sim.close, r.sense, lambda: r.set_velocity(0, 0), lambda: sim.mode,
                     lambda: sim.dt, lambda: sim.robot(1)):
            self.assert_error(5, call, "another thread", "connect()")
        self.assertEqual(sim.steps, 0)  # the last reply stays readable
        theirs.set_velocity(0.1, 0)
        other.step(timeout=60)
        stepping.join()
        self.assertEqual(r.get_pose().forward, 0.0)

    def test_one_after_the_other_may_use_a_sim(self):
        sim = self.connect(self.start(mode=1))
        r = sim.robot(1)
        for _ in range(2):
            thread = threading.Thread(target=lambda: (r.set_velocity(0.1, 0), sim.step(timeout=60)))
            thread.start()
            thread.join()
        self.assertEqual((sim.steps, r.get_pose().forward), (2, 0.1))


class Tracebacks(FakeTestCase):
    def test_show_the_line_of_the_program_and_nothing_of_the_inside(self):
        daemon = self.start(mode=1)
        sim = self.connect(daemon)
        r = sim.robot(1)
        sim.step(timeout=60)
        self.connect(daemon, name="other").reset()
        r.set_velocity(0.1, 0)
        for call in (lambda: sim.step(timeout=60), lambda: sim.robot(7), lambda: sim.set_mode("quick"), lambda: r.sense("pink"),
                     lambda: r.get_target("pink"), lambda: coopdyn.connect("localhost:1"),
                     lambda: r.set_velocity("fast", 0), lambda: r.set_velocity()):
            shown = ""
            try:
                call()
            except coopdyn.Error:
                shown = traceback.format_exc()
            self.assertEqual(shown.count("Traceback"), 1, shown)
            self.assertEqual(shown.count('coopdyn.py", line'), 1, shown)


class Interrupted(FakeTestCase):
    def test_after_a_timeout_the_next_reply_is_the_right_one(self):
        daemon = self.start(mode=1, robots=2)
        sim = self.connect(daemon)
        r = sim.robot(1)
        r.set_velocity(0.1, 0)
        self.assert_error(11, lambda: sim.step(timeout=0.1), "0.1 s", "robot2 (no client)")
        other = self.connect(daemon, name="other")
        other.robot(2)
        r.set_velocity(0.3, 0)
        stepped = threading.Event()

        def go_on():  # the timed-out command may still run, as a separate step
            while not stepped.is_set():
                try:
                    other.step(timeout=0.1)
                except coopdyn.Error:
                    pass

        going_on = threading.Thread(target=go_on)
        going_on.start()
        sim.step(timeout=60)
        stepped.set()
        going_on.join()
        self.assertEqual(r.get_pose().forward, 0.3)  # the last command, not the one that timed out
        self.assertEqual(r.get_wheels().left_speed, 0.3)

    def test_after_ctrl_c_in_a_step_the_next_reply_is_the_right_one(self):
        daemon = self.start(mode=1, robots=2)
        sim = self.connect(daemon)
        r = sim.robot(1)
        self.interrupt(daemon, lambda: daemon.robots[0].command is not None, sim.step)
        self.assertEqual(sim.call("/robot1/motors", "get_limits").command, 13)
        self.assertEqual(r.get_wheels().left_speed, 0.0)
        self.assertIsNotNone(daemon.robots[0].owner)

    def test_after_ctrl_c_in_a_reading_the_next_reply_is_the_right_one(self):
        daemon = self.start()
        daemon.hold = True
        sim = self.connect(daemon)
        r = sim.robot(1)
        self.interrupt(daemon, lambda: any(command == 40 for _, command, _, _ in daemon.received), r.get_pose)
        with daemon.lock:
            daemon.hold = False
            daemon.lock.notify_all()
        self.assertEqual(len(r.get_pose_3d()), 13)
        self.assertEqual(len(r.get_pose()), 5)

    def test_a_reading_whose_connection_breaks_is_asked_for_again(self):
        daemon = self.start()
        r = self.connect(daemon).robot(1)
        r.get_pose()
        daemon.break_replies = 1
        self.assertEqual(r.get_pose().x, 0.0)

    def test_replies_that_come_byte_by_byte_are_whole(self):
        daemon = self.start(mode=1, dribble=True)
        sim = self.connect(daemon)
        r = sim.robot(1)
        for k in range(3):
            self.assertEqual(len(r.sense().distances), 11)
            r.set_velocity(0.1, 0)
            sim.step()
        self.assertEqual(sim.steps, 3)


class Connecting(FakeTestCase):
    def test_nothing_listens_says_how_to_start_the_daemon(self):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))  # and does not listen
            port = s.getsockname()[1]
            self.assert_error(-1, lambda: coopdyn.connect(f"127.0.0.1:{port}"), "nothing listens", "coopdyn serve", "COOPDYN_SERVER")

    def test_a_silent_server_is_given_up(self):
        daemon = self.start(silent=True)
        self.assert_error(11, lambda: coopdyn.connect(daemon.server, timeout=0.2), "does not answer", "coopdyn status")

    def test_dropped_packets_are_given_up(self):
        with socket.socket() as full:
            full.bind(("127.0.0.1", 0))
            full.listen(0)
            port = full.getsockname()[1]
            crowd = [socket.socket() for _ in range(4)]
            for s in crowd:
                s.setblocking(False)
                s.connect_ex(("127.0.0.1", port))
            self.assert_error(11, lambda: coopdyn.connect(f"127.0.0.1:{port}", timeout=0.2), "within 0.2 s", "firewall")
            for s in crowd:
                s.close()

    def test_something_else_that_listens_is_named(self):
        daemon = self.start(says="SSH-2.0-OpenSSH")
        self.assert_error(-1, lambda: coopdyn.connect(daemon.server), "not a coopdyn daemon", "SSH-2.0")

    def test_another_protocol_says_where_to_get_the_client(self):
        daemon = self.start(protocol=2)
        self.assert_error(5, lambda: coopdyn.connect(daemon.server), "protocol 2", "take the coopdyn.py")

    def test_a_server_that_cannot_be_read_says_what_to_write(self):
        for server in ("host:port", "host:0", "host:99999", ":"):
            self.assert_error(4, lambda s=server: coopdyn.connect(s), "HOST:PORT")

    def test_an_unknown_robot_names_those_there_are(self):
        sim = self.connect(self.start(robots=2))
        self.assert_error(10, lambda: sim.robot("robbot"), "robot1, robot2")
        self.assert_error(10, lambda: sim.robot(3), "robot1, robot2")

    def test_the_server_comes_from_the_environment(self):
        daemon = self.start()
        os.environ["COOPDYN_SERVER"] = daemon.server
        self.addCleanup(os.environ.pop, "COOPDYN_SERVER")
        with coopdyn.connect() as sim:
            self.assertEqual(sim.robots(), ["robot1"])

    def test_doctor_says_ok_or_cause_and_cure(self):
        for options, ok, says in (({}, True, "round trip"), ({"protocol": 2}, False, "take the coopdyn.py"),
                                  ({"says": "220 ftp"}, False, "not a coopdyn daemon"),
                                  ({"says": "*** end of message"}, False, "not a coopdyn daemon")):
            with self.subTest(says), contextlib.redirect_stdout(io.StringIO()) as out:
                self.assertEqual(coopdyn.doctor(self.start(**options).server), ok)
            self.assertIn(says, out.getvalue())
            self.assertEqual("FAIL" in out.getvalue(), not ok)
            self.assertNotIn("names: 0", out.getvalue())


class Stepping(FakeTestCase):
    def test_a_long_wait_says_once_whom_for(self):
        daemon = self.start(mode=1, robots=2)
        sim, other = self.connect(daemon), self.connect(daemon, name="other", watch=True)
        sim.robot(1)
        self.assertEqual(coopdyn._NOTICE_AFTER_S, 2.0)
        self.notices_after(0.02)
        said = self.said_until(sim.step, "robot2 (no client)", lambda: other.set_mode("realtime"))
        self.assertEqual(said.count("coopdyn: waiting for"), 1, said)
        self.assertIn("robot2 (no client)", said)

    def test_in_lockstep_the_last_command_wins_and_nothing_is_sent_before_the_step(self):
        daemon = self.start(mode=1)
        sim = self.connect(daemon)
        r = sim.robot(1)
        r.set_velocity(0.1, 0)
        r.set_velocity(0.2, 0.5)
        self.assertEqual([x for x in daemon.received if x[1] == 11], [])
        sim.step()
        self.assertEqual([x[2:] for x in daemon.received if x[1] == 11], [((1,), (0.2, 0.5))])
        sim.step(3)
        self.assertEqual(sim.steps, 4)
        self.assertEqual(daemon.received[-1][1:], (2, (3,), ()))

    def test_one_refused_robot_of_five_never_hangs_the_loop(self):
        daemon = self.start(mode=1, robots=5)
        sim = self.connect(daemon)
        robots = [sim.robot(i + 1) for i in range(5)]
        for refused in ("robot3", "robot1", "", "robot5", ""):
            daemon.refuse = refused
            for k, r in enumerate(robots):
                r.set_velocity(0.1 * (k + 1), 0)
            if refused:
                self.assert_error(4, lambda: sim.step(timeout=60), refused)
            else:
                sim.step(timeout=60)
        self.assertGreaterEqual(sim.steps, 2)  # a command that had not run may still run before its successor
        self.assertEqual([r.get_pose().forward for r in robots], [0.1 * (k + 1) for k in range(5)])

    def test_a_mode_switched_to_lockstep_by_somebody_else_does_not_hang(self):
        daemon = self.start(mode=0)
        sim = self.connect(daemon)
        r = sim.robot(1)
        r.set_velocity(0.1, 0)
        sim.step()
        with daemon.lock:
            daemon.mode = 1
            daemon.lock.notify_all()
        for k in range(4):
            r.set_velocity(0.2, 0)
            r.get_wheels()
            sim.step(timeout=60)
        self.assertEqual(r.get_pose().forward, 0.2)

    def test_a_mode_switched_to_real_time_by_somebody_else_does_not_spin(self):
        daemon = self.start(mode=1)
        sim = self.connect(daemon)
        r = sim.robot(1)
        sim.step()
        with daemon.lock:
            daemon.mode = 0
            daemon.lock.notify_all()
        steps = [sim.steps]
        for k in range(5):
            r.set_velocity(0.1, 0)
            sim.step(timeout=60)
            steps.append(sim.steps)
        self.assertEqual(steps, sorted(set(steps)))

    def test_in_real_time_a_late_reply_is_not_taken_for_the_next(self):
        daemon = self.start(mode=0, delay_s=0.25)
        sim = self.connect(daemon)
        r = sim.robot(1)
        for k in range(3):
            r.set_velocity(0.1 * (k + 1), 0)
            self.assertEqual(r.get_limits().track, 0.28)
        sim.step(timeout=60)
        self.assertEqual([x[3] for x in daemon.received if x[1] == 11], [(0.1, 0.0), (0.2, 0.0), (0.1 * 3, 0.0)])

    def test_commands_are_checked_before_anything_is_written(self):
        daemon = self.start()
        r = self.connect(daemon).robot(1)
        received = len(daemon.received)
        self.assert_error(4, lambda: r.set_velocity(float("nan"), 0), "v [m/s]")
        self.assert_error(4, lambda: r.set_wheel_speeds(0, float("inf")), "r [rad/s]")
        self.assert_error(3, lambda: r.set_velocity("fast", 0))
        self.assert_error(3, lambda: r.set_velocity([1, 2], 0))
        self.assertEqual(len(daemon.received), received)

    def test_watching_takes_nothing_over_from_a_driver_in_the_same_process(self):
        daemon = self.start(mode=1)
        sim = self.connect(daemon)
        r = sim.robot(1)
        self.connect(daemon, watch=True).robot(1).sense()
        r.set_velocity(0.1, 0)
        sim.step(timeout=60)
        self.assertEqual(r.get_pose().forward, 0.1)

    def test_watching_claims_nothing_and_waits_for_steps(self):
        daemon = self.start(mode=0)
        sim = self.connect(daemon, watch=True)
        r = sim.robot(1)
        sim.step()
        first = sim.steps
        sim.step()
        self.assertGreater(sim.steps, first)
        self.assertEqual(len(r.sense().distances), 11)
        self.assertIsNone(daemon.robots[0].owner)
        self.assert_error(5, lambda: r.set_velocity(0, 0), "only watches")

    def test_a_reset_by_somebody_else_ends_the_wait_and_the_loop_goes_on(self):
        daemon = self.start(mode=1, robots=2)
        sim = self.connect(daemon)
        sim.robot(1)
        other = self.connect(daemon, name="other")
        self.assertEqual(self.reset_in(sim.step, daemon, other), [(5, RESET)])
        sim.robot(2)
        sim.step(timeout=60)
        self.assertEqual(sim.steps, 1)

    def test_closing_stops_and_frees_the_robots_of_this_sim(self):
        daemon = self.start(robots=2)
        sim = coopdyn.connect(daemon.server)
        sim.robot(1).set_velocity(0.5, 0)
        sim.close()
        for t in daemon.threads[2:]:
            t.join(10)
        self.assertEqual((daemon.robots[0].v, daemon.robots[0].owner), (0.0, None))
        self.assert_error(-1, sim.step, "closed")

    def test_raw_calls_know_commands_by_name(self):
        sim = self.connect(self.start())
        self.assertEqual(sim.call("/robot1/motors", "ping", [1, 2], [0.5]).data, [0.5])
        self.assertEqual(sim.robot(1).call("motors", 13).data, [10.0, 0.075, 0.28])
        self.assert_error(1, lambda: sim.call("/robot1/pose", "set_velocity"), "get_pose")

    def test_asking_about_a_module_does_not_take_it_over(self):
        daemon = self.start(mode=1)
        sim = self.connect(daemon)
        sim.robot(1)
        owner = daemon.robots[0].owner
        sim.describe("/robot1/motors")
        sim.call("/robot1/motors", "get_wheels")
        self.assertIs(daemon.robots[0].owner, owner)


if __name__ == "__main__":
    unittest.main()
