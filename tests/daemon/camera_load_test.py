"""Many clients that read cameras, and some that request pictures and never read: the simulation and all other clients continue."""
import socket
import threading
import unittest

from harness import Connection, Daemon, frame, scenario, until
from pictures import GET_IMAGE, GET_TIME, JPEG, Camera
from recording import SANITIZED, Play, RecordingTestCase

STEP_S = 0.01
CRATE = "[CRATE_1]\ntype box\nsize 0.4 0.4 0.6\nposition 1.2 0.3\ncolor orange\n"


def cameras(robots, mode):
    return scenario(robots, CRATE, mode).replace("type coopbot", "type coopbot_camera")


def memory_bytes(daemon):
    with open(f"/proc/{daemon.process.pid}/status") as file:
        return 1024 * next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


class Watcher(threading.Thread):
    """Requests pictures of one camera without pause until told to end. `seen`: the step of each picture, and the newest step at its
    arrival."""

    def __init__(self, daemon, robot, drive=True):
        super().__init__(daemon=True)
        self.camera, self.motors = Camera(daemon, robot), daemon.text(f"/{robot}/motors")
        self.seen, self.first, self.failure, self.stop = [], {}, None, threading.Event()
        if drive:
            self.motors.must("set_velocity 0.1 0.4")

    def run(self):
        try:
            while not self.stop.is_set():
                self.camera.ask_for_picture()
                self.camera.send(GET_TIME)
                picture, now = self.camera.receive_picture(), self.camera.receive()
                assert picture.error == 0, picture
                self.seen.append((picture.step, now.step))
                if now.step > picture.step and len(self.first) < 2:
                    self.first[picture.step] = picture
        except Exception as error:
            self.failure = error

    def has(self, count):
        if self.failure is not None:
            raise self.failure
        return len(self.seen) >= count


class TwentyCamerasTest(RecordingTestCase):
    def test_in_real_time_physics_waits_for_no_picture_and_those_that_come_late_say_of_which_step_they_are(self):
        with Daemon(cameras(20, "realtime"), "--record", self.file) as daemon:
            watchers = [Watcher(daemon, f"robot{i}") for i in range(1, 21)]
            for watcher in watchers:
                watcher.start()
            count = 3 if SANITIZED else 12
            # Late: physics has advanced while a picture was drawn.
            until(lambda: all(watcher.has(count) and watcher.first for watcher in watchers))
            after = daemon.status()
            for watcher in watchers:
                watcher.stop.set()
            for watcher in watchers:
                watcher.join()
                self.assertIsNone(watcher.failure)

        ages = sorted(now - step for watcher in watchers for step, now in watcher.seen)
        print(f"{len(ages)} pictures; {after['step']} steps and {after['late_periods']} skipped, factor {after['rtf']:.2f}; age in steps: "
              f"{ages[len(ages) // 2]}, at most {ages[-1]}", flush=True)
        self.assertGreaterEqual(ages[0], 0)
        for watcher in watchers:
            shown = [step for step, _ in watcher.seen]
            self.assertEqual(shown, sorted(shown))
            self.assertGreater(shown[-1], shown[0])

        with Play(self.file, "--paused") as daemon:
            playback = daemon.text("/playback")
            for i in (0, 9, 19):
                camera = Camera(daemon, f"robot{i + 1}")
                for step, picture in watchers[i].first.items():
                    self.assertEqual(playback.must(f"seek {step * STEP_S!r}").step, step)
                    self.assertEqual(camera.picture(), picture)


class DeafTest(unittest.TestCase):
    PICTURES = 20 if SANITIZED else 150
    # Much less than the requested pictures that are never read. The address sanitizer keeps 256 MiB of freed memory.
    MORE_BYTES = (400 if SANITIZED else 32) << 20

    def deaf(self, daemon):
        """Requests more pictures of the first robot's camera than a day has seconds, and reads none."""
        camera = Camera(daemon, "robot1")
        camera.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        camera.socket.setblocking(False)
        try:
            for _ in range(100):
                camera.socket.send(frame(GET_IMAGE) * 1000)
        except BlockingIOError:
            pass
        return camera

    def check(self, daemon, next_step):
        good = [Camera(daemon, "robot1"), Camera(daemon, "robot2")]
        pose = daemon.text("/robot1/pose")
        for camera in good:
            camera.picture()
        before, first = memory_bytes(daemon), pose.must("get_time").step
        deaf = [self.deaf(daemon) for _ in range(4)]
        for _ in range(self.PICTURES):
            next_step()
            for camera in good:
                camera.ask_for_picture()
            for camera in good:
                self.assertEqual(camera.receive_picture().error, 0)
        self.assertGreaterEqual(pose.must("get_time").step, first + self.PICTURES)
        self.assertLess(memory_bytes(daemon) - before, self.MORE_BYTES)
        for camera in deaf:
            camera.close()
        good[0].picture()

    def test_in_lockstep_asking_and_never_reading_hurts_nobody(self):
        with Daemon(cameras(2, "lockstep")) as daemon:
            motors = [daemon.text(f"/robot{i}/motors") for i in (1, 2)]

            def next_step():
                for robot in motors:
                    robot.send("set_velocity 0.1 0.2")
                for robot in motors:
                    self.assertEqual(robot.receive().error, 0)
            self.check(daemon, next_step)

    def test_in_real_time_asking_and_never_reading_hurts_nobody(self):
        with Daemon(cameras(2, "realtime")) as daemon:
            simulation = daemon.text("/simulation")
            self.check(daemon, lambda: simulation.must("ready"))

    def test_a_viewer_by_http_that_never_reads_hurts_nobody(self):
        with Daemon(cameras(2, "realtime"), "--http", "--render-fps", "60") as daemon:
            host, port = daemon.http.removeprefix("http://").rstrip("/").rsplit(":", 1)

            def view(robot, form="mjpg"):
                viewer = Connection((host, int(port)))
                daemon.connections.append(viewer)
                viewer.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
                viewer.write(f"GET /camera.{form}?robot={robot} HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n")
                return viewer

            def read(viewer, count):
                for _ in range(count):
                    while b"Content-Length: " not in viewer.buffer:
                        viewer._more()
                    viewer.buffer = viewer.buffer.split(b"Content-Length: ", 1)[1]

            good = [view("robot1"), view("robot2")]
            for viewer in good:
                read(viewer, 2)
            before, pose = memory_bytes(daemon), daemon.text("/robot1/pose")
            first = pose.must("get_time").step
            deaf = [view("robot1") for _ in range(8)]
            for viewer in deaf:
                viewer.read_line()  # it has begun
            for _ in range(4 if SANITIZED else 40):
                for viewer in good:
                    read(viewer, 1)
            self.assertEqual(Camera(daemon, "robot1").picture(JPEG).pixels[:2], b"\xff\xd8")
            self.assertGreater(pose.must("get_time").step, first)
            self.assertLess(memory_bytes(daemon) - before, self.MORE_BYTES)


if __name__ == "__main__":
    unittest.main()
