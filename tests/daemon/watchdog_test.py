"""A connected but silent client in real time: the status reports how long, and the robot's watchdog stops the robot."""
import re
import time
import unittest

from harness import Daemon, scenario, until
from recording import RecordingTestCase, equal_steps, rows, tool


def real_time(watchdog, robots=1, extra=""):
    """A scenario whose [SIMULATION] has this watchdog; none if it is empty."""
    text = scenario(robots, mode="realtime", extra=extra)
    return text.replace("[SIMULATION]\n", f"[SIMULATION]\nwatchdog {watchdog}\n") if watchdog else text


def speeds(daemon, name="robot1"):
    return daemon.text(f"/{name}/motors").must("get_wheels").data[2:4]


def drives(daemon, name="robot1"):
    return min(speeds(daemon, name)) > 1


def stands(daemon, name="robot1"):
    return max(map(abs, speeds(daemon, name))) < 1e-3


def robot(daemon, index=0):
    return daemon.status()["robots"][index]


def let_pass(daemon, seconds):
    """Waits for `seconds` of simulated time."""
    begin = daemon.status()["time_s"]
    until(lambda: daemon.status()["time_s"] > begin + seconds)


class WatchdogTest(unittest.TestCase):
    def drive(self, daemon, name="ana", module="/robot1/motors", command="set_velocity 0.2 0"):
        client = daemon.text(module)
        client.must(f"hello {name}")
        client.must(command)
        return client

    def keep_talking(self, daemon, talk):
        """Calls `talk`, which returns the simulated time, for longer than the silence that a watchdog of 1 s allows. If the robot is
        stopped anyway, this machine has delayed us."""
        begin, longest, last = talk(), 0, time.monotonic()
        while talk() < begin + 1.5:
            longest, last = max(longest, time.monotonic() - last), time.monotonic()
        if robot(daemon)["watchdog_stopped"]:
            self.assertGreater(max(longest, time.monotonic() - last), 0.9)

    def test_a_silent_client_loses_no_robot_but_the_robot_stops_until_its_next_command(self):
        with Daemon(real_time("0.5s")) as daemon:
            client = self.drive(daemon)
            until(lambda: robot(daemon)["watchdog_stopped"])
            until(lambda: stands(daemon))
            told = robot(daemon)
            self.assertEqual(told["owner"], "ana")
            self.assertGreaterEqual(told["silent_s"], 0.5)
            events = [event["text"] for event in daemon.status()["events"]]
            self.assertEqual(sum(re.match(r"ana has been silent for \d+\.\d s: robot1 is stopped until its next command", text)
                                 is not None for text in events), 1, events)
            until(lambda: re.search(r"driven by ana, silent for \d+ s, stopped until its next command\n",
                                    tool("status", "--server", "%s:%d" % daemon.names)[1]))
            until(lambda: client.must("set_velocity (20) 0.2 0") and drives(daemon))
            until(lambda: "ana has been silent for " in daemon.stderr())

    def test_off_it_drives_on_and_so_it_does_by_default_on_this_machine(self):
        for watchdog, seconds in (("", 5.5), ("off", 1)):
            with self.subTest(watchdog), Daemon(real_time(watchdog)) as daemon:
                self.drive(daemon)
                until(lambda: (robot(daemon)["silent_s"] or 0) > seconds)
                self.assertTrue(drives(daemon))
                self.assertFalse(robot(daemon)["watchdog_stopped"])

    def test_a_robots_own_word_counts_before_that_of_all(self):
        text = real_time("0.5s", 2).replace("name robot2\n", "name robot2\nwatchdog off\n")
        with Daemon(text) as daemon:
            for name in ("robot1", "robot2"):
                self.drive(daemon, module=f"/{name}/motors")
            until(lambda: robot(daemon)["watchdog_stopped"])
            let_pass(daemon, 1)
            self.assertTrue(stands(daemon) and drives(daemon, "robot2"))

    def test_whatever_its_program_says_on_the_robots_sockets_is_a_sign_of_life(self):
        with Daemon(real_time("1s")) as daemon:
            client = self.drive(daemon)
            reader = daemon.text("/robot1/pose")
            reader.must("hello ana:reader")
            for talks in (client, reader):
                client.must("set_velocity 0.2 0")
                self.keep_talking(daemon, lambda: talks.must("get_time").time_s)
            stranger = daemon.text("/robot1/pose")
            stranger.must("hello bob")
            until(lambda: stranger.must("get_pose") and robot(daemon)["watchdog_stopped"])

    def test_who_waits_for_the_end_of_its_command_is_not_silent(self):
        with Daemon(real_time("0.5s")) as daemon:
            reply = self.drive(daemon, command="hello ana").must("set_velocity (150) 0.2 0")
            until(lambda: robot(daemon)["watchdog_stopped"])
            silences = [event["step"] for event in daemon.status()["events"] if "silent" in event["text"]]
            self.assertGreaterEqual(min(silences), reply.step)

    def test_a_team_stops_and_drives_on(self):
        with Daemon(real_time("0.5s", 2)) as daemon:
            team = self.drive(daemon, "ana", "/swarm", "claim robot1 robot2")
            team.must("step_all 0.2 0 0.2 0")
            for index, name in enumerate(("robot1", "robot2")):
                until(lambda: robot(daemon, index)["watchdog_stopped"])
                until(lambda: stands(daemon, name))
            until(lambda: team.must("step_all 0.2 0 0.2 0") and drives(daemon))

    def test_a_stream_of_yarp_is_its_own_sign_of_life(self):
        with Daemon(real_time("1s")) as daemon:
            stream = daemon.raw("/robot1/motors")
            stream.write("CONNECT me\r\n")
            stream.read_line()

            def drive():
                stream.write("d\r\nset_velocity 0.2 0\r\n")
                return float(stream.read_line().split()[2])

            drive()
            self.keep_talking(daemon, drive)
            until(lambda: robot(daemon)["watchdog_stopped"])

    def test_in_lockstep_it_never_bites(self):
        with Daemon(real_time("0.1s").replace("mode realtime", "mode lockstep")) as daemon:
            client = self.drive(daemon)
            until(lambda: daemon.status()["awaiting"][0]["seconds"] > 0.5)
            self.assertIsNone(robot(daemon)["silent_s"])
            client.must("ready")
            self.assertFalse(any("silent" in event["text"] for event in daemon.status()["events"]))

    def test_set_changes_it_while_the_run_goes_on(self):
        with Daemon(real_time("off")) as daemon:
            self.drive(daemon)
            for change in ("watchdog 0.5s", "color red"):
                daemon.text("/world").must(f"set robot1 {change}")
            until(lambda: robot(daemon)["watchdog_stopped"])


class RecordedTest(RecordingTestCase):
    def test_the_stop_is_an_input_that_verify_repeats(self):
        with Daemon(real_time("off"), "--record", self.file) as daemon:
            daemon.text("/world").must("set robot1 watchdog 0.5s")
            client = daemon.text("/robot1/motors")
            client.must("set_velocity 0.2 0.5")
            until(lambda: robot(daemon)["watchdog_stopped"])
            until(lambda: stands(daemon))
            client.must("set_velocity (20) 0.2 0")
        self.assertGreater(equal_steps(self.file), 70)
        stops = rows(self.file, "SELECT detail FROM input WHERE action = 'disconnect'")
        self.assertEqual(set(stops), {("robot1 stop",)})


if __name__ == "__main__":
    unittest.main()
