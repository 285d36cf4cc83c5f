"""The pictures of a step are the same bytes for any number of threads, in playback, after a branch, by HTTP and in exports."""
import struct
import tempfile
import unittest
import urllib.error
import urllib.request
import zlib
from pathlib import Path

from harness import Daemon
from pictures import DEPTH, RGB, SEGMENTATION, Camera
from recording import Play, tool

WORLD = """
[SIMULATION]
mode lockstep
step 0.01
seed 5
[FLOOR]
size 8 8
texture checker
[LIGHT_1]
position 0.5 0.5 1.5
color 1 0.9 0.6
[CRATE_1]
type box
size 0.4 0.4 0.5
position 0.8 0.3
color orange
texture grid
[BALL_1]
type sphere
size 0.2
position 0.7 -0.6 0.4
mass 0.2
[ROBOT_1]
type coopbot_camera
name robot1
position 0 0
[ROBOT_2]
type turtle
name robot2
position 0 1.2
orientation -45deg
[ROBOT_3]
type moth
name robot3
position 1.6 -0.2
"""
STEP_S = 0.01
MOMENTS = (7, 31, 45)
STEPS = MOMENTS[-1] + 1
CAMERAS = ("robot1", "robot2")
KINDS = (RGB, DEPTH, SEGMENTATION)


def png_pixels(data):
    """Width, height and the bytes of an RGB picture of 8 bits."""
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk, at = data[at + 8:at + 8 + size], at + 12 + size
        if kind == b"IHDR":
            width, height, depth, colors = struct.unpack(">IIBB", chunk[:10])
            assert (depth, colors) == (8, 2), chunk
        elif kind == b"IDAT":
            packed += chunk
    rows, length = zlib.decompress(packed), 3 * width
    above, pixels = bytes(length), bytearray()
    for y in range(height):
        start = y * (length + 1)
        kind, row = rows[start], bytearray(rows[start + 1:start + 1 + length])
        for i in range(length):
            left, corner = (row[i - 3], above[i - 3]) if i >= 3 else (0, 0)
            nearest = min((left, above[i], corner), key=lambda value: abs(left + above[i] - corner - value))
            row[i] = (row[i] + (0, left, above[i], (left + above[i]) // 2, nearest)[kind]) & 255
        above = bytes(row)
        pixels += above
    return width, height, bytes(pixels)


class Viewer:
    """Reads all cameras of a daemon, and drives it."""

    def __init__(self, daemon):
        self.cameras = [Camera(daemon, robot) for robot in CAMERAS]
        self.motors = [daemon.text(f"/robot{i}/motors") for i in (1, 2, 3)]

    def drive_to(self, step):
        """Drives with commands that depend only on the step."""
        now = self.motors[0].must("get_time").step
        for k in range(now, step):
            for i, robot in enumerate(self.motors):
                robot.send(f"set_velocity {0.1 + 0.05 * i} {0.4 - 0.02 * (k % 40) * (i + 1)}")
            for robot in self.motors:
                assert robot.receive().error == 0

    def sees(self):
        return [camera.picture(kind) for camera in self.cameras for kind in KINDS]


def fetch(daemon, robot):
    with urllib.request.urlopen(f"{daemon.http}/camera.png?robot={robot}".replace("//camera", "/camera"), timeout=60) as answer:
        return answer.read()


class UnknownCameraTest(unittest.TestCase):
    def test_http_says_that_there_is_no_such_camera(self):
        with Daemon(WORLD, "--http") as daemon:
            for query in ("nobody", f"{CAMERAS[0]}&camera=nothing"):
                with self.assertRaises(urllib.error.HTTPError) as raised:
                    fetch(daemon, query)
                with raised.exception as error:
                    self.assertEqual(error.code, 404)


class CameraBytesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.file, cls.seen, cls.pngs = Path(folder.name) / "lesson.run", {}, {}
        with Daemon(WORLD, "--http", "--record", cls.file) as daemon:
            viewer = Viewer(daemon)
            for step in MOMENTS:
                viewer.drive_to(step)
                cls.seen[step] = viewer.sees()
                cls.pngs[step] = [fetch(daemon, robot) for robot in CAMERAS]
            viewer.drive_to(STEPS)

    def expect_seen(self, step, pictures):
        for robot_and_kind, (picture, before) in enumerate(zip(pictures, self.seen[step], strict=True)):
            self.assertEqual(picture, before, f"step {step}, camera {robot_and_kind // len(KINDS) + 1}, "
                             f"format {KINDS[robot_and_kind % len(KINDS)]}")

    def test_in_lockstep_a_picture_is_of_the_newest_sample_of_its_camera(self):
        for step in MOMENTS:
            sample = next(k for k in range(step + 1) if k * 30 // 100 == step * 30 // 100)
            self.assertEqual({picture.step for picture in self.seen[step]}, {sample})
            rgb, depth, segments = self.seen[step][:3]
            self.assertEqual([len(picture.pixels) / (320 * 240) for picture in (rgb, depth, segments)], [3, 4, 2])
            self.assertIn("CRATE_1", segments.legend)
        for one, other in zip(self.seen[MOMENTS[0]], self.seen[MOMENTS[1]]):
            self.assertNotEqual(one.pixels, other.pixels)

    def test_any_number_of_threads_draws_the_same(self):
        for threads in ("2", "4"):
            with Daemon(WORLD, "--threads", threads) as daemon:
                viewer = Viewer(daemon)
                for step in MOMENTS:
                    viewer.drive_to(step)
                    self.expect_seen(step, viewer.sees())

    def test_another_seed_has_other_noise(self):
        with Daemon(WORLD, "--seed", "6") as daemon:
            viewer = Viewer(daemon)
            viewer.drive_to(MOMENTS[0])
            self.assertNotEqual(viewer.sees()[0].pixels, self.seen[MOMENTS[0]][0].pixels)

    def test_playback_draws_the_same_in_any_order(self):
        with Play(self.file, "--paused") as daemon:
            viewer, playback = Viewer(daemon), daemon.text("/playback")
            for step in (MOMENTS[1], MOMENTS[0], MOMENTS[2]):
                self.assertEqual(playback.must(f"seek {STEP_S * step!r}").step, step)
                self.expect_seen(step, viewer.sees())

    def test_a_branch_draws_the_same(self):
        with Daemon(None, "--from", f"{self.file}@#{MOMENTS[0] + 2}", name="") as daemon:
            viewer = Viewer(daemon)
            for step in MOMENTS[1:]:
                viewer.drive_to(step)
                self.expect_seen(step, viewer.sees())

    def test_export_and_http_give_the_same_pixels(self):
        step = MOMENTS[1]
        for i, robot in enumerate(CAMERAS):
            out = Path(self.file).with_name(f"{robot}.png")
            code, said = tool("export", self.file, "--to", "png", "--camera", robot, "--time", repr(STEP_S * step), "--out", out)
            self.assertEqual(code, 0, said)
            raw = self.seen[step][i * len(KINDS)]
            self.assertEqual(self.pngs[step][i], out.read_bytes())
            self.assertEqual(png_pixels(out.read_bytes()), (raw.width, raw.height, raw.pixels))


if __name__ == "__main__":
    unittest.main()
