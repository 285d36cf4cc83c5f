# SPDX-License-Identifier: MIT
"""Clients of YARS, byte by byte: its UDP protocol of 2008, and the TCP protocol of the public YARS."""
import socket
import struct

from harness import LIMIT_S, Connection


def ints(*numbers):
    return struct.pack(f"<{len(numbers)}i", *numbers)


class Udp:
    """A client of a robot's UDP port: one datagram per request and reply."""

    def __init__(self, port, robot=0, host="127.0.0.1"):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((host, 0))
        self.socket.settimeout(LIMIT_S)
        self.server = (host, port)
        self.robot = robot
        self.socket.sendto(b"\0", self.server)

    def send(self, datagram):
        self.socket.sendto(datagram, self.server)

    def receive(self):
        return self.socket.recv(4096)

    def ask(self, *numbers):
        self.send(ints(*numbers))
        return self.receive()

    def handshake(self):
        """The basic handshake: returns the tags."""
        reply = self.ask(10, -1)
        tags = struct.unpack(f"<{len(reply) // 4}i", reply)
        assert tags[0] == 11 and tags[-1] == -1, tags
        return list(tags[1:-1])

    def extended_handshake(self):
        """[(tag, name, min, max)] of motors and sensors."""
        found = []
        reply = self.ask(12, 82, -1)
        assert struct.unpack("<2i", reply[:8]) == (13, 83), reply
        at = 8
        while True:
            tag, = struct.unpack("<i", reply[at:at + 4])
            at += 4
            if tag == -1:
                return found
            if tag in (300, 400, 500):
                low, high = struct.unpack("<2f", reply[at:at + 8])
                reply = self.ask(12, -1)
                _, size = struct.unpack("<2i", reply[:8])
                found.append((tag, reply[8:8 + size].decode(), low, high))
                reply = self.ask(12, -1)
                at = 4

    def step_request(self, motors, number=None):
        end = ints(-1) if number is None else ints(-1, number)
        return ints(40, self.robot, len(motors)) + struct.pack(f"<{len(motors)}f", *motors) + end

    def step(self, motors, number=None):
        """State and values."""
        self.send(self.step_request(motors, number))
        return self.values(self.receive())

    @staticmethod
    def values(reply):
        answer, _, state, count = struct.unpack("<4i", reply[:16])
        assert answer == 41, reply
        return state, list(struct.unpack(f"<{count}f", reply[16:16 + 4 * count]))

    def load(self, text, source=1):
        """Loads a new simulation: True on success."""
        raw = text.encode()
        each = 1004
        assert self.ask(93, -1) == ints(94, -1)
        assert self.ask(90, 1, len(raw), each, source, 7, -1, 0, -1) == ints(91, -1)
        for i in range(0, len(raw), each):
            self.send(ints(90, 1, i // each) + raw[i:i + each] + ints(-1))
            if i // each and i // each % 80 == 0:
                assert self.receive() == ints(91, -1)
        return self.receive() == ints(91, -1)

    def close(self):
        self.socket.close()


class Tcp(Connection):
    """A client of the controller TCPIP."""

    def __init__(self, port, host="127.0.0.1"):
        super().__init__((host, port))

    def say(self, text):
        raw = text.encode()
        self.write(b"s" + struct.pack("<i", len(raw)) + raw)

    def read_text(self):
        assert self.read_exactly(1) == b"s"
        size, = struct.unpack("<i", self.read_exactly(4))
        return self.read_exactly(size).decode()

    def configuration(self):
        self.say("CONFIGURATION")
        lines = [self.read_text()]
        while lines[-1] != "END CONFIGURATION":
            lines.append(self.read_text())
        return lines

    def sensors(self):
        self.say("SENSORS")
        assert self.read_exactly(1) == b"D"
        count, = struct.unpack("<i", self.read_exactly(4))
        return list(struct.unpack(f"<{count}d", self.read_exactly(8 * count)))

    def actuators(self, values):
        self.say("ACTUATORS")
        self.write(b"D" + struct.pack(f"<i{len(values)}d", len(values), *values))

    def reset(self, seed=None):
        if seed is not None:
            self.say("RANDOM SEED")
            self.write(b"i" + struct.pack("<i", seed))
        self.say("RESET")
