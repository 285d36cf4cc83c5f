"""Clients on other machines and firewalls, in separate network namespaces: permissions, and that one open port is enough.

Each test runs this file again inside `unshare --net`, where only the interfaces made by the test exist.
"""
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import threading
import unittest
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

from channel_test import STILL
from harness import BINARY, LIMIT_S, Daemon, Text, run_in_new_network, scenario, set_address, until
from yars_clients import Tcp, Udp

OUTER = "10.9.9.9"  # exists only inside the namespace
CLIENT = Path(__file__).resolve().parents[2] / "clients" / "python"


def inside(scene, *arguments):
    """Runs a scene of this file in a new network namespace."""
    run_in_new_network(__file__, scene, *arguments)


def pump(source, sink):
    """Forwards bytes until the end of the stream, and then closes the sink."""
    try:
        while chunk := source.recv(65536):
            sink.sendall(chunk)
        sink.shutdown(socket.SHUT_WR)
    except OSError:
        pass


def relay(listener, onward):
    """Relays each connection to the listener to a new onward(), in the background."""
    def serve():
        while True:
            try:
                near = listener.accept()[0]
            except OSError:
                return
            far = onward()
            for pair in ((near, far), (far, near)):
                threading.Thread(target=pump, args=pair, daemon=True).start()

    threading.Thread(target=serve, daemon=True).start()


class Stranger(Text):
    """A connection that does not come from loopback."""

    def __init__(self, daemon, module):
        names, daemon.names = daemon.names, (OUTER, daemon.names[1])
        try:
            super().__init__(daemon, module)
        finally:
            daemon.names = names


class StrangerScenes(unittest.TestCase):
    """Run by main below, inside the namespace."""

    def scene_world(self):
        with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk-and-board") as daemon:
            stranger = Stranger(daemon, "/simulation")
            for line in ("pause", "step 1", "reset", "run", "set_mode lockstep", "set_step 0.02", "set_speed 2", "quit", "stop_all",
                         "load_scenario empty", "reload", "set_participants robot1", "release_robot robot1"):
                reply = stranger.ask(line)
                self.assertEqual(reply.error, 12, line)
                self.assertIn("TOKEN", reply.text)
            for line in ("get_status", "get_time", "ready"):
                stranger.must(line)
            self.assertEqual(daemon.status()["state"], "running")
            self.assertEqual(stranger.ask("hello eve wrong").error, 12)
            self.assertEqual(stranger.ask("pause").error, 12)
            stranger.must("hello ana chalk-and-board")
            stranger.must("pause")
            self.assertEqual(daemon.status()["state"], "paused")
            daemon.text("/simulation").must("run")  # loopback needs no token
            stranger.close()

    def scene_shell(self):
        with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk-and-board") as daemon:
            def shell(*words, token=()):
                done = subprocess.run([BINARY, *words, *token, "--server", f"{OUTER}:{daemon.names[1]}"], capture_output=True, text=True,
                                      timeout=LIMIT_S, check=False)
                return done.returncode, done.stderr

            for words in (("pause",), ("call", "/simulation", "pause"), ("world", "undo")):
                code, said = shell(*words)
                self.assertEqual(code, 1, words)
                self.assertIn("give it with --token, or in COOPDYN_TOKEN", said, words)
                code, said = shell(*words, token=("--token", "wrong"))
                self.assertEqual(code, 1, words)
                self.assertRegex(said, "wrong token|wait", words)
            self.assertEqual(shell("call", "/simulation", "get_time"), (0, ""))
            daemon.text("/simulation").must("get_time")

    def scene_silence(self):
        with Daemon(scenario(2, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk-and-board") as daemon:
            stranger, near = Stranger(daemon, "/robot1/motors"), daemon.text("/robot2/motors")
            stranger.must("hello ana chalk-and-board")
            for motors in (near, stranger):
                motors.must("set_velocity 0.2 0")
            robots = until(lambda: (told := daemon.status()["robots"])[0]["watchdog_stopped"] and told)
            self.assertGreaterEqual(robots[0]["silent_s"], 5)
            self.assertFalse(robots[1]["watchdog_stopped"])
            self.assertGreater(min(daemon.text("/robot2/motors").must("get_wheels").data[2:4]), 1)
            stranger.close()

    def scene_first_programs(self):
        guide = (CLIENT.parents[1] / "docs" / "guide.md").read_text().split("\n## The student\n")[1]
        octave = ["octave", "--no-gui", "--norc", "--quiet", "--eval"]
        path = f"addpath('{CLIENT.parent / 'matlab'}'); "
        with Daemon(None, "--host", "0.0.0.0", "--token", "chalk-and-board", "--mode", "lockstep", name="classroom") as daemon:
            def ran(kind, body):
                program = [sys.executable, "-c", body] if kind == "python" else [*octave, path + body]
                env = {**os.environ, "COOPDYN_SERVER": f"{OUTER}:{daemon.names[1]}", "PYTHONPATH": str(CLIENT)}
                done = subprocess.run(program, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                      timeout=3 * LIMIT_S)
                return done.returncode, done.stdout

            for kind, reset, token in (
                ("python", "import coopdyn; coopdyn.connect(%s).reset()", 'token="TOKEN"'),
                ("matlab", "sim = coopdyn.connect(%s); sim.reset();", "'token', 'TOKEN'"),
            ):
                first = re.search(rf"^```{kind}\n(.*?)^```", guide, re.M | re.S).group(1)
                code, said = ran(kind, first)
                self.assertEqual(code, 0, said)
                self.assertRegex(said, r"at t = \d")
                code, said = ran(kind, reset % "")
                self.assertNotEqual(code, 0)
                self.assertIn(f"connect(..., {token})", said)
                self.assertIn('connect(..., {.token = "TOKEN"}) in C++', said)
                code, said = ran(kind, reset % token.replace("TOKEN", "chalk-and-board"))
                self.assertEqual(code, 0, said)

    def scene_guesses(self):
        with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk-and-board") as daemon:
            stranger = Stranger(daemon, "/simulation")
            guess, right = "hello eve guess\n", "hello eve chalk-and-board\n"
            stranger.write(3 * guess + right)  # immediately: the penalty may be over later
            for _ in range(3):
                self.assertIn("wrong token", stranger.receive().text)
            late = stranger.receive()
            self.assertEqual(late.error, 12)
            self.assertRegex(late.text, r"too many wrong tokens .*: wait 1 s")
            again = Stranger(daemon, "/simulation")  # another connection is the same address
            again.write(guess + right)  # the guess starts another penalty if this one is over
            self.assertEqual([again.receive().error for _ in range(2)], [12, 12])
            daemon.text("/simulation").must("hello ana chalk-and-board")  # this machine needs none
            until(lambda: "a wrong token from " + OUTER in daemon.stderr())

    def scene_guesses_over_http(self):
        with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk-and-board", "--http") as daemon:
            url = f"http://{OUTER}:{urllib.parse.urlsplit(daemon.http).port}/api/call"

            def pause(token):
                body = json.dumps({"id": 1, "module": "/simulation", "line": "pause"}).encode()
                headers = {"Content-Type": "application/json", "Authorization": "Bearer " + token}
                try:
                    return 200, urllib.request.urlopen(urllib.request.Request(url, body, headers), timeout=LIMIT_S).read().decode()
                except urllib.error.HTTPError as e:
                    return e.code, e.read().decode()

            self.assertIn("this needs the token", pause("guess")[1])
            parting = url.replace("/api/call", "/runs/one.run/parting?with=two.run")  # it repeats two runs
            for header, code in (({}, 403), ({"Authorization": "Bearer chalk-and-board"}, 404)):
                with self.assertRaises(urllib.error.HTTPError) as refused:
                    urllib.request.urlopen(urllib.request.Request(parting, headers=header), timeout=LIMIT_S)
                self.assertEqual(refused.exception.code, code)

            def locked_out():
                for _ in range(3):
                    pause("guess")
                return pause("chalk-and-board")

            code, text = until(lambda: next((said for said in [locked_out()] if said[0] != 200), None))
            self.assertEqual(code, 403)
            self.assertRegex(text, r"too many wrong tokens .*: wait \d+ s")

    def scene_names(self):
        with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0") as daemon:
            def ask(host, line):
                with socket.create_connection((host, daemon.names[1]), timeout=LIMIT_S) as names:
                    names.sendall(f"NAME_SERVER {line}\n".encode())
                    lines = names.makefile()
                    said = ""
                    while not said.endswith("*** end of message\n"):
                        said += lines.readline()
                    return said

            ask("127.0.0.1", "register /mine tcp 127.0.0.1 5")
            for line in ("unregister /mine", "set /mine key value", "register /mine tcp 127.0.0.1 6"):
                self.assertIn("*** refused", ask(OUTER, line), line)
            self.assertIn("port 5", ask(OUTER, "query /mine"))
            ask(OUTER, f"register /theirs tcp {OUTER} 7")
            self.assertNotIn("refused", ask("127.0.0.1", "unregister /theirs"))

    def scene_robots(self):
        for options, error in (([], 0), (["--private"], 12)):
            with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk-and-board", *options) as daemon:
                stranger = Stranger(daemon, "/robot1/motors")
                for line in ("set_velocity 0.1 0", "stop", "claim", "ready"):
                    self.assertEqual(stranger.ask(line).error, error, line)
                stranger.must("hello ana chalk-and-board")
                stranger.must("set_velocity 0.1 0")
                stranger.close()

    def scene_yars(self):
        """The YARS protocol has no way to send a token."""
        with tempfile.TemporaryDirectory() as folder:
            experiment = Path(folder) / "vehicle.xml"
            experiment.write_text(STILL)
            with Daemon(None, "--no-render", "--host", "0.0.0.0", "--channel-quits", name=str(experiment)) as daemon:
                port = daemon.module_port("/vehicle/channel")
                simulation = daemon.text("/simulation")
                udp = Udp(port, host=OUTER)
                udp.step([0, 0, 0])
                self.assertIn(b"not change the world", udp.ask(60, 0, 7, -1))
                self.assertFalse(udp.load(STILL))
                self.assertEqual(simulation.must("get_time").step, 5)
                udp.ask(100, -1)
                udp.close()
                tcp = Tcp(port, host=OUTER)
                tcp.reset(seed=7)
                tcp.actuators([0, 0, 0])
                tcp.sensors()
                self.assertEqual(simulation.must("get_time").step, 10)
                tcp.say("QUIT")
                self.assertEqual(tcp.read_to_end(), b"")
                simulation.must("get_time")
                until(lambda: "not change the world" in daemon.stderr())
                Tcp(port).say("QUIT")  # loopback needs no token
                until(lambda: daemon.process.poll() is not None)

    def scene_addresses(self):
        with Daemon(scenario(1), "--host", "0.0.0.0") as daemon:
            for host in ("127.0.0.1", OUTER):
                with socket.create_connection((host, daemon.names[1]), timeout=LIMIT_S) as names:
                    names.sendall(b"NAME_SERVER query /robot1/motors\n")
                    answer = names.makefile().readline()
                self.assertIn(f" ip {host} ", answer)  # the address at which it was asked, never 0.0.0.0
        with Daemon(scenario(1)) as daemon:  # without --host: this machine only
            with self.assertRaises(ConnectionRefusedError):
                socket.create_connection((OUTER, daemon.names[1]), timeout=LIMIT_S)

    def scene_one_port(self, relay_path, port, *program):
        """Runs a client that can reach only the name port, through a relay over a Unix socket. Without a program, uses the Python
        client in this process."""
        def onward():
            far = socket.socket(socket.AF_UNIX)
            far.connect(relay_path)
            return far

        relay(socket.create_server(("127.0.0.1", int(port))), onward)
        if program:
            done = subprocess.run(program, env={**os.environ, "COOPDYN_SERVER": f"127.0.0.1:{port}"}, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, timeout=3 * LIMIT_S)
            self.assertEqual(done.returncode, 0, done.stdout.decode())
            self.assertRegex(done.stdout.decode(), r"at t = \d")
            return
        sys.path.insert(0, str(CLIENT))
        import coopdyn
        with coopdyn.connect(f"127.0.0.1:{port}") as sim:
            robot = sim.robot("robot1")
            for _ in range(20):
                robot.get_distances()
                robot.set_velocity(0.3, 0.1)
                sim.step()
            self.assertGreater(robot.get_pose().x, 0.01)


class NetworkTest(unittest.TestCase):
    def test_strangers_change_the_world_only_with_the_token(self):
        inside("world")

    def test_the_shell_says_how_to_give_the_token(self):
        inside("shell")

    def test_a_silent_client_of_another_machine_stops_its_robot_after_five_seconds(self):
        inside("silence")

    def test_the_first_programs_of_the_guide_run_from_another_machine_and_a_refusal_names_the_token(self):
        inside("first_programs")

    def test_wrong_tokens_are_slowed_down_and_logged(self):
        inside("guesses")
        inside("guesses_over_http")

    def test_what_this_machine_has_registered_strangers_cannot_change(self):
        inside("names")

    def test_strangers_drive_robots_unless_the_daemon_is_private(self):
        inside("robots")

    def test_strangers_with_clients_of_yars_drive_robots_and_no_more(self):
        inside("yars")

    def test_names_are_told_with_the_address_at_which_they_were_asked(self):
        inside("addresses")

    def test_the_python_client_needs_no_port_but_that_of_the_names(self):
        self.through_one_port("lockstep")
        self.through_one_port("realtime")

    def test_the_cpp_client_needs_no_port_but_that_of_the_names(self):
        self.through_one_port("lockstep", str(Path(BINARY).parent / "clients" / "cpp" / "client_hello"))

    def test_the_octave_client_needs_no_port_but_that_of_the_names(self):
        folder = CLIENT.parent / "matlab"
        self.through_one_port("lockstep", "octave", "--no-gui", "--norc", "--quiet", "--eval",
                              f"addpath('{folder}'); hello")

    def through_one_port(self, mode, *program):
        with Daemon(scenario(1, mode=mode)) as daemon, tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "relay")
            listener = socket.socket(socket.AF_UNIX)
            listener.bind(path)
            listener.listen()
            relay(listener, lambda names=daemon.names: socket.create_connection(names))
            try:
                inside("one_port", path, daemon.names[1], *program)
            finally:
                listener.shutdown(socket.SHUT_RDWR)
                listener.close()


if __name__ == "__main__":
    set_address("lo", "127.0.0.1")
    set_address("lo:1", OUTER)
    getattr(StrangerScenes(), "scene_" + sys.argv[1])(*sys.argv[2:])
