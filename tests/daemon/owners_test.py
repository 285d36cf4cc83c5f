"""Owners of robots in lockstep, and the robots' behaviour when a client has gone, over raw sockets."""
import fcntl
import os
import signal
import struct
import subprocess
import sys
import termios
import unittest
from contextlib import contextmanager
from pathlib import Path

from harness import Binary, Daemon, Text, scenario, until
from local_socket_test import Local

CLIENT = """
import socket, sys
s = socket.create_connection((sys.argv[1], int(sys.argv[2])))
f = s.makefile("rw", newline="\\n")
def ask(line):
    f.write(line + "\\n"); f.flush(); return f.readline()
assert ask("OPEN " + sys.argv[3]) == "ok\\n"
print(ask("claim"), end="", flush=True)
while True:
    ask("set_velocity 0.1 0")
"""


@contextmanager
def client_process(daemon, module):
    """A client in a separate process that sends commands forever; it owns the module, and its first command may be on the way."""
    with subprocess.Popen([sys.executable, "-c", CLIENT, daemon.names[0], str(daemon.names[1]), module],
                          stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout.readline().startswith(b"0 ")
            yield process
        finally:
            process.kill()


def stop(process):
    """Stops a process; it has stopped on return."""
    process.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, process.pid, os.WSTOPPED)


class LostClientTest(unittest.TestCase):
    def test_a_stopped_client_stalls_the_world_and_is_named(self):
        with Daemon(scenario(2)) as daemon:
            with client_process(daemon, "/robot2/motors") as client:
                motors = daemon.text("/robot1/motors")
                motors.must("ready 5")
                stop(client)
                motors.send("ready 100000")
                until(lambda: daemon.awaited(1) == ["robot2"])
                status = daemon.status()
                self.assertIn("no command from", status["awaiting"][0]["why"])
                step = status["step"]
                self.assertEqual(daemon.status()["step"], step)
                client.send_signal(signal.SIGCONT)
                until(lambda: daemon.status()["step"] > step)

    def test_with_a_deadline_and_hold_the_others_go_on(self):
        text = scenario(2, robot_extra={2: "deadline 0.2\non_deadline hold"})
        with Daemon(text) as daemon:
            with client_process(daemon, "/robot2/motors") as client:
                motors = daemon.text("/robot1/motors")
                motors.must("ready 5")
                stop(client)
                self.assertGreaterEqual(motors.must("ready 300").step, 300)
                self.assertTrue(any("robot2 missed its deadline" in e["text"] for e in daemon.status()["events"]))
                client.send_signal(signal.SIGCONT)
                motors.must("ready 5")

    def test_a_killed_client_frees_its_robot(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            with client_process(daemon, "/robot1/motors"):
                self.assertEqual(motors.ask("set_velocity 0 0").error, 6)
            reply = until(lambda: (r := motors.ask("set_velocity 0 0")).error == 0 and r)
            self.assertEqual(reply.params[0], 1)

    def test_a_client_killed_while_its_command_waits_is_noticed_at_once(self):
        with Daemon(scenario(2)) as daemon:
            with client_process(daemon, "/robot1/motors"):
                until(lambda: daemon.awaited() == ["robot2"])  # which has no client
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_on_disconnect_hold_lets_the_others_go_on(self):
        with Daemon(scenario(2, robot_extra={2: "on_disconnect hold"})) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            two.send("set_velocity 0.2 0")
            one.must("ready")
            two.receive()
            two.close()
            self.assertEqual(one.must("ready 20").step, 21)
            self.assertGreater(daemon.text("/robot2/pose").must("get_pose").data[3], 0.1)

    def test_on_disconnect_drop_takes_the_robot_out_until_its_next_command(self):
        with Daemon(scenario(2, robot_extra={2: "on_disconnect drop"})) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            two.send("ready")
            one.must("ready")
            two.receive()
            two.close()
            one.must("ready 3")
            self.assertFalse(daemon.status()["robots"][1]["participates"])
            again = daemon.text("/robot2/motors")
            again.send("ready")
            until(lambda: daemon.status()["robots"][1]["participates"])
            one.must("ready")
            again.receive()
            one.send("ready")
            until(lambda: daemon.awaited() == ["robot2"])


class OwnershipTest(unittest.TestCase):
    def test_a_second_commander_gets_error_6_naming_the_owner(self):
        with Daemon(scenario(1)) as daemon:
            first, second = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            first.must("hello ana")
            first.must("ready")
            reply = second.ask("set_velocity 0.1 0")
            self.assertEqual(reply.error, 6)
            self.assertIn("ana", reply.text)
            self.assertEqual(second.must("get_wheels").error, 0)

    def test_release_frees_the_module(self):
        with Daemon(scenario(1)) as daemon:
            first, second = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            first.must("claim")
            self.assertEqual(second.ask("claim").error, 6)
            first.must("release")
            second.must("claim")

    def test_hello_of_the_same_name_takes_over_and_the_old_one_gets_a_notice(self):
        with Daemon(scenario(1)) as daemon:
            old, new = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            reader = daemon.text("/robot1/pose")
            for connection in (old, reader):
                connection.must("hello ana")
            old.must("claim")
            new.must("hello ana")
            self.assertEqual(old.receive().command, -1)
            self.assertEqual(old.read_to_end(), b"")
            new.must("set_velocity 0.1 0")
            reader.must("get_pose")

    def test_a_new_owners_first_command_replaces_the_old_ones_rest(self):
        with Daemon(scenario(2)) as daemon:
            old, new = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            two = daemon.text("/robot2/motors")
            old.must("hello ana")
            old.send("set_wheel_speeds (100) 5 5")
            two.must("ready")
            new.must("hello ana")
            new.send_to_wait("set_wheel_speeds 0 0")
            two.must("ready")
            self.assertEqual(new.receive().step, 2)
            two.send("ready")
            until(lambda: daemon.awaited() == ["robot1"])

    def test_release_of_a_robot_by_the_simulation_closes_its_owner(self):
        with Daemon(scenario(1)) as daemon:
            motors, simulation = daemon.text("/robot1/motors"), daemon.text("/simulation")
            motors.must("claim")
            simulation.must('release_robot robot1')
            self.assertEqual(motors.receive().command, -1)
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_half_closed_one_line_commands_are_executed_and_answered(self):
        with Daemon(scenario(1)) as daemon:
            host, port = daemon.names[0], daemon.module_port("/robot1/motors")
            for line in ("set_velocity 0.2 0", "get_wheels"):
                done = subprocess.run(["nc", "-N", host, str(port)], input=(line + "\n").encode(),
                                      stdout=subprocess.PIPE, timeout=60)
                self.assertTrue(done.stdout.startswith(b"0 "), done.stdout)
            self.assertEqual(daemon.status()["step"], 1)

    def test_pipelined_requests_of_a_half_closed_connection_run_in_their_steps(self):
        with Daemon(scenario(1)) as daemon:
            port = daemon.module_port("/robot1/motors")
            lines = "".join(f"set_wheel_speeds {k} {k}\n" for k in range(1, 6))
            done = subprocess.run(["nc", "-N", "127.0.0.1", str(port)], input=lines.encode(),
                                  stdout=subprocess.PIPE, timeout=60)
            self.assertEqual(done.stdout.count(b"\n"), 5)
            self.assertEqual(daemon.status()["step"], 5)
            until(lambda: not daemon.status()["robots"][0]["owner"])


@contextmanager
def held(daemon):
    """Stops the daemon for a while; arriving bytes wait for it, in order."""
    daemon.process.send_signal(signal.SIGSTOP)
    until(lambda: Path(f"/proc/{daemon.process.pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "T")
    try:
        yield
    finally:
        daemon.process.send_signal(signal.SIGCONT)


class AtOnceTest(unittest.TestCase):
    """A program closes its connection, and another connection takes the robot before the daemon has read the end."""

    def test_a_robot_in_every_mode_and_by_every_connection(self):
        kinds = {"text": lambda d: Text(d, "/robot1/motors"), "direct": lambda d: Text(d, "/robot1/motors", direct=True),
                 "local": lambda d: Local(d).open("/robot1/motors"), "binary": lambda d: Binary(d, "/robot1/motors")}
        with Daemon(scenario(1)) as daemon:
            next_one = daemon.text("/robot1/motors")
            for mode in ("lockstep", "realtime", "free"):
                daemon.text("/simulation").must(f"set_mode {mode}")
                for kind, connect in kinds.items():
                    with self.subTest(mode=mode, kind=kind):
                        owner = connect(daemon)
                        self.assertEqual(owner.ask(7 if kind == "binary" else "claim").error, 0)
                        with held(daemon):
                            next_one.send("set_velocity 0 0")  # the daemon reads it first
                            owner.close()
                        self.assertEqual(next_one.receive().error, 0)
                        next_one.must("release")

    def test_a_robot_whose_program_is_far_ahead(self):
        with Daemon(scenario(2)) as daemon:
            owner, next_one = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            next_one.must("get_wheels")
            owner.send_to_wait("set_velocity 0.1 0")
            owner.write(b"ping\n" * 226_000)  # more than the daemon reads before it has answered; the rest fits into its socket
            until(lambda: not struct.unpack("i", fcntl.ioctl(owner.socket, termios.TIOCOUTQ, bytes(4)))[0])  # has arrived
            owner.close()
            next_one.must("claim")

    def test_the_robots_of_many_programs_as_a_team(self):
        with Daemon(scenario(5)) as daemon:
            swarm = daemon.text("/swarm")
            for _ in range(10):
                owners = [Text(daemon, f"/robot{i}/motors") for i in range(1, 6)]
                for owner in owners:
                    owner.must("claim")
                with held(daemon):
                    for owner in owners:
                        owner.close()
                    swarm.send("claim robot1 robot2 robot3 robot4 robot5")
                self.assertEqual(swarm.receive().params, [1, 2, 3, 4, 5])
                swarm.must("release")

    def test_a_team_whose_program_ends_by_the_next_team_and_by_single_programs(self):
        with Daemon(scenario(5)) as daemon:
            for taker in ("/swarm", "/robot1/motors") * 5:
                with client_process(daemon, "/robot1/motors") as program:
                    team, next_one = Text(daemon, "/swarm"), Text(daemon, taker)
                    next_one.must("get_time")
                    self.assertEqual(team.must("claim robot2 robot3").params, [2, 3])
                    with held(daemon):
                        next_one.send("claim robot1 robot2 robot3" if taker == "/swarm" else "claim")
                        team.close()
                        program.kill()
                        program.wait()
                    self.assertEqual(next_one.receive().error, 0)
                next_one.close()


if __name__ == "__main__":
    unittest.main()
