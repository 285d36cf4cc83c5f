"""Wrong input of every kind: an error or a closed connection with a reason, and no effect on another robot."""
import json
import random
import socket
import struct
import subprocess
import threading
import unittest

from document import block
from harness import Daemon, frame, scenario, until

STEPS = 60


def drive_steps(daemon, steps=STEPS):
    """A fixed drive of robot1; returns the hash after it."""
    motors = daemon.text("/robot1/motors")
    for k in range(steps):
        motors.must(f"set_wheel_speeds {1 + k % 5} {2 - k % 3}")
    motors.close()
    return daemon.status()["hash"]


class HostileTest(unittest.TestCase):
    def undisturbed(self):
        with Daemon(scenario(2, robot_extra={2: "sync no"})) as daemon:
            return drive_steps(daemon)

    def check_beside(self, attack):
        """Runs `attack(daemon)` while a robot is driven: the hash must equal that of a run without the attack."""
        expected = self.undisturbed()
        with Daemon(scenario(2, robot_extra={2: "sync no"})) as daemon:
            failures = []

            def run():
                try:
                    attack(daemon)
                except BaseException as error:  # reported below
                    failures.append(error)

            attacker = threading.Thread(target=run)
            attacker.start()
            hashed = drive_steps(daemon)
            attacker.join()
            if failures:
                raise failures[0]
            self.assertEqual(hashed, expected)

    def hostile_frames(self):
        whole = frame(11, data=(0.1, 0.2))
        yield from (whole[:cut] for cut in range(1, len(whole)))
        yield struct.pack("<I", 19) + b"x" * 19                             # size below the header
        yield struct.pack("<I", 0xFFFFFFFF) + b"x" * 64                     # 4 GiB
        yield struct.pack("<I", 2 << 20) + b"x" * 64                        # above 1 MiB
        yield struct.pack("<IiiIII", 20, 0, 11, 0xFFFFFFFF, 0, 0)           # negative T
        yield struct.pack("<IiiIII", 20, 0, 11, 0, 0x80000000, 0)           # negative M
        yield struct.pack("<IiiIII", 20, 0, 11, 0, 0, 0x20000000)           # N × 8 overflows
        yield struct.pack("<IiiIII", 24, 0, 11, 4, 0, 0) + b"\xff\xfe\x00x"  # not UTF-8, NUL
        yield frame(11, data=(float("nan"), float("inf")))
        yield frame(99999)
        yield frame(-5, params=(1, 2, 3))
        chance = random.Random(3)
        for _ in range(40):
            yield bytes(chance.randrange(256) for _ in range(chance.randrange(1, 200)))

    def test_hostile_binary_beside_a_driven_robot(self):
        def attack(daemon):
            for bad in self.hostile_frames():
                connection = daemon.raw("/robot2/motors")
                connection.write(b"CDS1" + bad)
                connection.socket.shutdown(socket.SHUT_WR)
                connection.read_to_end()  # an error, a reason, or nothing, but an end
                connection.close()
        self.check_beside(attack)

    def test_hostile_text_beside_a_driven_robot(self):
        lines = [b"set_velocity 0,5 0\n", b"0 \"\" 11 0 99999999999\n", b"0 \"\" 11 -1 0\n", b"\xff\xfe\xfd\n",
                 b"set_velocity nan inf\n", b"set_velocity 1e999 0\n", b"((((((((\n", b"\"\"\"\"\n", b"ready 2.5\n",
                 b"set_velocity (99999999999) 0 0\n", b"get_target \"\\q\"\n", b"\x00\x00\x00\n", b"a" * 5000 + b"\n"]

        def attack(daemon):
            for line in lines:
                connection = daemon.raw("/robot2/motors")
                connection.write(line)
                reply = connection.read_line()
                self.assertNotEqual(reply.split()[0], "0", (line, reply))
                connection.close()
        self.check_beside(attack)

    def test_a_line_of_two_megabytes_is_too_large(self):
        with Daemon(scenario(1)) as daemon:
            connection = daemon.raw("/robot1/motors")
            try:
                connection.write(b"a" * (2 << 20))
            except (BrokenPipeError, ConnectionResetError):
                pass
            self.assertTrue(connection.read_to_end() in (b"",) or b"8 " in connection.buffer[:4], connection.buffer[:80])
            daemon.text("/robot1/motors").must("ready")

    def test_twenty_malformed_messages_in_a_row_close_the_connection(self):
        with Daemon(scenario(1)) as daemon:
            connection = daemon.raw("/robot1/pose")
            connection.write(b")(\n" * 20)
            said = connection.read_to_end().decode()
            self.assertIn(" -1 ", said.splitlines()[-1])

    def test_http_on_a_module_or_name_port_gets_400_and_moves_nothing(self):
        with Daemon(scenario(1)) as daemon:
            for connection in (daemon.raw("/robot1/motors"), daemon.raw()):
                connection.write(b"POST / HTTP/1.1\r\nHost: x\r\n\r\nset_velocity 1 1\n")
                self.assertTrue(connection.read_to_end().startswith(b"HTTP/1.1 400"))
            self.assertEqual(daemon.status()["step"], 0)

    def test_another_version_of_the_magic_is_told_what_to_send(self):
        with Daemon(scenario(1)) as daemon:
            connection = daemon.raw("/robot1/motors")
            connection.write(b"CDS9")
            self.assertIn(b"CDS1", connection.read_to_end())

    def test_a_slow_trickle_of_first_bytes_holds_nobody_up(self):
        def attack(daemon):
            trickles = [daemon.raw("/robot2/motors") for _ in range(5)]
            for byte in b"CDS1" + frame(0, params=(7,)):
                for trickle in trickles:
                    trickle.write(bytes([byte]))
            for trickle in trickles:
                self.assertEqual(struct.unpack("<I", trickle.read_exactly(4))[0] % 4, 0)
        self.check_beside(attack)

    def test_half_closed_netcat_gets_its_answer(self):
        with Daemon(scenario(1)) as daemon:
            done = subprocess.run(["nc", "-N", "127.0.0.1", str(daemon.module_port("/robot1/pose"))], input=b"get_pose\n",
                                  stdout=subprocess.PIPE, timeout=60)
            self.assertTrue(done.stdout.startswith(b'0 "" 40 0 7 '), done.stdout)

    def test_two_hundred_idle_connections_hold_nobody_up(self):
        def attack(daemon):
            idle = [daemon.raw("/robot2/pose") for _ in range(200)]
            idle[-1].write(b"get_pose\n")
            self.assertTrue(idle[-1].read_line().startswith("0 "))
        self.check_beside(attack)

    def test_a_reader_that_never_reads_holds_nobody_up(self):
        def attack(daemon):
            deaf = daemon.raw("/robot2/pose")
            deaf.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            deaf.write(b"subscribe\n")
            deaf.socket.setblocking(False)
            try:
                for _ in range(200):
                    deaf.socket.send(b"get_pose\n" * 1000)
            except BlockingIOError:
                pass
            deaf.socket.settimeout(60)
        self.check_beside(attack)

    def test_descriptors_are_given_back(self):
        with Daemon(scenario(1)) as daemon:
            daemon.text("/robot1/pose").must("get_pose")
            before = daemon.open_files()
            for k in range(300):
                connection = daemon.raw(("/robot1/pose", "/robot1/motors", None)[k % 3])
                connection.write((b"get_pose\n", b"CDS1", b"OPEN /robot1/pose\nget_pose\n")[k % 3])
                connection.close()
            for module in ("/robot1/pose", "/robot1/motors"):  # earlier connections have been accepted by now
                last = daemon.text(module, direct=True)
                last.must("ping")
                last.close()
            until(lambda: daemon.open_files() <= before)

    def test_running_out_of_descriptors_is_survived(self):
        script = ["prlimit", "--nofile=64:64"]
        with Daemon(scenario(1)) as daemon:
            limit = 64
            subprocess.run([*script, "--pid", str(daemon.process.pid)], check=True)
            before = daemon.text("/robot1/pose")
            crowd = [daemon.raw() for _ in range(limit * 2)]
            before.must("get_pose")
            for connection in crowd:
                connection.close()
            daemon.text("/robot1/motors").must("ready")

    def test_numbers_do_not_depend_on_the_locale(self):
        with Daemon(scenario(1), env={"LC_ALL": "de_DE.UTF-8", "LC_NUMERIC": "de_DE.UTF-8"}) as daemon:
            motors = daemon.text("/robot1/motors")
            self.assertEqual(motors.must("ping").error, 0)
            self.assertAlmostEqual(motors.must("set_velocity 0.25 0").time_s, 0.01)
            motors.send("get_wheels")
            self.assertNotIn(",", motors.read_line())
            self.assertEqual(json.loads(daemon.text("/simulation").must("get_status").text)["step_s"], 0.01)

    def test_an_unknown_module_is_refused_by_open(self):
        with Daemon(scenario(1)) as daemon:
            connection = daemon.raw()
            connection.write(b"OPEN /robot1/moters\n")
            self.assertIn("/robot1/motors", connection.read_line())


class ExchangeTest(unittest.TestCase):
    """Executes the examples of docs/protocol.md on the classroom scenario."""

    def test_the_sixty_line_client_drives_the_robot(self):
        source = block("client")
        with Daemon(name="classroom") as daemon:
            done = subprocess.run(["python3", "-c", source, f"{daemon.names[0]}:{daemon.names[1]}"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr.decode())
            self.assertTrue(done.stdout)


if __name__ == "__main__":
    unittest.main()
