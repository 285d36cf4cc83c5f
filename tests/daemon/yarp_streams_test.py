"""Ports that send readings to YARP programs: opened and connected on request, with back-pressure."""
import os
import socket
import struct
import subprocess
import tempfile
import unittest
import zlib
from pathlib import Path

from harness import BINARY, LIMIT_S, Connection, Daemon, scenario, until
from yarp_ports import ACK, CODES, HEADER, Reader, YarpPorts, registration


class YarpStreamsTest(YarpPorts, unittest.TestCase):
    def test_a_port_is_there_when_its_name_is_asked_for(self):
        with Daemon(scenario(1)) as daemon:
            names = daemon.keep(Connection(daemon.names))
            names.write("NAME_SERVER list /robot1/pose\n")
            self.assertIn("/robot1/pose ", names.read_line())
            self.assertTrue(names.read_line().startswith("***"))
            for name in ("/robot1/pose/state:o", "/robot1/pose/pose_3d:o", "/robot1/pose/10/state:o", "/robot1/motors/command:i",
                         "/simulation/state:o", "/recorder/state:o"):
                self.assertIsNotNone(registration(daemon, name), name)
                self.assertEqual(registration(daemon, name), registration(daemon, name))
            for name in ("/robot1/pose/nothing:o", "/robot1/pose/0/state:o", "/robot9/pose/state:o", "/robot1/pose/state:i",
                         "/state:o", "/robot1//state:o"):
                self.assertIsNone(registration(daemon, name), name)

    def test_a_reader_gets_a_sample_at_once_and_one_each_step(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon)
            connection = self.connect(daemon, "/robot1/pose/state:o", reader)
            self.assertEqual(connection.hello[0], struct.pack("<i", 7777 + CODES["tcp"]))
            pose = daemon.text("/robot1/pose").must("get_pose").data[:-2]
            self.assertEqual(connection.read_sample(ACK), ("D 0 0.0", struct.pack("<ii5d", 256 | 10, 5, *pose)))
            motors = daemon.text("/robot1/motors")
            for step in (1, 2):
                motors.must("set_velocity 0.2 0")
                pose = daemon.text("/robot1/pose").must("get_pose").data[:-2]
                expected = (f"D {step} 0.0{step}", struct.pack("<ii5d", 256 | 10, 5, *pose))
                self.assertEqual(connection.read_sample(ACK), expected)

    def test_a_reader_of_yarp_4_gets_its_numbers(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon, version=4))
            self.assertEqual(struct.unpack_from("<ii", connection.read_sample()[1]), (256 | 20, 5))

    def test_a_told_version_is_not_asked_for(self):
        with Daemon(scenario(1), "--yarp-dialect", "4") as daemon:
            reader = Reader(daemon)
            self.admin(daemon, "/robot1/pose").write('a\r\n[add] "tcp://reader"\r\n')
            connection = reader.accept()
            connection.read_hello()
            self.assertEqual(struct.unpack_from("<ii", connection.read_sample()[1]), (256 | 20, 5))

    def test_who_does_not_acknowledge_gets_nothing_more_and_delays_nothing(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon))
            connection.read_sample()
            motors = daemon.text("/robot1/motors")
            for _ in range(100):
                motors.must("set_velocity 0.2 0")
            self.assertFalse(connection.has_bytes())
            connection.write(ACK)
            # The newest 64 were queued; the number shows that 36 are lost.
            self.assertEqual(connection.read_sample(ACK)[0], "D 37 0.37")
            self.assertEqual(connection.read_sample(ACK)[0], "D 38 0.38")

    def test_fast_tcp_needs_no_acknowledgement(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon), "fast_tcp")
            self.assertEqual(connection.hello[0], struct.pack("<i", 7777 + CODES["fast_tcp"]))
            motors = daemon.text("/robot1/motors")
            for _ in range(2):
                motors.must("set_velocity 0.2 0")
            self.assertEqual([connection.read_sample()[0] for _ in range(3)], ["D 0 0.0", "D 1 0.01", "D 2 0.02"])

    def test_carriers_of_text_send_lines(self):
        for carrier, word, ack in (("text", "CONNECT", ""), ("text_ack", "CONNACK", "<ACK>\r\n")):
            with self.subTest(carrier), Daemon(scenario(1)) as daemon:
                connection = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon), carrier)
                self.assertEqual(connection.hello[0], word)
                self.assertEqual(connection.read_line(), "D 0 0.0")
                self.assertEqual(len(connection.read_line().split()), 5)
                daemon.text("/robot1/motors").must("set_velocity 0.2 0")
                connection.write(ack)
                self.assertEqual(connection.read_line(), "D 1 0.01")

    def test_a_port_with_a_number_sends_one_in_so_many_steps(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/3/state:o", Reader(daemon), "fast_tcp")
            motors = daemon.text("/robot1/motors")
            for _ in range(6):
                motors.must("set_velocity 0.2 0")
            self.assertEqual([connection.read_sample()[0] for _ in range(3)], ["D 0 0.0", "D 1 0.03", "D 2 0.06"])

    def test_each_reading_has_a_port(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/pose_3d:o", Reader(daemon))
            wanted = daemon.text("/robot1/pose").must("get_pose_3d").data[:-2]
            self.assertEqual(connection.read_sample()[1], struct.pack(f"<ii{len(wanted)}d", 256 | 10, len(wanted), *wanted))

    def test_who_connects_by_text_and_sends_r_gets_the_reading_of_the_port(self):
        with Daemon(scenario(1)) as daemon:
            connection = daemon.keep(Connection(registration(daemon, "/robot1/pose/2/pose_3d:o")))
            connection.write("CONNECT me\r\nr\r\n")
            connection.read_line()
            motors = daemon.text("/robot1/motors")
            for _ in range(2):
                motors.must("set_velocity 0.2 0")
            self.assertEqual(connection.read_line(), "D 0 0.02")
            self.assertEqual(len(connection.read_line().split()), len(daemon.text("/robot1/pose").must("get_pose_3d").data) - 2)

    def udp_socket(self, daemon):
        datagrams = daemon.keep(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        datagrams.settimeout(LIMIT_S)
        datagrams.bind(("127.0.0.1", 0))
        return datagrams

    def test_samples_go_out_as_datagrams(self):
        with Daemon(scenario(1)) as daemon:
            port, reader, datagrams = "/robot1/pose/state:o", Reader(daemon), self.udp_socket(daemon)
            admin = self.admin(daemon, port)
            admin.write('a\r\n[add] "udp://reader"\r\n')
            reader.answer_probe()
            reader.accept().read_hello(datagrams.getsockname()[1])
            self.assertEqual(admin.read_line(), f'0 "Added connection from {port} to udp://reader\\r\\n"')
            daemon.text("/robot1/motors").must("set_velocity 0.2 0")
            for envelope in (b"D 0 0.0\0", b"D 1 0.01\0"):
                datagram = datagrams.recv(65536)
                crc, number = struct.unpack_from("<Ii", datagram)
                self.assertEqual((crc, number), (zlib.crc32(datagram[8:]), 0))
                self.assertTrue(datagram[8:].startswith(HEADER.pack(b"YA", 10, b"RP")))
                self.assertIn(b"~\0\0\1" + envelope + struct.pack("<ii", 256 | 10, 5), datagram)
            admin.read_line()
            self.assertEqual(self.ask(admin, '[list] [out] "/reader"'), f'(from "{port}") (to "/reader") (carrier udp)')
            self.ask(admin, '[del] "/reader"')
            farewell = reader.accept()  # YARP's notice of the end
            self.assertEqual([farewell.read_line() for _ in range(3)], ["CONNECT admin", "~" + port, "q"])

    def test_a_reader_of_datagrams_that_goes_is_forgotten(self):
        with Daemon(scenario(1)) as daemon:
            reader, datagrams = Reader(daemon), self.udp_socket(daemon)
            admin = self.admin(daemon, "/robot1/pose/state:o")
            admin.write('a\r\n[add] "udp://reader"\r\n')
            reader.answer_probe()
            reader.accept().read_hello(datagrams.getsockname()[1])
            datagrams.recv(65536)
            datagrams.close()
            reader.listener.close()
            motors = daemon.text("/robot1/motors")

            def is_forgotten():
                motors.must("set_velocity 0.2 0")  # sending reveals that nobody reads
                return self.links(daemon, "/robot1/pose/state:o") == ""

            until(is_forgotten)

    def test_commands_come_in_as_datagrams(self):
        with Daemon(scenario(1)) as daemon:
            host = registration(daemon, "/robot1/motors/command:i")
            hello = daemon.keep(Connection(host))
            hello.write(HEADER.pack(b"YA", 7777, b"RP") + struct.pack("<i", 8) + b"/sender\0")
            _, port, _ = HEADER.unpack(hello.read_exactly(8))
            hello.close()
            datagrams = self.udp_socket(daemon)
            words = struct.pack("<iiii12sidid", 256, 3, 4, 12, b"set_velocity", 10, 0.2, 10, 0.5)
            message = HEADER.pack(b"YA", 10, b"RP") + b"\2\1" + b"\xff" * 8 + struct.pack("<iii", 8, len(words), 0) + \
                b"\0\0\0\0~D\0\1" + words

            def send(piece, number, crc=None):
                datagrams.sendto(struct.pack("<Ii", zlib.crc32(piece) if crc is None else crc, number) + piece, ("127.0.0.1", port))

            send(message, 0, 4711)  # spoiled
            send(message, 1)  # its beginning is missing
            send(message, -1)  # says nothing
            send(message, 0)
            until(lambda: daemon.status()["step"] == 1)
            send(message[:20], 0)
            send(message[20:], 1)
            until(lambda: daemon.status()["step"] == 2)
            self.assertTrue(daemon.status()["robots"][0]["owner"])
            farewell = daemon.keep(Connection(host))
            farewell.write("CONNECT admin\r\n~/sender\r\nq\r\n")
            farewell.read_line()
            self.assertEqual(farewell.read_line(), "Removing connection from /sender to /robot1/motors/command:i")
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_a_sender_of_datagrams_shows_the_token_where_others_must(self):
        token = "a-token-for-tests"
        with Daemon(scenario(1), "--host", "0.0.0.0", "--private", "--token", token) as daemon:
            hello = daemon.keep(Connection(("127.0.0.1", registration(daemon, "/robot1/motors/command:i")[1])))
            hello.write(HEADER.pack(b"YA", 7777, b"RP") + struct.pack("<i", 8) + b"/sender\0")
            _, port, _ = HEADER.unpack(hello.read_exactly(8))
            datagrams = self.udp_socket(daemon)

            def send(*words):
                content = b"".join(struct.pack("<i", len(word)) + word.encode() for word in words)
                payload = struct.pack("<ii", 256 | 4, len(words)) + content
                message = HEADER.pack(b"YA", 10, b"RP") + b"\2\1" + b"\xff" * 8 + struct.pack("<iii", 8, len(payload), 0) + \
                    b"\0\0\0\0~D\0\1" + payload
                datagrams.sendto(struct.pack("<Ii", zlib.crc32(message), 0) + message, ("127.0.0.1", port))

            pose = daemon.text("/robot1/pose")

            def speed():
                return pose.must("get_pose").data[3]

            send("hello", "me", "wrong-token-here")
            send("set_velocity", "0.3", "0")
            send("hello", "me", token)
            send("stop")
            until(lambda: daemon.status()["step"] > 0)
            self.assertAlmostEqual(speed(), 0)  # it is the stop that was taken
            send("set_velocity", "0.3", "0")
            until(lambda: daemon.status()["step"] > 1)
            self.assertGreater(speed(), 0.01)

    def test_a_sender_of_datagrams_that_comes_again_replaces_itself(self):
        with Daemon(scenario(1)) as daemon:
            host = registration(daemon, "/robot1/motors/command:i")
            before = None
            for _ in range(20):
                hello = Connection(host)
                hello.write(HEADER.pack(b"YA", 7777, b"RP") + struct.pack("<i", 8) + b"/sender\0")
                hello.read_exactly(8)
                hello.close()
                before = before or daemon.open_files()
            until(lambda: daemon.open_files() <= before + 2)

    def test_a_connection_is_listed_until_it_is_removed(self):
        with Daemon(scenario(1)) as daemon:
            port = "/robot1/pose/state:o"
            connection = self.connect(daemon, port, Reader(daemon))
            admin = self.admin(daemon, port)
            self.assertEqual(self.ask(admin, "[list] [out]"), '"/reader"')
            self.assertEqual(self.ask(admin, '[list] [out] "/reader"'), f'(from "{port}") (to "/reader") (carrier tcp)')
            self.assertEqual(self.ask(admin, '[list] [out] "/other"'), "")
            self.assertEqual(self.ask(admin, '[del] "/reader"'), f'0 "Removed connection from {port} to /reader\\r\\n"')
            connection.read_sample()
            self.assertEqual(connection.read_to_end(), b"")
            self.assertEqual(self.ask(admin, "[list] [out]"), "")
            self.assertTrue(self.ask(admin, '[del] "/reader"').startswith("-1 "))

    def test_adding_a_connection_again_replaces_it(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon)
            first = self.connect(daemon, "/robot1/pose/state:o", reader)
            second = self.connect(daemon, "/robot1/pose/state:o", reader, "text")
            first.read_sample()
            self.assertEqual(first.read_to_end(), b"")
            self.assertEqual(second.read_line(), "D 0 0.0")
            self.assertEqual(self.links(daemon, "/robot1/pose/state:o"), '"/reader"')

    def test_a_reader_that_goes_is_forgotten(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon))
            connection.close()
            motors = daemon.text("/robot1/motors")
            motors.must("set_velocity 0.2 0")
            until(lambda: self.links(daemon, "/robot1/pose/state:o") == "")

    def test_who_cannot_be_reached_is_told_to_whom_who_asked(self):
        with Daemon(scenario(1)) as daemon:
            admin = self.admin(daemon, "/robot1/pose/state:o")
            self.assertEqual(self.ask(admin, '[add] "tcp://nobody"'), '-1 "Do not know how to connect to /nobody\\r\\n"')
            reader = Reader(daemon)
            self.assertRegex(self.ask(admin, '[add] "mcast://reader"'), "^-1 .*use tcp, fast_tcp, ")
            reader.listener.close()
            self.assertRegex(self.ask(admin, '[add] "tcp://reader"'), "^-1 .Cannot connect to /reader: Connection refused")

    def test_who_is_no_port_of_yarp_is_left_alone(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon)
            admin = self.admin(daemon, "/robot1/pose/state:o")
            admin.write('a\r\n[add] "text://reader"\r\n')
            stranger = reader.accept()
            stranger.write("HTTP/1.1 400 Bad Request\r\n\r\n")
            self.assertRegex(admin.read_line(), "^-1 .*it is no port of YARP")

    def test_a_line_of_text_connects_too(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon)
            admin = self.admin(daemon, "/robot1/pose/state:o")
            admin.write("/reader\r\n")
            reader.answer_probe()
            reader.accept().read_hello()
            self.assertEqual(admin.read_line(), "Added connection from /robot1/pose/state:o to /reader")

    def test_commands_stream_in(self):
        with Daemon(scenario(1)) as daemon:
            connection = daemon.keep(Connection(registration(daemon, "/robot1/motors/command:i")))
            connection.write("CONNACK me\r\n")
            connection.read_line()
            for _ in range(3):
                connection.write("D\r\nset_velocity 0.2 0.5\r\n")
                self.assertEqual(connection.read_line(), "<ACK>")
            self.assertEqual(daemon.status()["step"], 3)
            self.assertTrue(daemon.status()["robots"][0]["owner"])

    def test_readers_change_nothing_of_the_run(self):
        hashes = []
        for readers in (0, 2):
            with Daemon(scenario(1)) as daemon:
                for i in range(readers):
                    self.connect(daemon, "/robot1/pose/state:o", Reader(daemon, f"/reader{i}"), "fast_tcp" if i else "tcp")
                motors = daemon.text("/robot1/motors")
                for _ in range(50):
                    motors.must("set_velocity 0.2 0.5")
                hashes.append(daemon.status()["hash"])
        self.assertEqual(hashes[0], hashes[1])

    def test_a_robot_that_leaves_takes_its_ports_along(self):
        with Daemon(scenario(2)) as daemon:
            connection = self.connect(daemon, "/robot2/pose/state:o", Reader(daemon), "text")
            connection.read_line()
            connection.read_line()
            daemon.text("/simulation").must('load_scenario "' + scenario(1).replace("\n", "\\n") + '"')
            self.assertEqual(connection.read_line(), "q")
            self.assertIsNone(registration(daemon, "/robot2/pose/state:o"))
            self.assertIsNotNone(registration(daemon, "/robot1/pose/state:o"))

    def test_another_name_server_has_the_ports_and_finds_the_readers(self):
        with tempfile.TemporaryDirectory() as folder, Daemon(scenario(1)) as server:
            (Path(folder) / "_lab.conf").write_text(f"127.0.0.1 {server.names[1]} yarp\n")
            env = {"YARP_CONFIG_HOME": folder, "YARP_NAMESPACE": "/lab"}
            with Daemon(scenario(2), "--yarp-server", "yarp.conf", env=env):
                for name in ("/robot2/motors", "/robot2/motors/command:i", "/robot2/pose/state:o", "/robot2/pose/measures:o",
                             "/robot2/pose/rpc:o", "/robot2/base/command:i", "/world_input_port"):
                    until(lambda: registration(server, name))
                connection = self.connect(server, "/robot2/pose/state:o", Reader(server))
                self.assertEqual(connection.read_sample()[0], "D 0 0.0")
            connection.read_to_end()
            self.assertIsNone(registration(server, "/robot2/pose/state:o"))

    def test_a_yarp_conf_that_is_not_there_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([BINARY, "serve", "--yarp-server", "yarp.conf"], env={**os.environ, "YARP_CONFIG_HOME": folder},
                                 capture_output=True, text=True, timeout=LIMIT_S)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(f"{folder}/yarp.conf names no server: write HOST:PORT, or run yarp conf HOST PORT", run.stderr)

    def test_the_daemon_ends_in_the_midst_of_streams(self):
        with Daemon(scenario(1)) as daemon:
            connection = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon))
            daemon.end()
            connection.read_sample()
            connection.read_to_end()


if __name__ == "__main__":
    unittest.main()
