# SPDX-License-Identifier: MIT
"""coopdyn sweep: its plan, its files, and that it finishes after every failure."""
import contextlib
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import unittest

import engines
from sweep_case import BINARY, SCENARIO, TABLE, SweepCase


class SweepTest(SweepCase):
    def test_each_combination_has_a_result_with_its_inputs_scores_and_hash(self):
        self.sweep(*TABLE, "--seeds", "1..2,7")
        results = self.results()
        inputs = {(one["set"]["SWARM_1.count"], one["controller"], one["seed"]) for one in results}
        self.assertEqual(inputs, {(count, f"diffuse speed={speed}", seed) for count in "24" for speed in ("0.1", "0.2") for seed in (1, 2, 7)})
        for one in results:
            self.assertEqual((one["ended"], one["steps"], one["error"], len(one["hash"])), ("duration", 50, None, 16))
            self.assertLessEqual(one["scores"]["way"], 0.5 * float(one["controller"][-3:]) + 1e-9)

    def test_a_run_of_a_sweep_is_the_run_of_serve(self):
        self.sweep("--seeds", "5", "--duration", "1")
        summary = self.path("summary.json")
        done = engines.answers([BINARY, "serve", self.scenario, "--no-net", "--mode", "free", "--speed", "0", "--seed", "5", "--duration", "1", "--summary", summary])
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(summary, encoding="utf-8") as stream:
            alone = json.load(stream)
        [result] = self.results()
        self.assertEqual(result["hash"], alone["hash"])
        self.assertEqual(result["scores"], {score["name"]: score["value"] for score in alone["scores"]})

    def test_what_is_there_is_not_run_again(self):
        self.sweep(*TABLE, "--seeds", "1")
        before = self.lines()
        self.assertIn("4 runs, 0 to do", self.sweep(*TABLE, "--seeds", "1").stdout)
        self.assertIn("8 runs, 4 to do", self.sweep(*TABLE, "--seeds", "1..2", "--dry-run").stdout)
        self.assertEqual(self.lines(), before)

    def test_a_changed_scenario_runs_again(self):
        self.sweep("--duration", "0.5")
        self.write("lesson.scenario", SCENARIO.replace("spacing 0.9", "spacing 0.8"))
        self.assertIn("1 runs, 1 to do", self.sweep("--duration", "0.5").stdout)

    def test_a_changed_robot_or_controller_runs_again(self):
        """Named by the scenario, by a setting, or by --controller."""
        root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
        shutil.copytree(os.path.join(root, "robots/minibot"), self.path("robots/mine"))
        environment = dict(os.environ, COOPDYN_PATH=self.folder)
        os.mkdir(self.path("controllers"))
        shutil.copy(os.path.join(os.path.dirname(os.path.abspath(BINARY)), "controllers/diffuse.so"), self.path("controllers/own.so"))
        words = ["--set", "SWARM_1.type=mine", "--controller", "own speed=0.1", "--duration", "0.1"]
        self.assertIn("1 to do", self.sweep(*words, env=environment).stdout)
        self.assertIn("0 to do", self.sweep(*words, env=environment).stdout)
        for name in (self.path("controllers/own.so"), next(entry.path for entry in os.scandir(self.path("robots/mine")) if entry.is_file())):
            with open(name, "ab") as stream:
                stream.write(b"\n")
            self.assertIn("1 to do", self.sweep(*words, "--dry-run", env=environment).stdout, name)
            self.sweep(*words, env=environment)

    def test_a_dry_run_writes_nothing(self):
        self.assertIn("4 runs, 4 to do", self.sweep(*TABLE, "--dry-run").stdout)
        self.assertFalse(os.path.exists(self.path("out")))

    def test_a_table_gives_rows_of_values(self):
        table = self.write("table.csv", "SWARM_1.count,seed,controller\n2,3,diffuse speed=0.1\n5,4,diffuse speed=0.3\n")
        self.sweep("--table", table, "--duration", "0.5")
        self.assertEqual({(one["set"]["SWARM_1.count"], one["seed"], one["controller"]) for one in self.results()},
                         {("2", 3, "diffuse speed=0.1"), ("5", 4, "diffuse speed=0.3")})

    def test_a_client_drives_each_run_in_lockstep(self):
        client = self.write("mine.py", "import sys\nsys.path.insert(0, sys.argv[2])\nimport coopdyn\nsim = coopdyn.connect(sys.argv[1])\nr = sim.robot('eva')\n"
                            "for k in range(30):\n    r.set_velocity(0.2, 0)\n    sim.log('turns', k)\n    sim.step()\nsim.close()\n")
        self.scenario = self.write("one.scenario", "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n[SCORE_1]\nname t\nkind time\nuntil >= 0.3\n")
        python = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../clients/python")
        self.sweep("--client", f"python3 {client} {{server}} {python}", "--seeds", "1..2")
        for one in self.results():
            self.assertEqual((one["ended"], one["steps"], one["error"], one["logged"]), ("score", 30, None, {"turns": 29}))
        first = {one["seed"]: one["hash"] for one in self.results()}
        self.sweep("--client", f"python3 {client} {{server}} {python}", "--seeds", "1..2", out="again")
        self.assertEqual({one["seed"]: one["hash"] for one in self.results("again")}, first)

    def test_a_client_that_fails_is_told(self):
        self.scenario = self.write("one.scenario", "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n")
        done = self.sweep("--client", "false", "--duration", "1", code=1)
        self.assertIn("the client ended with exit code 1", done.stderr)
        self.assertEqual(self.results()[0]["ended"], "client failed")

    def test_the_last_words_of_a_client_that_fails_are_kept(self):
        self.scenario = self.write("one.scenario", "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n")
        self.sweep("--client", "python3 nofile.py {server}", "--duration", "1", code=1)
        self.assertRegex(self.results()[0]["error"], "exit code 2: .*nofile.py")

    def test_a_client_has_no_seat_of_a_class(self):
        """Whatever COOPDYN_SEAT says: the daemon of a run is no class."""
        client = self.write("mine.py", "import os\nraise SystemExit('the seat is ' + repr(os.environ['COOPDYN_SEAT']))\n")
        self.scenario = self.write("one.scenario", "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n")
        self.sweep("--client", f"python3 {client}", "--duration", "1", code=1, env=dict(os.environ, COOPDYN_SEAT="ana:7305"))
        self.assertIn("the seat is ''", self.results()[0]["error"])

    def test_what_a_client_logs_after_the_end_is_refused(self):
        client = self.write("mine.py", "import sys\nsys.path.insert(0, sys.argv[2])\nimport coopdyn\nsim = coopdyn.connect(sys.argv[1])\nr = sim.robot('eva')\n"
                            "k = 0\nwhile True:\n    r.set_velocity(0.2, 0)\n    sim.log('turns', k)\n    sim.step()\n    k += 1\n")
        self.scenario = self.write("one.scenario", "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n[SCORE_1]\nname t\nkind time\nuntil >= 0.3\n")
        python = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../clients/python")
        self.sweep("--client", f"python3 {client} {{server}} {python}", "--seeds", "1..8")
        self.assertEqual({(one["ended"], one["steps"], one["logged"]["turns"]) for one in self.results()}, {("score", 30, 29)})

    def test_ctrl_c_ends_it_and_its_runs_at_once(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            sweep = subprocess.Popen(self.words("--duration", "1000000", "--seeds", "1..3", "--jobs", "2"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.addCleanup(sweep.kill)
            while not sweep.stdout.readline().startswith("3 runs"):
                pass
            while len(engines.children(sweep.pid)) < 2:
                self.assertIsNone(sweep.poll())
            runs = engines.children(sweep.pid)
            sweep.send_signal(number)
            said = sweep.communicate(timeout=60)[1]
            self.assertEqual(sweep.returncode, 130, said)
            self.assertIn("The same command does what is missing", said)
            self.assertFalse([run for run in runs if os.path.exists(f"/proc/{run}")])

    def test_two_results_of_a_run_with_different_hashes_are_told(self):
        self.sweep("--duration", "0.5")
        [result] = self.results()
        with open(os.path.join(self.path("out"), "results.jsonl"), "a", encoding="utf-8") as stream:
            stream.write(json.dumps(dict(result, hash="0" * 16)) + "\n")
        told = f"{result['key']}: two results of this run have different hashes, though files, build and libraries are the same"
        self.assertIn(told, self.refused("--duration", "0.5"))
        report = engines.answers([BINARY, "sweep", "report", self.path("out")])
        self.assertEqual(report.returncode, 1)
        self.assertIn(told, report.stderr)

    def test_a_setting_may_not_take_the_end_of_a_run_away(self):
        self.scenario = self.write("ends.scenario", SCENARIO + "until >= 3\n")
        self.assertIn("2 runs", self.sweep("--seeds", "1,2", "--dry-run").stdout)
        self.assertRegex(self.refused("--set", "SCORE_2.until="), "nothing ends a run of .* with SCORE_2.until=: add --duration SECONDS")

    def test_a_run_that_takes_too_long_is_ended(self):
        self.sweep("--duration", "1000000", "--time-limit", "0.5", code=1)
        [result] = self.results()
        self.assertEqual(result["ended"], "time limit")
        self.assertIn("--time-limit", result["error"])
        self.assertIn("1 runs, 1 to do", self.sweep("--duration", "1000000", "--time-limit", "0.5", "--again-failed", "--dry-run").stdout)

    def test_recordings_of_runs_verify(self):
        self.sweep("--duration", "0.5", "--record", "all")
        [result] = self.results()
        done = engines.answers([BINARY, "verify", os.path.join(self.path("out"), "recordings", result["key"] + ".run")])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_recordings_of_failed_runs_only(self):
        self.sweep("--duration", "0.5", "--record", "failed")
        self.assertFalse(os.path.exists(os.path.join(self.path("out"), "recordings")))

    def test_the_report_has_medians_and_quartiles(self):
        self.sweep(*TABLE, "--seeds", "1..4")
        done = engines.answers([BINARY, "sweep", "report", self.path("out")])
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.path("out"), "cells.csv"), newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        row = next(row for row in rows if row["SWARM_1.count"] == "4" and row["controller"].endswith("0.2") and row["score"] == "way")
        values = sorted(one["scores"]["way"] for one in self.results() if one["set"]["SWARM_1.count"] == "4" and one["controller"].endswith("0.2"))
        self.assertAlmostEqual(float(row["median"]), (values[1] + values[2]) / 2)
        self.assertAlmostEqual(float(row["lower_quartile"]), values[0] + 0.75 * (values[1] - values[0]))
        for name in ("runs.csv", "way.svg", "hits.svg", "report.html"):
            self.assertGreater(os.path.getsize(os.path.join(self.path("out"), name)), 100, name)
        with open(os.path.join(self.path("out"), "report.html"), encoding="utf-8") as stream:
            self.assertIn("<svg", stream.read())

    def test_mistakes_are_told_with_what_to_write(self):
        self.assertIn("did you mean 'count'?", self.refused("--set", "SWARM_1.cont=3", "--duration", "1"))
        self.assertIn("SECTION.key=value, for example --set SWARM_1.count=10,20,50", self.refused("--set", "count=3", "--duration", "1"))
        self.assertIn("did you mean 'count'?", self.refused("--set", "SWARM_1.cont=3", "--duration", "1", "--dry-run"))
        self.assertIn("--out /proc/none cannot be made", engines.answers([BINARY, "sweep", self.scenario, "--duration", "1", "--out", "/proc/none"]).stderr)
        self.assertIn("--client has {sever}: a sweep fills in {server} and {seed}", self.refused("--client", "python3 mine.py {sever}"))
        self.assertIn("--seeds 1..30", self.refused("--seeds", "a", "--duration", "1"))
        self.assertIn("write the smaller number first", self.refused("--seeds", "5..1", "--duration", "1"))
        self.assertIn("names a seed twice", self.refused("--seeds", "1,1", "--duration", "1"))
        self.assertIn("add --duration SECONDS", self.refused())
        self.assertIn("diffuse speed=0.1,0.2", self.refused("--controller", "diffuse 0.1", "--duration", "1"))
        self.assertIn("--dask and --slurm are two engines", self.refused("--dask", "local", "--slurm", "--duration", "1", code=2))
        self.assertIn("two runs of this sweep are the same", self.refused("--set", "SWARM_1.count=2,2", "--duration", "1"))
        self.assertIn("table.csv:1: error: 'count' is no setting", self.refused("--table", self.write("table.csv", "count\n2\n"), "--duration", "1"))
        self.assertIn("nope", engines.answers([BINARY, "sweep", "nope", "--duration", "1"]).stderr)

    def test_two_sweeps_do_not_write_to_one_folder(self):
        first = subprocess.Popen(self.words("--duration", "1000000", "--time-limit", "100"), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(first.stdout.close)
        self.addCleanup(first.wait)
        self.addCleanup(first.kill)
        first.stdout.readline()
        self.assertIn("another sweep writes to", self.refused("--duration", "1000000"))

    def test_killed_sweeps_and_daemons_and_a_full_disk_change_nothing(self):
        """200 runs: the sweep is killed ten times, daemons five times, and its disk is full once."""
        words = [*TABLE, "--seeds", "1..50"]
        self.sweep(*words, out="whole")
        for name in ("out", "scratch"):
            os.mkdir(self.path(name))
        small = engines.answers(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", self.path("out")]).returncode == 0
        if small:
            self.addCleanup(engines.answers, ["umount", "--lazy", self.path("out")])
        environment = dict(os.environ, TMPDIR=self.path("scratch"))
        choose = random.Random(7)
        for attempt in range(10):
            sweep = subprocess.Popen(self.words(*words), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
                                     env=environment)
            aim = len(self.finished()) + choose.randint(1, 15)
            engines.until(lambda aim=aim, sweep=sweep: len(self.finished()) >= aim or sweep.poll() is not None, "results come")
            if attempt % 2:
                for child in engines.answers(["pgrep", "-P", str(sweep.pid)]).stdout.split():
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(int(child), signal.SIGKILL)
                engines.until(lambda aim=aim, sweep=sweep: len(self.finished()) > aim or sweep.poll() is not None, "it goes on after a lost daemon")
            sweep.kill()
            sweep.wait()
        if small:
            filler = os.path.join(self.path("out"), "filler")
            with contextlib.suppress(OSError), open(filler, "wb", buffering=0) as stream:
                while stream.write(bytes(4096)):
                    pass
            done = engines.answers(self.words(*words))
        else:  # no disk can be mounted here: a file that may not grow
            limit = f"ulimit -f {os.path.getsize(os.path.join(self.path('out'), 'results.jsonl')) // 1024 + 1}; exec \"$@\""
            done = engines.answers(["bash", "-c", limit, "bash", *self.words(*words)])
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("it does what is missing", done.stderr)
        if small:
            os.remove(filler)
        with open(os.path.join(self.path("out"), "results.jsonl"), "a", encoding="utf-8") as stream:
            stream.write('{"key": "cut o')
        self.sweep(*words)
        self.assertEqual(self.lines(), self.lines("whole"))
        self.assertEqual(os.listdir(self.path("scratch")), [])

    def test_one_process_and_two_give_equal_hashes(self):
        self.sweep(*TABLE, "--seeds", "1..3", "--jobs", "1", out="one")
        self.sweep(*TABLE, "--seeds", "1..3", "--jobs", "2", out="two")
        self.assertEqual(self.lines("one"), self.lines("two"))

    def test_dask_without_a_scheduler_is_told(self):
        self.assertRegex(self.refused("--duration", "1", "--dask", f"tcp://127.0.0.1:{engines.held_port()}"), "no Dask scheduler answers|python3-distributed")
        self.assertRegex(self.refused("--duration", "1", "--dask", "foo"), "write --dask tcp://HOST:8786 of one, or --dask local|python3-distributed")


if __name__ == "__main__":
    unittest.main()
