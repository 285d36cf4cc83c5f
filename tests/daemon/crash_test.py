"""A recording whose daemon is killed: it opens, is repaired, verifies, and has all committed data."""
import os
import random
import tempfile
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from harness import Daemon, frame, scenario, until
from recording import SANITIZED, equal_steps, rows, tool

SET_WHEEL_SPEEDS = 11
KILLS = 6 if SANITIZED else 50
LONGEST_S = 0.8
FAST_STEPS = 5_000 if SANITIZED else 30_000


class Victim:
    """A daemon in lockstep that records, a client that drives it as fast as possible, and the client's readings. `committed`: the
    last step that readers could see in the file directly before the end."""

    def __init__(self, file, delay_s, seed):
        self.seen, self.file = [], file  # moments and steps of the replies
        with Daemon(scenario(1), "--record", file, expect_exit=-9) as daemon:
            recorder = daemon.text("/recorder")
            until(lambda: recorder.must("get_recording").data[4] > 0)  # bytes: its file is there
            motors = daemon.binary("/robot1/motors")
            chance = random.Random(seed)
            requests = [frame(SET_WHEEL_SPEEDS, data=(chance.uniform(-5, 5), chance.uniform(-5, 5))) for _ in range(64)]
            killer = threading.Timer(delay_s, self.kill, [daemon])
            killer.start()
            try:
                for k in range(10 ** 9):
                    motors.write(requests[k % 64])
                    self.seen.append((motors.receive().step, time.monotonic()))
            except (EOFError, OSError):
                pass
            killer.join()

    def kill(self, daemon):
        (self.committed,), = rows(self.file, "SELECT max(step) FROM step")
        self.killed = time.monotonic()
        daemon.process.kill()


class KillTest(unittest.TestCase):
    def kill_once(self, file, delay_s, seed):
        """Kills the daemon once; returns the lost wall time [s]."""
        victim = Victim(file, delay_s, seed)
        code, said = tool("info", file)
        self.assertEqual(code, 0, said)
        self.assertIn("mended", said)
        steps = equal_steps(file)
        self.assertEqual(rows(file, "SELECT max(step), count(*) FROM step"), [(steps, steps + 1)])
        self.assertGreaterEqual(steps, victim.committed, f"killed after {delay_s} s and {len(victim.seen)} steps")
        self.assertEqual([one for one in os.listdir(file.parent) if one.startswith(file.name)], [file.name],
                         "mended it is one plain file")
        after = [moment for step, moment in victim.seen if step == steps + 1]
        return victim.killed - after[0] if after else 0

    def test_killed_at_any_moment_it_verifies_up_to_the_last_commit(self):
        chance = random.Random(2604)
        delays = [chance.uniform(0.01, LONGEST_S) for _ in range(KILLS)]
        with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
            files = [Path(folder) / f"{k}.run" for k in range(KILLS)]
            lost = list(pool.map(self.kill_once, files, delays, range(KILLS)))
        print(f"{KILLS} kills: at most {max(lost):.3f} s of wall time lost, {sum(lost) / KILLS:.3f} s on average")

    def kept_after(self, drive, *options):
        """Drives a robot in lockstep by its `/motors`, kills the daemon at the last reply; returns the steps answered and kept."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "lesson.run"
            with Daemon(scenario(1), "--record", file, *options, expect_exit=-9) as daemon:
                answered = drive(daemon.text("/robot1/motors"))
                daemon.process.kill()
            return answered, equal_steps(file)

    def test_killed_in_fast_lockstep_it_has_all_answered_steps_but_a_thousand(self):
        answered, kept = self.kept_after(lambda motors: motors.must(f"ready {FAST_STEPS}").step)
        self.assertEqual(answered, FAST_STEPS)
        self.assertGreaterEqual(kept, answered - 1000)

    def test_killed_in_fast_free_mode_it_has_all_answered_steps_but_a_thousand(self):
        answered, kept = self.kept_after(lambda motors: motors.must(f"ready {FAST_STEPS}").step, "--mode", "free")
        self.assertGreaterEqual(kept, answered - 1000)

    def test_durable_it_has_every_answered_step(self):
        for steps in (1, 2, 60):
            answered, kept = self.kept_after(
                lambda motors: [motors.must(f"set_wheel_speeds {k % 7} 3").step for k in range(steps)][-1], "--record-durable")
            self.assertEqual((answered, kept), (steps, steps))

    def test_of_many_short_runs_all_but_the_last_two_are_there(self):
        with tempfile.TemporaryDirectory() as folder:
            with Daemon(scenario(1), "--record", str(Path(folder) / "a.run"), expect_exit=-9) as daemon:
                motors, simulation = daemon.text("/robot1/motors"), daemon.text("/simulation")
                for _ in range(20):
                    simulation.must("reset")
                    motors.must("ready 30")
                daemon.process.kill()
            whole = [file for file in Path(folder).glob("*.run") if tool("info", file)[0] == 0]
            self.assertGreaterEqual([equal_steps(file) for file in whole].count(30), 18)

    def test_what_was_killed_goes_on_where_it_ended(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "lesson.run"
            Victim(file, 0.5, 1)
            with Daemon(None, "--from", f"{file}@end", name="") as daemon:
                status = daemon.status()
                step, hash_ = rows(file, "SELECT step, hash FROM step ORDER BY step DESC LIMIT 1")[0]
                self.assertEqual(status["step"], step)
                self.assertEqual(status["hash"], f"{hash_ % 2**64:016x}")
                self.assertEqual(daemon.text("/robot1/motors").must("set_velocity 0.1 0").step, step + 1)


if __name__ == "__main__":
    unittest.main()
