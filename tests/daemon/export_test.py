"""`coopdyn export`: the recording of a live run for MATLAB, Octave, spreadsheets and film players."""
import csv
import math
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon, scenario
from recording import RecordingTestCase, tool

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "clients" / "python"))
import coopdyn  # noqa: E402

BOX = "[BOX_1]\ntype box\nsize 0.3 0.3 0.3\nposition 0.5 0.1\nmass 1\n"

# Prints `equal` if the file's numbers equal those of the CSV beside it, bit for bit; else the difference.
OCTAVE = r"""
function same(what, a, b)
  if ! isequal(size(a), size(b)) || ! isequaln(a, b)
    printf("%s differs\n", what);
    exit(1);
  end
end
load("run.mat");
line = fgetl(fopen("run.csv"));
names = strsplit(line, ",");
table = dlmread("run.csv", ",", 1, 0);
column = @(name) table(:, strcmp(names, name));
same("step", run.step, column("step"));
same("time", run.time, column("time_s"));
for i = 1:numel(run.robots)
  r = run.robots(i);
  n = [r.name "."];
  same("names", r.name, run.names{i});
  same([n "pose"], r.pose, [column([n "x_m"]), column([n "y_m"]), column([n "heading_rad"])]);
  same([n "pose_3d"], r.pose_3d(:, 1:2), r.pose(:, 1:2));
  same([n "joints"], r.joints, {"left_wheel_joint", "right_wheel_joint"});
  of = @(word) [column([n r.joints{1} word]), column([n r.joints{2} word])];
  same([n "channels"], r.channels, [of("_rad"), of("_rad_s")]);
  same([n "setpoints"], r.setpoints, of("_setpoint_rad_s"));
  same([n "modes"], r.modes, 3 * ones(size(r.setpoints)));
  same([n "targets"], r.targets, [column([n "red1_distance_m"]), column([n "red1_bearing_rad"])]);
  for k = 1:columns(r.distances)
    same([n "distances"], r.distances(:, k), column(sprintf("%sd%d_m", n, k)));
  end
end
o = run.objects(1);
at = find(strcmp(names, [o.name ".x_m"]));
same("object", o.pose_3d, table(:, at:at + 6));
fid = fopen("run.csv");
fgetl(fid);
for k = 1:rows(run.hash)
  row = strsplit(fgetl(fid), ",");
  same("hash", run.hash(k, :), row{end});
end
same("seed", double(run.seed), 1);
same("inf in distances", any(isinf(run.robots(1).distances(:))), true);
same("target", [run.targets.x run.targets.y], [3 0]);
same("scenario", isempty(strfind(run.scenario, "BOX_1")), false);
note = run.events(strcmp({run.events.level}, "note"));
same("note", {note.text, note.step}, {'half way, "there"', 30});
printf("equal, %d moments, %d commands\n", numel(run.time), rows(run.robots(1).commands));
"""

# Replaces ffmpeg, which need not be installed: prints its arguments and the number of bytes received.
FFMPEG = """#!%s
import json, os, sys
mode = os.environ.get("FAKE_FFMPEG", "")
if "-encoders" in sys.argv:
    print(" V....D mpeg4                MPEG-4 part 2")
    if mode != "no x264":
        print(" V....D libx264              libx264 H.264 / AVC / MPEG-4 AVC")
    sys.exit(0)
if mode == "fails":
    sys.stdin.buffer.read(1000)
    sys.stderr.write("something else\\nUnknown encoder 'libx264'\\n")
    sys.exit(1)
got = sys.stdin.buffer.read()
out = sys.argv[-1]
assert out.startswith("file:")
with open(out[5:], "w") as file:
    json.dump([sys.argv[1:], len(got), got[:3] != got[-3:] or any(got)], file)
"""


class ExportTest(RecordingTestCase):
    @classmethod
    def setUpClass(cls):
        cls.recorded = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.recorded.cleanup)
        run = Path(cls.recorded.name) / "run.run"
        with Daemon(scenario(2, BOX), "--record", str(run), "--record-what", "all") as daemon:
            robots = [daemon.text(f"/robot{i}/motors") for i in (1, 2)]
            recorder = daemon.text("/recorder")
            for k in range(60):
                if k == 30:
                    recorder.must('note "half way, \\"there\\""')
                for i, robot in enumerate(robots):
                    robot.send(f"set_velocity {0.05 * (k % 7) + 0.01 * i} {0.3 - 0.01 * k}")
                for robot in robots:
                    assert robot.receive().error == 0

    def setUp(self):
        super().setUp()
        shutil.copy(Path(self.recorded.name) / "run.run", self.folder)

    def export(self, *words, env=None):
        return tool("export", "run.run", *words, cwd=self.folder, env=env)

    def must(self, *words, env=None):
        code, said = self.export(*words, env=env)
        self.assertEqual(code, 0, said)
        return said

    def files(self):
        return sorted(os.listdir(self.folder))

    def table(self):
        with open(self.folder / "run.csv", newline="") as file:
            return list(csv.DictReader(file))

    def fake_ffmpeg(self):
        """An environment whose PATH has only the fake ffmpeg."""
        place = self.folder / "bin"
        place.mkdir()
        program = place / "ffmpeg"
        program.write_text(FFMPEG % sys.executable)
        program.chmod(0o755)
        return {"PATH": str(place)}

    def test_octave_loads_the_numbers_of_the_csv(self):
        self.must("--to", "csv")
        self.assertEqual(self.must("--to", "mat"), "wrote run.mat\n")
        (self.folder / "compare.m").write_text("1;\n" + OCTAVE)
        done = subprocess.run(["octave-cli", "--norc", "--quiet", "compare.m"], cwd=self.folder, capture_output=True,
                              text=True, timeout=2 * LIMIT_S)
        self.assertEqual((done.returncode, done.stdout), (0, "equal, 61 moments, 61 commands\n"), done.stderr)

    def test_read_run_has_the_numbers_of_the_csv(self):
        self.must("--to", "csv")
        run = coopdyn.read_run(self.folder / "run.run")
        table = self.table()
        self.assertEqual([float(row["time_s"]) for row in table], list(run.time))
        self.assertEqual([row["hash"] for row in table], run.hash)
        for name in run.names:
            for row, (x_m, y_m, heading_rad) in zip(table, run.pose(name)):
                self.assertEqual((float(row[f"{name}.x_m"]), float(row[f"{name}.y_m"])), (x_m, y_m))
                self.assertAlmostEqual(float(row[f"{name}.heading_rad"]), heading_rad, delta=1e-15, msg="by another arc tangent")
            numbers = [tuple(float(row[f"{name}.d{k}_m"]) for k in range(1, 12)) for row in table]
            self.assertEqual(numbers, list(run.reading(name, "distances")))
            columns = [f"{name}.{joint}_{unit}" for unit in ("rad", "rad_s") for joint in run.joints(name)]
            self.assertEqual([tuple(float(row[column]) for column in columns) for row in table],
                             list(run.reading(name, "channels")))
        numbers = [tuple(float(row[f"BOX_1.{field}"]) for field in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"))
                   for row in table]
        self.assertEqual(numbers, list(run.pose_3d("BOX_1")))

    def test_the_csv_is_there_with_its_events_or_not_at_all(self):
        self.assertEqual(self.must("--to", "csv"), "wrote run.csv and run-events.csv\n")
        self.assertEqual(self.files(), ["run-events.csv", "run.csv", "run.run"])
        with open(self.folder / "run-events.csv", newline="") as file:
            notes = [(row["step"], float(row["time_s"]), row["text"]) for row in csv.DictReader(file) if row["level"] == "note"]
        self.assertEqual(notes, [("30", 300_000_000 / 1e9, 'half way, "there"')])
        code, said = self.export("--to", "csv")
        self.assertEqual(code, 1)
        self.assertIn("run.csv is there already: --force overwrites it", said)
        self.must("--to", "csv", "--force", "--from", "0.1", "--until", "0.3", "--every", "0.05", "--robots", "robot2",
                  "--objects", "none")
        table = self.table()
        self.assertEqual([row["step"] for row in table], ["10", "15", "20", "25", "30"])
        self.assertFalse([name for name in table[0] if name.startswith(("robot1.", "BOX_1."))])
        self.assertTrue(all(math.isfinite(float(row["robot2.x_m"])) for row in table))

    def test_force_overwrites_no_recording_and_no_scenario(self):
        shutil.copy(self.folder / "run.run", self.folder / "other.run")
        (self.folder / "mix.scenario").write_text("mine")
        for name, kind in (("other.run", "a recording"), ("mix.scenario", "a scenario")):
            before = (self.folder / name).read_bytes()
            code, said = self.export("--to", "mat", "--out", name, "--force")
            self.assertEqual((code, said), (1, f"coopdyn: export: {name} is {kind}, which export never overwrites: "
                                               "choose another --out\n"))
            self.assertEqual((self.folder / name).read_bytes(), before)

    def test_an_empty_folder_takes_pictures_unasked(self):
        (self.folder / "film").mkdir()
        self.must("--to", "png", "--out", "film", "--size", "64x48")
        self.assertIn("000001.png", os.listdir(self.folder / "film"))

    def test_the_name_of_the_output_tells_the_format(self):
        self.must("--out", "path.mat", "--robots", "robot1")
        self.assertEqual(self.files(), ["path.mat", "run.run"])

    def test_wrong_use_says_what_to_write(self):
        for words, expected in ((["--to", "xls"], "--to: write csv, mat, png or mp4"),
                                ([], "--to: write csv, mat, png or mp4"),
                                (["--to", "csv", "--fps", "10"], "--fps is for --to png and mp4"),
                                (["--to", "png", "--robots", "robot1"], "--robots is for --to csv and mat"),
                                (["--to", "mp4", "--time", "1"], "--time is for --to png: one picture"),
                                (["--to", "png", "--size", "huge"], "--size: write WIDTHxHEIGHT in pixels, e.g. 640x480"),
                                (["--to", "csv", "--robots", ""], "--robots: write names with commas in between, or none")):
            code, said = self.export(*words)
            self.assertEqual((code, expected in said), (2, True), said)
        self.assertEqual(self.files(), ["run.run"])

    def test_errors_name_what_is_near_and_leave_nothing(self):
        code, said = self.export("--to", "mat", "--robots", "robot1,robto2")
        self.assertEqual((code, said), (1, "coopdyn: export: there is no robot 'robto2' in this part of the run; did you mean "
                                           "'robot2'?\n"))
        code, said = self.export("--to", "csv", "--from", "5")
        self.assertEqual((code, said), (1, "coopdyn: export: --from 5: the run lasts from 0 to 0.6 s\n"))
        code, said = self.export("--to", "csv", "--out", "none/run.csv")
        self.assertEqual((code, said), (1, "coopdyn: export: none/run.csv cannot be written: No such file or directory\n"))
        code, said = tool("export", "lost.run", "--to", "csv", cwd=self.folder)
        self.assertEqual(code, 1, said)
        self.assertEqual(self.files(), ["run.run"])

    def test_pictures_have_the_number_and_size_that_was_asked_for(self):
        self.must("--to", "png", "--fps", "5", "--size", "160x120", "--eye", "-2,0,2", "--look", "0,0,0", "--rays")
        names = sorted(os.listdir(self.folder / "run-png"))
        self.assertEqual(names, [f"00000{i}.png" for i in range(1, 5)])
        head = (self.folder / "run-png" / names[-1]).read_bytes()[:24]
        self.assertEqual(struct.unpack(">II", head[16:]), (160, 120))
        self.must("--to", "png", "--time", "0.35", "--size", "64x48", "--out", "one.png")
        self.assertEqual(struct.unpack(">II", (self.folder / "one.png").read_bytes()[16:24]), (64, 48))

    def test_a_film_is_fed_to_ffmpeg_picture_by_picture(self):
        import json
        env = self.fake_ffmpeg()
        self.must("--to", "mp4", "--fps", "20", "--speed", "2", "--size", "64x48", env=env)
        arguments, got, drawn = json.loads((self.folder / "run.mp4").read_text())
        self.assertEqual(arguments[:-1], "-hide_banner -loglevel error -f rawvideo -pix_fmt rgb24 -s 64x48 -r 20 -i - -an "
                                         "-c:v libx264 -pix_fmt yuv420p -f mp4 -y".split())
        self.assertEqual((got, drawn), (7 * 64 * 48 * 3, True))  # 0.6 s at twice the speed: 6 pictures and the first
        self.must("--to", "mp4", "--size", "64x48", "--force", env={**env, "FAKE_FFMPEG": "no x264"})
        self.assertNotIn("libx264", (self.folder / "run.mp4").read_text())
        self.assertEqual(self.files(), ["bin", "run.mp4", "run.run"])

    def test_what_ffmpeg_complains_about_is_said(self):
        code, said = self.export("--to", "mp4", "--size", "640x480", env={**self.fake_ffmpeg(), "FAKE_FFMPEG": "fails"})
        self.assertEqual((code, said), (1, "coopdyn: export: ffmpeg failed: Unknown encoder 'libx264'\n"))
        self.assertEqual(self.files(), ["bin", "run.run"])

    def test_without_ffmpeg_pictures_are_offered(self):
        code, said = self.export("--to", "mp4", env={"PATH": str(self.folder)})
        self.assertEqual(code, 1)
        self.assertIn("ffmpeg is not installed: ", said)
        self.assertIn("--to png", said)
        self.assertEqual(self.files(), ["run.run"])

    def test_ctrl_c_leaves_nothing(self):
        process = subprocess.Popen([BINARY, "export", "run.run", "--to", "png", "--fps", "1000", "--speed", "0.01", "--size", "1280x720"],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + LIMIT_S
        while not list(self.folder.glob("run-png.part/000002.png")):
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=LIMIT_S)[1]
        self.assertEqual((process.returncode, said), (1, "coopdyn: export: stopped; nothing was written\n"))
        self.assertEqual(self.files(), ["run.run"])

    def test_a_run_that_is_being_recorded_is_exported_as_far_as_it_goes(self):
        run = self.folder / "live.run"
        with Daemon(scenario(1), "--record", str(run)) as daemon:
            motors = daemon.text("/robot1/motors")
            for _ in range(30):
                motors.must("set_velocity 0.1 0")
            deadline = time.monotonic() + LIMIT_S
            while True:  # until the recorder has committed them
                code, said = tool("export", "live.run", "--to", "csv", "--force", cwd=self.folder)
                if code == 0 and len((self.folder / "live.csv").read_text().splitlines()) == 32:
                    break
                self.assertLess(time.monotonic(), deadline, said)
                motors.must("get_wheels")


if __name__ == "__main__":
    unittest.main()
