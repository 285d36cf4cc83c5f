"""Programs on the same machine reach the daemon by its unix socket, or on request by TCP; others by TCP."""
import json
import os
import socket
import subprocess
import sys
import unittest
from pathlib import Path

from harness import Connection, Daemon, LIMIT_S, parse_line, scenario, until

CLIENT = Path(__file__).resolve().parents[2] / "clients" / "python"
PEER_OF_PYTHON = """
import sys
sys.path.insert(0, sys.argv[1])
import coopdyn
with coopdyn.connect(sys.argv[2], name="ana") as sim:
    robot = sim.robot("robot1")
    robot.set_velocity(0.1, 0)
    sim.step()
    print(*sorted({c["peer"].split(":")[0] for c in sim.status()["clients"] if c["name"].startswith("ana")}))
"""


class Local(Connection):
    """A text connection over the unix socket: to the name server, and after OPEN to a module."""

    def __init__(self, daemon):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(LIMIT_S)
        self.socket.connect(f"\0coopdyn-{daemon.names[1]}")
        self.buffer = b""

    def open(self, module):
        self.write(f"OPEN {module}\n")
        assert self.read_line() == "ok"
        return self

    def ask(self, line):
        self.write(line + "\n")
        return parse_line(self.read_line())


def has_local_socket(daemon):
    with socket.socket(socket.AF_UNIX) as probe:
        return probe.connect_ex(f"\0coopdyn-{daemon.names[1]}") == 0


class LocalSocketTest(unittest.TestCase):
    def peers_of_python(self, daemon, **env):
        command = [sys.executable, "-c", PEER_OF_PYTHON, str(CLIENT), f"127.0.0.1:{daemon.names[1]}"]
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, timeout=LIMIT_S,
                              env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **env}).stdout.decode().strip()

    def test_names_and_a_lockstep_command(self):
        with Daemon(scenario()) as daemon:
            local = Local(daemon)
            local.write("NAME_SERVER query /robot1/motors\n")
            self.assertRegex(local.read_line(), "^registration name /robot1/motors ip 127.0.0.1 port [1-9]")
            self.assertEqual(local.read_line(), "*** end of message")
            local.open("/robot1/motors")
            first = local.ask("set_velocity 0.1 0")
            self.assertEqual((first.error, local.ask("set_velocity 0.1 0").step - first.step), (0, 1))
            connections = daemon.status()["clients"]
            self.assertIn(f"unix:{os.getpid()}", [c["peer"] for c in connections])
            local.close()
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_a_name_takes_over_from_the_same_name_by_tcp(self):
        with Daemon(scenario()) as daemon:
            old = daemon.text("/robot1/motors")
            old.must("hello ana")
            old.must("claim")
            new = Local(daemon).open("/robot1/motors")
            self.assertEqual(new.ask("hello ana").error, 0)
            self.assertEqual(new.ask("claim").error, 0)
            self.assertEqual(old.receive().command, -1)
            new.close()

    def test_python_uses_it_unless_told_otherwise(self):
        with Daemon(scenario()) as daemon:
            self.assertEqual(self.peers_of_python(daemon), "unix")
            self.assertEqual(self.peers_of_python(daemon, COOPDYN_TCP="1"), "127.0.0.1")

    def test_a_reply_of_a_megabyte_comes_whole(self):
        robots = "".join(f"[ROBOT_{i}]\ntype minibot\nname r{i}\nposition {i % 30 - 15} {i // 30 - 15} 0\n"
                         for i in range(1, 801))
        text = f"[SIMULATION]\nmode lockstep\nstep 0.01\n[FLOOR]\nsize 60 60 0.1\n{robots}"
        with Daemon(text) as daemon:
            local = Local(daemon).open("simulation")
            local.write("describe\n" * 400 + "ping\n")
            local.socket.shutdown(socket.SHUT_WR)
            everything = local.read_to_end()
            self.assertGreater(len(everything), 1 << 20)
            self.assertEqual(everything.count(b"\n"), 401)
            self.assertEqual(json.loads(parse_line(everything.split(b"\n", 1)[0].decode()).text)["module"],
                             "simulation")
            local.close()

    def test_a_daemon_of_other_addresses_has_none(self):
        with Daemon(scenario()) as near, Daemon(scenario(), "--host", "127.0.0.1", "--host", "127.0.0.2") as far:
            self.assertEqual((has_local_socket(near), has_local_socket(far)), (True, False))


if __name__ == "__main__":
    unittest.main()
