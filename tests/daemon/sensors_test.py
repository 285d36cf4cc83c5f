"""A module that only reads a sensor is served like any other: the compass of a minibot."""
import unittest

from harness import Daemon, scenario

MINIBOT = scenario(1, robot_extra={1: "orientation 90deg"}).replace("type coopbot", "type minibot")


class SensorsTest(unittest.TestCase):
    def test_compass_in_text_binary_attached_and_pushed(self):
        with Daemon(MINIBOT) as daemon:
            compass, motors = daemon.text("/robot1/compass"), daemon.text("/robot1/motors", direct=True)
            heading = daemon.text("/robot1/pose").must("get_pose").data[2]
            self.assertAlmostEqual(heading, 1.5708, places=3)
            self.assertEqual(compass.must("get_compass").data, [heading, 0, 0])
            self.assertEqual(daemon.binary("/robot1/compass").ask(300).data, [heading, 0, 0])

            self.assertEqual(motors.must("attach compass pose").error, 0)
            compass.must("subscribe")
            reply = motors.must("set_velocity 0 1")
            self.assertEqual(reply.params, [1, 1, 5])
            self.assertEqual(reply.data[0], reply.data[3])
            push = compass.receive()
            self.assertEqual((push.command, push.data), (-300, [reply.data[0], 0.01, 1]))

    def test_help_describe_and_verbose_name_it(self):
        with Daemon(MINIBOT) as daemon:
            compass = daemon.text("/robot1/compass")
            self.assertIn('"get_compass"', compass.must("describe").text)
            compass.send("help")
            said = [compass.read_line()]
            while not said[-1].startswith("#   get_compass"):
                said.append(compass.read_line())
            compass.must("ping")
            compass.send("verbose")
            compass.send("get_compass")
            said = compass.read_line()
            while "heading" not in said:
                said = compass.read_line()
            self.assertIn("rad", said)

    def test_support_tells_how_a_load_has_moved_it_in_text_binary_attached_and_pushed(self):
        with Daemon("[SIMULATION]\nmode lockstep\n[ROBOT]\ntype transporter\nname robot1\nposition 0 0\n") as daemon:
            support, motors = daemon.text("/robot1/support"), daemon.text("/robot1/motors", direct=True)
            first = support.must("get_support").data
            self.assertEqual(first[3:], [0, 0])
            for value, noise in zip(first[:3], (0.0005, 0.0005, 0.0035)):
                self.assertLess(abs(value), 6 * noise)
                self.assertNotEqual(value, 0)
            self.assertEqual(daemon.binary("/robot1/support").ask(280).data, first)
            motors.must("attach support pose")
            support.must("subscribe")
            for _ in range(5):  # the robot starts off: the empty cradle lags behind
                reply = motors.must("set_velocity 1 0")
                push = support.receive()
                self.assertEqual(push.command, -280)
                self.assertEqual(push.data[:3], reply.data[:3])
            self.assertEqual(reply.params, [1, 3, 5])
            self.assertLess(reply.data[0], 0)

    def test_swarm_has_a_column_for_it(self):
        text = "[SIMULATION]\nmode lockstep\n" + "".join(
            f"[ROBOT_{i}]\ntype {kind}\nposition 0 {i}\n" for i, kind in ((1, "transporter"), (2, "coopbot")))
        with Daemon(text) as daemon:
            swarm = daemon.text("/swarm")
            self.assertEqual(swarm.must("select_readings support").params, [3])
            rows = swarm.must("read_all (1 2)").data
            self.assertEqual(rows[:3], daemon.text("/robot1/support").must("get_support").data[:3])
            self.assertTrue(all(value != value for value in rows[3:6]))

    def test_pictures_are_not_pushed_and_the_reply_says_what_to_do_instead(self):
        with Daemon("[SIMULATION]\nmode lockstep\n[ROBOT]\ntype turtle\nname robot1\nposition 0 0\n") as daemon:
            camera = daemon.text("/robot1/camera")
            instead = "get_image is not pushed; ask for each picture with get_image, or read /camera.mjpg by HTTP"
            for line in ("subscribe 1 get_image", "subscribe get_image"):
                camera.send(line)
                refused = camera.receive()
                self.assertEqual((refused.error, refused.command), (2, 4))
                self.assertIn(instead, refused.text)
            refused = daemon.binary("/robot1/camera").ask(4, (1, 270))
            self.assertEqual(refused.error, 4)
            self.assertIn(instead, refused.text)
            self.assertEqual(camera.must("get_image jpeg").params[:2], [320, 240])
            camera.must("subscribe 1 get_camera")
            daemon.text("/robot1/motors", direct=True).must("ready")
            self.assertEqual(camera.receive().command, -271)


if __name__ == "__main__":
    unittest.main()
