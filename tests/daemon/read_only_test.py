"""A read-only daemon: in every encoding, on the name port and over HTTP."""
import json
import subprocess
import unittest
import urllib.error
import urllib.request

from harness import BINARY, LIMIT_S, Connection, Daemon
from yarp_ports import registration

WHY = "--read-only"


def call(http, module, line):
    body = json.dumps({"id": 1, "module": module, "line": line}).encode()
    request = urllib.request.Request(http + "api/call", body, {"Content-Type": "application/json"})
    try:
        with urllib.request.urlopen(request) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


class ReadOnlyTest(unittest.TestCase):
    def test_lines_that_change_something_are_refused_in_words(self):
        with Daemon(None, "--read-only", name="classroom") as daemon:
            for module, line in (("/robot1/motors", "set_velocity 0.2 0"), ("/robot1/motors", "claim"), ("/simulation", "pause"),
                                 ("/simulation", "reset"), ("/simulation", "quit"), ("/recorder", "start x"),
                                 ("/swarm", "stop_team")):
                reply = daemon.text(module).ask(line)
                self.assertEqual(reply.error, 12, line)
                self.assertIn(WHY, reply.text, line)
            self.assertEqual(daemon.status()["state"], "running")

    def test_binary_frames_are_refused_likewise(self):
        with Daemon(None, "--read-only", name="classroom") as daemon:
            connection = daemon.binary("/simulation")
            pause = next(command for command in json.loads(daemon.text("/simulation").must("describe").text)["commands"]
                         if command["name"] == "pause")
            reply = connection.ask(pause["id"])
            self.assertEqual(reply.error, 12)
            self.assertIn(WHY, reply.text)

    def test_reading_and_watching_go_on(self):
        with Daemon(None, "--read-only", name="classroom") as daemon:
            motors = daemon.text("/robot1/motors")
            motors.must("hello me")
            motors.must("get_wheels")
            motors.must("subscribe 1")
            first, second = motors.receive(), motors.receive()
            self.assertLess(first.step, second.step)

    def test_the_world_interface_of_yarp_refuses_also_what_would_change_nothing(self):
        with Daemon(None, "--read-only", name="classroom") as daemon:
            port = Connection(registration(daemon, "/world_input_port"))
            port.write("CONNECT me\r\n")
            port.read_line()

            def ask(line):
                port.write(f"d\r\n{line}\r\n")
                return port.read_line()

            place = "0 0 1 0 0 0"
            for line in (f"makeSphere 0.1 {place} 0 0 0", f"makeSphere 0.1 {place} 0 0 0 robot1", f"makeBox 0.1 0.1 0.1 {place} 0 0 0",
                         f"makeCylinder 0.1 0.1 {place} 0 0 0", "changeColor robot1 0 0 0", f"setPose robot1 {place}", "enableGravity robot1 1",
                         "enableCollision robot1 1", "loadModelFromFile coopbot", f"loadModelFromFileWithPose coopbot {place}",
                         "deleteObject robot1", "deleteAll", "rename robot1 eva"):
                answer = ask(line)
                self.assertTrue(answer.startswith("[fail]"), f"{line}: {answer}")
                self.assertIn(WHY, answer, line)
            self.assertEqual(ask("getList"), "()")
            self.assertEqual(len(ask("getPose robot1").split()), 6)
            port.close()

    def test_the_shell_does_not_ask_for_a_token(self):
        with Daemon(None, "--read-only", name="classroom") as daemon:
            for words in (("pause",), ("call", "/simulation", "pause"), ("world", "undo")):
                done = subprocess.run([BINARY, *words, "--server", "%s:%d" % daemon.names], capture_output=True, text=True,
                                      timeout=LIMIT_S, check=False)
                self.assertEqual(done.returncode, 1, words)
                self.assertIn("the daemon was started with --read-only", done.stderr, words)

    def test_names_neither_come_nor_go(self):
        with Daemon(None, "--read-only", name="classroom") as daemon:
            names = Connection(daemon.names)
            names.write("NAME_SERVER register /mine\n")
            self.assertIn(WHY, names.read_line())
            names.close()

    def test_calls_over_http_are_refused_with_403(self):
        with Daemon(None, "--read-only", "--http", name="classroom") as daemon:
            status, text = call(daemon.http, "/simulation", "pause")
            self.assertEqual(status, 403)
            self.assertIn(WHY, text)
            self.assertEqual(call(daemon.http, "/simulation", "get_status")[0], 200)

    def test_lockstep_without_anybody_who_may_drive_is_refused(self):
        with self.assertRaisesRegex(AssertionError, "--read-only leaves nobody to drive"):
            Daemon(None, "--read-only", "--mode", "lockstep", name="classroom")


if __name__ == "__main__":
    unittest.main()
