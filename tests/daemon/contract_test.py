"""Clauses of the contract that no other file here tests: names and ports, the text form, speeds, deadlines, status."""
import re
import subprocess
import unittest

from harness import BINARY, Daemon, scenario, until


def one_line(text):
    return text.replace("\n", "\\n")


class NameTest(unittest.TestCase):
    END = b"*** end of message\r\n"

    def ask(self, daemon, line):
        """The name server's complete answer to a request."""
        connection = daemon.raw()
        connection.write(line + "\n")
        answer = b""
        while not answer.endswith(self.END):
            answer += connection.read_exactly(1)
        connection.close()
        return answer.decode()

    def test_a_query_gives_the_registration_and_an_unknown_name_the_end_line_alone(self):
        with Daemon(scenario(1)) as daemon:
            for line in ("NAME_SERVER query /robot1/motors", "query /robot1/motors", "NAME_SERVER query /robot1/motors\r"):
                self.assertRegex(self.ask(daemon, line),
                                 r"^registration name /robot1/motors ip 127\.0\.0\.1 port [1-9]\d* type tcp\r\n\*\*\* end of message\r\n$")
            self.assertEqual(self.ask(daemon, "NAME_SERVER query /nobody").encode(), self.END)

    def test_names_come_and_go_but_those_of_the_daemon_stay(self):
        with Daemon(scenario(1)) as daemon:
            registration = "registration name /tracker/out ip 127.0.0.1 port 5555 type tcp\r\n"
            self.assertIn(registration, self.ask(daemon, "NAME_SERVER register /tracker/out tcp 127.0.0.1 5555"))
            self.assertIn("*** refused", self.ask(daemon, "NAME_SERVER register /tracker/out tcp 127.0.0.1 5556"))
            self.assertIn(registration, self.ask(daemon, "list"))
            self.assertEqual(self.ask(daemon, "NAME_SERVER unregister /tracker/out").encode(), self.END)
            self.assertEqual(self.ask(daemon, "query /tracker/out").encode(), self.END)
            before = self.ask(daemon, "list")
            self.assertIn("*** refused", self.ask(daemon, "NAME_SERVER register /robot1/motors tcp 127.0.0.1 5555"))
            self.assertIn("*** refused", self.ask(daemon, "NAME_SERVER unregister /robot1/motors"))
            self.assertEqual(self.ask(daemon, "list"), before)

    def test_a_load_keeps_the_ports_of_robots_that_stay_and_frees_those_of_the_others(self):
        with Daemon(scenario(2)) as daemon:
            kept, simulation = daemon.module_port("/robot1/motors"), daemon.module_port("/simulation")
            text = one_line(scenario(2).replace("robot2", "zed"))
            daemon.text("/simulation").must(f'load_scenario "{text}"')
            self.assertEqual(daemon.module_port("/robot1/motors"), kept)
            self.assertEqual(daemon.module_port("/simulation"), simulation)
            self.assertEqual(self.ask(daemon, "query /robot2/motors").encode(), self.END)
            daemon.text("/zed/motors", direct=True).must("get_limits")

    def test_a_robot_without_sockets_is_listed_with_port_0_and_reached_by_open(self):
        with Daemon(scenario(1, robot_extra={1: "sockets no"})) as daemon:
            self.assertEqual(daemon.module_port("/robot1/motors"), 0)
            daemon.text("/robot1/motors").must("set_velocity 0.1 0")


class TextTest(unittest.TestCase):
    CASES = (  # line, error, command
        ("set_velocity 0.1 0", 0, 11), ("set_velocity (2) .1 0.", 0, 11), ('0 "" 11 0 2 +1e-1 -.5', 0, 11), ("ready 2", 0, 2),
        ("ping (1 -2) inf NaN", 0, 0), ("  get_limits  ", 0, 13), ("subscribe 5 get_wheels", 0, 4), ("unsubscribe", 0, 5),
        ("set_velocty 1 1", 1, -2), ('0 "" 999 0 0', 1, 999), ("set_velocity (1 2) 0 0", 2, 11), ("describe 1", 2, 1),
        ("get_limits 1", 2, 13), ("set_velocity 1", 3, 11), ("set_velocity 1 2 3", 3, 11), ("set_velocity nan 0", 4, 11),
        ("set_velocity 0 -inf", 4, 11), ("ready 0", 4, 2), ("set_velocity (-1) 0 0", 4, 11), ("set_velocity 0,2 0,5", 7, -2),
        ("set_velocity (1.5) 0 0", 7, -2), ("ready 2.0", 7, -2), ("ready 99999999999", 7, -2), ('0 "" 11 0 2 1 2 3', 7, -2),
        ('0 "" 11 0 3 1 2', 7, -2), ('0 "" 12 -1 0', 7, -2), ('0 "\\x" 12 0 0', 7, -2), ("attach nothing", 10, 9))

    def test_each_line_gets_its_error_and_command(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            motors = daemon.text("/robot1/motors")
            for line, error, command in self.CASES:
                reply = motors.ask(line)
                self.assertEqual((reply.error, reply.command), (error, command), f"{line}: {reply}")
                if error:
                    self.assertEqual((reply.params, reply.data), ([], []), line)
                    self.assertTrue(reply.text, line)

    def test_a_decimal_comma_is_told_what_to_write(self):
        with Daemon(scenario(1)) as daemon:
            self.assertIn("write 0.5", daemon.text("/robot1/motors").ask("set_velocity 0,5 0").text)

    def test_telnet_negotiation_is_skipped_and_backspace_works(self):
        with Daemon(scenario(1)) as daemon:
            for direct in (False, True):
                motors = daemon.text("/robot1/motors", direct)
                motors.write(b"\xff\xfb\x01\xff\xfd\x03get_limixx\x08\x7fts\r\n")
                self.assertEqual((lambda reply: (reply.error, reply.command))(motors.receive()), (0, 13))

    def test_commands_beyond_the_limit_are_scaled_with_their_curvature(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            limit, radius, track = motors.must("get_limits").data[:3]
            reply = motors.must("set_velocity 4 10")
            fastest = (4 + 10 * track / 2) / radius
            said = re.fullmatch(r"limited to (\S+) m/s (\S+) rad/s", reply.text)
            self.assertTrue(said, reply)
            self.assertAlmostEqual(float(said.group(1)), 4 * limit / fastest, places=3)
            self.assertAlmostEqual(float(said.group(2)), 10 * limit / fastest, places=3)
            self.assertEqual(motors.must("set_velocity 0.2 0.1").text, "")

    def test_verbose_says_whom_it_waits_for(self):
        with Daemon(scenario(2)) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.write("verbose\nset_velocity 0.1 0\n")
            until(lambda: re.match(r"# waiting for robot2 \(no client\), \d+\.\d s", motors.read_line()))


class TimeTest(unittest.TestCase):
    def test_the_same_commands_in_the_same_steps_give_the_same_hashes_in_every_mode(self):
        hashes = []
        for mode in ("lockstep", "realtime", "free"):
            with Daemon(scenario(1, mode=mode), "--paused") as daemon:
                motors = daemon.text("/robot1/motors")
                motors.send("set_velocity (20) 0.3 0.5")
                until(lambda: daemon.status()["robots"][0]["owner"])
                self.assertFalse(motors.has_bytes())
                daemon.text("/simulation").must("step 20")
                self.assertEqual(motors.receive().step, 20)
                hashes.append(daemon.status()["hash"])
        self.assertEqual(len(set(hashes)), 1, hashes)

    def test_a_speed_holds_for_the_mode_in_which_it_was_set(self):
        with Daemon(scenario(1, mode="realtime"), "--speed", "3") as daemon:
            simulation = daemon.text("/simulation")

            def speed_in(mode):
                simulation.must(f"set_mode {mode}")
                return daemon.status()["speed"]

            self.assertEqual([speed_in(mode) for mode in ("realtime", "lockstep", "free")], [3, None, None])
            simulation.must("set_speed 2")
            self.assertEqual([speed_in(mode) for mode in ("lockstep", "realtime", "free")], [None, 3, 2])

    def test_a_reset_keeps_mode_step_speed_pause_and_participants(self):
        with Daemon(scenario(2)) as daemon:
            simulation = daemon.text("/simulation")
            for line in ("set_step 0.02", "set_speed 0.5", "set_participants robot2", "pause", "reset 7"):
                simulation.must(line)
            status = daemon.status()
            self.assertEqual([status[key] for key in ("mode", "step_s", "speed", "state", "seed", "step", "time_s", "revision")],
                             ["lockstep", 0.02, 0.5, "paused", 7, 0, 0, 0])
            simulation.must("run")
            daemon.text("/robot2/motors").must("ready")  # robot1 is still no participant

    def test_steps_out_of_range_are_refused_with_the_reason(self):
        with Daemon(scenario(1)) as daemon:
            simulation = daemon.text("/simulation")
            for step in ("0.0004", "0.11", "0.0100005", "nan", "-1"):
                reply = simulation.ask(f"set_step {step}")
                self.assertEqual((reply.error, bool(reply.text)), (4, True), step)
            self.assertEqual(daemon.status()["step_s"], 0.01)

    def test_time_counts_each_step_with_the_length_it_had(self):
        with Daemon(scenario(1)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            for step in (0.01, 0.0005, 0.1):
                simulation.must(f"set_step {step}")
                reply = motors.must("ready")
            self.assertEqual(reply.time_s, 110500000 / 1e9)
            self.assertEqual(reply.step, 3)


class ReadinessTest(unittest.TestCase):
    def test_a_stopped_or_dropped_robot_is_back_with_its_next_command(self):
        for what in ("stop", "drop"):
            with Daemon(scenario(2, robot_extra={1: f"deadline 0.2\non_deadline {what}"})) as daemon:
                slow, other = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
                slow.send("set_velocity 0.3 0")
                until(lambda: daemon.status()["robots"][0]["owner"])  # it has arrived, possibly after its deadline
                other.must("ready")
                slow.receive()
                other.must("ready 30")  # the deadline fires once, not in each step
                left, right = slow.must("get_wheels").data[2:4]
                self.assertLess(max(abs(left), abs(right)), 1e-6, what)
                self.assertEqual(daemon.awaited(), ["robot2"])
                slow.must("hello ana")
                slow.send("set_velocity 0.3 0")
                until(lambda: slow.has_bytes() or not other.must("ready"))  # it may come after some steps of the other
                self.assertEqual(slow.receive().error, 0)
                self.assertGreater(sum(slow.must("get_wheels").data[:2]), 0)

    def test_requests_of_a_half_closed_connection_end_with_the_next_owner(self):
        with Daemon(scenario(1)) as daemon:
            simulation = daemon.text("/simulation")
            simulation.must("pause")
            gone, heir = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            gone.write("set_velocity 0.5 0\nset_velocity 0.5 0\nget_limits\n")
            gone.socket.shutdown(1)
            until(lambda: not daemon.awaited())
            until(lambda: daemon.status()["robots"][0]["owner"] is None)
            heir.send("stop")
            self.assertEqual([gone.receive().error for _ in range(3)], [6, 6, 0])
            self.assertEqual(gone.read_to_end(), b"")
            simulation.must("run")
            self.assertEqual(heir.receive().step, 1)
            self.assertLess(abs(heir.must("get_wheels").data[0]), 1e-9)

    def test_a_waiting_rest_of_n_steps_is_gone_after_stop_all_but_still_answered_in_its_step(self):
        with Daemon(scenario(1)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            simulation.must("pause")
            motors.send("set_velocity (10) 0.5 0")
            until(lambda: not daemon.awaited())
            simulation.must("step 5")
            simulation.must("stop_all")
            simulation.must("step 5")
            self.assertEqual(motors.receive().step, 10)
            self.assertLess(abs(motors.must("get_wheels").data[2]), 1e-6)


class StatusTest(unittest.TestCase):
    KEYS = ("version protocol scenario seed mode state step revision time_s step_s speed rtf hash robots clients awaiting "
            "awaiting_count frozen recording http events").split()

    def test_the_status_has_every_key_and_lists_of_equal_keys(self):
        with Daemon(scenario(2)) as daemon:
            daemon.text("/robot1/motors").must("hello ana")
            daemon.text("/robot2/pose").must("get_pose")
            status = daemon.status()
            self.assertEqual([key for key in self.KEYS if key not in status], [])
            for name in ("robots", "clients", "awaiting", "events"):
                self.assertLessEqual(len({tuple(entry) for entry in status[name]}), 1, name)
            self.assertRegex(status["hash"], "^[0-9a-f]{16}$")

    def test_many_robots_are_told_in_parts(self):
        text = "[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 60 60\n[SWARM_1]\ntype coopbot\nname ant\ncount 300\n"
        with Daemon(text) as daemon:
            status = daemon.status()
            self.assertEqual([len(status["robots"]), len(status["awaiting"]), status["awaiting_count"]], [256, 20, 300])
            reply = daemon.text("/simulation").must("get_status 299 5")
            self.assertEqual(re.findall(r'"name":"(ant_\d+)"', reply.text), ["ant_299", "ant_300"])


class CommandLineTest(unittest.TestCase):
    def test_values_that_make_no_sense_are_wrong_use(self):
        for words in (["--step", "0.2"], ["--step", "10ms"], ["--duration", "-1"], ["--mode", "fast"], ["--port", "70000"]):
            done = subprocess.run([BINARY, "serve", "empty", "--port", "0", "--no-http", *words], capture_output=True, timeout=100)
            self.assertEqual((done.returncode, done.stdout), (2, b""), words)
            self.assertEqual(done.stderr.count(b"\n"), 1, done.stderr)

    def test_numbers_that_are_none_or_too_large_are_wrong_use(self):
        serve = ("serve", "empty", "--port", "0")
        for words in ((*serve, "--duration", "9.3e9"), (*serve, "--duration", "inf"), (*serve, "--record-every", "1e30"),
                      (*serve, "--render-fps", "nan"), (*serve, "--speed", "nan"), ("play", "x.run", "--at", "1e30")):
            done = subprocess.run([BINARY, *words], capture_output=True, timeout=100)
            self.assertEqual((done.returncode, done.stdout), (2, b""), words)
            self.assertRegex(done.stderr, rb"\A.*%s must be .*, not %s.*\n\Z" % (words[-2].encode(), words[-1].encode()))

    def test_a_duration_has_the_bound_of_a_scenario(self):
        done = subprocess.run([BINARY, "serve", "empty", "--duration", "1e11"], capture_output=True, timeout=100)
        self.assertIn(b"must be at most 1000000000, not 1e11", done.stderr)


if __name__ == "__main__":
    unittest.main()
