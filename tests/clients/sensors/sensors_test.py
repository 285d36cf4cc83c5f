# SPDX-License-Identifier: MIT
"""Python, Octave and C++ read every sensor by the same program. SENSOR_PROGRAM names the one in C++."""
import os
import pathlib
import subprocess
import sys
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python"))
import fake_sensors  # noqa: E402
import harness  # noqa: E402
import coopdyn  # noqa: E402
from fake_daemon import FakeDaemon  # noqa: E402

CLIENTS = harness.ROOT / "clients"
LIMIT_S = 600
ROOM = """[SIMULATION]
mode lockstep
[FLOOR]
size 8 8 0.1
[WALL]
type box
size 0.2 4 0.6
position 1.5 0
[BALL]
type sphere
size 0.3
position 0.9 0.1
color red
[ROBOT_1]
type sensed
name robot1
position 0 0
"""


def octave(code):
    return ["octave", "--no-gui", "--norc", "--eval", f"addpath('{CLIENTS / 'matlab'}'); addpath('{HERE}'); {code}"]


def run(command, server):
    env = dict(os.environ, COOPDYN_SERVER=server, PYTHONPATH=str(CLIENTS / "python"))
    env.pop("DISPLAY", None)
    done = subprocess.run(list(map(str, command)), env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=LIMIT_S)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.stdout}{done.stderr}")
    return done.stdout.splitlines()


def numbers(word, values):
    return " ".join([word, *("%.17g" % value for value in values)])


class SameReadings(unittest.TestCase):
    def read(self, command):
        with FakeDaemon(mode=1, sensors=True) as daemon:
            return run(command, daemon.server)

    @classmethod
    def expected(cls):
        data = {reading: data for reading, (_, _, data) in fake_sensors.READINGS.items()}
        ranges = [numbers("ranges", data[250][k : k + fake_sensors.COLUMNS]) for k in (0, fake_sensors.COLUMNS)]
        scan = [*ranges, numbers("azimuth", [-1, -0.5, 0, 0.5, 1]), numbers("elevation", [-0.25, 0.25]), "limits 0.125 10"]
        rows = {"imu": 230, "wrench": 240, "sonar": 320, "infrared": 330, "light": 310, "battery": 290, "odometry": 340}
        simple = {word: numbers(word, data[reading]) for word, reading in rows.items()}
        touches = [data[260][:7], data[260][7:]]
        named = [numbers("contact floor", [0, *touches[0]]), numbers("contact box_2", [7, *touches[1]])]
        nameless = [numbers("contact ", [-1, *touch]) for touch in touches]

        def image(right):
            raw, k = fake_sensors.pixels(0, right), 3 * (fake_sensors.WIDTH + 2)
            last = 3 * (fake_sensors.WIDTH - 1)
            return numbers("image", [fake_sensors.WIDTH, fake_sensors.HEIGHT, sum(raw), *raw[k : k + 3], *raw[last : last + 3]])

        count = fake_sensors.WIDTH * fake_sensors.HEIGHT
        jpeg = fake_sensors.pixels(1, False)
        second = {module: numbers(word, fake_sensors.SECOND[(module, reading)][2])
                  for word, module, reading in (("imu", "mast_imu", 230), ("ranges", "rear_lidar", 250))}
        rear_scan = [second["rear_lidar"], numbers("azimuth", [-0.25, 0, 0.25]), "elevation 0", "limits 0 4"]
        lines = [simple["imu"], second["mast_imu"], simple["wrench"], *scan, *rear_scan, *named, "bumper 1 0 1"]
        lines += [simple[word] for word in ("sonar", "infrared", "light", "battery", "odometry")]
        lines += [numbers("camera", data[271]), image(False), numbers("when", [6 * 0.01, 6, 7]), image(True)]
        lines += [numbers("jpeg", [len(jpeg), 0xFF, 0xD8, sum(jpeg)])]
        lines += [numbers("depth", [33, 3, 35 / 8, 66 / 8, 0, (count - 1) / 8, 1])]
        lines += [numbers("segmentation", [33, 3, 700, 701 * count // 3]), "name 1 floor", "name 700 ball_1"]
        for step in (8, 9, 10):
            lines += [numbers("sense", [step * 0.01, step, step]), simple["imu"], simple["wrench"], *scan, *nameless]
            lines += [simple[word] for word in ("sonar", "infrared", "light", "battery", "odometry")]
            lines += [numbers("when", [step // 3 * 3, step])]
        return [*lines, simple["light"].replace("light", "pushed"), second["rear_lidar"].replace("ranges", "pushed")]

    def test_python_reads_every_sensor_and_a_camera_s_last_picture_is_no_reset(self):
        self.assertEqual(self.read([sys.executable, HERE / "sensor_program.py"]), self.expected())

    def test_octave_reads_the_same(self):
        self.assertEqual(self.read(octave("sensor_program")), self.expected())

    def test_cpp_reads_the_same(self):
        self.assertEqual(self.read([os.environ["SENSOR_PROGRAM"]]), self.expected())


class RealReadings(unittest.TestCase):
    def test_the_three_languages_read_the_same_of_a_robot_with_all_sensors(self):
        read = []
        for command in ([sys.executable, HERE / "sensor_program.py"], octave("sensor_program"), [os.environ["SENSOR_PROGRAM"]]):
            with unittest.mock.patch.dict(os.environ, COOPDYN_PATH=str(HERE)), harness.Daemon(ROOM, "--no-http") as daemon:
                read.append(run(command, daemon.server))
        words = [line.split()[0] for line in read[0]]
        for word in ("imu", "wrench", "ranges", "bumper", "sonar", "infrared", "light", "battery", "odometry", "image", "depth", "name"):
            self.assertIn(word, words)
        counts = [len(line.split()) - 1 for line in read[0] if line.startswith("ranges")]
        self.assertEqual(counts, [9, 9, 3] + 3 * [9, 9])  # the rear lidar is read by its name alone
        self.assertEqual(read[1], read[0])
        self.assertEqual(read[2], read[0])


class Resets(unittest.TestCase):
    def test_a_picture_after_the_reset_of_another_client_says_so(self):
        with FakeDaemon(mode=1, sensors=True) as daemon, coopdyn.connect(daemon.server) as sim:
            robot = sim.robot("robot1")
            sim.step(7)
            self.assertEqual((robot.get_image().step, sim.steps), (6, 7))
            with coopdyn.connect(daemon.server, watch=True, name="other") as other:
                other.reset()
            self.assertRaises(coopdyn.WorldReset, robot.get_image)
            self.assertEqual(robot.get_image().step, 0)


if __name__ == "__main__":
    unittest.main()
