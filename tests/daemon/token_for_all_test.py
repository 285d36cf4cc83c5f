# SPDX-License-Identifier: MIT
"""A daemon that requires the token also on its own machine: without it, programs drive and read, and change nothing else."""
import unittest

from harness import Daemon, scenario
from local_socket_test import Local
from read_only_test import call

TOKEN = "chalk-and-board"
CHANGES = (("/simulation", "reset"), ("/simulation", "set_mode free"), ("/simulation", "pause"), ("/simulation", "quit"), ("/simulation", "end_run"),
           ("/simulation", "save a"), ("/simulation", "log a 1"), ("/world", "set_pose robot1 1 1"), ("/world", "remove robot1"), ("/recorder", "start x"))


class TokenForAllTest(unittest.TestCase):
    def test_by_tcp_and_by_the_unix_socket_nothing_but_robots_is_changed(self):
        with Daemon(scenario(), "--token-for-all", "--token", TOKEN) as daemon:
            for connect in (daemon.text, lambda module: Local(daemon).open(module), lambda module: daemon.text(module, direct=True)):
                for module, line in CHANGES:
                    self.assertEqual(connect(module).ask(line).error, 12, line)
                self.assertEqual(connect("/simulation").ask("get_status").error, 0)
            self.assertEqual(daemon.status()["state"], "waiting")
            self.assertEqual(daemon.text("/robot1/motors").must("set_velocity 0.2 0").step, 1)

    def test_with_the_token_everything_goes(self):
        with Daemon(scenario(), "--token-for-all", "--token", TOKEN) as daemon:
            local = Local(daemon).open("/simulation")
            self.assertEqual(local.ask("hello ana wrong-token-here").error, 12)
            self.assertEqual(local.ask(f"hello ana {TOKEN}").error, 0)
            self.assertEqual(local.ask("reset").error, 0)

    def test_the_page_needs_it_too(self):
        with Daemon(scenario(), "--token-for-all", "--token", TOKEN, "--http") as daemon:
            self.assertEqual(call(daemon.http, "/simulation", "reset")[0], 403)
            self.assertEqual(call(daemon.http, "/simulation", "get_status")[0], 200)

    def test_without_the_option_this_machine_is_trusted(self):
        with Daemon(scenario(), "--token", TOKEN) as daemon:
            for module, line in (("/simulation", "reset"), ("/simulation", "save a")):
                self.assertEqual(daemon.text(module).ask(line).error, 0, line)

    def test_a_token_is_made_if_none_is_given(self):
        with Daemon(scenario(), "--token-for-all") as daemon:
            self.assertEqual(daemon.text("/simulation").ask("reset").error, 12)


if __name__ == "__main__":
    unittest.main()
