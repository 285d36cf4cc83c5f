# SPDX-License-Identifier: MIT
"""Clients of YARS drive robots by its UDP and TCP protocols, in mapped values, in lockstep."""
import math
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon, until, with_own_ports
from yars_clients import Tcp, Udp, ints

# A vehicle of two wheels with a swinging tail, and a crate that stands elsewhere with each seed.
EXPERIMENT = """<rosiml version="1.0">
  <simulator frequency="100" controllerFrequency="20" mode="lockstep" seed="5"/>
  <environment>
    <ground width="10" depth="10"/>
    <box name="crate" width="0.4" depth="0.4" height="0.4"><pose x="1" y="0" z="0.2"/>%s</box>
  </environment>
  <movables>
    <movable name="vehicle" type="active">
      <body>
        <object name="base" mass="1.2" friction="0">
          <pose z="0.06"/>
          <cylinder radius="0.1" height="0.08"/>
          <sphere radius="0.01"><pose x="-0.08" z="-0.05"/></sphere>
          <sphere radius="0.01"><pose x="0.08" z="-0.05"/></sphere>
          <proximity name="ahead" range="2"><pose x="0.11"/><mapping min="1" max="0"/></proximity>
          <position name="place" z="false"/>
        </object>
        <object name="nose" mass="0.01">
          <pose x="0.105" z="0.06"/><box width="0.01" depth="0.1" height="0.02"/>
          <contact name="bumper" abort="true"/>
        </object>
        <connector name="holder" type="fixed" source="base" destination="nose"/>
        <object name="left wheel" mass="0.05" friction="1">
          <pose y="0.09" z="0.03"/><cylinder radius="0.03" height="0.01"><pose alpha="-90"/></cylinder>
        </object>
        <object name="right wheel" mass="0.05" friction="1">
          <pose y="-0.09" z="0.03"/><cylinder radius="0.03" height="0.01"><pose alpha="-90"/></cylinder>
        </object>
        <object name="tail" mass="0.1"><pose x="-0.25" z="0.08"/><box width="0.2" depth="0.02" height="0.02"/></object>
        <connector name="left motor" type="hinge" source="base" destination="left wheel">
          <pose y="0.09" z="-0.03" gamma="90"/>
          <drive type="velocity" maxForce="0.2" maxVelocity="10"><mapping min="-1" max="1"/></drive>
          <read what="velocity"><mapping min="-1" max="1"/></read>
        </connector>
        <connector name="right motor" type="hinge" source="base" destination="right wheel">
          <pose y="-0.09" z="-0.03" gamma="90"/>
          <drive type="velocity" maxForce="0.2" maxVelocity="10"><mapping min="-1" max="1"/></drive>
        </connector>
        <connector name="wag" type="hinge" source="base" destination="tail">
          <pose x="-0.1" z="0.02" beta="-90"/>
          <limit min="-60" max="60"/>
          <drive type="position" maxForce="2" maxVelocity="6"><mapping min="-1" max="1"/></drive>
          <read what="position"><mapping min="-1" max="1"/></read>
        </connector>
      </body>
    </movable>
  </movables>
</rosiml>
"""
STILL = EXPERIMENT % ""
DRAWN = EXPERIMENT % '<randomise x="0.7 1.8"/>'
# The values of a client, in the order of the handshake.
AHEAD, BUMPER, LEFT, WAG, X, Y = range(6)


class ChannelTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.file = self.folder / "vehicle.xml"
        self.file.write_text(STILL)

    def serve(self, text=STILL, *options):
        self.file.write_text(text)
        self.daemon = self.enterContext(Daemon(None, "--no-render", *options, name=str(self.file)))
        self.port = self.daemon.module_port("/vehicle/channel")
        return self.daemon

    def udp(self):
        client = Udp(self.port)
        self.addCleanup(client.close)
        return client

    def tcp(self):
        client = Tcp(self.port)
        self.addCleanup(client.close)
        return client

    def steps_run(self):
        return self.daemon.text("/simulation").must("get_time").step

    # --- UDP

    def test_the_handshake_tells_the_morphology(self):
        self.serve()
        tags = self.udp().handshake()
        self.assertEqual(tags[:2], [0, 100])
        self.assertEqual((tags.count(200), tags.count(300), tags.count(400), tags.count(500)), (4, 3, 4, 0))

    def test_the_extended_handshake_tells_names_and_mappings(self):
        self.serve()
        told = self.udp().extended_handshake()
        self.assertEqual([one for one in told if one[0] == 300],
                         [(300, "left_motor", -1, 1), (300, "right_motor", -1, 1), (300, "wag", -1, 1)])
        self.assertEqual([one[1] for one in told if one[0] == 400],
                         ["ahead", "bumper", "left_motor_velocity", "wag_position"])
        self.assertEqual([one[1] for one in told if one[0] == 500], ["place", "place"])
        self.assertIn((400, "ahead", 1, 0), told)

    def test_a_step_lasts_a_period_of_the_controller(self):
        self.serve()
        client = self.udp()
        client.handshake()
        before = self.steps_run()
        for _ in range(10):
            state, _ = client.step([0, 0, 0])
            self.assertEqual(state, 0)
        self.assertEqual(self.steps_run() - before, 50)

    def test_values_are_mapped(self):
        self.serve()
        client = self.udp()
        for _ in range(20):
            _, values = client.step([0.2, 0.2, 0.5])
        self.assertAlmostEqual(values[LEFT], 0.2, delta=0.01)
        self.assertAlmostEqual(values[WAG], 0.5, delta=0.02)
        # 2 rad/s of wheels of 3 cm for 1 s; the crate's front is at 0.8 m, and the range, 2 m, is mapped to 1 … 0.
        self.assertAlmostEqual(values[X], 0.06, delta=0.01)
        self.assertAlmostEqual(values[AHEAD], 1 - (0.8 - 0.11 - values[X]) / 2, delta=0.01)

    def test_a_bumper_aborts_the_try(self):
        self.serve()
        client = self.udp()
        for _ in range(300):
            state, values = client.step([1, 1, 0])
            if state:
                break
        self.assertEqual(state, 1)
        self.assertEqual(values[BUMPER], 1)

    def test_reset_and_seed_through_the_channel(self):
        self.serve(DRAWN)
        client = self.udp()
        first = client.step([0, 0, 0])
        self.assertEqual(client.ask(60, 0, 9, -1), ints(61, 0, -1))
        other = client.step([0, 0, 0])
        self.assertEqual(client.ask(70, 0, 5, -1), ints(71, 0, -1))
        self.assertEqual(client.step([0, 0, 0]), first)
        self.assertNotEqual(other, first)
        client.step([1, 1, 0])
        self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
        self.assertEqual(client.step([0, 0, 0]), first)

    def test_a_repeated_numbered_step_runs_once(self):
        self.serve()
        client = self.udp()
        client.step([1, 1, 0], number=1)
        before = self.steps_run()
        answers = []
        for _ in range(3):
            client.send(client.step_request([1, 1, 0], number=2))
            answers.append(client.receive())
        self.assertEqual(len(set(answers)), 1)
        self.assertEqual(self.steps_run() - before, 5)

    def test_a_second_client_is_told_that_the_robot_is_driven(self):
        self.serve()
        first, second = self.udp(), self.udp()
        first.step([0, 0, 0])
        reply = second.ask(10, -1)
        self.assertEqual(reply[:4], ints(99))
        self.assertIn(b"is driven by 127.0.0.1", reply)
        first.step([0, 0, 0])

    def test_an_experiment_over_the_channel(self):
        self.serve()
        client = self.udp()
        client.step([0, 0, 0])
        self.assertTrue(client.load(STILL.replace('x="1" y="0"', 'x="0.7" y="0"')))
        client.handshake()
        _, values = client.step([0, 0, 0])
        self.assertAlmostEqual(values[AHEAD], 1 - 0.39 / 2, delta=0.01)

    def test_another_robot_over_the_channel_keeps_port_and_client(self):
        self.serve()
        client = self.udp()
        client.step([0, 0, 0])
        # Without its tail, and with more than 80 datagrams of text.
        head, rest = STILL.split('<connector name="wag"')
        smaller = head + rest.split("</connector>", 1)[1]
        self.assertTrue(client.load(smaller + " " * 100_000))
        self.assertEqual(client.handshake().count(300), 2)
        client.step([0, 0])

    def test_an_experiment_with_mistakes_is_refused_and_changes_nothing(self):
        self.serve()
        client = self.udp()
        client.step([0, 0, 0])
        self.assertFalse(client.load(STILL.replace("<movables>", "<movable>")))
        client.step([0, 0, 0])

    def test_an_edited_file_is_read_at_the_next_reset(self):
        self.serve()
        client = self.udp()
        _, before = client.step([0, 0, 0])
        self.file.write_text(STILL.replace('x="1" y="0"', 'x="0.7" y="0"'))
        self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
        _, after = client.step([0, 0, 0])
        self.assertAlmostEqual(after[AHEAD] - before[AHEAD], 0.3 / 2, delta=0.01)

    def test_nonsense_is_answered_in_words_and_harms_nobody(self):
        self.serve()
        client = self.udp()
        for nonsense in (b"\xff" * 3, b"\xff" * 2000, ints(40, 0, 3), ints(90, 1, -5, -1), ints(12345, -1)):
            client.send(nonsense)
            self.assertEqual(client.receive()[:4], ints(99))
        client.step([0, 0, 0])

    def test_another_robots_number_is_refused(self):
        self.serve()
        client = self.udp()
        before = self.steps_run()
        client.robot = 1
        for request in (client.step_request([0, 0, 0]), ints(20, 1, -1), ints(50, 1, -1)):
            client.send(request)
            self.assertIn(b"the robot of this port is number 0", client.receive())
        self.assertEqual(self.steps_run(), before)

    # --- TCP

    def test_the_configuration_over_tcp(self):
        self.serve()
        lines = self.tcp().configuration()
        self.assertEqual(lines[:2], ["BEGIN CONFIGURATION", "BEGIN DATA TYPES"])
        self.assertIn("NAME vehicle", lines)
        at = lines.index("NAME ahead")
        self.assertEqual(lines[at - 1:at + 5],
                         ["BEGIN SENSOR", "NAME ahead", "DIMENSION 1", "INTERNAL DOMAIN 0 2", "EXTERNAL DOMAIN 1 0",
                          "END SENSOR"])
        self.assertEqual(lines.count("BEGIN ACTUATOR"), 3)

    def test_steps_over_tcp(self):
        self.serve()
        client = self.tcp()
        before = self.steps_run()
        for _ in range(20):
            values = client.sensors()
            client.actuators([0.2, 0.2, 0.5])
        values = client.sensors()
        self.assertEqual(self.steps_run() - before, 100)
        self.assertIn(0.5, [round(value, 1) for value in values])

    def test_ranges_are_finite(self):
        self.serve()
        lines = self.tcp().configuration()
        at = lines.index("NAME bumper")
        self.assertEqual(lines[at + 2:at + 4], ["INTERNAL DOMAIN 0 1", "EXTERNAL DOMAIN 0 1"])
        at = lines.index("NAME place")
        self.assertEqual(lines[at + 2:at + 4], ["INTERNAL DOMAIN -100000 100000", "EXTERNAL DOMAIN -100000 100000"])

    def test_an_unknown_first_command_is_answered(self):
        self.serve()
        for word in ("HELLO", "x", "TEN LETTER", "S" * 300):
            client = self.tcp()
            client.say(word)
            self.assertIn(f"ERROR there is no command '{word[:40]}'", client.read_text())
            self.assertEqual(client.read_to_end(), b"")
        until(lambda: "there is no command 'HELLO'" in self.daemon.stderr())

    def test_wrong_actuators_are_told_in_the_log_and_the_client_goes_on(self):
        self.serve()
        for wrong in ([0], [0, 0, math.nan]):
            client = self.tcp()
            before = self.steps_run()
            client.actuators(wrong)
            client.actuators(wrong)
            self.assertEqual(len(client.sensors()), 6)
            self.assertEqual(self.steps_run(), before)
            client.actuators([0, 0, 0])
            client.sensors()
            self.assertEqual(self.steps_run(), before + 5)
            client.close()
        until(lambda: self.daemon.stderr().count("has not taken ACTUATORS") >= 2)  # the log is written a moment later
        said = self.daemon.stderr()
        self.assertEqual(said.count("has not taken ACTUATORS"), 2, said)
        self.assertIn("3 values, one for each motor, not 1", said)
        client = self.tcp()
        client.say("ACTUATORS")
        client.say("fast")
        self.assertIn("ERROR the command before is followed by D", client.read_text())

    def test_reset_with_a_seed_over_tcp(self):
        self.serve(DRAWN)
        client = self.tcp()
        first = client.sensors()
        client.reset(seed=9)
        other = client.sensors()
        client.reset(seed=5)
        self.assertEqual(client.sensors(), first)
        self.assertNotEqual(other, first)

    def test_nobody_resets_under_the_client_that_drives(self):
        self.serve()
        driver, second = self.udp(), self.tcp()
        driver.step([1, 1, 0])
        second.sensors()
        second.reset(seed=9)
        self.assertIn("ERROR vehicle is driven by 127.0.0.1", second.read_text())
        self.assertEqual(second.read_to_end(), b"")
        until(lambda: "closed: vehicle is driven by" in self.daemon.stderr())
        self.assertEqual(self.steps_run(), 5)
        self.assertEqual(driver.ask(50, 0, -1), ints(51, 0, -1))
        self.assertEqual(self.steps_run(), 0)

    def test_nobody_resets_by_udp_under_the_client_that_drives_by_tcp(self):
        self.serve()
        driver, second = self.tcp(), self.udp()
        driver.actuators([1, 1, 0])
        driver.sensors()
        self.assertIn(b"vehicle is driven by 127.0.0.1", second.ask(50, 0, -1))
        self.assertFalse(second.load(STILL))
        self.assertEqual(self.steps_run(), 5)
        driver.reset()
        driver.sensors()
        self.assertEqual(self.steps_run(), 0)

    def test_with_a_token_for_all_udp_clients_of_this_machine_drive_and_do_not_reset(self):
        self.serve(STILL, "--token-for-all")
        driver = self.udp()
        driver.step([1, 1, 0])
        self.assertIn(b"may drive its robot, not change the world", driver.ask(50, 0, -1))
        self.assertFalse(driver.load(STILL))
        self.assertEqual(self.steps_run(), 5)

    def test_with_a_token_for_all_tcp_clients_of_this_machine_drive_and_do_not_reset(self):
        self.serve(STILL, "--token-for-all")
        client = self.tcp()
        client.actuators([1, 1, 0])
        client.sensors()
        client.reset(seed=9)
        client.sensors()
        until(lambda: "may drive its robot, not change the world" in self.daemon.stderr())
        self.assertGreaterEqual(self.steps_run(), 5)

    def test_a_client_that_dies_in_the_middle_leaves_the_robot_to_the_next(self):
        self.serve()
        first = self.tcp()
        first.sensors()
        first.say("ACTUATORS")
        first.close()
        second = self.tcp()
        second.actuators([0, 0, 0])
        self.assertEqual(len(second.sensors()), 6)

    def test_our_own_protocol_on_the_same_port(self):
        self.serve()
        channel = self.daemon.text("/vehicle/channel")
        reply = channel.must("set_motors 0.2 0.2 0.5")
        self.assertEqual((reply.step, len(reply.data)), (5, 6 + 2))
        self.assertEqual(channel.must("get_channel").params, [3, 6, 5, 4])

    # --- coopdyn yars

    def test_the_options_of_yars(self):
        self.file.write_text(STILL)
        base = self.folder / "ports"
        process = subprocess.Popen([BINARY, "yars", "--xml", str(self.file), "--nogui", "--seed", "3", "--port", "0",
                                    "--printComPortsToFile", str(base)],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        opened = process.stdout.readline()
        port = int((self.folder / "ports-vehicle").read_text())
        self.assertEqual(opened, f"opened port {port} for vehicle\n")
        self.assertTrue(process.stdout.readline().startswith("ready "))
        client = Tcp(port)
        self.addCleanup(client.close)
        client.actuators([0, 0, 0])
        client.sensors()
        second, by_udp = Tcp(port), Udp(port)
        self.addCleanup(second.close)
        self.addCleanup(by_udp.close)
        self.assertIn(b"vehicle is driven by", by_udp.ask(100, -1))
        second.say("QUIT")
        self.assertIn("ERROR vehicle is driven by", second.read_text())
        client.sensors()
        client.say("QUIT")
        self.assertEqual(process.wait(LIMIT_S), 0)

    @with_own_ports
    def test_two_run_side_by_side(self):
        self.file.write_text(STILL)
        for _ in range(2):
            process = subprocess.Popen([BINARY, "yars", "--xml", str(self.file)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True)
            self.addCleanup(process.communicate)
            self.addCleanup(process.kill)
            self.assertTrue(process.stdout.readline().startswith("opened port "))

    def test_iterations_end_a_run_of_a_loaded_controller(self):
        code = subprocess.run([BINARY, "yars", "braitenberg", "--nogui", "--iterations", "50", "--port", "0"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=LIMIT_S)
        self.assertEqual(code.returncode, 0, code.stderr)
        self.assertIn("0.5", code.stderr)

    def test_iterations_of_an_experiment_from_a_pipe(self):
        with open(Path(__file__).resolve().parents[2] / "scenarios" / "braitenberg.xml") as text:
            code = subprocess.run([BINARY, "yars", "--xml", "-", "--nogui", "--iterations", "50", "--port", "0"], stdin=text,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=LIMIT_S)
        self.assertEqual(code.returncode, 0, code.stderr)
        self.assertIn("0.5", code.stderr)


if __name__ == "__main__":
    unittest.main()
