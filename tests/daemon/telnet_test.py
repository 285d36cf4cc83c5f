"""A user at a keyboard: leaving a connection, opening it twice, impossible numbers, an arm driven in words."""
import subprocess
import unittest

from harness import BINARY, Daemon, scenario

ARM = "[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 6 6 0.1\n[ROBOT_1]\ntype lwa\nname arm1\nposition 0 0\n"


class TelnetTest(unittest.TestCase):
    def assert_left(self, connection, word):
        connection.write(f"{word}\r\n")
        said = connection.read_line()
        with self.assertRaises(EOFError):
            connection.read_line()
        return said

    def test_exit_quit_and_bye_close_the_connection_to_a_module(self):
        with Daemon(scenario(1)) as daemon:
            for word in ("exit", "quit", "bye"):
                motors = daemon.text("/robot1/motors")
                motors.must("get_wheels")
                self.assertRegex(self.assert_left(motors, word), '^0 "goodbye" -1 ')

    def test_exit_and_bye_close_the_connection_to_the_simulation_and_its_quit_ends_the_daemon(self):
        with Daemon(scenario(1)) as daemon:
            for word in ("exit", "bye"):
                self.assertRegex(self.assert_left(daemon.text("/simulation"), word), '^0 "goodbye" -1 ')
            daemon.text("/simulation").must("quit")
            self.assertEqual(daemon.process.wait(60), 0)

    def test_exit_quit_and_bye_close_the_connection_to_the_name_server(self):
        with Daemon(scenario(1)) as daemon:
            for word in ("exit", "quit", "bye"):
                names = daemon.raw()
                self.assertEqual(self.assert_left(names, word), "*** end of message")

    def test_a_second_open_says_that_it_needs_a_new_connection(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            reply = motors.ask("OPEN /robot1/pose")
            self.assertEqual((reply.error, reply.command), (5, -2))
            self.assertEqual(reply.text, "this connection is a motors module's already: OPEN another one on a new connection")
            motors.must("get_wheels")

    def test_a_number_beyond_a_double_is_out_of_range(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            reply = motors.ask("set_velocity 1e400 0")
            self.assertEqual((reply.error, reply.command), (4, 11))
            self.assertIn("'1e400' is too large: set_velocity 0.2 0.5", reply.text)

    def test_a_port_alone_is_a_server_of_this_machine_to_the_program(self):
        with Daemon(scenario(1)) as daemon:
            done = subprocess.run([BINARY, "status", "--server", str(daemon.names[1])], stdout=subprocess.PIPE, timeout=60)
            self.assertEqual(done.returncode, 0)
            self.assertIn(b"robot1", done.stdout)

    def test_times_print_as_the_decimal_that_they_are(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.must("ready 660")
            for k in range(661, 700):
                motors.write("stop\n")
                self.assertTrue(motors.read_line().endswith(f" {k / 100:.15g} {k}.0"))


class ArmTest(unittest.TestCase):
    """An arm of seven axes, driven by words."""

    def setUp(self):
        self.daemon = self.enterContext(Daemon(ARM))
        self.arm = self.daemon.text("/arm1/arm")

    def positions(self):
        return self.arm.must("get_joints").data[:-2][::3]

    def test_words_move_the_joints_that_are_named(self):
        self.assertEqual(self.arm.must("set_positions (1 2) 0.3 0.2").params[0], 1)  # the mode: lockstep
        self.assertEqual(list(self.arm.must("get_motion (1 2)").data[:-2]), [0.3, 0.2])
        while 0 in self.arm.must("get_motion").params:
            self.arm.must("ready 10")
        for here, there in zip(self.positions(), (0.3, 0.2, 0, 0, 0, 0, 0)):
            self.assertAlmostEqual(here, there, places=3)

    def test_words_choose_how_a_joint_is_driven(self):
        self.arm.must("set_velocities (7) 0.5")
        self.arm.must("set_efforts (6) 0.1")
        self.arm.must("set_positions_direct (5) 0.01")
        self.arm.must("set_modes (4) idle")
        self.assertEqual(list(self.arm.must("get_modes").params[3:]), [0, 2, 4, 3])
        self.arm.must("hold")
        self.assertEqual(list(self.arm.must("get_modes").params), [1] * 7)
        self.arm.must("set_compliance (2) 200 20 0")
        self.assertEqual(list(self.arm.must("get_compliance (2)").data[:-2]), [200, 20, 0])
        self.arm.must("set_compliance (2) inf 0 0")
        self.assertEqual(self.arm.must("get_compliance (2)").data[0], float("inf"))

    def test_what_is_beyond_the_limits_is_cut_and_said(self):
        self.assertIn("limited to", self.arm.must("set_positions (2) 99").text)

    def test_errors_say_what_to_write(self):
        for line, error, says in (("set_positions (1 2) 0.3", 3, "set_positions (1 3) 0.5 0.2"),
                                  ("set_positions 0.3", 3, "7"),
                                  ("set_positions (8) 0.3", 2, "joints 1 to 7"),
                                  ("set_positions (1 1) 0.3 0.2", 2, "twice"),
                                  ("set_positions (joint_1) 0.3", 7, "as in set_positions (1 3) 0.5 0.2"),
                                  ("set_positions (1) nan", 4, "finite"),
                                  ("set_positions (1) 0,3", 7, "write 0.3"),
                                  ("set_modes (1) fast", 3, "idle"),
                                  ("set_position (1) 0.3", 1, "set_positions"),
                                  ("set_velocity 0.2 0", 1, "help lists all of joints")):
            reply = self.arm.ask(line)
            self.assertEqual(reply.error, error, (line, reply.text))
            self.assertIn(says, reply.text, line)
        self.assertEqual(self.daemon.status()["step"], 0)

    def test_somebody_else_is_told_who_drives(self):
        self.arm.must("hello ana")
        self.arm.must("hold")
        reply = self.daemon.text("/arm1/arm").ask("set_positions (1) 0.1")
        self.assertEqual(reply.error, 6)
        self.assertIn("ana", reply.text)

    def test_help_lists_the_commands_of_joints(self):
        self.arm.write("help\nping\n")
        lines = []
        while not lines or lines[-1].startswith("#"):
            lines.append(self.arm.read_line())
        for word in ("set_positions", "set_efforts", "set_compliance", "hold", "get_motion"):
            self.assertTrue(any(word in line for line in lines), lines)


if __name__ == "__main__":
    unittest.main()
