"""Reports of a run: the summary, the exit code, and the events of its recording."""
import json
import os
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BINARY, Daemon, scenario, until

FREE = scenario(1, mode="free")
LONG = ("--mode", "free", "--speed", "1", "--duration", "1000")


def run(*arguments):
    return subprocess.run([BINARY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False)


class SummaryTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.file = self.folder / "summary.json"

    def told(self):
        return json.loads(self.file.read_text())

    def serve(self, *options, text=FREE, expect_exit=0):
        return Daemon(text, "--no-render", "--summary", str(self.file), *options, expect_exit=expect_exit)

    def test_a_run_that_reached_its_duration_says_so(self):
        with self.serve("--duration", "0.5") as daemon:
            daemon.process.wait(60)
        told = self.told()
        self.assertEqual((told["ended"], told["duration_s"], told["time_s"], told["stopped"]), ("duration", 0.5, 0.5, []))

    def test_sigterm_before_the_duration_writes_it_and_cuts_the_run_short(self):
        for signum in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            self.file.unlink(missing_ok=True)
            with self.serve(*LONG, expect_exit=5) as daemon:
                until(lambda: daemon.status()["step"] > 0)
                self.assertEqual(daemon.end(signum), 5)
                self.assertRegex(daemon.stderr(), r"ended early by a signal, at [\d.]+ of 1000 s")
            told = self.told()
            self.assertEqual(told["ended"], "signal")
            self.assertAlmostEqual(told["duration_s"], 1000)
            self.assertGreater(told["steps"], 0)
            self.assertAlmostEqual(told["rtf"] * told["wall_s"], told["time_s"])

    def test_quit_before_the_duration_cuts_the_run_short(self):
        with self.serve(*LONG, expect_exit=5) as daemon:
            daemon.text("/simulation").send("quit")
            self.assertEqual(daemon.process.wait(60), 5)
        self.assertEqual(self.told()["ended"], "quit")

    def test_without_a_duration_a_signal_and_quit_are_the_usual_end(self):
        with self.serve() as daemon:
            self.assertEqual(daemon.end(), 0)
        self.assertEqual((self.told()["ended"], self.told()["duration_s"]), ("signal", None))
        with self.serve() as daemon:
            daemon.text("/simulation").send("quit")
            self.assertEqual(daemon.process.wait(60), 0)
        self.assertEqual(self.told()["ended"], "quit")

    def test_a_duration_that_a_loaded_scenario_brings_counts(self):
        with self.serve(expect_exit=5) as daemon:
            text = FREE.replace("[SIMULATION]\n", "[SIMULATION]\nduration 1000\nspeed 1\n").replace("\n", "\\n")
            daemon.text("/simulation").must(f'load_scenario "{text}"')
            self.assertEqual(daemon.end(), 5)
        self.assertAlmostEqual(self.told()["duration_s"], 1000)

    def test_sigusr1_writes_how_the_run_stands_and_it_goes_on(self):
        with self.serve(*LONG, expect_exit=5) as daemon:
            for _ in range(2):
                self.file.unlink(missing_ok=True)
                daemon.process.send_signal(signal.SIGUSR1)
                until(self.file.exists)
                told = self.told()
                self.assertIsNone(told["ended"])
                until(lambda: daemon.status()["step"] > told["steps"])

    def test_sigusr1_without_a_summary_is_answered_in_the_log(self):
        with Daemon(FREE, *LONG, expect_exit=5) as daemon:
            daemon.process.send_signal(signal.SIGUSR1)
            until(lambda: "so far: " in daemon.stderr())
            until(lambda: daemon.status()["step"] > 0)

    def test_a_summary_never_replaces_a_recording(self):
        record = self.folder / "lesson.run"
        with Daemon(FREE, "--record", str(record), "--duration", "0.1") as daemon:
            daemon.process.wait(60)
        before = record.read_bytes()
        done = run("serve", "empty", "--no-net", "--duration", "0.1", "--mode", "free", "--summary", str(record))
        self.assertEqual(done.returncode, 2)
        self.assertEqual(record.read_bytes(), before)

    def test_a_recording_says_that_its_run_was_cut_short(self):
        record = str(self.folder / "lesson.run")
        with self.serve(*LONG, "--record", record, expect_exit=5) as daemon:
            until(lambda: daemon.status()["step"] > 0)
        done = run("info", record, "--events")
        self.assertRegex(done.stdout.decode(), r"the run ended early by a signal, at [\d.]+ of 1000 s")
        self.assertEqual(run("verify", record).returncode, 0)

    def test_steps_are_counted_in_steps_of_the_recording_that_a_run_goes_on_from(self):
        record = self.folder / "a.run"
        text = self.folder / "a.scenario"
        text.write_text(FREE)
        run("serve", text, "--mode", "free", "--no-net", "--step", "0.002", "--steps", "100", "--record", record)
        run("serve", "--from", f"{record}@#50", "--mode", "free", "--no-net", "--steps", "80", "--summary", self.file)
        self.assertEqual(self.told()["steps"], 80)

    def test_the_factor_is_counted_from_where_a_run_goes_on(self):
        record = str(self.folder / "lesson.run")
        with Daemon(FREE, "--record", record, "--duration", "20") as daemon:
            daemon.process.wait(60)
        done = run("serve", "--from", f"{record}@#1999", "--mode", "free", "--speed", "1", "--no-net", "--duration", "20.1",
                   "--summary", str(self.file))
        self.assertEqual(done.returncode, 0, done.stderr)
        told = self.told()
        self.assertAlmostEqual(told["rtf"] * told["wall_s"], 20.1 - 19.99)  # the 20 s before it do not count


class ControllerFailureTest(unittest.TestCase):
    """robot2's controller is not a shared object: its robot stands still."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "summary.json"
        (Path(folder.name) / "broken.so").write_text("not a program")
        self.scenario = Path(folder.name) / "test.scenario"
        self.scenario.write_text(scenario(2, mode="free", robot_extra={2: "controller broken"}))

    def serve(self, *options):
        done = run("serve", str(self.scenario), "--no-net", "--no-render", "--duration", "0.5", "--summary", str(self.file),
                   *options)
        return done.returncode, json.loads(self.file.read_text())

    def assert_robot2_is_told(self, told):
        self.assertEqual([(one["robot"], one["by"], one["step"], one["time_s"]) for one in told["stopped"]],
                         [("robot2", "controller", 0, 0)])
        self.assertIn("controller broken cannot be used", told["stopped"][0]["why"])

    def test_the_rest_goes_on_and_the_exit_code_says_that_one_failed(self):
        code, told = self.serve()
        self.assertEqual((code, told["ended"], told["steps"]), (4, "duration", 50))
        self.assert_robot2_is_told(told)

    def test_a_failure_before_a_load_still_counts(self):
        with Daemon(None, "--no-render", "--summary", str(self.file), name=str(self.scenario), expect_exit=4) as daemon:
            daemon.text("/simulation").must('load_scenario "' + FREE.replace("\n", "\\n") + '"')
            self.assertEqual(daemon.end(), 4)
        told = json.loads(self.file.read_text())
        self.assertEqual(told["robots"], 1)
        self.assert_robot2_is_told(told)

    def test_if_asked_to_the_run_ends(self):
        code, told = self.serve("--on-controller-failure", "stop")
        self.assertEqual((code, told["ended"], told["steps"]), (4, "controller", 0))
        self.assert_robot2_is_told(told)


class SignalledGroupTest(unittest.TestCase):
    """A batch system signals all processes of a job, including those of the controllers."""

    def processes(self, pid):
        """The processes of the controllers: the daemon's child, and its children."""
        children = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                parent = int(stat.read_text(errors="replace").rsplit(")", 1)[1].split()[1])
            except OSError:  # it has ended
                continue
            if parent == pid:
                children.append(int(stat.parent.name))
        return [each for child in sorted(children) for each in (child, *self.processes(child))]

    def test_controllers_leave_signals_to_the_daemon(self):
        text = scenario(2, mode="free", robot_extra={1: "controller diffuse", 2: "controller diffuse"})
        with Daemon(text.replace("type coopbot", "type minibot"), "--speed", "1") as daemon:
            until(lambda: len(self.processes(daemon.process.pid)) == 2)
            children = self.processes(daemon.process.pid)
            for signum in (signal.SIGUSR1, signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
                for child in children:
                    os.kill(child, signum)
            step = daemon.status()["step"]
            until(lambda: daemon.status()["step"] > step + 10)
            self.assertEqual(self.processes(daemon.process.pid), children)
            self.assertNotIn("controllers' process", daemon.stderr())

    def test_controllers_that_end_with_the_daemon_are_no_errors(self):
        text = scenario(2, mode="free", robot_extra={1: "controller diffuse", 2: "controller diffuse"})
        with Daemon(text.replace("type coopbot", "type minibot")) as daemon:
            until(lambda: daemon.status()["step"] > 0)
            for child in self.processes(daemon.process.pid):
                os.kill(child, signal.SIGTERM)
            self.assertEqual(daemon.end(), 0)
            self.assertNotRegex(daemon.stderr(), "error|controllers' process")


if __name__ == "__main__":
    unittest.main()
