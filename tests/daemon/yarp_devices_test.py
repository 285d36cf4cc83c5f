"""Ports of YARP's own devices: control boards of versions 3 and 4, sensors, cameras, a drive, the world interface."""
import math
import socket
import struct
import tempfile
import unittest
import zlib
from pathlib import Path

from harness import Connection, Daemon, scenario, until
from yarp_ports import ACK, HEADER, Reader, YarpPorts, registration

ENV = {"COOPDYN_PATH": str(Path(__file__).parent / "robots")}
VOCAB = 9


def arm(mode="lockstep", robot=""):
    return f"[SIMULATION]\nmode {mode}\nstep 0.01\n[ROBOT_1]\ntype elbow\nname r\nposition 0 0 0\n{robot}\n"


def word(text):
    return struct.pack("<i4s", VOCAB, text.encode())


def numbers(*values):
    return struct.pack("<ii", 256 | 10, len(values)) + struct.pack(f"<{len(values)}d", *values)


class Program:
    """A program's port that is connected to one of ours by tcp."""

    def __init__(self, daemon, port, name, peer=None):
        self.connection = daemon.keep(Connection(registration(daemon, port)))
        self.connection.write(HEADER.pack(b"YA", 7777 + 3 + 128, b"RP") + struct.pack("<i", len(name) + 1) + name.encode() + b"\0")
        if peer is not None:
            peer.answer_probe()  # the daemon first queries its version
        assert self.connection.read_exactly(8)[:2] == b"YA"

    @staticmethod
    def message(kind, *items):
        payload = struct.pack("<ii", 256, len(items)) + b"".join(items)
        return HEADER.pack(b"YA", 10, b"RP") + bytes([2, 1]) + b"\xff" * 8 + struct.pack("<iii", 8, len(payload), 0) + \
            b"\0\0\0\0~" + kind + b"\0\1" + payload

    def send(self, kind, *items):
        self.connection.write(self.message(kind, *items))

    def write(self, *items):
        """Sends a streamed command; returns when it is acknowledged."""
        self.send(b"D", *items)
        assert self.connection.read_exactly(8) == ACK

    def ask(self, size, *items):
        """Sends a request; returns the reply of `size` bytes."""
        self.send(b"d", *items)
        reply = self.connection.read_exactly(size)
        assert self.connection.read_exactly(8) == ACK
        return reply


class YarpDevicesTest(YarpPorts, unittest.TestCase):
    def test_a_program_with_a_name_is_served_on_each_port_that_takes_requests(self):
        """The daemon queries its YARP version before its first request."""
        with Daemon(arm("realtime"), "--read-only", env=ENV) as daemon:
            for port in ("/world_input_port", "/clock/rpc", "/r/arm/rpc:i", "/r/arm/nws/rpc:i", "/r/arm", "/world"):
                text = daemon.keep(Connection(registration(daemon, port)))
                text.write(b"CONNECT /me\nr\n")
                program = Program(daemon, port, "/me")
                program.send(b"d")
                program.connection.read_exactly(8)  # the beginning of the answer
            self.assertIn("robots", daemon.text("/simulation").must("get_status").text)

    def words(self, daemon, port):
        """A text connection to a port."""
        connection = daemon.keep(Connection(registration(daemon, port)))
        connection.write("CONNECT me\r\n")
        self.assertEqual(connection.read_line(), "Welcome me")

        def ask(line):
            connection.write(f"d\r\n{line}\r\n")
            return connection.read_line()
        return ask

    # --- control boards

    def test_a_board_moves_its_joints_in_degrees(self):
        with Daemon(arm(), env=ENV) as daemon:
            board = self.words(daemon, "/r/arm/rpc:i")
            self.assertEqual(board("get axes"), "[is] axes 2 [tsta] 0 0.0 [ok]")
            self.assertEqual(board("set poss (30 -20)"), "[ok]")
            self.assertEqual(daemon.status()["step"], 1)
            self.assertTrue(board("get don 0").startswith("[is] don 0 "))
            for _ in range(1000):
                if board("get dons").startswith("[is] dons 1 "):
                    break
                self.assertEqual(board("set vel 0 40"), "[ok]")
                board("set poss (30 -20)")
            positions = daemon.text("/r/arm").must("get_joints").data
            self.assertAlmostEqual(positions[0], math.radians(30), delta=math.radians(0.1))
            self.assertAlmostEqual(positions[3], math.radians(-20), delta=math.radians(0.1))

    def test_a_reset_empties_the_integral_of_a_servo(self):
        """Driven only by the integral, the joint moves beyond its reference, and stops when the integral is emptied."""
        with Daemon(arm(), env=ENV) as daemon:
            board = self.words(daemon, "/r/arm/rpc:i")
            value = lambda answer: float(answer.split()[2])  # noqa: E731
            self.assertEqual(board("set pid pid pos 0 (0 0 20 0 0 0 0 0 0 0)"), "[ok]")
            while value(board("get enc 0")) < 5:
                self.assertEqual(board("set dpo 0 5"), "[ok]")
            self.assertGreater(value(board("get esp 0")), 10)
            self.assertEqual(board("set pid res pos 0"), "[ok]")
            self.assertEqual(board("set dpo 0 5"), "[ok]")
            self.assertLess(abs(value(board("get esp 0"))), 1)

    def test_an_encoder_with_a_resolution_has_counts_and_an_exact_one_has_none(self):
        with tempfile.TemporaryDirectory() as folder:
            text = (Path(__file__).parent / "robots/elbow/model.sdf").read_text()
            model = Path(folder) / "elbow/model.sdf"
            model.parent.mkdir()
            model.write_text(text.replace('name="arm"', f'name="arm" encoder_resolution="{2 * math.pi / 4096}"'))
            with Daemon(arm(), env={"COOPDYN_PATH": folder}) as daemon:
                self.assertTrue(self.words(daemon, "/r/arm/rpc:i")("get mcpr 0").startswith("[is] mcpr 4096.0"))
        with Daemon(arm(), env=ENV) as daemon:
            self.assertIn("is exact", self.words(daemon, "/r/arm/rpc:i")("get mcpr 0"))

    def test_the_ports_of_one_program_drive_together_and_others_are_refused(self):
        with Daemon(arm("realtime"), env=ENV) as daemon:
            requests = Program(daemon, "/r/arm/rpc:i", "/ctl/rpc:o")
            stream = Program(daemon, "/r/arm/command:i", "/ctl/command:o")
            modes = struct.pack("<ii", 256 | VOCAB, 2) + b"vel\0" * 2
            self.assertEqual(requests.ask(12, word("set"), word("icmd"), word("cmds"), modes), struct.pack("<ii4s", 256 | VOCAB, 1, b"ok"))
            stream.write(struct.pack("<ii4s", 256 | VOCAB, 1, b"vmos"), numbers(10.0, -10.0))
            self.assertIn("is driven by /ctl", self.words(daemon, "/r/arm/rpc:i")("set pos 0 10"))
            arm_module = daemon.text("/r/arm")
            self.assertEqual(arm_module.ask("set_velocities 0 0").error, 6)
            arm_module.must("subscribe")
            while arm_module.receive().data[1] < math.radians(9):
                pass

    def test_a_program_that_streams_and_asks_in_lockstep_waits_for_one_step(self):
        with Daemon(arm(), env=ENV) as daemon:
            requests = Program(daemon, "/r/arm/rpc:i", "/ctl/rpc:o")
            stream = Program(daemon, "/r/arm/command:i", "/ctl/command:o")
            for step in range(1, 6):
                stream.write(struct.pack("<ii4s", 256 | VOCAB, 1, b"vmos"), numbers(10.0, -10.0))
                self.assertEqual(daemon.status()["step"], step)
            requests.ask(12, word("set"), word("stos"))
            self.assertEqual(daemon.status()["step"], 6)

    def test_modes_switch_in_motion(self):
        with Daemon(arm(), env=ENV) as daemon:
            board, modes = self.words(daemon, "/r/arm/rpc:i"), []
            for request in ("set vmos (20 20)", "set icmd cmod 0 pos", "set pos 0 10", "set icmd cmds (torq torq)",
                            "set torq refs (0.1 0)", "set dpos (1 1)", "set icmd cmds (idl idl)"):
                self.assertEqual(board(request), "[ok]")
                modes.append(board("get icmd cmds").split("[tsta]")[0])
            self.assertEqual(modes, [f"[is] cmds ([{a}] [{b}]) " for a, b in
                                     (("vel", "vel"), ("pos", "vel"), ("pos", "vel"), ("torq", "torq"), ("torq", "torq"),
                                      ("posd", "posd"), ("idl", "idl"))])

    def test_motion_is_not_done_right_after_the_command_though_no_step_has_run(self):
        with Daemon(arm("realtime"), "--paused", env=ENV) as daemon:
            board = self.words(daemon, "/r/arm/rpc:i")
            self.assertTrue(board("get dons").startswith("[is] dons 1"))
            self.assertEqual(board("set pos 0 30"), "[ok]")
            self.assertTrue(board("get dons").startswith("[is] dons 0"))
            self.assertEqual(board("set icmd cmod 1 vel"), "[ok]")
            self.assertTrue(board("get icmd cmod 1").startswith("[is] 1 [vel]"))

    def test_what_a_board_refuses_it_refuses_in_words(self):
        with Daemon(arm(), env=ENV) as daemon:
            board = self.words(daemon, "/r/arm/rpc:i")
            for request, why in (("set pos 7 1", "there is no joint 7"), ("get icur refs", "no currents"), ("set ipwm ref 0 1", "no PWM"),
                                 ("set llim 0 0 1", "robot's model"), ("set icmd cmod 0 mix", "the modes are"),
                                 ("set vel 0 -3", "above 0")):
                answer = board(request)
                self.assertTrue(answer.startswith("[fail] ") and why in answer, answer)
            self.assertEqual(board("nonsense"), "[nak]")
            self.assertEqual(daemon.status()["step"], 0)

    def test_a_program_of_yarp_4_gets_its_numbers_though_it_sends_none(self):
        with Daemon(scenario(1)) as daemon:
            peer = Reader(daemon, "/ctl/rpc:o", 4)
            program = Program(daemon, "/robot1/pose", "/ctl/rpc:o", peer)
            reply = program.ask(8 + 8 + 7 * 12, struct.pack("<ii8s", 4, 8, b"get_pose"))
            self.assertEqual(struct.unpack_from("<i", reply, 16), (20,))

    def test_who_drives_by_datagrams_is_forgotten_when_its_port_has_gone(self):
        with Daemon(arm("realtime"), env=ENV) as daemon:
            peer = Reader(daemon, "/ctl/command:o")
            dial = daemon.keep(Connection(registration(daemon, "/r/arm/command:i")))
            dial.write(HEADER.pack(b"YA", 7777, b"RP") + struct.pack("<i", 15) + b"/ctl/command:o\0")
            port = struct.unpack("<2si2s", dial.read_exactly(8))[1]
            peer.answer_probe()
            whole = Program.message(b"D", struct.pack("<ii4s", 256 | VOCAB, 1, b"vmos"), numbers(1.0, 1.0))
            sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            daemon.keep(sender).sendto(struct.pack("<Ii", zlib.crc32(whole), 0) + whole, ("127.0.0.1", port))
            until(lambda: "/ctl" in str(daemon.status()["robots"][0]["owner"]))
            peer.listener.close()
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_a_refused_stream_is_told_in_the_log_once(self):
        with Daemon(arm(), env=ENV) as daemon:
            stream = Program(daemon, "/r/arm/command:i", "/ctl/command:o")
            for _ in range(2):
                stream.write(struct.pack("<ii", 4, 3) + b"set")
            until(lambda: "a command is two lists" in daemon.stderr())
            self.assertEqual(daemon.stderr().count("a command is two lists"), 1)

    def test_others_change_no_impedance(self):
        with Daemon(arm(), env=ENV) as daemon:
            daemon.text("/r/arm").must("claim")
            board = self.words(daemon, "/r/arm/rpc:i")
            for request in ("set iimp ipr 0 (2 0.2)", "set intm mode 0 stif", "set iimp iof 0 (1)"):
                self.assertIn("is driven by", board(request))

    def test_yarp_4_asks_by_its_own_calls(self):
        with Daemon(arm(), env=ENV) as daemon:
            board = Program(daemon, "/r/arm/nws/rpc:i", "/ctl/nwc/rpc:o")

            def call(size, name, *arguments):
                return board.ask(size, struct.pack("<ii", 4, len(name)) + name.encode(), *arguments)
            self.assertEqual(call(16, "getRemoteProtocolVersion"), struct.pack("<iihhhh", 256, 1, 0, 4, 0, 0))
            ok = struct.pack("<ii", 256, 1) + word("ok")
            self.assertEqual(call(32, "getAxesRPC"), struct.pack("<ii", 256, 2) + ok + struct.pack("<ii", 1, 2))
            move = struct.pack("<ii", 1, 0), struct.pack("<id", 20, 15.0)
            self.assertEqual(call(16, "positionMoveOneRPC", *move), ok)
            self.assertEqual(daemon.status()["step"], 1)
            target = call(36, "getTargetPositionOneRPC", struct.pack("<ii", 1, 0))
            self.assertEqual(target[:24], struct.pack("<ii", 256, 2) + ok)
            self.assertAlmostEqual(struct.unpack_from("<d", target, 28)[0], 15.0, delta=1e-9)

    def test_the_state_of_a_board_streams_in_the_layout_of_each_version(self):
        for version, fields, tag in ((3, 22, 10), (4, 24, 20)):
            with self.subTest(version), Daemon(arm(), env=ENV) as daemon:
                state = self.connect(daemon, "/r/arm/stateExt:o", Reader(daemon, version=version))
                head, payload = state.read_sample(ACK)
                self.assertEqual(head, "D 0 0.0")
                self.assertEqual(struct.unpack_from("<iiii", payload), (256, fields, 256 | tag, 2))
                daemon.text("/r/arm").must("set_velocities 0.2 0")
                head, payload = state.read_sample(ACK)
                self.assertEqual(head, "D 1 0.01")
                velocity, = struct.unpack_from("<d", payload, 8 + 32 + 8)
                self.assertAlmostEqual(velocity, math.degrees(0.2), delta=0.1)

    def test_readers_and_rubbish_change_nothing(self):
        hashes = []
        for beset in (False, True):
            with Daemon(arm(), env=ENV) as daemon:
                board = self.words(daemon, "/r/arm/rpc:i")
                readers = [self.connect(daemon, f"/r/arm/{port}", Reader(daemon, f"/{i}")) for i, port in
                           enumerate(("stateExt:o", "state:o", "measures:o")) if beset]  # of whom two never read
                for step in range(60):
                    self.assertEqual(board(f"set poss ({10 + step % 20} {-step})"), "[ok]")
                    if beset:
                        readers[0].read_sample(ACK)
                        board("set pos 0")
                        rubbish = daemon.keep(Connection(registration(daemon, ("/r/arm/command:i", "/r/arm/nws/rpc:i")[step % 2])))
                        rubbish.write(HEADER.pack(b"YA", 7777 + 3, b"RP") + struct.pack("<i", 3) + b"/x\0" + bytes(range(step, step + 90)))
                        rubbish.close()
                hashes.append(daemon.status()["hash"])
        self.assertEqual(hashes[0], hashes[1])

    def test_state_o_has_the_positions_alone(self):
        with Daemon(arm(), env=ENV) as daemon:
            daemon.text("/r/arm").must("set_positions_direct 0.1 0")
            positions = self.connect(daemon, "/r/arm/state:o", Reader(daemon)).read_sample(ACK)[1]
            expected = daemon.text("/r/arm").must("get_joints").data
            self.assertEqual(positions, numbers(math.degrees(1) * expected[0], math.degrees(1) * expected[3]))

    # --- sensors

    def sampler(self, extra=""):
        return Daemon(f"[SIMULATION]\nstep 0.01\n[ROBOT_1]\ntype sampler\nname r\nposition 0 0\n{extra}", "--paused", env=ENV)

    def test_an_imu_is_one_of_multiple_analog_sensors(self):
        with self.sampler() as daemon:
            self.assertIn('((imu imu ""))', self.words(daemon, "/r/imu/rpc:o")("getMetadata"))
            payload = self.connect(daemon, "/r/imu/measures:o", Reader(daemon)).read_sample(ACK)[1]
            kinds, gyroscopes = struct.unpack_from("<ii", payload)[1], struct.unpack_from("<ii", payload, 8)[1]
            self.assertEqual((kinds, gyroscopes), (12, 1))

    def test_a_lidar_sends_a_scan_to_who_connects_to_its_name(self):
        with self.sampler("[BOX_1]\ntype box\nposition 1 0 0.5\nsize 0.4 0.4 1\n") as daemon:
            payload = self.connect(daemon, "/r/lidar", Reader(daemon)).read_sample(ACK)[1]
            self.assertEqual(struct.unpack_from("<ii", payload), (256, 6))
            first, last = (struct.unpack_from("<d", payload, at)[0] for at in (12, 24))
            tag, count = struct.unpack_from("<ii", payload, 56)
            self.assertEqual((tag, count), (256 | 10, 36))
            self.assertGreater(last, first)
            ranges = struct.unpack_from("<36d", payload, 64)
            self.assertEqual(list(ranges), daemon.text("/r/lidar").must("get_scan").data[:-2])
            self.assertLess(min(ranges), 1)

    def test_a_lidar_answers_each_version_in_its_codes(self):
        for version, size, code in ((3, 40, struct.pack("<ii", 1, 0)), (4, 48, struct.pack("<ii", 256, 1) + word("ok"))):
            with self.subTest(version), self.sampler() as daemon:
                peer = Reader(daemon, "/ctl/rpc:o", version)
                program = Program(daemon, "/r/lidar/rpc:i", "/ctl/rpc:o", peer)
                reply = program.ask(size, struct.pack("<ii13s", 4, 13, b"getScanLimits"), word("RPC"))
                self.assertEqual(reply[:8 + len(code)], struct.pack("<ii", 256, 3) + code)

    def test_a_camera_sends_a_picture_for_each_step_that_its_reader_takes(self):
        text = "[SIMULATION]\nmode lockstep\nstep 0.1\n[ROBOT_1]\ntype coopbot_camera\nname r\nposition 0 0\n"
        with Daemon(text) as daemon:
            width, height = (int(n) for n in daemon.text("/r/camera").must("get_camera").data[:2])
            self.assertTrue(self.words(daemon, "/r/camera/rpc")("visr get res").endswith(f"{width} {height}"))
            picture, motors = self.connect(daemon, "/r/camera", Reader(daemon)), daemon.text("/r/motors")
            row = (3 * width + 7) // 8 * 8
            for step in range(3):
                head, payload = picture.read_sample(ACK)
                self.assertEqual(head.split()[:2], ["D", str(step)])
                self.assertEqual(len(payload), 60 + row * height)
                self.assertEqual(struct.unpack_from("<ii4s", payload, 8), (VOCAB, int.from_bytes(b"mat\0", "little"), struct.pack("<i", VOCAB)))
                self.assertEqual(struct.unpack_from("<ii", payload, 44), (width, height))
                motors.must("set_velocity 0.1 0")

    def test_a_camera_is_an_rgbd_sensor_of_both_versions(self):
        text = "[SIMULATION]\nmode lockstep\nstep 0.1\n[ROBOT_1]\ntype coopbot_camera\nname r\nposition 0 0\n"
        with Daemon(text) as daemon:
            camera = daemon.text("/r/camera").must("get_camera").data
            width, height = int(camera[0]), int(camera[1])
            ask = self.words(daemon, "/r/camera/rpc:i")
            self.assertEqual(ask("[rgdb] [get] [prot]"), "[rgdb] [prot] [is] 1 0")
            self.assertEqual([float(n) for n in ask("[visd] [get] [clip]").split()[3:]], camera[6:8])
            program = Program(daemon, "/r/camera/rpc:i", "/ctl/rpc:o", Reader(daemon, "/ctl/rpc:o", 4))
            name = b"getDepthResolutionRPC"
            ok = struct.pack("<ii", 256, 1) + word("ok")
            self.assertEqual(program.ask(40, struct.pack("<ii", 4, len(name)) + name),
                             struct.pack("<ii", 256, 3) + ok + struct.pack("<iiii", 1, width, 1, height))
            colours = self.connect(daemon, "/r/camera/rgbImage:o", Reader(daemon, "/colours"))
            distances = self.connect(daemon, "/r/camera/depthImage:o", Reader(daemon, "/distances"))
            motors = daemon.text("/r/motors")
            for step in range(3):
                (colour_head, colour), (depth_head, depth) = colours.read_sample(ACK), distances.read_sample(ACK)
                self.assertEqual(colour_head, depth_head)
                self.assertEqual(colour_head.split()[1], str(step))
                self.assertEqual((colour[20:24], depth[20:24]), (b"rgb\0", b"dec\0"))
                self.assertEqual(len(depth), 60 + (4 * width + 7) // 8 * 8 * height)
                motors.must("set_velocity 0.1 0")

    def test_a_battery_sends_its_charge(self):
        text = "[SIMULATION]\nmode lockstep\nstep 0.1\n[ROBOT_1]\ntype turtle\nname r\nposition 0 0\n"
        with Daemon(text) as daemon:
            data = self.connect(daemon, "/r/battery/data:o", Reader(daemon))
            energy, fraction, power = daemon.text("/r/battery").must("get_battery").data[:3]
            head, payload = data.read_sample(ACK)
            self.assertEqual(head, "D 0 0.0")
            self.assertEqual(len(payload), 8 + 4 * 12 + 8)
            self.assertEqual(payload[:20], struct.pack("<iiid", 256, 5, 10, 100 * fraction))
            self.assertEqual([math.isnan(struct.unpack_from("<d", payload, at)[0]) for at in (24, 36, 48)], 3 * [True])
            self.assertEqual(struct.unpack_from("<ii", payload, 56), (1, 2))  # it is in use
            daemon.text("/r/motors").must("set_velocity 0.1 0")
            self.assertLess(struct.unpack_from("<d", data.read_sample(ACK)[1], 12)[0], 100 * fraction)
            self.assertEqual(self.words(daemon, "/r/battery/rpc:i")("getBatteryInfoRPC"), '0 "a battery of coopdyn"')

    # --- the drive, the world, time

    def test_a_base_takes_the_commands_of_base_control(self):
        with Daemon(scenario(1)) as daemon:
            base = self.words(daemon, "/robot1/base/command:i")
            for command in ("3 0.2 0 20 100", "2 0 0.2 20 100"):
                for _ in range(100):  # it gains speed
                    self.assertEqual(base(command), "[ok]")
                speeds = daemon.text("/robot1/pose").must("get_pose").data[3:5]
                self.assertAlmostEqual(speeds[0], 0.2, delta=0.02)
                self.assertAlmostEqual(speeds[1], math.radians(20), delta=0.05)
            self.assertIn("3 FORWARD SIDEWAYS TURN GAIN", base("9 1 2 3 4"))

    def test_the_world_interface_makes_and_moves_things(self):
        with Daemon(scenario(1)) as daemon:
            world = self.words(daemon, "/world_input_port")
            name = world("makeBox 0.2 0.2 0.2 1.0 0.5 0.1 0 0 0 255 0 0")
            self.assertIn(name, daemon.text("/world").must("list").text)
            self.assertEqual(world(f"setPose {name} 2.0 0.5 0.1 0 0 0"), "[ok]")
            x = float(world(f"getPose {name}").split()[0])
            self.assertAlmostEqual(x, 2.0, delta=1e-9)
            self.assertEqual(world(f"deleteObject {name}"), "[ok]")
            self.assertNotIn(name, daemon.text("/world").must("list").text)

    def test_lockstep_waits_for_a_named_program_that_reads(self):
        text = scenario(1, robot_extra={1: "sync no"}).replace("step 0.01", "step 0.01\nwaits_for yarp /ctl")
        with Daemon(text) as daemon:
            self.assertIn("it reads none of our ports", str(daemon.status()["awaiting"]))
            pose = self.connect(daemon, "/robot1/pose/state:o", Reader(daemon, "/ctl/pose:i"))
            for step in range(5):
                self.assertEqual(pose.read_sample()[0], f"D {step} {step * 0.01:.6g}" if step else "D 0 0.0")
                self.assertEqual(daemon.status()["step"], step)
                pose.write(ACK)
            pose.read_sample()
            pose.close()
            self.assertEqual(daemon.status()["step"], 5)


if __name__ == "__main__":
    unittest.main()
