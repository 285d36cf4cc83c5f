"""Sensors have no side effects and are reproducible: bitwise the same hashes and readings for any readers and number of threads, recorded
or not, after a branch; and each shows exactly the step that its rate and delay determine."""
import math
import os
import unittest
from pathlib import Path

from harness import Daemon
from pictures import DEPTH, JPEG, RGB, SEGMENTATION, Camera
from recording import SANITIZED, RecordingTestCase, equal_steps

ENV = {"COOPDYN_PATH": os.pathsep.join(filter(None, [str(Path(__file__).parent / "robots"), os.environ.get("COOPDYN_PATH")]))}
ZOO = """
[SIMULATION]
mode lockstep
step 0.01
[FLOOR]
size 12 12
[WALL_1]
type box
size 0.1 6 0.5
position 2.5 0
[LIGHT_1]
position 1 1 1.2
[BALL_1]
type sphere
size 0.2
position 0.6 -1.5 0.1
mass 0.3
[TARGET]
red 2 2 0.3
[ROBOT_1]
type turtle
position 0 0
[ROBOT_2]
type coopbot_camera
position 0 -1.5
[ROBOT_3]
type moth
position 0 1.5
[ROBOT_4]
type balancer
position -1.5 0 0.002
orientation 0 12deg 0
[ROBOT_5]
type humanoid
position -1.5 2
sync no
"""
GETTERS = {"imu": "get_imu", "wrench": "get_wrench", "lidar": "get_scan", "contact": "get_contacts", "light": "get_light",
           "battery": "get_battery", "odometry": "get_odometry", "pose": "get_pose_3d", "distance": "get_distances",
           "target": "get_targets", "motors": "get_wheels", "joints": "get_joints", "compass": "get_compass"}


class Zoo:
    """Robots of all kinds in one daemon: drives them by commands that depend only on the step, and reads their sensors."""

    def __init__(self, daemon):
        self.daemon = daemon
        robots = daemon.status()["robots"]
        self.step_of = daemon.text("/simulation")
        self.sensors = [(module["name"], GETTERS[module["type"]]) for robot in robots for module in robot["modules"]
                        if module["type"] in GETTERS]
        self.readers = {module: daemon.text(module) for module, _ in self.sensors}
        self.drives = [(daemon.text(module["name"]), module["type"]) for robot in robots for module in robot["modules"]
                       if module["type"] in ("motors", "joints") and robot["participates"]]
        self.cameras = [Camera(daemon, robot["name"]) for robot in robots
                        if any(module["type"] == "camera" for module in robot["modules"])]

    def drive_to(self, step, each=lambda: None):
        for k in range(self.step_of.must("get_time").step, step):
            for i, (drive, kind) in enumerate(self.drives):
                value = 0.2 * math.sin(0.1 * k + i)
                drive.send(f"set_velocity 0.2 {value!r}" if kind == "motors" else f"set_efforts {value / 10!r} {value / 20!r}")
            for drive, _ in self.drives:
                reply = drive.receive()
                assert reply.error == 0, reply
            each()

    def reads(self):
        """The reading of every sensor, with its step."""
        seen = {}
        for module, getter in self.sensors:
            self.readers[module].send(getter)
        for module, _ in self.sensors:
            reply = self.readers[module].receive()
            assert reply.error == 0, (module, reply)
            seen[module] = (reply.text, reply.params, reply.data)
        return seen

    def hash(self):
        return self.daemon.status()["hash"]


class ZooTest(RecordingTestCase):
    STEPS = (30, 60)

    @classmethod
    def setUpClass(cls):
        """Makes the run that nobody reads before its end."""
        cls.hashes = {}
        with Daemon(ZOO) as daemon:
            zoo = Zoo(daemon)
            for step in cls.STEPS:
                zoo.drive_to(step)
                cls.hashes[step] = zoo.hash()
            cls.end = zoo.reads()

    def expect_same(self, zoo, each=lambda: None):
        for step in self.STEPS:
            zoo.drive_to(step, each)
            self.assertEqual(zoo.hash(), self.hashes[step], f"step {step}")
        for module, read in zoo.reads().items():
            self.assertEqual(str(read), str(self.end[module]), module)

    def test_all_kinds_of_sensors_are_there_and_show_something(self):
        telling = {module.rsplit("/", 1)[1] for module, (_, _, data) in self.end.items()
                   if any(value not in (0, math.inf) for value in data[:-2])}
        self.assertLessEqual({"imu", "odometry", "battery", "light", "lidar", "left_wrench", "pose", "distance"}, telling)

    def test_readers_cameras_threads_and_a_recording_change_nothing(self):
        for threads in ("1", "4") if SANITIZED else ("1", "2", "4"):
            file = self.folder / f"threads{threads}.run"
            with Daemon(ZOO, "--http", "--threads", threads, "--record", file, "--record-what", "all,images") as daemon:
                zoo = Zoo(daemon)
                for module, _ in zoo.sensors[::2]:
                    daemon.text(module).send("subscribe")  # and never reads
                kinds = (RGB, JPEG, DEPTH, SEGMENTATION)

                def look():
                    zoo.reads()
                    for i, camera in enumerate(zoo.cameras):
                        camera.picture(kinds[i])
                self.expect_same(zoo, look if threads == "1" else lambda: None)
            self.assertEqual(equal_steps(file), self.STEPS[-1])

    def test_a_branch_goes_on_with_the_same_hashes_and_readings(self):
        with Daemon(ZOO, "--record", self.file) as daemon:
            Zoo(daemon).drive_to(self.STEPS[-1])
        for step in (11, 30) if SANITIZED else (1, 11, 22, 30):
            with Daemon(None, "--from", f"{self.file}@#{step}", name="") as daemon:
                self.expect_same(Zoo(daemon))


SAMPLER = ("[SIMULATION]\nmode lockstep\nstep 0.01\n[BOX_1]\ntype box\nsize 1 1 1\nposition 2 0.3\n"
           "[ROBOT_1]\ntype sampler\nname robot1\nposition 0 0\n")


class SamplerTest(unittest.TestCase):
    STEPS = 50

    def run_steps(self, each):
        """Drives the steps and calls each(daemon, ask, step) after every one."""
        with Daemon(SAMPLER, env=ENV) as daemon:
            motors, readers = daemon.text("/robot1/motors"), {}

            def ask(module, getter="get_imu"):
                if module not in readers:
                    readers[module] = daemon.text(f"/robot1/{module}")
                reply = readers[module].must(getter)
                return reply.step, reply.data[:-2]
            for k in range(1, self.STEPS + 1):
                self.assertEqual(motors.must(f"set_velocity {0.3 * math.sin(0.3 * k)!r} {math.cos(0.5 * k)!r}").step, k)
                each(daemon, ask, k)

    def test_a_sensor_shows_the_step_that_its_rate_and_delay_say(self):
        exact, shown = {}, {"slow": [], "odd": [], "late": []}

        def each(_, ask, k):
            exact[k] = ask("imu")
            for module, steps in shown.items():
                step, data = ask(module)
                steps.append(step)
                if step > 0:
                    self.assertEqual(data, exact[step][1], f"{module}, step {k}")
        self.run_steps(each)
        steps = range(1, self.STEPS + 1)
        self.assertEqual([exact[k][0] for k in steps], list(steps))
        self.assertEqual(len({str(data) for _, data in exact.values()}), self.STEPS)
        # 10 Hz, 20 ms late: it changes at the steps 12, 22, 32, …
        self.assertEqual(shown["slow"], [max(0, (k - 2) // 10 * 10) for k in steps])
        # 30 Hz of 100: samples at 0, 4, 7, 10, 14, …
        self.assertEqual(shown["odd"], [-(-(3 * k // 10) * 10 // 3) for k in steps])
        # 25 ms late: what is at least that old
        self.assertEqual(shown["late"], [max(0, k - 3) for k in steps])

    def test_noise_is_the_same_whoever_reads_and_how_often(self):
        modules = {"noisy": "get_imu", "lidar": "get_scan", "slow_lidar": "get_scan"}
        alone, crowded = {}, {}

        def read_each_step(_, ask, k):
            alone[k] = [ask(module, getter) for module, getter in modules.items()]

        def read_in_a_crowd(daemon, ask, k):
            if k == 1:
                for module in modules:
                    daemon.text(f"/robot1/{module}").must("subscribe")
            others = [daemon.text(f"/robot1/{module}").must(getter) for module, getter in modules.items() for _ in range(2)]
            if k % 7 == 0:
                crowded[k] = [ask(module, getter) for module, getter in modules.items()]
                self.assertEqual([(other.step, other.data[:-2]) for other in others[::2]], crowded[k])
                self.assertEqual(crowded[k], [ask(module, getter) for module, getter in modules.items()])
        self.run_steps(read_each_step)
        self.run_steps(read_in_a_crowd)
        for k, readings in crowded.items():
            self.assertEqual(readings, alone[k], f"step {k}")
        for i, module in enumerate(modules):
            samples = {str(readings[i][1]) for readings in alone.values()}
            self.assertEqual(len(samples), self.STEPS // 10 + 1 if module == "slow_lidar" else self.STEPS, module)


if __name__ == "__main__":
    unittest.main()
