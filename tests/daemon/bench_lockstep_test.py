"""`coopdyn bench lockstep`: output of tiny runs, that every client drives the same run, and refused arguments."""
import json
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BINARY

KEYS = {"robots", "robot", "clients", "language", "fidelity", "rays", "protocol_only", "robot_threads", "threads", "record", "rounds",
        "repeats", "rounds_per_s", "robot_rounds_per_s", "rtf", "us_per_robot_round", "server_cpu_us_per_robot_round",
        "client_cpu_us_per_robot_round", "hash"}


def bench(*options):
    return subprocess.run([BINARY, "bench", "lockstep", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)


def figures(*options, repeats=1):
    done = bench("--robots", "10", "--rounds", "20", "--repeats", str(repeats), "--json", *options)
    assert done.returncode == 0, done.stderr.decode()
    return json.loads(done.stdout)


class BenchLockstepTest(unittest.TestCase):
    def test_the_json_has_all_figures(self):
        said = figures()
        self.assertEqual(set(said), KEYS)
        self.assertEqual((said["robots"], said["clients"], said["language"], said["rounds"]), (10, "per-robot", "cpp", 20))
        for key in ("rounds_per_s", "server_cpu_us_per_robot_round", "client_cpu_us_per_robot_round"):
            self.assertGreater(said[key], 0, key)
        self.assertAlmostEqual(said["robot_rounds_per_s"] / (10 * said["rounds_per_s"]), 1, places=2)
        self.assertAlmostEqual(said["us_per_robot_round"] * said["robot_rounds_per_s"] / 1e6, 1, places=2)

    def test_every_client_and_number_of_threads_drives_the_same_run(self):
        runs = [figures("--clients", clients, "--language", language)
                for clients in ("per-robot", "batch") for language in ("cpp", "python")]
        runs += [figures("--robot-threads", threads) for threads in ("1", "10")]
        self.assertEqual({run["hash"] for run in runs}, {runs[0]["hash"]})

    def test_repeats_start_afresh(self):
        self.assertEqual(figures(repeats=2)["hash"], figures()["hash"])

    def test_rays_replace_the_sensors_of_the_robot(self):
        for clients in ("per-robot", "batch"):
            said = figures("--clients", clients, "--rays", "11")
            self.assertEqual((said["rays"], said["clients"]), (11, clients))

    def test_protocol_only_is_a_team_at_rest(self):
        said = figures("--clients", "batch", "--protocol-only")
        self.assertEqual((said["fidelity"], said["protocol_only"], said["rays"]), ("planar", True, 0))

    def test_a_recorded_run_ends_in_the_same_state(self):
        said = figures("--record", "poses")
        self.assertEqual((said["record"], said["hash"]), ("poses", figures()["hash"]))

    def test_the_table_has_the_figures_too(self):
        done = bench("--robots", "3", "--rounds", "20", "--repeats", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        for words in (b"rounds per second", b"CPU of the daemon", b"CPU of the client", b"state hash"):
            self.assertIn(words, done.stdout)

    def test_what_cannot_be_measured_is_told(self):
        done = bench("--protocol-only")
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"--clients batch", done.stderr)
        done = bench("--robot", "no_such_robot", "--rounds", "20", "--repeats", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"no_such_robot", done.stderr)
        done = bench("--robot", "no_such_robot", "--rays", "4", "--rounds", "20", "--repeats", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"no_such_robot", done.stderr)

    def test_numbers_that_are_none_or_too_large_are_wrong_use(self):
        for words in (("swarm", "--range", "nan"), ("swarm", "--density", "nan"), ("swarm", "--seconds", "nan"),
                      ("lockstep", "--range", "inf"), ("recording", "--seconds", "nan")):
            done = subprocess.run([BINARY, "bench", *words], capture_output=True, timeout=60)
            self.assertEqual((done.returncode, done.stdout), (2, b""), words)
            self.assertRegex(done.stderr, rb"\A.*%s must be .*, not %s.*\n\Z" % (words[-2].encode(), words[-1].encode()))

    def test_without_coopdyn_bench_it_says_how_to_build_it(self):
        with tempfile.TemporaryDirectory() as folder:
            alone = shutil.copy(BINARY, Path(folder) / "coopdyn")
            done = subprocess.run([alone, "bench", "lockstep"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--target coopdyn-bench", done.stderr)


if __name__ == "__main__":
    unittest.main()
