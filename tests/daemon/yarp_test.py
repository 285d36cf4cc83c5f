"""YARP programs on the ports of modules: their handshakes, Bottles and acknowledgements, beside other clients."""
import socket
import struct
import unittest

from harness import Daemon, scenario

HEADER = struct.Struct("<2si2s")
ACK = HEADER.pack(b"YA", 0, b"RP")
HELLO = HEADER.pack(b"YA", 7777 + 3 + 128, b"RP") + struct.pack("<i", 9) + b"anon_rpc\0"


def string(text):
    return struct.pack("<ii", 4, len(text)) + text.encode()


def real(value):
    return struct.pack("<id", 10, value)


def bottle(*items):
    return struct.pack("<ii", 256, len(items)) + b"".join(items)


def message(command, payload):
    return HEADER.pack(b"YA", 10, b"RP") + bytes([2, 1]) + b"\xff" * 8 + struct.pack("<iii", 8, len(payload), 0) + \
        b"\0\0\0\0~" + command + b"\0\1" + payload


DRIVE = bottle(string("set_velocity"), real(0.2), real(0.5))


class YarpTest(unittest.TestCase):
    def connect(self, daemon, module, hello=HELLO):
        connection = daemon.raw(module)
        connection.write(hello)
        answer = connection.read_exactly(8)
        self.assertEqual((answer[:2], answer[6:]), (b"YA", b"RP"))
        return connection

    def ask_text(self, connection, line):
        connection.write(f"d\r\n{line}\r\n")
        return connection.read_line()

    def text(self, daemon, module):
        connection = daemon.raw(module)
        connection.write("CONNECT me\r\n")
        self.assertEqual(connection.read_line(), "Welcome me")
        return connection

    def test_a_request_in_words_drives_the_robot_a_step_in_lockstep(self):
        with Daemon(scenario(1)) as daemon:
            self.assertEqual(self.ask_text(self.text(daemon, "/robot1/motors"), "set_velocity 0.2 0.5"), "[ok] 1 0.01 1.0")
            self.assertEqual(daemon.status()["step"], 1)

    def test_the_binary_reply_is_followed_by_the_acknowledgement(self):
        with Daemon(scenario(1)) as daemon:
            motors = self.connect(daemon, "/robot1/motors")
            motors.write(message(b"d", DRIVE))
            expected = bottle(struct.pack("<i4s", 9, b"ok"), struct.pack("<ii", 1, 1), real(0.01), real(1)) + ACK
            self.assertEqual(motors.read_exactly(len(expected)), expected)

    def test_a_write_without_reply_drives_too(self):
        with Daemon(scenario(1)) as daemon:
            motors = self.connect(daemon, "/robot1/motors")
            for _ in range(3):
                motors.write(message(b"D", DRIVE))
                self.assertEqual(motors.read_exactly(8), ACK)
            self.assertEqual(daemon.status()["step"], 3)

    def test_the_module_of_another_client_refuses_in_words(self):
        with Daemon(scenario(1)) as daemon:
            daemon.text("/robot1/motors").must("claim")
            refusal = self.ask_text(self.text(daemon, "/robot1/motors"), "set_velocity 0.2 0.5")
            self.assertRegex(refusal, r'^\[fail\] ".*" 6$')

    def test_a_program_of_yarp_owns_what_it_drives_until_it_goes(self):
        with Daemon(scenario(1)) as daemon:
            program, other = self.text(daemon, "/robot1/motors"), daemon.text("/robot1/motors")
            self.ask_text(program, "set_velocity 0.2 0.5")
            self.assertEqual(other.ask("set_velocity 0 0").error, 6)
            program.write("q\r\n")
            program.read_to_end()
            other.must("set_velocity 0 0")

    def test_who_is_refused_is_told_which_program_drives(self):
        with Daemon(scenario(1)) as daemon:
            program = daemon.raw("/robot1/motors")
            program.write("CONNECT /own\r\n")
            program.read_line()
            self.ask_text(program, "set_velocity 0.2 0.5")
            self.assertIn("is driven by /own", daemon.text("/robot1/motors").ask("set_velocity 0 0").text)

    def test_a_message_of_five_values_is_answered_by_one(self):
        with Daemon(scenario(1)) as daemon:
            self.assertEqual(self.ask_text(self.text(daemon, "/robot1/motors"), '0 "" 11 () (0.2 0.5)'), '0 "" 11 (1) (0.01 1.0)')

    def test_a_reversed_connection_gets_a_reading_each_step(self):
        with Daemon(scenario(1)) as daemon:
            pose = self.text(daemon, "/robot1/pose")
            pose.write("r\r\n*\r\n")  # the answer to * says that r is done
            while "input connection" not in pose.read_line():
                pass
            motors = daemon.text("/robot1/motors")
            for step in range(1, 4):
                motors.must("set_velocity 0.2 0")
                self.assertEqual(pose.read_line(), f"D {step - 1} {step * 0.01:.2f}")
                self.assertEqual(len(pose.read_line().split()), 5)

    def test_yarps_own_questions_are_answered_on_every_module(self):
        with Daemon(scenario(1)) as daemon:
            for module in ("/robot1/motors", "/robot1/pose", "/simulation", "/world"):
                port = daemon.raw(module)
                port.write("CONNACK <ping>\r\n*\r\na\r\n[ver]\r\nq\r\n")
                said = port.read_to_end().decode().split("\r\n")
                self.assertEqual(said[:2], ["Welcome <ping>", f"This is {module}"])
                self.assertIn("[ver] 1 2 3", said)

    def test_a_program_killed_in_mid_message_changes_nothing(self):
        with Daemon(scenario(1)) as daemon:
            whole = HELLO + message(b"d", DRIVE)
            for size in range(1, len(whole)):
                victim = daemon.raw("/robot1/motors")
                victim.write(whole[:size])
                victim.close()
            daemon.text("/robot1/motors").must("set_velocity 0.2 0.5")
            self.assertEqual(daemon.status()["step"], 1)

    def test_nonsense_after_the_hello_ends_that_connection_only(self):
        with Daemon(scenario(1)) as daemon:
            for nonsense in (b"\xff" * 64, message(b"d", b"")[:18] + b"\xff" * 64, b"GET / HTTP/1.1\r\n\r\n"):
                port = self.connect(daemon, "/robot1/motors")
                port.write(nonsense)
                port.read_to_end()
            daemon.text("/robot1/motors").must("get_wheels")

    def test_a_connection_without_bytes_is_harmless(self):
        with Daemon(scenario(1)) as daemon:
            for _ in range(40):
                socket.create_connection(("127.0.0.1", daemon.module_port("/robot1/motors"))).close()
            self.assertEqual(self.ask_text(self.text(daemon, "/robot1/motors"), "ping"), "[ok] 0.0 0.0")


if __name__ == "__main__":
    unittest.main()
