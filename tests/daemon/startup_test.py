"""How the daemon starts, reports errors, and exits."""
import contextlib
import json
import os
import pty
import re
import signal
import socket
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon, scenario, until, with_own_ports


def run(*arguments, **more):
    return subprocess.run([BINARY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, **more)


class MistakeTest(unittest.TestCase):
    """Each mistake is one clear line, with the right exit code."""

    def refused(self, text, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "wrong.scenario"
            path.write_text(text)
            done = run("serve", str(path), "--port", "0", *options)
            self.assertEqual(done.stdout, b"")
            self.assertEqual(done.returncode, 1)
            return done.stderr.decode()

    def test_a_port_in_use_names_the_port_and_the_flag(self):
        with socket.socket() as busy:
            busy.bind(("127.0.0.1", 0))
            busy.listen()
            port = busy.getsockname()[1]
            done = run("serve", "classroom", "--port", str(min(port, 65000)), "--name-port", str(port))
            self.assertEqual(done.returncode, 1)
            said = done.stderr.decode()
            self.assertIn(str(port), said)
            self.assertIn("--port", said)
            self.assertEqual(len(said.strip().splitlines()), 1, said)

    def test_names_and_page_may_take_other_ports_than_those_in_use(self):
        with socket.create_server(("127.0.0.1", 0)) as busy:
            port = str(busy.getsockname()[1])
            with Daemon(scenario(), "--any-port", "--name-port", port, "--http-port", port, "--http", "--no-render") as daemon:
                self.assertNotEqual(daemon.names[1], int(port))
                self.assertNotIn(":" + port, daemon.http)

    def test_channels_take_no_port_of_the_daemons_own(self):
        for options in (("--port", "14000", "--channel-port", "14000"), ("--port", "14000", "--channel-port", "14001"),
                        ("--port", "14000", "--channel-port", "15999"), ("--port", "0", "--name-port", "14000", "--channel-port", "14000"),
                        ("--port", "0", "--http-port", "14001", "--channel-port", "14001")):
            done = run("serve", "classroom", *options)
            self.assertNotEqual(done.returncode, 0, options)
            self.assertEqual(done.stdout, b"")
            said = done.stderr.decode()
            self.assertRegex(said, r"--channel-port \d+ is one of the daemon's own", options)
            self.assertIn("write another one", said)

    def test_a_missing_file_is_one_line(self):
        done = run("serve", "no_such_scenario", "--port", "0")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(len(done.stderr.decode().strip().splitlines()), 1)
        self.assertIn("no_such_scenario", done.stderr.decode())

    def test_an_unknown_robot_type_is_one_line_with_its_place(self):
        said = self.refused(scenario(1).replace("type coopbot", "type cooopbot"))
        self.assertRegex(said, r"wrong\.scenario:\d+: error: .*cooopbot")
        self.assertEqual(len(said.strip().splitlines()), 1, said)

    def test_two_robots_of_one_name_are_one_line(self):
        said = self.refused(scenario(2).replace("name robot2", "name robot1"))
        self.assertRegex(said, r"wrong\.scenario:\d+: error: .*robot1")
        self.assertEqual(len(said.strip().splitlines()), 1, said)

    def test_robots_inside_one_another_are_refused_at_their_line(self):
        said = self.refused(scenario(2).replace("position 0 2 0", "position 0.1 0 0"))
        self.assertRegex(said, r"wrong\.scenario:\d+: error: ")

    def test_wrong_use_is_exit_code_2_with_one_line(self):
        for arguments in (("serve", "--mode", "quick"), ("serve", "--step", "3"), ("frobnicate",), (), ("step", "x"),
                          ("serve", "--port", "99999"), ("serve", "--seed", "-1"), ("serve", "--speed", "nan"),
                          ("serve", "--token", "x y")):
            done = run(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertEqual(len(done.stderr.decode().strip().splitlines()), 1, (arguments, done.stderr))

    def test_wrong_use_says_what_to_write(self):
        for arguments, wanted in ((("serve", "a", "b"), "b is one word too many (coopdyn serve --help shows how to write it)"),
                                  (("serve", "--prot", "1"), "there is no option --prot: did you mean --port?"),
                                  (("serve", "--port", "1", "--port", "2"), "--port may be given once"),
                                  (("serve", "--record"), "--record needs a value"),
                                  (("serve", "classroom", "--record", "--mode", "free"),
                                   "--record needs a value (coopdyn serve --help shows how to write it)"),
                                  (("export", "a.run", "--to", "png", "--eye", "1,2"), "--eye takes 3 numbers"),
                                  (("export", "a.run", "--to", "csv", "--from", "x"), "--from must be a number, not x"),
                                  (("check", "a.run"), "there is no such scenario"),
                                  (("describe", "robot"), "describe robot takes a name, one of balancer, car, coopbot, "),
                                  (("export",), "RUN is missing (coopdyn export --help shows how to write it)")):
            self.assertIn(wanted, run(*arguments).stderr.decode())

    def test_a_wrong_value_names_its_source_and_what_is_possible(self):
        cases = (((("serve", "--port", "80x"), {}), ("--port", "0 to 65000", "80x")),
                 ((("serve", "--mode", "realtim"), {}), ("--mode", "lockstep", "did you mean realtime?")),
                 ((("serve",), {"COOPDYN_MODE": "foo"}), ("COOPDYN_MODE", "lockstep", "foo")),
                 ((("describe", "thing", "x"), {}), ("KIND", "robot", "thing")),
                 ((("serve", "--config", "/nope"), {}), ("--config /nope", "No such file")),
                 ((("serve", "--record", "/nonexist/x.run"), {}), ("--record", "no folder /nonexist")))
        for (words, env), wanted in cases:
            done = run(*words, env={**os.environ, **env})
            self.assertEqual(done.returncode, 2, done)
            for word in wanted:
                self.assertIn(word, done.stderr.decode())

    def test_a_file_that_is_no_scenario_is_told_what_it_is(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, wanted in (("a.run", "this is a recorded run: coopdyn play"), ("notes", "write ./notes to read")):
                Path(folder, name).touch()
                self.assertIn(wanted, run("check", name, cwd=folder).stderr.decode())

    def test_a_folder_is_not_checked_and_a_missing_recording_has_near_names(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("folder", run("check", folder).stderr.decode())
            Path(folder, "lesson1.run").touch()
            self.assertIn("did you mean", run("info", folder + "/lesson2.run").stderr.decode())

    def test_a_weak_token_is_refused_where_others_can_try_tokens(self):
        done = run("serve", "empty", "--port", "0", "--host", "0.0.0.0", "--token", "chalk")
        self.assertEqual(done.returncode, 2)
        said = done.stderr.decode()
        self.assertEqual(len(said.strip().splitlines()), 1, said)
        self.assertIn("write at least 12", said)
        self.assertIn("--weak-token", said)
        done = run("serve", "empty", "--port", "0", "--host", "0.0.0.0", "--token", "é" * 11)
        self.assertIn("--token has 11 characters", done.stderr.decode())
        with Daemon(scenario(1, mode="realtime"), "--host", "0.0.0.0", "--token", "chalk", "--weak-token"):
            pass
        with Daemon(scenario(1, mode="realtime"), "--token", "chalk"):  # nobody else can try
            pass

    def test_no_daemon_there_is_exit_code_3(self):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            port = unused.getsockname()[1]
        for command in (["status"], ["list"], ["call", "/robot1/motors", "stop"], ["doctor"]):
            done = run(*command, "--server", f"127.0.0.1:{port}")
            self.assertEqual(done.returncode, 3, (command, done))

    def test_the_server_flag_overrides_the_variable(self):
        with socket.socket() as unused, Daemon(scenario(1)) as daemon:
            unused.bind(("127.0.0.1", 0))  # and does not listen
            port = unused.getsockname()[1]
            env = {**os.environ, "COOPDYN_SERVER": f"127.0.0.1:{daemon.names[1]}"}
            self.assertEqual(run("status", env=env).returncode, 0)
            for command in (["status"], ["pause"], ["call", "/robot1/motors", "stop"]):
                self.assertEqual(run(*command, "--server", f"127.0.0.1:{port}", env=env).returncode, 3, command)
            self.assertEqual(daemon.status()["state"], "waiting")

    def test_an_unknown_command_is_named_and_the_known_ones_listed(self):
        said = run("frobnicate").stderr.decode()
        self.assertIn("frobnicate", said)
        self.assertIn("serve", said)

    def test_help_of_every_command_shows_an_example(self):
        for command in ("serve", "check", "list", "status", "run", "pause", "step", "reset", "reload", "load", "stop-all",
                        "quit", "call", "doctor"):
            done = run(command, "--help")
            self.assertEqual(done.returncode, 0, command)
            self.assertIn(f"Example: coopdyn {command}", done.stdout.decode())

    def test_help_of_yars_has_a_line_for_each_option(self):
        lines = run("yars", "--help").stdout.decode().splitlines()
        self.assertTrue(any(line.lstrip().startswith("--seed ") for line in lines), lines)
        self.assertTrue(any(line.lstrip().startswith("--printComPortsToFile ") for line in lines), lines)


class SilentServerTest(unittest.TestCase):
    def test_a_server_that_does_not_answer_is_left(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            done = run("status", "--server", f"127.0.0.1:{server.getsockname()[1]}")
        self.assertEqual(done.returncode, 3)
        self.assertIn(b"does not answer", done.stderr)


class RemoteTest(unittest.TestCase):
    def setUp(self):
        self.daemon = Daemon(scenario(1))
        self.addCleanup(self.daemon.__exit__, None, None, None)
        self.server = f"{self.daemon.names[0]}:{self.daemon.names[1]}"

    def ask(self, *words, code=0):
        done = run(*words, "--server", self.server)
        self.assertEqual(done.returncode, code, (words, done))
        return (done.stdout + done.stderr).decode()

    def test_the_run_is_steered_from_the_command_line(self):
        self.assertIn("/robot1/motors", self.ask("list"))
        self.assertIn("waiting for robot1 (no client)", self.ask("status"))
        self.ask("pause")
        self.assertIn("paused", self.ask("status"))
        self.ask("run")
        self.ask("step", "3", code=1)
        self.ask("reset", "7")
        self.assertEqual(self.daemon.status()["seed"], 7)
        self.ask("load", "corridor")
        self.assertEqual(self.daemon.status()["scenario"], "corridor")
        self.ask("reload")
        self.ask("stop-all")
        self.ask("load", "nothing_of_that_name", code=1)
        self.assertIn("did you mean 'classroom'?", self.ask("load", "clas", code=1))

    def test_any_command_of_any_module_can_be_called(self):
        self.assertTrue(self.ask("call", "/robot1/motors", "set_velocity", "0.2", "-0.5").startswith('0 "" 11 1 1 '))
        self.assertIn(" 31 ", self.ask("call", "/robot1/target", "get_target", "red"))
        self.assertIn("set_velocity", self.ask("call", "/robot1/motors", "set_velocity", "0.2", code=1))
        self.assertIn("# This is a motors module", self.ask("call", "/robot1/motors", "help"))
        self.assertIn("takes nothing", self.ask("call", "/robot1/motors", "verbose", "on", code=1))
        self.ask("call", "/robot9/motors", "stop", code=1)

    def test_a_file_of_this_machine_is_loaded_by_its_text(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "mine.scenario"
            path.write_text(scenario(3))
            self.ask("load", str(path))
        self.assertEqual(len(self.daemon.status()["robots"]), 3)

    def test_doctor_finds_nothing_wrong(self):
        self.assertNotIn("FAILED", self.ask("doctor"))

    def test_quit_ends_the_daemon_in_order(self):
        self.ask("quit")
        self.assertEqual(self.daemon.process.wait(60), 0)


def thread_names(process):
    names = []
    for thread in Path(f"/proc/{process}/task").iterdir():
        with contextlib.suppress(OSError):  # it has ended
            names.append((thread / "comm").read_text().strip())
    return names


@contextlib.contextmanager
def many_robots():
    """The file of a scenario that takes some time to start."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "many.scenario"
        file.write_text("[FLOOR]\nsize 1000 1000 0.1\n[SWARM_1]\ntype minibot\nname ant\ncount 100000\nsockets no\n")
        yield file


class EndTest(unittest.TestCase):
    def test_signals_end_the_daemon_under_load_with_exit_code_0(self):
        for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with Daemon(name="arena20") as daemon:
                daemon.text("/simulation").must("set_mode free")
                stop, loading = threading.Event(), threading.Semaphore(0)

                def load():
                    try:
                        motors = daemon.text("/robot_1/motors")
                        motors.must("subscribe")
                        motors.ask("set_velocity 0.1 0.1")
                        loading.release()
                        while not stop.is_set():
                            motors.ask("set_velocity 0.1 0.1")
                    except (EOFError, ConnectionError, OSError):
                        pass

                workers = [threading.Thread(target=load) for _ in range(4)]
                for worker in workers:
                    worker.start()
                self.assertTrue(all(loading.acquire(timeout=LIMIT_S) for _ in workers))
                until(lambda: daemon.status()["step"] > 10)
                self.assertEqual(daemon.end(signum), 0)
                stop.set()
                for worker in workers:
                    worker.join()

    def test_a_signal_while_it_starts_ends_it_at_once(self):
        with many_robots() as file:
            process = subprocess.Popen([BINARY, "serve", file, "--port", "0"], stdout=subprocess.PIPE)
            self.addCleanup(process.stdout.close)
            self.addCleanup(process.kill)
            until(lambda: "signals" in thread_names(process.pid))
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(LIMIT_S), -signal.SIGTERM)
            self.assertEqual(process.stdout.read(), b"", "it was not ready")

    def test_nohup_keeps_it_from_its_terminals_end_and_ctrl_c_ends_it_in_the_background_too(self):
        def as_nohup_in_a_script():
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # as sh does to what it starts with &

        with Daemon(before_exec=as_nohup_in_a_script) as daemon:
            daemon.process.send_signal(signal.SIGHUP)
            daemon.process.send_signal(signal.SIGUSR1)  # of signals that wait, the lower number is taken first
            until(lambda: "so far" in daemon.stderr())
            self.assertEqual(daemon.end(signal.SIGINT), 0)
        with many_robots() as file:
            process = subprocess.Popen([BINARY, "serve", file, "--port", "0"], stdout=subprocess.PIPE, preexec_fn=as_nohup_in_a_script)
            self.addCleanup(process.stdout.close)
            self.addCleanup(process.kill)
            until(lambda: "signals" in thread_names(process.pid))
            process.send_signal(signal.SIGHUP)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(LIMIT_S), -signal.SIGINT)

    def test_waiting_clients_get_a_notice_when_the_daemon_ends(self):
        with Daemon(scenario(2)) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.send("set_velocity 0.2 0")
            until(lambda: daemon.awaited() == ["robot2"])
            self.assertEqual(daemon.end(), 0)
            self.assertIn("stopping", motors.read_to_end().decode())

    def test_a_run_with_a_duration_ends_by_itself_and_writes_a_summary(self):
        with tempfile.TemporaryDirectory() as folder:
            summary = Path(folder) / "s.json"
            done = run("serve", "arena20", "--mode", "free", "--duration", "2", "--no-net", "--no-render", "--summary",
                       str(summary))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.decode().strip(), "ready names=off http=off robots=20")
            told = json.loads(summary.read_text())
            self.assertEqual((told["steps"], told["time_s"], told["robots"]), (200, 2, 20))
            self.assertRegex(told["hash"], "^[0-9a-f]{16}$")

    def test_a_summary_that_cannot_be_written_is_refused_at_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "file"
            file.write_text("kept")
            for summary in (f"{folder}/none/s.json", f"{file}/s.json", folder):
                done = run("serve", "empty", "--mode", "free", "--no-net", "--duration", "0.1", "--summary", summary)
                self.assertEqual((done.returncode, done.stdout), (2, b""), summary)
                self.assertRegex(done.stderr.decode(), rf"\Acoopdyn: --summary {re.escape(summary)} .*\n\Z")

    def test_the_file_of_the_summary_stays_as_it_is_until_the_end(self):
        with tempfile.TemporaryDirectory() as folder:
            old = Path(folder) / "old.json"
            old.write_text("kept")
            for summary in (old, Path(folder) / "new.json"):
                done = run("serve", "no_such_scenario", "--no-net", "--summary", str(summary))
                self.assertEqual(done.returncode, 1)
            self.assertEqual((old.read_text(), os.listdir(folder)), ("kept", ["old.json"]))

    def test_a_request_that_waits_when_the_duration_ends_is_answered(self):
        with Daemon(scenario(1), "--duration", "0.05") as daemon:
            motors = daemon.text("/robot1/motors")
            reply = motors.ask("ready 10")
            self.assertEqual((reply.error, reply.text), (5, "the run has ended: it has reached its duration"))
            self.assertEqual(daemon.process.wait(60), 0)

    def test_a_lockstep_run_that_nobody_could_drive_is_refused(self):
        done = run("serve", "formation", "--mode", "lockstep", "--no-net", "--duration", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--mode free", done.stderr.decode())

    def test_the_log_says_whom_the_world_waits_for(self):
        with Daemon(scenario(1)) as daemon:
            until(lambda: "waiting for robot1 (no client)" in daemon.stderr())

    def test_a_log_line_stands_above_the_bar_of_a_terminal(self):
        terminal, side = pty.openpty()
        said = bytearray()

        def is_logged():
            said.extend(os.read(terminal, 4096))  # there is a new bar soon
            return re.search(rb"waiting for robot1[^\n]*\n.*\[", said)

        with Daemon(scenario(1), "--duration", "5", before_exec=lambda: os.dup2(side, 2), expect_exit=5):
            until(is_logged)
        os.close(side)
        os.close(terminal)
        self.assertRegex(said, rb"\x1b\[\?7h\r\x1b\[K[\d:.+ -]+ info: waiting for robot1[^\n]*\n\x1b\[\?7l\[")

    def test_two_runs_of_one_scenario_and_seed_give_the_same_hash(self):
        hashes = set()
        with tempfile.TemporaryDirectory() as folder:
            for threads in ("1", "1", "4"):
                summary = Path(folder) / "s.json"
                run("serve", "formation", "--mode", "free", "--duration", "1", "--no-net", "--robot-threads", threads,
                    "--summary", str(summary))
                hashes.add(json.loads(summary.read_text())["hash"])
        self.assertEqual(len(hashes), 1)


class OptionTest(unittest.TestCase):
    def test_flags_override_variables_which_override_the_config_file(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder) / "c.ini"
            config.write_text("mode=free\nstep=0.02\nseed=5\n")
            with Daemon(scenario(1).replace("mode lockstep\nstep 0.01\n", ""), "--config", str(config), "--seed", "9",
                        "--paused", env={"COOPDYN_STEP": "0.005"}) as daemon:
                status = daemon.status()
                self.assertEqual((status["mode"], status["step_s"], status["seed"]), ("free", 0.005, 9))

    def test_the_log_goes_to_a_file_too_with_dates_and_zone(self):
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "night.log"
            with Daemon(scenario(1), "--log-file", str(log)) as daemon:
                until(lambda: "waiting for robot1" in log.read_text())
                self.assertIn(log.read_text(), daemon.stderr())
            self.assertRegex(log.read_text(), r"\A\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3}[+-]\d\d:\d\d info: waiting for robot1 ")

    def test_a_log_file_that_cannot_be_written_is_refused_at_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            for log in (folder, f"{folder}/none/night.log"):
                done = run("serve", "empty", "--port", "0", "--log-file", log)
                self.assertEqual((done.returncode, done.stdout), (2, b""), log)
                self.assertRegex(done.stderr.decode(), rf"\Acoopdyn: --log-file {re.escape(log)} .*\n\Z")

    @with_own_ports
    def test_ports_come_in_one_block_in_the_documented_order(self):
        base = 20000
        process = subprocess.Popen([BINARY, "serve", "formation", "--port", str(base), "--no-render"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            ready = process.stdout.readline().decode()
            self.assertIn(f"names=127.0.0.1:{base} http=http://127.0.0.1:{base + 1}/", ready)
            listing = run("list", "--server", f"127.0.0.1:{base}").stdout.decode()
            ports = {line.split()[0]: int(line.rsplit(":", 1)[1]) for line in listing.splitlines()}
            for index, module in enumerate(("motors", "distance", "target", "pose")):
                self.assertEqual(ports[f"/robot1/{module}"], base + 2 + index)
                self.assertEqual(ports[f"/robot5/{module}"], base + 18 + index)
            self.assertEqual(ports["/simulation"], base + 22)
        finally:
            process.terminate()
            process.communicate()


if __name__ == "__main__":
    unittest.main()
