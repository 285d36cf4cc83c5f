"""coopdyn bench recording: prints its figures for a small run."""
import json
import subprocess
import unittest

from harness import BINARY

KEYS = {"robots", "seconds", "what", "live_s", "live_cpu_s", "recorded_s", "recorded_cpu_s", "recorder_cpu_s", "bytes",
        "bytes_per_robot_step", "seek_ms", "longest_seek_ms", "verify_s", "reset_ms", "reset_growth_kb"}


def bench(*options):
    return subprocess.run([BINARY, "bench", "recording", "--robots", "5", "--seconds", "2", "--seeks", "5", "--resets", "20",
                           *options], capture_output=True, text=True, timeout=120)


class BenchRecordingTest(unittest.TestCase):
    def test_the_json_has_all_figures(self):
        done = bench("--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual(set(said), KEYS)
        self.assertGreater(said["bytes_per_robot_step"], 18)
        self.assertGreater(said["recorder_cpu_s"], 0)

    def test_the_table_has_them_too(self):
        done = bench()
        self.assertEqual(done.returncode, 0, done.stderr)
        for words in ("bytes per robot-step", "seek, ms", "verify, s", "reset of 20 full robots"):
            self.assertIn(words, done.stdout)

    def test_what_cannot_be_recorded_is_told(self):
        done = bench("--what", "poems")
        self.assertEqual(done.returncode, 1)
        self.assertIn("knows no 'poems'", done.stderr)


if __name__ == "__main__":
    unittest.main()
