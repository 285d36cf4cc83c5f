"""A robot stops when its program ends without notice, in real time and in free mode; over raw sockets."""
import subprocess
import sys
import unittest
from contextlib import contextmanager

from harness import Daemon, scenario, until
from recording import RecordingTestCase, equal_steps, rows, tool

CLIENT = """
import socket, sys
s = socket.create_connection((sys.argv[1], int(sys.argv[2])))
f = s.makefile("rw", newline="\\n")
def ask(line):
    f.write(line + "\\n"); f.flush(); return f.readline()
assert ask("OPEN " + sys.argv[3]) == "ok\\n"
for line in sys.argv[4:]:
    reply = ask(line)
    assert reply.startswith("0 "), reply
print("driving", flush=True)
sys.stdin.read()
"""


@contextmanager
def program(daemon, module, *lines):
    """A process that sends these lines, and then waits until it is killed."""
    with subprocess.Popen([sys.executable, "-c", CLIENT, daemon.names[0], str(daemon.names[1]), module, *lines],
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout.readline() == b"driving\n"
            yield process
        finally:
            process.kill()


def kill_program(daemon, module, *lines):
    """Runs a program until it drives, kills it, and waits until its robots are free."""
    with program(daemon, module, *lines) as process:
        process.kill()
    until(lambda: not any(robot["owner"] for robot in daemon.status()["robots"]))


def speeds(daemon, robot="robot1"):
    return daemon.text(f"/{robot}/motors").must("get_wheels").data[2:4]


def robot(daemon, index=0):
    return daemon.status()["robots"][index]


class ProgramEndTest(unittest.TestCase):
    def test_a_killed_program_that_said_hello_stops_its_robot(self):
        for mode in ("realtime", "free"):
            with self.subTest(mode), Daemon(scenario(1, mode=mode)) as daemon:
                kill_program(daemon, "/robot1/motors", "hello ana", "set_velocity (5) 0.2 0")
                until(lambda: max(map(abs, speeds(daemon))) < 1e-3)
                self.assertFalse(robot(daemon)["still_moving"])
                self.assertTrue(any("lost client ana: robot1 stopped" in event["text"]
                                    for event in daemon.status()["events"]))

    def test_one_without_hello_leaves_its_set_points_and_status_says_so(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            kill_program(daemon, "/robot1/motors", "set_velocity (5) 0.2 0")
            self.assertTrue(robot(daemon)["still_moving"])
            self.assertGreater(min(speeds(daemon)), 1)
            self.assertIn("nobody drives it, still moving", tool("status", "--server", "%s:%d" % daemon.names)[1])
            daemon.text("/simulation").must("stop_all")
            self.assertFalse(robot(daemon)["still_moving"])

    def test_what_a_single_call_with_a_token_sets_stays(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            code, said = tool("call", "--server", "%s:%d" % daemon.names, "--token", "chalk-and-board", "/robot1/motors",
                              "set_velocity", "0.2", "0")
            self.assertEqual(code, 0, said)
            until(lambda: not robot(daemon)["owner"])
            daemon.text("/simulation").must("ready 5")
            self.assertGreater(min(speeds(daemon)), 1)

    def test_an_explicit_policy_holds_in_every_mode(self):
        with Daemon(scenario(1, mode="realtime", robot_extra={1: "on_disconnect hold"})) as daemon:
            kill_program(daemon, "/robot1/motors", "hello ana", "set_velocity (5) 0.2 0")
            daemon.text("/simulation").must("ready 5")
            self.assertGreater(min(speeds(daemon)), 1)

    def test_a_killed_program_stops_its_whole_team(self):
        with Daemon(scenario(3, mode="realtime")) as daemon:
            kill_program(daemon, "/swarm", "hello ana", "claim robot1 robot3", "step_all 0.2 0 0.2 0")
            for name in ("robot1", "robot3"):
                until(lambda: max(map(abs, speeds(daemon, name))) < 1e-3)

    def test_lost_in_lockstep_the_robot_stops_when_the_mode_is_switched(self):
        with Daemon(scenario(1)) as daemon:
            kill_program(daemon, "/robot1/motors", "hello ana", "set_velocity (5) 0.2 0")
            self.assertEqual(daemon.status()["step"], 5)  # which waits
            daemon.text("/simulation").must("set_mode realtime")
            until(lambda: max(map(abs, speeds(daemon))) < 1e-3)

    def test_a_robot_that_was_stopped_so_is_waited_for_in_lockstep(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            kill_program(daemon, "/robot1/motors", "hello ana", "set_velocity (5) 0.2 0")
            daemon.text("/simulation").must("set_mode lockstep")
            until(lambda: daemon.awaited() == ["robot1"])

    def test_a_killed_program_whose_robot_somebody_else_drives_now_changes_nothing(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            with program(daemon, "/robot1/motors", "hello ana", "set_velocity 0.2 0") as process:
                self.assertEqual(robot(daemon)["owner"], "ana")
                daemon.text("/simulation").must("release_robot robot1")
                with program(daemon, "/robot1/motors", "hello bob", "set_velocity (5) 0.2 0"):
                    process.kill()
                    process.wait()
                    daemon.text("/simulation").must("ready 5")
                    self.assertGreater(min(speeds(daemon)), 1)  # it is bob's


class RecordedEndTest(RecordingTestCase):
    def test_the_stop_is_an_input_that_verify_repeats(self):
        with Daemon(scenario(1, mode="free"), "--speed", "20", "--record", self.file) as daemon:
            kill_program(daemon, "/robot1/motors", "hello ana", "set_velocity (50) 0.2 0.5")
            until(lambda: max(map(abs, speeds(daemon))) < 1e-3)
            daemon.text("/simulation").must("ready 20")
        self.assertGreater(equal_steps(self.file), 70)
        self.assertEqual(rows(self.file, "SELECT detail FROM input WHERE action = 'disconnect'"), [("robot1 stop",)])


class PauseTest(unittest.TestCase):
    def test_pause_ends_a_long_step_n_which_tells_how_many_have_run(self):
        with Daemon(scenario(1, mode="realtime"), "--paused") as daemon:
            stepping, simulation = daemon.text("/simulation"), daemon.text("/simulation")
            stepping.send("step 1000000")
            until(lambda: daemon.status()["step"] > 3)
            step = simulation.must("pause").step
            reply = stepping.receive()
            self.assertEqual(reply.error, 5)
            self.assertEqual(reply.text, f"paused after {step} of 1000000 steps: step {1000000 - step} runs the rest")
            simulation.must("ping")
            self.assertEqual(daemon.status()["step"], step)
            self.assertEqual(stepping.must("step 2").step, step + 2)

    def test_counts_of_steps_have_a_most(self):
        with Daemon(scenario(1), "--paused") as daemon:
            for module, line in (("/simulation", "step 2147483647"), ("/simulation", "ready 10000001"),
                                 ("/robot1/motors", "set_velocity (10000001) 0.1 0"), ("/swarm", "ready 10000001")):
                reply = daemon.text(module).ask(line)
                self.assertEqual(reply.error, 4, line)
                self.assertIn("1 to 10000000", reply.text)


class WaitsForTest(unittest.TestCase):
    def test_lockstep_waits_for_the_modules_that_are_listed(self):
        with Daemon(scenario(2, robot_extra={2: "waits_for motors"})) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.send("ready")
            until(lambda: daemon.awaited() == ["robot2"])
            daemon.text("/robot2/distance").send("ready")  # no actuator: makes nobody ready
            self.assertEqual(daemon.awaited(), ["robot2"])
            self.assertEqual(daemon.text("/robot2/motors").must("ready").step, 1)

    def test_who_is_awaited_comes_with_what_to_do(self):
        with Daemon(scenario(2)) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.send("ready")
            until(lambda: daemon.awaited() == ["robot2"])
            cure = "let the others go on with set_participants robot1"
            self.assertIn(cure, daemon.status()["awaiting"][0]["cure"])
            self.assertIn(cure, tool("status", "--server", "%s:%d" % daemon.names)[1])
            until(lambda: cure in daemon.stderr())
            daemon.text("/simulation").must("set_participants robot1")
            self.assertEqual(motors.receive().step, 1)


class BroadcastTest(unittest.TestCase):
    def test_two_clients_without_a_name_do_not_share_a_robots_messages(self):
        with Daemon(scenario(1, mode="realtime").replace("type coopbot", "type minibot")) as daemon:
            motors, stranger = daemon.text("/robot1/motors"), daemon.text("/robot1/neighbours")
            stranger.must("send_message 1")
            motors.must("claim")
            self.assertEqual(stranger.ask("send_message 1").error, 6)
            motors.must("hello ana")
            self.assertEqual(stranger.ask("send_message 1").error, 6)
            stranger.must("hello ana")
            stranger.must("send_message 1")


if __name__ == "__main__":
    unittest.main()
