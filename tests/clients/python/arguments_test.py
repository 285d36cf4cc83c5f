# SPDX-License-Identifier: MIT
"""Calls with arguments that do not fit say what to write; two speeds may be one row; a number is a port."""
import array
import os
import unittest
from unittest import mock

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn
from cases import FakeTestCase


class Arguments(FakeTestCase):
    def setUp(self):
        self.daemon = self.start(mode=1)
        self.sim = self.connect(self.daemon)
        self.r = self.sim.robot(1)

    def driven(self):
        self.sim.step(timeout=60)
        p = self.r.get_pose()
        return round(p.forward, 9), round(p.turn, 9)

    def test_two_speeds_may_be_one_row(self):
        rows = [[0.2, 0.5], (0.2, 0.5), array.array("d", [0.2, 0.5]), [[0.2, 0.5]]]
        try:
            import numpy
            rows += [numpy.array([0.2, 0.5]), numpy.array([[0.2, 0.5]])]
        except ImportError:
            pass
        for row in rows:
            with self.subTest(row=row):
                self.r.stop()
                self.driven()
                self.r.set_velocity(row)
                self.assertEqual(self.driven(), (0.2, 0.5))
        self.r.set_wheel_speeds([2, 2])
        self.assertEqual(self.driven(), (0.15, 0.0))

    def test_a_row_of_another_length_says_what_to_write(self):
        for call in (lambda: self.r.set_velocity(0.2), lambda: self.r.set_velocity([1, 2, 3]), lambda: self.r.set_velocity([]),
                     lambda: self.r.set_velocity("ab" * 3)):
            self.assert_error(3, call, "v [m/s] and w [rad/s]", "write r.set_velocity(0.2, 0.5) or r.set_velocity([0.2, 0.5])")
        self.assert_error(3, lambda: self.r.set_wheel_speeds(2), "write r.set_wheel_speeds(0.2, 0.5)")
        self.assert_error(3, lambda: self.r.set_velocity("ab"), "v [m/s] must be one number")

    def test_a_call_without_its_arguments_says_what_to_write(self):
        sim, r = self.sim, self.r
        for call, example in (
            (r.set_velocity, "r.set_velocity(0.2, 0.5)"), (r.set_wheel_speeds, "r.set_wheel_speeds(2, 3)"),
            (r.send_message, "r.send_message([1, 0.5])"), (r.get_target, 'r.get_target("red") or r.get_target(1)'),
            (r.subscribe, 'r.subscribe("distance")'), (r.call, 'r.call("motors"'), (sim.robot, 'sim.robot("robot1")'),
            (sim.load_scenario, 'sim.load_scenario("corridor")'), (sim.set_mode, 'sim.set_mode("lockstep")'),
            (sim.set_step, "sim.set_step(0.01)"), (sim.set_speed, "sim.set_speed(2)"),
            (sim.release_robot, 'sim.release_robot("robot1")'), (sim.save_state, "sim.save_state("),
            (sim.restore_state, "sim.restore_state("), (sim.note, 'sim.note("half-time")'),
            (sim.fetch_run, 'sim.fetch_run("lesson1")'), (sim.seek, "sim.seek(12.5)"),
            (sim.set_play_speed, "sim.set_play_speed(2)"), (sim.set_loop, "sim.set_loop(True)"),
            (sim.snapshot, 'sim.snapshot("a.png")'), (sim.describe, "sim.describe("), (sim.call, "sim.call("),
            (coopdyn.read_run, "coopdyn.read_run("),
            (lambda: coopdyn.connect(host="a"), "coopdyn.connect("),
            (lambda: sim.set_participants("robot1", "robot2"), 'sim.set_participants(["robot1", "robot2"])'),
            (lambda: sim.team("robot1", "robot2"), 'sim.team("swarm1"), sim.team(["robot1", "robot2"])'),
        ):
            with self.subTest(example):
                self.assert_error(2, call, f"write {example}")

    def test_every_call_with_too_many_arguments_says_what_to_write(self):
        for variable, cls in (("r", coopdyn.Robot), ("sim", coopdyn.Simulation), ("team", coopdyn.Team), ("run", coopdyn.Run)):
            for name, call in vars(cls).items():
                if name.startswith("_") or not callable(call) or name == "select":  # which takes any number
                    continue
                with self.subTest(f"{variable}.{name}"):
                    self.assert_error(2, lambda: call(*range(20)), f"too many arguments: write {variable}.{name}(")
        for name in ("connect", "doctor", "read_run"):
            self.assert_error(2, lambda: getattr(coopdyn, name)(*range(20)), f"too many arguments: write coopdyn.{name}(")

    def test_an_argument_of_another_name_is_told(self):
        self.assert_error(2, lambda: self.sim.step(steps=2), "'steps': write sim.step(), sim.step(10)")

    def test_what_the_daemon_would_refuse_is_told_in_words_of_the_client(self):
        sim, r = self.sim, self.r
        self.daemon.received.clear()
        for code, call, says in (
            (3, lambda: sim.load_scenario(""), 'no scenario: write sim.load_scenario("corridor")'),
            (4, lambda: sim.set_step(5), "a step lasts 0.0005 to 0.1 s, not 5: write sim.set_step(0.01)"),
            (4, lambda: sim.set_step(0.0012346), "whole microseconds, not 0.0012346 s: write sim.set_step(0.001235)"),
            (4, lambda: sim.reset(-1), "a seed is at least 0, not -1: write sim.reset(7)"),
            (4, lambda: sim.step(20000000), "n must be at most 10000000, not 20000000: write sim.step("),
            (3, lambda: sim.note(""), 'no note: write sim.note("half-time")'),
            (4, lambda: sim.save_state("1st"), 'a letter, then letters, digits, _ and -, at most 63: write sim.save_state("'),
            (4, lambda: sim.play(65), "not 65: write sim.play(2)"),
            (4, lambda: sim.set_play_speed(0), "not 0: write sim.play(2), or sim.pause()"),
            (4, lambda: sim.skip(0), "not 0: write sim.skip(1)"),
            (3, lambda: r.get_target(""), "a target is a colour or an id, not ''; write r.get_target(\"red\")"),
        ):
            with self.subTest(says):
                self.assert_error(code, call, says)
        self.assertEqual(self.daemon.received, [])

    def test_what_the_daemon_takes_at_its_limits_is_sent(self):
        for step_s in (0.0005, 0.000501, 0.033333, 0.1):
            self.sim.set_step(step_s)
            self.assertEqual(self.sim.dt, step_s)
        self.sim.reset(0)

    def test_an_argument_of_another_kind_says_what_it_must_be(self):
        sim, r = self.sim, self.r
        for code, call, says in (
            (3, lambda: r.get_target(None), 'r.get_target("red") or r.get_target(1)'),
            (3, lambda: r.get_target(["red"]), 'r.get_target("red")'),
            (3, lambda: sim.robot(["robot1"]), 'sim.robot("robot1")'),
            (3, lambda: sim.robot(None), 'sim.robot("robot1")'),
            (3, lambda: sim.load_scenario(5), "a scenario is a text, not 5"),
            (3, lambda: sim.set_participants(5), "sim.set_participants(["),
            (3, lambda: sim.set_participants([r]), "sim.set_participants(["),
            (3, lambda: sim.snapshot(5), "the name of a file is a text"),
            (3, lambda: sim.fetch_run("a", 5), "the name of a file is a text"),
            (3, lambda: sim.describe(5), '"/robot1/motors"'),
            (3, lambda: sim.call(5, "stop"), '"/robot1/motors"'),
            (2, lambda: sim.call("/robot1/motors", "stop", 5), "a list of whole numbers"),
            (4, lambda: sim.call("/robot1/motors", "stop", [2**31]), "a param"),
            (3, lambda: sim.call("/robot1/motors", "stop", data=5), "a list of numbers"),
            (2, lambda: sim.call("/robot1/motors", "stop", text=5), "text is a text"),
            (3, lambda: r.subscribe(["pose"]), '"distance"'),
            (3, lambda: sim.step(timeout="long"), "timeout [s] must be one number"),
            (2, lambda: sim.reset("a"), "a seed must be a whole number"),
            (3, lambda: coopdyn.read_run(5), "the name of a recording is a text"),
            (3, lambda: coopdyn.connect(self.daemon.server, name=5), "a client name"),
        ):
            with self.subTest(says):
                self.assert_error(code, call, says)

    def test_a_number_that_no_double_holds_is_told(self):
        self.assert_error(4, lambda: self.sim.set_speed(10**400), "the speed factor is too large")

    def test_a_number_of_steps_beyond_32_bits_is_named_as_such(self):
        self.assert_error(4, lambda: self.sim.step(2**31), "32 bits", "2147483648")
        self.assert_error(4, lambda: self.sim.step(0), "n must be at least 1, not 0")
        self.assert_error(4, lambda: self.sim.reset(2**31), "32 bits")

    def test_numbers_like_numpys_count_as_whole(self):
        class Whole:
            def __index__(self):
                return 1

        self.assertEqual(self.sim.robot(Whole()).name, "robot1")
        self.sim.step(Whole(), timeout=60)

    def test_an_error_of_type_inside_a_call_stays_what_it_is(self):
        with mock.patch.object(self.sim._session, "robot_names", side_effect=TypeError("ours")):
            with self.assertRaisesRegex(TypeError, "^ours$"):
                self.sim.robot(1)

    def test_a_number_as_server_is_a_port_of_this_machine(self):
        with mock.patch.dict(os.environ):
            os.environ.pop("COOPDYN_SERVER", None)
            for server in (self.daemon.port, str(self.daemon.port)):
                sim = coopdyn.connect(server)
                self.addCleanup(sim.close)
                self.assertEqual(sim.robots(), ["robot1"])
        for server in (0.5, -1, 70000, ["a"], (), {}, b"labserver", object()):
            with self.subTest(server=server):
                self.assert_error(4, lambda s=server: coopdyn.connect(s), "cannot read the server",
                                  "HOST, HOST:PORT, or a port of this machine")

    def test_a_port_beside_the_host_says_how_to_write_both(self):
        self.assert_error(3, lambda: coopdyn.connect("127.0.0.1", 21000), 'write connect("127.0.0.1:21000")')
        self.assert_error(3, lambda: coopdyn.connect("::1", 21000), 'write connect("[::1]:21000")')

    def test_the_address_of_the_page_is_told_as_such(self):
        for page in ("http://127.0.0.1:21080/", "https://labserver"):
            self.assert_error(4, lambda: coopdyn.connect(page), f"{page} is the address of the page", "HOST:PORT",
                              'write e.g. connect("127.0.0.1:10000")')


class BrokenSocket:
    """Full at the first write, closed at the second."""

    def __init__(self):
        self.blocks = True

    def setblocking(self, blocks):
        self.blocks = blocks

    def settimeout(self, seconds):
        self.blocks = True

    def send(self, data):
        raise BlockingIOError

    def sendall(self, data):
        raise ConnectionResetError("gone")

    def recv(self, size):
        if self.blocks:
            raise AssertionError("reading would wait")
        return b""

    def close(self):
        pass


class ALargeRequest(FakeTestCase):
    def test_to_a_daemon_that_goes_while_it_is_written_is_an_error_of_the_client(self):
        connection = coopdyn._Connection(coopdyn._Address("127.0.0.1:1", "ana", None, 3), "/simulation")
        connection.sock = BrokenSocket()
        self.assert_error(-1, lambda: connection.send(b"x" * 100), "the daemon closed the connection")


if __name__ == "__main__":
    unittest.main()
