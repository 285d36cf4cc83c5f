# SPDX-License-Identifier: MIT
"""The file of an experiment is edited while YARS clients drive its robots: the next reset loads it."""
import contextlib
import itertools
import socket
import tempfile
import threading
import unittest
from pathlib import Path

from channel_test import STILL
from filters_test import EXPERIMENT as ARM
from harness import LIMIT_S, Daemon, until, with_own_ports
from yars_clients import Tcp, Udp, ints


def with_ball(text, name, x=3, more=""):
    """The experiment with another robot: a ball turned by a motor."""
    return text.replace("</movables>", f"""<movable name="{name}" type="active"><body>
        <object name="ball" mass="1"><pose x="{x}" y="2" z="0.1"/><sphere radius="0.1"/>{more}</object>
        <connector name="spin" type="hinge" source="ball"><drive type="velocity" maxForce="1" maxVelocity="1"/></connector>
    </body></movable></movables>""")


class ChannelReloadTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.file = self.folder / "vehicle.xml"

    def serve(self, text=STILL, *options):
        self.file.write_text(text)
        self.daemon = self.enterContext(
            Daemon(None, "--no-render", "--channel-ports-to", str(self.folder / "port"), *options, name=str(self.file)))
        return self.daemon

    def port(self, robot):
        return int((self.folder / f"port-{robot}").read_text())

    def udp(self, robot):
        client = Udp(self.port(robot))
        self.addCleanup(client.close)
        return client

    def test_a_renamed_robot_keeps_port_and_client(self):
        self.serve()
        client = self.udp("vehicle")
        client.handshake()
        client.step([0, 0, 0])
        before = self.port("vehicle")
        self.file.write_text(STILL.replace('movable name="vehicle"', 'movable name="car"'))
        self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
        self.assertEqual(self.port("car"), before)
        self.assertFalse((self.folder / "port-vehicle").exists())
        client.handshake()
        client.step([0, 0, 0])
        self.file.write_text(STILL)
        self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
        self.assertEqual(self.port("vehicle"), before)

    def test_two_renamed_robots_keep_their_ports_in_their_order(self):
        self.serve(with_ball(STILL, "ball"))
        ports = [self.port("vehicle"), self.port("ball")]
        client = self.udp("vehicle")
        client.handshake()
        self.file.write_text(with_ball(STILL, "b").replace('movable name="vehicle"', 'movable name="a"'))
        self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
        self.assertEqual([self.port("a"), self.port("b")], ports)

    @with_own_ports
    def test_a_changed_robot_keeps_its_port_when_the_one_before_it_goes(self):
        for options in ((), ("--channel-port", "14700")):
            with self.subTest(options):
                both = with_ball(with_ball(STILL, "ball"), "other", 4)
                self.serve(both, *options)
                client = self.udp("other")
                client.handshake()
                before = self.port("other")
                self.file.write_text(with_ball(STILL, "other", 4, '<contact name="hit"/>'))
                self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
                self.assertEqual(self.port("other"), before)
                self.assertEqual(client.handshake().count(400), 1)

    def test_the_client_of_a_robot_that_is_gone_is_told(self):
        self.serve(with_ball(STILL, "ball"))
        client = self.udp("ball")
        client.handshake()
        self.file.write_text(STILL)
        reply = client.ask(50, 0, -1)
        self.assertEqual(reply[:4], ints(99))
        self.assertIn(b"robot has been removed", reply)
        until(lambda: "robot has been removed" in self.daemon.stderr())

    def tcp(self, robot):
        client = Tcp(self.port(robot))
        self.addCleanup(client.close)
        return client

    def test_a_tcp_client_stays_while_its_robot_is_edited(self):
        self.serve()
        client = self.tcp("vehicle")
        crate_near = STILL.replace('x="1" y="0"', 'x="0.7" y="0"')
        short = STILL.replace('range="2"', 'range="0.5"')
        values = len(client.sensors())
        for text in (crate_near, short, STILL, STILL.replace('movable name="vehicle"', 'movable name="car"')):
            self.file.write_text(text)
            client.reset()
            self.assertEqual(len(client.sensors()), values)
            client.actuators([0, 0, 0])
            client.sensors()
        self.assertIn("NAME car", client.configuration())

    def test_what_is_said_after_a_reset_goes_to_the_edited_robot(self):
        self.serve()
        client = self.tcp("vehicle")
        client.actuators([0, 0, 0])
        client.actuators([0, 0, 0])
        client.sensors()
        steps = self.daemon.status()["step"]
        for reach in ("0.5", "2") * 10:
            self.file.write_text(STILL.replace('range="2"', f'range="{reach}"'))
            client.reset(7)
            client.actuators([0, 0, 0])
            client.actuators([0, 0, 0])
            client.sensors()
            self.assertEqual(self.daemon.status()["step"], steps)

    def test_a_client_can_connect_while_robots_are_edited(self):
        self.serve()
        client = self.tcp("vehicle")
        for reach in ("0.5", "2") * 20:
            self.file.write_text(STILL.replace('range="2"', f'range="{reach}"'))
            client.reset()
            for _ in range(5):
                with contextlib.closing(Tcp(self.port("vehicle"))) as other:
                    self.assertTrue(other.sensors())

    def test_the_log_says_why_an_edit_ends_the_connections_of_a_robot(self):
        self.serve()
        client = self.tcp("vehicle")
        client.sensors()
        self.file.write_text(STILL.replace('type="active"', 'type="passive"'))
        client.reset()
        self.assertEqual(client.read_to_end(), b"")
        until(lambda: "vehicle has been edited: connections to port" in self.daemon.stderr())

    def test_a_client_brings_back_its_robot_that_an_edit_has_taken(self):
        passive = STILL.replace('type="active"', 'type="passive"')
        for others in (lambda text: text, lambda text: with_ball(text, "ball")):
            with self.subTest():
                self.serve(others(STILL))
                client = self.udp("vehicle")
                client.step([0, 0, 0]) if others(STILL) == STILL else client.handshake()
                self.file.write_text(others(passive))
                for _ in range(2):
                    for request in (ints(50, 0, -1), ints(0, -1), client.step_request([1, 1, 0]), ints(20, 0, -1)):
                        client.send(request)
                        reply = client.receive()
                        self.assertEqual(reply[:4], ints(99))
                        self.assertIn(b"robot has been removed", reply)
                self.file.write_text(others(STILL))
                self.assertEqual(client.ask(60, 0, 9, -1), ints(61, 0, -1))
                self.assertEqual(client.handshake().count(300), 3)
                self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))

    def test_a_step_that_anothers_reload_ends_is_answered(self):
        self.serve(with_ball(STILL, "ball"))
        vehicle, ball = self.udp("vehicle"), self.udp("ball")
        vehicle.handshake()
        ball.handshake()
        vehicle.send(vehicle.step_request([0, 0, 0]))  # waits for the ball's client
        until(lambda: self.daemon.awaited() == ["ball"])
        self.file.write_text(with_ball(STILL.replace('mass="0.1"', 'mass="0.2"'), "ball"))
        self.assertEqual(ball.ask(50, 0, -1), ints(51, 0, -1))
        self.assertEqual(vehicle.values(vehicle.receive())[0], 0)
        self.assertEqual(vehicle.handshake().count(300), 3)


    def test_no_request_of_another_robot_is_lost_or_refused_while_both_are_edited(self):
        def both(size):
            return with_ball(STILL.replace('range="2"', f'range="{size}"'), "ball").replace('"ball" mass="1"', f'"ball" mass="{size}"')
        for mode in ("free", "lockstep"):
            with self.subTest(mode):
                self.serve(both(2), "--mode", mode)
                vehicle, ball = self.tcp("vehicle"), self.udp("ball")
                ball.handshake()
                done = threading.Event()

                def edit_and_drive():
                    with contextlib.suppress(OSError, EOFError):  # closed
                        for k in itertools.count():
                            if done.is_set():
                                break
                            self.file.write_text(both(1 + k % 2))
                            vehicle.reset()
                            for _ in range(3):
                                vehicle.actuators([0, 0, 0])
                                vehicle.sensors()

                other = threading.Thread(target=edit_and_drive)
                other.start()
                answers = []
                for _ in range(40):
                    ball.send(ball.step_request([0]))
                    answers.append(ball.receive()[:4])
                done.set()
                vehicle.socket.shutdown(socket.SHUT_RDWR)
                other.join(LIMIT_S)
                self.assertEqual(set(answers), {ints(41)})

    @with_own_ports
    def test_a_robot_has_the_port_that_its_file_names_or_the_next_free_one(self):
        named = 14800
        text = ARM.replace('module="TCPIP" frequency="100"/>',
                           f'module="TCPIP" frequency="100"><parameter name="port" value="{named}"/></controller>')
        self.serve(text)
        self.assertEqual(self.port("arm"), named)
        self.serve(text)
        self.assertEqual(self.port("arm"), named + 1)
        self.serve(text, "--channel-port", "0")
        self.assertNotEqual(self.port("arm"), named)

    def test_a_datagram_behind_a_reset_is_taken_up_after_it(self):
        self.serve()
        client = self.udp("vehicle")
        client.handshake()
        for reach in ("0.5", "1", "2"):
            self.file.write_text(STILL.replace('range="2"', f'range="{reach}"'))
            client.send(ints(50, 0, -1))
            client.send(ints(20, 0, -1))
            self.assertEqual(client.receive(), ints(51, 0, -1))
            self.assertEqual(client.receive()[:4], ints(21))

    def test_what_was_sent_before_the_end_of_the_input_is_answered(self):
        self.serve()
        client = self.tcp("vehicle")
        client.sensors()
        self.file.write_text(STILL.replace('range="2"', 'range="1"'))
        client.reset()
        client.say("SENSORS")
        client.socket.shutdown(socket.SHUT_WR)
        self.assertEqual(client.read_to_end()[:1], b"D")

    def test_a_robot_that_has_lost_its_channel_has_no_file_of_its_port(self):
        self.serve()
        client = self.udp("vehicle")
        self.file.write_text(STILL.replace('type="active"', 'type="passive"'))
        client.ask(50, 0, -1)
        until(lambda: not (self.folder / "port-vehicle").exists())


if __name__ == "__main__":
    unittest.main()
