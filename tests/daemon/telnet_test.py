"""Somebody at a keyboard: how a connection is left, opened twice, and what an impossible number is answered."""
import subprocess
import unittest

from harness import BINARY, Daemon, scenario


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


if __name__ == "__main__":
    unittest.main()
