"""While a load starts thousands of robots, other clients are served and a stop is obeyed."""
import json
import resource
import signal
import time
import unittest

from harness import Connection, Daemon, until

LOAD = 108
ROBOTS = 30000  # seconds
SWARM = (f"[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 200 200 0.1\n"
         f"[SWARM_1]\ntype minibot\nname ant\ncount {ROBOTS}\n")


def is_up(daemon, module):
    connection = Connection(daemon.names)
    connection.write(f"NAME_SERVER query {module}\n")
    answer = connection.read_line()
    connection.close()
    return answer.startswith("registration name ")


class LoadTest(unittest.TestCase):
    def test_nobody_waits_for_a_load_of_thousands(self):
        with Daemon() as daemon:
            bystander = daemon.text("/simulation")
            loader = daemon.binary("/simulation")
            loader.send(LOAD, text=SWARM)
            began = asked = time.monotonic()
            longest = 0
            while not loader.has_bytes():
                bystander.must("get_time")
                asked, before = time.monotonic(), asked
                longest = max(longest, asked - before)
            took = time.monotonic() - began
            self.assertEqual(loader.receive().error, 0)
            self.assertTrue(is_up(daemon, f"/ant_{ROBOTS}/pose"), "the reply comes when all are up")
            self.assertLess(longest, took / 3)

    def test_a_stop_does_not_wait_until_all_are_up(self):
        with Daemon() as daemon:
            loader = daemon.text("/simulation")
            loader.send("load_scenario " + json.dumps(SWARM))
            until(lambda: is_up(daemon, "/ant_1/pose"))
            self.assertEqual(daemon.end(signal.SIGTERM), 0)
            said = loader.read_to_end().decode()
            self.assertNotIn(f" {LOAD} ", said)
            self.assertIn("stop", said)

    def load_without_files(self, robots):
        """Loads robots into a daemon that may open 60 more files; returns the log's lines about it."""
        with Daemon() as daemon:
            simulation = daemon.text("/simulation")
            _, hard = resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE)
            resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE, (daemon.open_files() + 60, hard))
            text = f"[SWARM_1]\ntype minibot\nname ant\ncount {robots}\nsockets yes\n"
            simulation.must("load_scenario " + json.dumps(text))
            resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE, (hard, hard))
            self.assertEqual(len(daemon.status()["robots"]), robots)
            lines = until(lambda: [line for line in daemon.stderr().splitlines() if "Too many open files" in line])
            daemon.text("/ant_1/motors").must("get_limits")
        return lines

    def test_modules_without_ports_for_want_of_files_are_told_in_one_line(self):
        lines = self.load_without_files(100)
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], r"/ant_\d+/\w+ \(and \d+ more\): .*OPEN.*ulimit -n.*sockets")

    def test_robots_without_threads_for_want_of_files_are_told_in_one_line(self):
        lines = self.load_without_files(40)
        self.assertEqual(sum("cannot be reached" in line for line in lines), 1, lines)


if __name__ == "__main__":
    unittest.main()
