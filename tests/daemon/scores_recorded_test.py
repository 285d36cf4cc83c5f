"""Scores and logged numbers of recordings: for each step as live, in exports, in playback and in the clients."""
import csv
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import LIMIT_S, Daemon, until
from recording import Play, equal_steps, tool

sys.path.insert(0, str(Path(__file__).parents[2] / "clients" / "python"))
import coopdyn  # noqa: E402

WORLD = """[SIMULATION]
mode lockstep
[FLOOR]
size 8 8
[TARGET]
red 0.25 0
[BOX_1]
type box
size 0.2 0.2 0.2
position -1 1
mass 1
[ROBOT_1]
type coopbot
name eva
position 0.02 0.03
[SCORE_1]
kind time
until >= 0.8
limit 99
[SCORE_2]
kind distance
name way
[SCORE_3]
kind reach
target red
within 0.1
[SCORE_4]
kind coverage
cell 0.1
[SCORE_5]
kind energy
"""
STEPS = 80
SCORES = ["score.time_s", "score.way_m", "score.reach", "score.coverage_m2", "score.energy_j"]
# After these steps: names and values.
LOGS = {10: [("gap", 0.25)], 20: [("gap", -1.5), ("tries", 3)], 35: [("gap", 1), ("gap", 1e-7)]}

# Prints `equal` if the numbers of scored.mat equal those of the CSV beside it, and the values of `coopdyn.Run`.
OCTAVE = r"""
addpath("%s");
names = strsplit(fgetl(fopen("scored.csv")), ",");
table = dlmread("scored.csv", ",", 1, 0);
column = @(name) table(:, strcmp(names, name));
load("scored.mat");
ok = isequal({run.scores.name}, {"time", "way", "reach", "coverage", "energy"}) && isequal({run.scores.unit}, {"s", "m", "", "m2", "J"});
ok = ok && isequal({run.logged.name}, {"gap", "tries"});
ok = ok && isequaln([run.scores.value], [column("score.time_s"), column("score.way_m"), column("score.reach"), ...
  column("score.coverage_m2"), column("score.energy_j")]);
ok = ok && isequaln([run.logged.value], [column("logged.gap"), column("logged.tries")]) && any(isnan(run.logged(1).value));
r = coopdyn.read_run("scored.mat");
ok = ok && isequal(r.score("way"), [r.time, column("score.way_m")]);
last = r.scores();
ok = ok && last.way == table(end, strcmp(names, "score.way_m")) && numel(fieldnames(last)) == 5;
try
  r.score("wya");
  ok = false;
catch e
  ok = ok && ! isempty(strfind(e.message, "has no score wya; there are time, way, reach, coverage, energy"));
end
if ok; printf("equal"); end
"""


class ScoresRecordedTest(unittest.TestCase):
    """A recorded run, and the scores that its client read after each step."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.file = cls.folder / "scored.run"
        scenario = cls.folder / "scored.scenario"
        scenario.write_text(WORLD)
        cls.live = []
        summary = cls.folder / "summary.json"
        with Daemon(None, "--no-render", "--record", cls.file, "--summary", summary, name=str(scenario)) as daemon:
            motors = daemon.text("/eva/motors")
            with coopdyn.connect(daemon.names[1]) as sim:
                for step in range(STEPS):
                    if step > 0:
                        motors.must("set_velocity 0.5 0.2")
                    cls.live.append(sim.scores())
                    for name, value in LOGS.get(step, []):
                        sim.log(name, value)
                motors.send("set_velocity 0.5 0.2")  # the last step: `time` ends the run, and the daemon with it
                assert daemon.process.wait(LIMIT_S) == 0
        cls.live.append({score["name"]: score["value"] for score in json.loads(summary.read_text())["scores"]})
        cls.table = cls.export("all.csv")

    @classmethod
    def export(cls, name, *options):
        """The rows of a CSV, by name of column."""
        code, said = tool("export", cls.file, "--to", "csv", "--out", cls.folder / name, "--force", *options)
        assert code == 0, said
        with open(cls.folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def numbers(self, column, table=None):
        return [float(row[column]) for row in table or self.table]

    def logged_at(self, name, step):
        """The expected newest value of a name; nan before the first."""
        values = [value for at in sorted(LOGS) if at <= step for one, value in LOGS[at] if one == name]
        return values[-1] if values else math.nan

    def test_columns_stand_behind_robots_and_things_in_the_order_of_the_scenario(self):
        columns = list(self.table[0])
        at = columns.index("BOX_1.qz") + 1
        self.assertEqual(columns[at:], [*SCORES, "logged.gap", "logged.tries", "hash"])

    def test_each_row_has_the_bits_that_a_client_saw_after_that_step(self):
        self.assertEqual([row["step"] for row in self.table], [str(step) for step in range(STEPS + 1)])
        for column, name in zip(SCORES, ("time", "way", "reach", "coverage", "energy")):
            self.assertEqual(self.numbers(column), [scores[name] for scores in self.live], column)

    def test_scores_agree_with_the_recorded_poses(self):
        self.assertEqual(self.numbers("score.time_s"), self.numbers("time_s"))
        x, y = self.numbers("eva.x_m"), self.numbers("eva.y_m")
        way, ways = 0.0, [0.0]
        for k in range(1, len(x)):
            way += math.hypot(x[k] - x[k - 1], y[k] - y[k - 1])
            ways.append(way)
        self.assertGreater(way, 0.1)
        for k, value in enumerate(self.numbers("score.way_m")):
            self.assertAlmostEqual(value, ways[k], delta=1e-6 * (k + 1))  # each pose is kept to half a micrometre
        first = next(k for k in range(len(x)) if math.hypot(x[k] - 0.25, y[k]) <= 0.1)
        self.assertEqual(self.numbers("score.reach"), [float(k >= first) for k in range(len(x))])
        cells = {(math.floor(a / 0.1), math.floor(b / 0.1)) for a, b in zip(x, y)}
        self.assertAlmostEqual(self.numbers("score.coverage_m2")[-1], 0.01 * len(cells))

    def test_a_logged_number_holds_from_its_step_on(self):
        for name in ("gap", "tries"):
            told = self.numbers(f"logged.{name}")
            for step, value in enumerate(told):
                expected = self.logged_at(name, step)
                self.assertTrue(value == expected or math.isnan(value) and math.isnan(expected), (name, step, value))
        self.assertTrue(math.isnan(self.numbers("logged.gap")[9]))
        self.assertEqual(self.numbers("logged.gap")[35], 1e-7)

    def test_a_part_of_the_run_begins_with_what_was_logged_before_it(self):
        table = self.export("part.csv", "--from", "0.25", "--until", "0.3")
        self.assertEqual(self.numbers("logged.gap", table), [-1.5] * 6)
        self.assertNotIn("logged.tries", self.export("early.csv", "--until", "0.15")[0])

    def test_both_are_chosen_by_name(self):
        table = self.export("chosen.csv", "--robots", "none", "--objects", "none", "--scores", "reach,way", "--logged", "tries")
        self.assertEqual(list(table[0]), ["step", "time_s", "score.way_m", "score.reach", "logged.tries", "hash"])
        self.assertEqual(self.numbers("score.way_m", table), self.numbers("score.way_m"))
        table = self.export("none.csv", "--robots", "none", "--objects", "none", "--scores", "none", "--logged", "none")
        self.assertEqual(list(table[0]), ["step", "time_s", "hash"])
        for option, word, said in (("--scores", "raech", "there is no score 'raech' in this part of the run; did you mean 'reach'?"),
                                   ("--logged", "tris", "there is no logged number 'tris' in this part of the run; did you mean 'tries'?"),
                                   ("--logged", "x1y2z3", "there are gap and tries")):
            code, told = tool("export", self.file, "--to", "csv", "--out", self.folder / "wrong.csv", option, word)
            self.assertEqual((code, said in told), (1, True), told)

    def test_matlab_files_have_the_same_bits(self):
        self.export("scored.csv", "--objects", "none")
        code, said = tool("export", self.file, "--to", "mat", "--out", self.folder / "scored.mat", "--force")
        self.assertEqual(code, 0, said)
        script = OCTAVE % (Path(__file__).parents[2] / "clients" / "matlab")
        done = subprocess.run(["octave-cli", "--norc", "--quiet", "--eval", script], cwd=self.folder, capture_output=True, text=True,
                              timeout=2 * LIMIT_S)
        self.assertEqual((done.returncode, done.stdout), (0, "equal"), done.stdout + done.stderr)

    def test_read_run_has_them(self):
        run = coopdyn.read_run(self.file)
        way = run.score("way")
        self.assertEqual([value for _, value in way], self.numbers("score.way_m"))
        self.assertEqual([time for time, _ in way], list(run.time))
        self.assertEqual(run.scores(), {name: self.numbers(column)[-1] for column, name in
                                        zip(SCORES, ("time", "way", "reach", "coverage", "energy"))})
        with self.assertRaisesRegex(coopdyn.Error, "has no score wya; there are time, way, reach, coverage, energy"):
            run.score("wya")

    def test_a_playback_shows_those_of_its_moment_forwards_and_backwards(self):
        with Play(self.file, "--paused") as player:
            playback = player.text("/playback")
            for step in (9, 10, 36, STEPS, 20, 3):
                playback.must(f"seek {self.table[step]['time_s']}")
                until(lambda: player.status()["step"] == step)
                status = player.status()
                self.assertEqual({score["name"]: score["value"] for score in status["scores"]}, self.live[step])
                self.assertEqual([score["met"] for score in status["scores"]], [step == STEPS, None, None, None, None])
                names = [name for name in ("gap", "tries") if not math.isnan(self.logged_at(name, step))]
                self.assertEqual([(one["name"], one["value"]) for one in status["logged"]],
                                 [(name, self.logged_at(name, step)) for name in names])
            self.assertEqual([(score["until"], score["limit_s"]) for score in status["scores"]],
                             [(">= 0.8", 99), *[(None, None)] * 4])

    def test_it_verifies(self):
        self.assertEqual(equal_steps(self.file), STEPS)


if __name__ == "__main__":
    unittest.main()
