# SPDX-License-Identifier: MIT
"""coopdyn sweep: a key depends on all inputs, a cell has one kind of runs, and a line can be repeated."""
import csv
import json
import os
import re
import shutil
import sys
import tempfile
import time
import unittest

import engines
from sweep_case import BINARY, ROOT, SCENARIO, SweepCase

sys.path.insert(0, os.path.join(ROOT, "clients/sweep"))
import plan  # noqa: E402
import results  # noqa: E402
import run  # noqa: E402

ONE = "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n[SCORE_1]\nname way\nkind distance\n"
# The robot stands at 0 0.
AIM = """[FLOOR]
size 20 20
[TARGET]
red 1 0
[ROBOT_1]
type coopbot
name eva
position 0 0
controller diffuse speed=0
[SCORE_1]
name found
kind reach
target red
until all
limit 0.5
[SCORE_2]
name duration
kind time
"""
ARM = """<rosiml version="0.8.41"><simulator frequency="100"/><environment/><robots><robot name="arm">
<body>
<box name="base"><dimension width="0.1" depth="0.1" height="1"/><pose z="0.5"/><physics><mass kg="0"/></physics></box>
<box name="bar"><dimension width="0.1" depth="0.1" height="0.4"/><pose x="0.3" z="0.8"/><physics><mass kg="1"/></physics></box>
</body>
<actuators><hinge name="j" type="velocity" mode="active"><source name="base"/><destination name="bar"/><force max="50"/>
<velocity max="4"/><pose z="0.3"/><mapping min="-1" max="1"/></hinge></actuators>
<sensors/><controller module="own"/>
</robot></robots></rosiml>
"""
CLIENT = ("import sys\nsys.path.insert(0, sys.argv[2])\nimport coopdyn\nfrom speed import SPEED\nsim = coopdyn.connect(sys.argv[1])\n"
          "r = sim.robot('eva')\nfor k in range(40):\n    r.set_velocity(SPEED, 0)\n    sim.step()\n")


class InputsTest(SweepCase):
    def report(self, out="out", code=0):
        done = engines.answers([BINARY, "sweep", "report", self.path(out)])
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def rows(self, name="cells.csv", out="out"):
        with open(os.path.join(self.path(out), name), newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    def cells(self, score):
        self.report()
        return [row for row in self.rows() if row["score"] == score]

    def page(self, out="out"):
        with open(os.path.join(self.path(out), "report.html"), encoding="utf-8") as stream:
            return stream.read()

    def test_what_differs_is_not_pooled(self):
        root = os.path.dirname(os.path.abspath(BINARY))
        os.mkdir(self.path("controllers"))
        own = shutil.copy(os.path.join(root, "controllers/diffuse.so"), self.path("controllers/own.so"))
        environment = dict(os.environ, COOPDYN_PATH=self.folder)
        seeds = ["--seeds", "1..2"]
        self.sweep(*seeds, "--duration", "0.3")
        self.sweep(*seeds, "--duration", "0.6")
        self.sweep(*seeds, "--duration", "0.3", "--controller", "own", env=environment)
        with open(own, "ab") as stream:
            stream.write(b"\n")
        self.sweep(*seeds, "--duration", "0.3", "--controller", "own", env=environment)
        self.write("lesson.scenario", SCENARIO.replace("spacing 0.9", "spacing 0.8"))
        self.sweep(*seeds, "--duration", "0.3")
        self.scenario = self.write("other.scenario", SCENARIO)
        self.sweep(*seeds, "--duration", "0.3")
        cells = self.cells("way")
        self.assertEqual([row["runs"] for row in cells], ["2"] * 6)
        labels = re.findall(r"<tr><td>([^<]*)<td>2<td>0<td>2", self.page().partition("<h2>way [m]")[2].partition("<h2>")[0])
        self.assertEqual(len(set(labels)), 6, labels)
        self.assertTrue(any("digest controller own=" in label for label in labels), labels)
        self.assertTrue(any("digest scenario=" in label for label in labels), labels)

    def test_a_changed_client_or_what_it_imports_runs_again(self):
        self.scenario = self.write("one.scenario", ONE)
        client, helper = self.write("mine.py", CLIENT), self.write("speed.py", "SPEED = 0.1\n")
        words = ["--client", f"python3 {client} {{server}} {os.path.join(ROOT, 'clients/python')}"]
        self.assertIn("1 to do", self.sweep(*words).stdout)
        self.assertIn("0 to do", self.sweep(*words).stdout)
        with open(client, "a", encoding="utf-8") as stream:
            stream.write("sim.close()\n")
        self.assertIn("1 to do", self.sweep(*words).stdout)
        self.write("speed.py", "SPEED = 0.3\n")
        self.assertIn("1 to do", self.sweep(*words).stdout)
        cells = self.cells("way")
        self.assertEqual(len(cells), 3)
        self.assertEqual(len({row[f"digest client {helper}"] for row in cells}), 2)

    def to_do(self, *words):
        return self.sweep(*words, "--dry-run").stdout.splitlines()[0]

    def test_a_client_inside_other_words_runs_again_when_it_changes(self):
        self.scenario = self.write("one.scenario", ONE)
        os.mkdir(self.path("own"))
        files = {"own/__init__.py": "", "own/drive.py": "import own.speed\n", "own/speed.py": "", "mine.py": "", "numbers.json": ""}
        for name, text in files.items():
            self.write(name, text)
        for client, names in (('sh -c "cd . && exec python3 mine.py {server} <numbers.json"', ("mine.py", "numbers.json")),
                              ("sh -c 'sh -c \"python3 mine.py; true\"'", ("mine.py",)),
                              ("python3 -m own.drive {server}", ("own/__init__.py", "own/drive.py", "own/speed.py"))):
            words = ["--client", client, "--duration", "0.1"]
            self.sweep(*words)
            for name in names:
                self.assertEqual(self.to_do(*words), "1 runs, 0 to do", client)
                self.write(name, files[name] + "\n")
                self.assertEqual(self.to_do(*words), "1 runs, 1 to do", f"{client}: {name}")
                self.write(name, files[name])

    def test_code_among_the_words_of_a_client_is_no_mistake(self):
        self.assertEqual(self.to_do("--client", "python3 -c 'print(\"it is\", 1) # \"'"), "1 runs, 1 to do")

    def test_inputs_that_no_command_names_are_named(self):
        self.write("run.sh", "exec python3 mine.py\n")
        mine = self.write("mine.py", "")
        words = ["--client", "sh run.sh", "--duration", "0.1", "--input", "mine.py"]
        self.sweep(*words)
        self.assertEqual(self.to_do(*words), "1 runs, 0 to do")
        [line] = self.results()
        self.assertIn("input mine.py", line["digests"])
        self.write("mine.py", "pass\n")
        self.assertEqual(self.to_do(*words), "1 runs, 1 to do")
        again = engines.answers([BINARY, "sweep", "rerun", self.path("out"), "--key", line["key"]], cwd=self.folder)
        self.assertIn("not what it was: input mine.py", again.stdout)
        self.assertIn("--input none.py: there is no such file", self.refused(*words[:-1], "none.py"))
        os.remove(mine)
        again = engines.answers([BINARY, "sweep", "rerun", self.path("out"), "--key", line["key"]], cwd=self.folder)
        self.assertIn("--input mine.py: there is no such file", again.stderr)

    def test_another_binary_of_the_same_version_runs_again(self):
        program = shutil.copy(BINARY, self.path("coopdyn"))
        words = [sys.executable, os.path.join(ROOT, "clients/sweep"), program, ROOT, self.scenario, "--duration", "0.1", "--out", self.path("out")]
        environment = dict(os.environ, COOPDYN_PATH=f"{os.path.dirname(os.path.abspath(BINARY))}:{ROOT}")
        self.assertIn("1 to do", engines.answers(words, env=environment).stdout)
        self.assertIn("0 to do", engines.answers(words, env=environment).stdout)
        with open(program, "ab") as stream:
            stream.write(b"\n")
        self.assertIn("1 to do", engines.answers(words, env=environment).stdout)

    def test_a_rebuilt_controller_of_an_experiment_runs_again(self):
        """`library=` of the paper's grammar, `module=` of the public one."""
        with open(os.path.join(ROOT, "scenarios/braitenberg.xml"), encoding="utf-8") as stream:
            own = stream.read().replace('library="braitenberg"', 'library="own"')
        for name, text, like in (("library", own, "braitenberg"), ("module", ARM, "reach")):
            plug_in = shutil.copy(os.path.join(os.path.dirname(os.path.abspath(BINARY)), f"controllers/{like}.so"), self.path("own.so"))
            self.scenario = self.write(f"{name}.xml", text)
            key = lambda: self.sweep("--duration", "0.1", "--dry-run").stdout.splitlines()[1].split()[0]
            before = key()
            self.assertEqual(key(), before)
            with open(plug_in, "ab") as stream:
                stream.write(b"\n")
            self.assertNotEqual(key(), before, name)

    def test_a_changed_mesh_of_a_robot_in_another_folder_runs_again(self):
        os.makedirs(self.path("robots/own"))
        self.write("robots/own/model.sdf", '<sdf version="1.7"><model name="own"><link name="base"><inertial><mass>1</mass></inertial>'
                   '<collision name="c"><geometry><mesh><uri>model://shapes/a.obj</uri></mesh></geometry></collision></link></model></sdf>')
        os.mkdir(self.path("shapes"))
        shape = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        self.scenario = self.write("one.scenario", ONE.replace("coopbot", "own"))
        environment = dict(os.environ, COOPDYN_PATH=self.folder)
        for size in ("0.2", "0.3"):
            self.write("shapes/a.obj", shape.format(size))
            self.assertIn("1 to do", self.sweep("--duration", "0.1", env=environment).stdout, size)

    def test_a_plug_in_that_is_rebuilt_while_the_sweep_runs_is_told(self):
        job = {"key": "k", "words": ["sh", "-c", "echo '{\"ended\":\"duration\",\"scores\":[],\"digests\":{\"build\":\"b\",\"controller own\":\"2\"}}'"],
               "inputs": {"client": None, "time_limit_s": None, "memory_limit_mib": None, "digests": {"build": "b", "controller own": "1"}},
               "record": "none", "own_files": {}}
        self.assertIn("controller own: not what it was when the sweep began", run.run_one(job)["error"])

    def test_lines_of_an_older_version_are_named_and_not_mixed(self):
        self.sweep("--duration", "0.3", "--seeds", "1..2")
        old = {name: value for name, value in self.results()[0].items() if name not in ("digests", "units", "met", "met_s", "command", "cpu")}
        with open(os.path.join(self.path("out"), "results.jsonl"), "a", encoding="utf-8") as stream:
            stream.write(json.dumps(dict(old, key="0" * 20)) + "\n")
        told = self.report().stderr
        self.assertIn("1 lines of an older coopdyn", told)
        self.assertIn("0" * 20, told)
        self.assertEqual([row["runs"] for row in self.cells("way")], ["2"])
        self.assertIn("0" * 20, self.page())
        self.assertIn("0" * 20, self.sweep("--duration", "0.3", "--again-failed").stderr)
        self.assertEqual(len(self.lines()), 3)
        done = engines.answers([BINARY, "sweep", "rerun", self.path("out"), "--key", "0" * 20])
        self.assertEqual(done.returncode, 1)
        self.assertIn("run its sweep again", done.stderr)

    def test_one_line_is_repeated_and_compared(self):
        self.sweep("--controller", "diffuse speed=0.1", "--set", "SWARM_1.count=2", "--duration", "0.3", "--seeds", "3")
        [line] = self.results()
        words = [BINARY, "sweep", "rerun", self.path("out"), "--key", line["key"][:8]]
        same = engines.answers(words)
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        self.assertIn(f"{line['key']}: the same: 30 steps, hash {line['hash']}", same.stdout)
        self.write("out/results.jsonl", json.dumps(dict(line, hash="0" * 16)) + "\n")
        other = engines.answers(words)
        self.assertEqual(other.returncode, 1)
        self.assertIn(f"hash is {line['hash']}, was {'0' * 16}", other.stdout)
        self.write("lesson.scenario", SCENARIO.replace("spacing 0.9", "spacing 0.8"))
        self.assertIn("not what it was: scenario", engines.answers(words).stdout)
        self.assertIn("has no result none", engines.answers([*words[:-1], "none"]).stderr)

    def test_the_command_of_a_line_repeats_it_by_hand(self):
        self.sweep("--duration", "0.3", "--seeds", "3")
        [line] = self.results()
        done = engines.answers(["sh", "-c", line["command"] + " --summary /dev/stdout"])
        self.assertIn(line["hash"], done.stdout, done.stderr)

    def test_a_run_that_ended_at_its_limit_is_not_counted_as_a_time(self):
        self.scenario = self.write("aim.scenario", AIM)
        self.sweep("--set", "ROBOTS.controller=diffuse speed=0", "--set", "TARGET.red=0 0,9 9")
        found = {one["set"]["TARGET.red"]: one for one in self.results()}
        self.assertEqual((found["0 0"]["met"], found["0 0"]["met_s"], found["0 0"]["time_s"]), ({"found": True}, {"found": 0.01}, 0.01))
        self.assertEqual((found["9 9"]["met"], found["9 9"]["met_s"], found["9 9"]["time_s"]), ({"found": False}, {"found": None}, 0.5))
        times = {(row["TARGET.red"], row["score"]): (row["n"], row["median"]) for row in self.cells("duration") + self.cells("time_s") + self.cells("found met")}
        for name in ("duration", "time_s", "found met"):
            self.assertEqual((times["0 0", name], times["9 9", name]), (("1", "0.01"), ("0", "")), name)
        self.assertEqual({row["TARGET.red"]: (row["met"], row["success_rate"]) for row in self.cells("found")}, {"0 0": ("1", "1.0"), "9 9": ("0", "0.0")})
        self.assertEqual({row["unit"] for row in self.cells("duration")}, {"s"})

    def test_the_report_shows_counts_failures_points_units_and_success(self):
        self.scenario = self.write("aim.scenario", AIM.replace("kind time", "kind distance").replace("duration", "way"))
        self.sweep("--seeds", "1..3", "--set", "TARGET.red=0 0,9 9")
        lines = self.results()
        lines[0].update(error="it broke")
        self.write("out/results.jsonl", "".join(json.dumps(one) + "\n" for one in lines))
        self.report()
        page = self.page()
        self.assertIn("<h2>way [m]</h2>", page)
        self.assertRegex(page, "<th>runs<th>failed<th>n<th>met<th>success rate")
        self.assertRegex(page, "<td>3<td>1<td>2<td>[02]<td>(100|0) %")
        with open(os.path.join(self.path("out"), "way.svg"), encoding="utf-8") as stream:
            svg = stream.read()
        self.assertIn("way [m]: each run, median and quartiles", svg)
        self.assertIn("n = 2, 1 failed", svg)

    def test_a_client_that_fails_after_the_end_of_its_run_leaves_a_result(self):
        """The daemon is still closing its files when the client, which has lost it, fails."""
        daemon = self.write("daemon.py", "import json, signal\nprint('ready names=x', flush=True)\nsignal.sigwait([signal.SIGTERM])\n"
                            "print(json.dumps({'ended': 'duration', 'steps': 30, 'time_s': 0.3, 'hash': 'h', 'cpu': 'c', 'logged': [], 'digests': {},\n"
                            "  'scores': [{'name': 'way', 'value': 1.5, 'unit': 'm', 'met': None, 'met_s': None, 'until': None}]}))\n")
        words = [sys.executable, "-c", f"import signal; signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM]); exec(open({daemon!r}).read())"]
        job = {"key": "k", "words": words, "record": "none", "own_files": {},
               "inputs": {"client": "false", "seed": 1, "time_limit_s": None, "memory_limit_mib": None, "digests": {}}}
        result = run.run_one(job)
        self.assertEqual((result["ended"], result["error"], result["scores"]), ("duration", None, {"way": 1.5}))

    def test_nothing_is_written_through_links(self):
        self.sweep("--duration", "0.1", "--seeds", "1..2")
        names = ("runs.csv", "cells.csv", "report.html", "way.svg", "hits.svg")
        for name in names:
            os.symlink(self.write("victim-" + name, "mine"), os.path.join(self.path("out"), name))
        self.report()
        for name in names:
            with open(self.path("victim-" + name), encoding="utf-8") as stream:
                self.assertEqual(stream.read(), "mine", name)
            self.assertFalse(os.path.islink(os.path.join(self.path("out"), name)))
        for name in (".lock", "results.jsonl"):
            os.makedirs(self.path("trap"), exist_ok=True)
            os.symlink(self.write("victim", "mine"), os.path.join(self.path("trap"), name))
            self.assertIn(f"{name} is a link: take it away", self.sweep("--duration", "0.1", out="trap", code=1).stderr)
            with open(self.path("victim"), encoding="utf-8") as stream:
                self.assertEqual(stream.read(), "mine", name)
            os.remove(os.path.join(self.path("trap"), name))


class Linear(unittest.TestCase):
    """Files of eight times as many lines take about eight times as long to read."""

    def expect(self, read):
        def cpu_s(lines):
            with tempfile.TemporaryDirectory() as folder:
                begin_s = time.process_time()
                read(folder, lines)
                return time.process_time() - begin_s
        small_s = min(cpu_s(2000), cpu_s(2000))
        self.assertLess(cpu_s(8 * 2000), 24 * (small_s + 0.02))

    def test_results(self):
        def read(folder, lines):
            with open(os.path.join(folder, "results.jsonl"), "w", encoding="utf-8") as stream:
                for number in range(lines):
                    stream.write(json.dumps({"key": f"{number:016x}", "hash": "0", "digests": {}}) + "\n")
            self.assertEqual(len(results.Results(folder).done), lines)
        self.expect(read)

    def test_tables(self):
        def read(folder, lines):
            file = os.path.join(folder, "table.csv")
            with open(file, "w", encoding="utf-8") as stream:
                stream.write("ROBOT_1.x,seed\n" + "".join(f"{number},1\n" for number in range(lines)))
            self.assertEqual(len(plan.table_of(file)), lines)
        self.expect(read)


if __name__ == "__main__":
    unittest.main()
