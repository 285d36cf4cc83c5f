"""Recordings of live runs: they verify, keep all events, and their failures never disturb the simulation."""
import random
import re
import resource
import unittest
from pathlib import Path

from harness import BOX, LIMIT_S, Daemon, scenario, until
from recording import RecordingTestCase, change, equal_steps, rows, tool, verify


def minibots(mode="lockstep", count=4, more=""):
    return (f"[SIMULATION]\nmode {mode}\nstep 0.01\n[FLOOR]\nsize 20 20 0.1\n[SWARM_1]\ntype minibot\nname ant\n"
            f"count {count}\narea 0 0 3 3\n{more}\n")


def drive(motors, steps, seed=1):
    """Drives one robot for `steps` steps in lockstep; returns the step reached."""
    chance = random.Random(seed)
    for _ in range(steps):
        step = motors.must(f"set_wheel_speeds {chance.uniform(-5, 5)!r} {chance.uniform(-5, 5)!r}").step
    return step


class VerifyTest(RecordingTestCase):
    def test_a_run_in_lockstep_verifies_equal(self):
        chance = random.Random(5)
        with Daemon(scenario(2, extra=BOX), "--record", self.file) as daemon:
            robots = [daemon.text(f"/robot{i}/motors") for i in (1, 2)]
            simulation = daemon.text("/simulation")
            for k in range(150):
                for robot in robots:
                    robot.send(f"set_wheel_speeds {chance.uniform(-5, 5)!r} {chance.uniform(-5, 5)!r}")
                for robot in robots:
                    self.assertEqual(robot.receive().error, 0)
                if k == 40:
                    simulation.must("set_step 0.004")
                if k == 80:
                    simulation.must("stop_all")
                if k == 120:
                    simulation.must("set_step 0.01")
            hash_ = daemon.status()["hash"]
        self.assertEqual(equal_steps(self.file), 150)
        last = rows(self.file, "SELECT hash FROM step ORDER BY step DESC LIMIT 1")[0][0]
        self.assertEqual(f"{last % 2**64:016x}", hash_)

    def test_a_run_in_real_time_verifies_equal(self):
        with Daemon(scenario(2, mode="realtime", extra=BOX), "--record", self.file) as daemon:
            robots = [daemon.text(f"/robot{i}/motors") for i in (1, 2)]
            for k in range(30):
                robots[k % 2].must(f"set_velocity {0.02 * k} {0.1 * (k % 5)}")
                step = robots[k % 2].must(f"ready {1 + k % 3}").step
        self.assertGreaterEqual(rows(self.file, "SELECT max(step) FROM step")[0][0], step)
        verify(self.file)

    def test_a_run_with_loaded_controllers_verifies_equal(self):
        with Daemon(minibots(more="controller flock"), "--record", self.file, "--mode", "free", "--duration", "4") as daemon:
            daemon.process.wait(LIMIT_S)
        self.assertEqual(equal_steps(self.file), 400)

    def test_two_runs_alike_are_equal_and_others_part_where_they_do(self):
        other, third = self.folder / "other.run", self.folder / "third.run"
        for file, seed in ((self.file, 1), (other, 1), (third, 2)):
            with Daemon(scenario(1), "--record", file) as daemon:
                motors = daemon.text("/robot1/motors")
                drive(motors, 20)
                drive(motors, 20, seed)
        self.assertEqual(equal_steps(self.file, other), 40)
        code, said = tool("verify", self.file, third)
        self.assertEqual(code, 1, said)
        self.assertIn("21", said)
        self.assertIn("robot1", said)

    def test_one_bit_of_a_recorded_command_is_found(self):
        with Daemon(scenario(1), "--record", self.file) as daemon:
            drive(daemon.text("/robot1/motors"), 60)
        blob = bytearray(rows(self.file, "SELECT commands FROM step WHERE step = 37")[0][0])
        blob[4] ^= 1  # the last bit of the left wheel's speed
        change(self.file, "UPDATE step SET commands = ? WHERE step = 37", bytes(blob))
        code, said = tool("verify", self.file)
        self.assertEqual(code, 1, said)
        self.assertIn("step 37", said)
        self.assertIn("robot1", said)


class FileTest(RecordingTestCase):
    def test_what_is_there_is_not_overwritten_without_force(self):
        with Daemon(scenario(1), "--record", self.file) as daemon:
            drive(daemon.text("/robot1/motors"), 7)
        before = self.file.read_bytes()
        code, said = tool("serve", "empty", "--port", "0", "--no-http", "--record", self.file)
        self.assertEqual(code, 1, said)
        self.assertIn("--force", said)
        self.assertEqual(self.file.read_bytes(), before)
        with Daemon(scenario(1), "--record", self.file, "--force") as daemon:
            drive(daemon.text("/robot1/motors"), 5)
        self.assertEqual(equal_steps(self.file), 5)

    def test_it_carries_what_it_needs(self):
        with Daemon(scenario(1), "--record", self.file, "--seed", "77") as daemon:
            drive(daemon.text("/robot1/motors"), 3)
            text = Path(daemon.folder.name, "test.scenario").read_text()
        meta = dict(rows(self.file, "SELECT key, value FROM meta"))
        self.assertEqual(meta["seed"], "77")
        self.assertEqual(meta["mode"], "lockstep")
        self.assertEqual(meta["closed"], 1)
        self.assertIn("--record", meta["command"])
        texts = {(kind, name): content for kind, name, content in rows(self.file, "SELECT kind, name, content FROM text")}
        self.assertEqual([content for (kind, _), content in texts.items() if kind == "scenario"], [text])
        self.assertIn("<sdf", texts["robot", "coopbot"])

    def test_after_a_reset_it_goes_on_in_another_file(self):
        with Daemon(scenario(1), "--record", self.file) as daemon:
            motors, simulation = daemon.text("/robot1/motors"), daemon.text("/simulation")
            drive(motors, 30)
            simulation.must("reset")
            drive(motors, 20)
            simulation.must("reset 9")
            drive(motors, 10)
        for name, steps, seed in (("lesson.run", 30, "1"), ("lesson-2.run", 20, "1"), ("lesson-3.run", 10, "9")):
            self.assertEqual(equal_steps(self.folder / name), steps)
            self.assertEqual(rows(self.folder / name, "SELECT value FROM meta WHERE key = 'seed'")[0][0], seed)

    def test_a_restored_state_goes_on_in_another_file(self):
        with Daemon(scenario(1), "--record", self.file) as daemon:
            motors, simulation = daemon.text("/robot1/motors"), daemon.text("/simulation")
            drive(motors, 20)
            simulation.must("save middle")
            drive(motors, 10)
            simulation.must("restore middle")
            drive(motors, 15)
        self.assertEqual(equal_steps(self.file), 30)
        second = self.folder / "lesson-2.run"
        self.assertEqual(equal_steps(second), 15)
        self.assertEqual(rows(second, "SELECT min(step), max(step) FROM step"), [(20, 35)])

    def test_controllers_start_afresh_with_a_reset_and_are_verified(self):
        with Daemon(minibots(more="controller diffuse"), "--record", self.file, "--mode", "free", "--paused") as daemon:
            simulation = daemon.text("/simulation")
            hashes = []
            for _ in range(2):
                simulation.must("step 50")
                hashes.append(daemon.status()["hash"])
                simulation.must("reset")
            self.assertEqual(hashes[0], hashes[1])
        for name in ("lesson.run", "lesson-2.run"):
            self.assertEqual(equal_steps(self.folder / name), 50)


class RecorderModuleTest(RecordingTestCase):
    def test_a_recording_is_started_marked_and_stopped_by_socket(self):
        with Daemon(scenario(1), "--recordings", self.folder) as daemon:
            recorder, motors = daemon.text("/recorder"), daemon.text("/robot1/motors")
            drive(motors, 10)
            self.assertEqual(recorder.must("get_recording").params, [0])
            self.assertEqual(recorder.must("start lesson").text, "lesson.run")
            drive(motors, 10)
            recorder.must('note "the box falls"')
            drive(motors, 10)
            status = recorder.must("get_recording")
            self.assertEqual(status.params, [1])
            self.assertEqual(status.text, "lesson.run")
            self.assertTrue(recorder.must("stop").text.startswith("lesson.run"))
            drive(motors, 10)
            self.assertNotEqual(recorder.ask("start lesson").error, 0)
        self.assertEqual(rows(self.file, "SELECT min(step), max(step) FROM step"), [(10, 30)])
        self.assertEqual(rows(self.file, "SELECT step FROM event WHERE text LIKE '%the box falls%'"), [(20,)])
        self.assertEqual(equal_steps(self.file), 20)


FULL_BYTES = 2 << 20


def small_files():
    """Limits the size of the process's files, as a full disk does."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (FULL_BYTES, FULL_BYTES))


class FullDiskTest(RecordingTestCase):
    def daemon(self, *options):
        # Five times real time, so that the disk is full after some commits.
        return Daemon(minibots(count=20), "--mode", "free", "--speed", "5", "--record", self.file, *options,
                      before_exec=small_files, expect_exit=4)

    def test_it_holds_the_recording_up_with_an_event_and_not_the_simulation(self):
        with self.daemon() as daemon:
            event = until(lambda: [event for event in daemon.status()["events"] if "lesson.run" in event["text"]])[0]
            self.assertEqual(event["level"], "error")
            self.assertIn("it goes on by itself when there is room", event["text"])
            # Not even where SQLite restarts its journal.
            resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (1, 1))
            before = daemon.status()["step"]
            self.assertGreaterEqual(daemon.text("/simulation").must("ready 100").step, before + 100)
            until(lambda: daemon.status()["recording_lost"] > 0)
            until(lambda: "it goes on by itself when there is room" in (daemon.status()["recording_stalled"] or ""))
            says = re.compile(r"not recording to lesson\.run for now, \d+ steps? lost\n  .*when there is room\n")
            until(lambda: says.search(tool("status", "--server", "%s:%d" % daemon.names)[1]))
        self.assertLessEqual(self.file.stat().st_size, FULL_BYTES)
        self.assertGreater(equal_steps(self.file), 0)

    def test_with_stop_it_ends_the_run(self):
        with self.daemon("--on-record-failure", "stop") as daemon:
            self.assertEqual(daemon.process.wait(LIMIT_S), 4)
            self.assertIn("lesson.run", daemon.stderr())
        self.assertGreater(equal_steps(self.file), 0)


class FolderTest(RecordingTestCase):
    def test_the_folder_of_recordings_is_made(self):
        folder = self.folder / "of" / "lessons"
        with Daemon(scenario(1), "--recordings", folder) as daemon:
            recorder = daemon.text("/recorder")
            recorder.must("start lesson1")
            daemon.text("/robot1/motors").must("set_wheel_speeds 2 3")
            recorder.must("stop")
        self.assertTrue((folder / "lesson1.run").is_file())

    def test_all_modules_say_at_the_end_that_the_daemon_is_stopping(self):
        with Daemon(scenario(1)) as daemon:
            names = ("/simulation", "/recorder", "/playback", "/swarm", "/robot1/motors")
            modules = [daemon.text(name) for name in names]
            for module in modules:
                module.must("hello test")  # it has arrived
            self.assertEqual(daemon.end(), 0)
            for name, module in zip(names, modules):
                self.assertIn("the daemon is stopping", module.read_to_end().decode(), name)


if __name__ == "__main__":
    unittest.main()
