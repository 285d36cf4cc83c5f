# SPDX-License-Identifier: MIT
"""coopdyn.launch(): a private daemon that exits with its program, however that ends."""
import glob
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

import harness

sys.path.insert(0, str(harness.ROOT / "clients" / "python"))
import coopdyn  # noqa: E402

TEXT = "[SIMULATION]\nmode lockstep\n[ROBOT_1]\ntype coopbot\nname ana\nposition 0 0\n"
LIMIT_S = 60


def daemons():
    """Process ids of daemons launched by this process's programs."""
    found = []
    for line in glob.glob("/proc/[0-9]*/cmdline"):
        try:
            words = pathlib.Path(line).read_bytes().split(b"\0")
        except OSError:
            continue
        if b"--with-process" in words:
            found.append((int(line.split("/")[2]), int(words[words.index(b"--with-process") + 1])))
    return found


def of_process(process):
    return [daemon for daemon, parent in daemons() if parent == process]


def until(condition):
    limit = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < limit, "still not so"
        time.sleep(0.01)


class LaunchTest(unittest.TestCase):
    def tearDown(self):
        self.assertEqual(of_process(os.getpid()), [], "no daemon is left")

    def test_it_starts_a_scenario_by_its_name_and_ends_with_the_with(self):
        with coopdyn.launch("classroom", mode="lockstep") as sim:
            self.assertEqual((sim.status()["scenario"], sim.mode), ("classroom", "lockstep"))
            self.assertEqual(len(of_process(os.getpid())), 1)
            robot = sim.robot("robot1")
            robot.set_velocity(0.2, 0)
            sim.step(10)
            self.assertEqual(sim.steps, 10)

    def test_it_takes_a_text_settings_and_a_seed(self):
        with coopdyn.launch(TEXT, set={"ROBOT_1.position": (1, 2), "SCORE_1.kind": "distance"}, seed=7) as sim:
            self.assertEqual(sim.robot("ana").get_pose()[:2], (1, 2))
            self.assertEqual((sim.status()["seed"], sim.scores()), (7, {"distance": 0}))

    def test_it_takes_a_file_and_records(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "own.scenario")
            file.write_text(TEXT)
            record = os.path.join(folder, "own.run")
            with coopdyn.launch(str(file), record=record, options=["--no-http"]) as sim:
                robot = sim.robot("ana")
                robot.set_velocity(0.1, 0)
                sim.step(5)
            self.assertEqual(list(coopdyn.read_run(record).steps)[:6], [0, 1, 2, 3, 4, 5])

    def test_close_ends_it_too_and_twice_does_no_harm(self):
        sim = coopdyn.launch(TEXT)
        sim.close()
        self.assertEqual(of_process(os.getpid()), [])
        sim.close()

    def test_who_forgets_its_sim_leaves_no_daemon(self):
        for _ in range(3):
            sim = coopdyn.launch(TEXT)
            self.assertEqual(len(of_process(os.getpid())), 1)
            del sim

    def test_what_is_wrong_with_a_scenario_is_told(self):
        with self.assertRaises(coopdyn.Error) as caught:
            coopdyn.launch(TEXT.replace("coopbot", "cooopbot"))
        self.assertEqual(caught.exception.code, 7)
        self.assertIn("did you mean 'coopbot'?", caught.exception.text)
        with self.assertRaisesRegex(coopdyn.Error, "--set ROBOT_1.positon=1 2: error: unknown word 'positon'"):
            coopdyn.launch(TEXT, set={"ROBOT_1.positon": (1, 2)})
        with self.assertRaisesRegex(coopdyn.Error, "there is no such scenario"):
            coopdyn.launch("clasroom")

    def test_a_program_that_is_not_there_is_told(self):
        with self.assertRaisesRegex(coopdyn.Error, "/nowhere/coopdyn cannot be started"):
            coopdyn.launch(TEXT, program="/nowhere/coopdyn")

    def test_a_loop_of_a_hundred_leaves_nothing_behind(self):
        folder = tempfile.TemporaryDirectory()  # private, because other tests run meanwhile
        self.addCleanup(folder.cleanup)
        changed = unittest.mock.patch.dict(os.environ, TMPDIR=folder.name)
        changed.start()
        self.addCleanup(changed.stop)
        opened = len(os.listdir("/proc/self/fd"))
        for seed in range(100):
            with coopdyn.launch(TEXT, seed=seed, options=["--no-http", "--no-render"]) as sim:
                self.assertEqual(sim.status()["seed"], seed)
        self.assertEqual(len(os.listdir("/proc/self/fd")), opened)
        self.assertEqual(os.listdir(folder.name), [])


class OtherProgramTest(unittest.TestCase):
    """A separate program launches a daemon and ends in many ways."""

    def launched(self, rest):
        code = (f"import sys\nsys.path.insert(0, {str(harness.ROOT / 'clients' / 'python')!r})\nimport coopdyn, time\n"
                f"sim = coopdyn.launch({TEXT!r})\nprint('launched', flush=True)\n{rest}\n")
        program = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.stdout.close)
        self.addCleanup(program.wait)
        self.addCleanup(program.kill)
        self.assertEqual(program.stdout.readline(), "launched\n")
        return program

    def ends(self, program):
        until(lambda: not of_process(program.pid))

    def test_killed_by_force(self):
        program = self.launched("time.sleep(1000)")
        self.assertEqual(len(of_process(program.pid)), 1)
        program.send_signal(signal.SIGKILL)
        self.ends(program)

    def test_ctrl_c(self):
        program = self.launched("time.sleep(1000)")
        program.send_signal(signal.SIGINT)
        self.ends(program)

    def test_an_error(self):
        self.ends(self.launched("raise RuntimeError"))

    def test_its_end_without_close(self):
        program = self.launched("")
        self.ends(program)
        self.assertEqual(program.wait(LIMIT_S), 0)


class WithProcessTest(unittest.TestCase):
    def test_a_process_that_is_not_there_is_wrong_use(self):
        gone = 2 ** 22 + 1  # beyond the kernel's largest pid
        done = subprocess.run([os.environ["COOPDYN_BINARY"], "serve", "--port", "0", "--with-process", str(gone)],
                              capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 2)
        self.assertIn("write the number of a process that runs", done.stderr)


if __name__ == "__main__":
    unittest.main()
