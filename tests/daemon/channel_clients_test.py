# SPDX-License-Identifier: MIT
"""The needs of YARS clients of 2008 and later: the daemon waits for them, answers all requests, and sends only what they know."""
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from channel_test import STILL
from harness import BINARY, LIMIT_S, Daemon, until, with_own_ports
from yars_clients import Tcp, Udp, ints

# A ball that falls, and its height.
BALL = """<rosiml version="1.0">
  <simulator frequency="100" controllerFrequency="10" mode="lockstep"/>
  <environment><ground width="10" depth="10"/></environment>
  <movables>
    <movable name="ball" type="active">
      <body><object name="ball" mass="1">
        <pose z="5"/><sphere radius="0.1"/>
        <position name="place" x="false" y="false" auxiliary="false"/>
      </object></body>
    </movable>
  </movables>
</rosiml>
"""

# A rotor without a motor turns on a post; a wheel with a motor on it pushes the rotor in the opposite direction.
ROTOR = """<rosiml version="1.0">
  <simulator frequency="200" controllerFrequency="20" mode="lockstep"/>
  <environment><ground width="10" depth="10"/></environment>
  <movables>
    <movable name="rotor" type="active">
      <body>
        <object name="post" mass="1"><pose z="1"/><box width="0.1" depth="0.1" height="0.1"/></object>
        <object name="rotor" mass="1"><pose z="1.2"/><box width="0.2" depth="0.2" height="0.1"/></object>
        <object name="wheel" mass="1"><pose z="1.4"/><box width="0.2" depth="0.2" height="0.1"/></object>
        <connector name="stand" type="fixed" source="post"/>
        <connector name="loose" type="hinge" source="post" destination="rotor">
          <pose beta="-90"/><read what="position"><domain min="-3600" max="3600"/></read>
        </connector>
        <connector name="motor" type="hinge" source="rotor" destination="wheel">
          <pose beta="-90"/>
          <drive type="velocity" maxForce="5" maxVelocity="10"/>
          <read what="position"><domain min="-3600" max="3600"/></read>
        </connector>
      </body>
    </movable>
  </movables>
</rosiml>
"""


class ChannelClientsTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.file = self.folder / "experiment.xml"

    def serve(self, text, robot, *options):
        self.file.write_text(text)
        self.daemon = self.enterContext(Daemon(None, "--no-render", *options, name=str(self.file)))
        self.port = self.daemon.module_port(f"/{robot}/channel")
        return self.daemon

    def udp(self):
        client = Udp(self.port)
        self.addCleanup(client.close)
        return client

    def test_a_movable_without_motors_is_waited_for(self):
        self.serve(BALL, "ball")
        self.assertEqual(self.daemon.awaited(), ["ball"])
        client = self.udp()
        heights = [client.step([])[1][0] for _ in range(4)]
        for i, height in enumerate(heights):
            t = 0.1 * (i + 1)
            self.assertAlmostEqual(height, 5 - 9.81 * t * t / 2, delta=1e-3)
        self.assertEqual(self.daemon.awaited(), ["ball"])

    def test_the_last_step_of_a_run_is_answered_and_an_init_begins_the_next(self):
        ends = (("score", BALL.replace("</rosiml>", '<score name="low" kind="time" until="&gt;= 0.35"/></rosiml>'), 4),
                ("limit", BALL.replace("</rosiml>", '<score name="low" kind="time" limit="0.55"/></rosiml>'), 6),
                ("duration", BALL.replace('mode=', 'duration="0.3" mode='), 3))
        for name, text, exchanges in ends:
            with self.subTest(name):
                self.serve(text, "ball")
                client = self.udp()
                client.handshake()
                for seed in range(3):
                    states = [client.step([])[0] for _ in range(exchanges + 2)]
                    self.assertEqual(states, [0] * (exchanges - 1) + [1] * 3)
                    self.assertEqual(client.ask(60, 0, seed, -1), ints(61, 0, -1))

    @with_own_ports
    def test_whoever_was_answered_a_ping_may_begin(self):
        for _ in range(12):
            self.file.write_text(STILL)
            process = subprocess.Popen([BINARY, "serve", str(self.file), "--no-render", "--no-http"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            try:
                client = Udp(4500)
                client.socket.settimeout(0.002)
                while True:
                    try:
                        if client.ask(0, -1) == ints(1, -1):
                            break
                    except (TimeoutError, ConnectionError):
                        continue
                client.socket.settimeout(LIMIT_S)
                client.send(ints(60, 0, 7, -1))
                answer = client.receive()
                while answer == ints(1, -1):  # to a ping before
                    answer = client.receive()
                self.assertEqual(answer, ints(61, 0, -1))
                client.close()
            finally:
                process.terminate()
                process.wait(LIMIT_S)

    def test_a_client_that_writes_in_pieces_waits_for_no_acknowledgement(self):
        self.serve(STILL, "vehicle")
        client = Tcp(self.port)
        self.addCleanup(client.close)

        class Pieces:
            """Writes as YARS's Java client does: letter, length and content."""

            def __init__(self, socket):
                self.socket = socket

            def sendall(self, data):
                for piece in (data[:1], data[1:5], data[5:]):
                    self.socket.sendall(piece)

            def __getattr__(self, name):
                return getattr(self.socket, name)

        def exchanges(count):
            begin = time.monotonic()
            for _ in range(count):
                client.actuators([0, 0, 0])
                client.sensors()
            return (time.monotonic() - begin) / count

        whole = min(exchanges(20) for _ in range(3))
        client.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 0)
        client.socket = Pieces(client.socket)
        pieces = min(exchanges(20) for _ in range(3))
        # A delayed acknowledgement costs 40 ms, a hundred times as long as an exchange.
        self.assertLess(pieces, 20 * whole)

    def test_a_hinge_without_a_motor_counts_its_turns(self):
        self.serve(ROTOR, "rotor")
        client = self.udp()
        self.assertEqual([(told[1], round(told[2])) for told in client.extended_handshake() if told[0] == 400],
                         [("loose_position", -63), ("motor_position", -63)])
        for speed in (10, -10):
            for _ in range(60):
                _, (loose, motor) = client.step([speed])
                self.assertAlmostEqual(loose, -motor / 2, delta=0.1)
            if speed > 0:
                self.assertGreater(motor, 25)
        client.ask(60, 0, 1, -1)
        self.assertAlmostEqual(client.step([0])[1][0], 0, delta=1e-6)

    def test_resets_do_not_read_a_file_that_nobody_writes(self):
        size = 2 << 20
        self.serve(STILL.replace("<environment>", f"<!--{' ' * size}--><environment>"), "vehicle")
        client = self.udp()

        def read_by_reset():
            def count():
                text = Path(f"/proc/{self.daemon.process.pid}/io").read_text()
                return int(text.split("rchar:")[1].split()[0])

            before = count()
            for _ in range(3):
                self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
            return count() - before

        until(lambda: read_by_reset() < size)  # once its age exceeds the resolution of file times
        self.assertLess(read_by_reset(), size)
        self.file.write_text(STILL.replace("<mapping min=\"1\" max=\"0\"/>", "<mapping min=\"3\" max=\"0\"/>"))
        self.assertEqual(client.ask(50, 0, -1), ints(51, 0, -1))
        self.assertIn((400, "ahead", 3, 0), client.extended_handshake())


if __name__ == "__main__":
    unittest.main()
