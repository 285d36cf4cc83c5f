"""A module that does nothing but read its sensor is served as the others are: the compass of a minibot."""
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


if __name__ == "__main__":
    unittest.main()
