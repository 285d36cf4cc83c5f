"""The lockstep contract, clause by clause, over raw sockets."""
import json
import math
import os
import random
import signal
import subprocess
import sys
import threading
import unittest

from harness import BINARY, Connection, Daemon, Text, scenario, until


def drive(connection, commands, delays):
    """Sends each command, waits for its reply, now and then after a random pause; returns the steps of the replies."""
    steps = []
    for (left, right), delay in zip(commands, delays):
        threading.Event().wait(delay)  # a client that thinks
        reply = connection.must(f"set_wheel_speeds {left!r} {right!r}")
        steps.append(reply.step)
    return steps


class DeterminismTest(unittest.TestCase):
    STEPS = 40

    def hashes_of_a_run(self, seed, spectators):
        """Two robots with fixed commands; arrival order, delays and spectators differ by `seed`."""
        chance = random.Random(seed)
        fixed = random.Random(42)
        commands = [[(fixed.uniform(-5, 5), fixed.uniform(-5, 5)) for _ in range(self.STEPS)] for _ in range(2)]
        with Daemon(scenario(2, extra="[BOX_1]\ntype box\nsize 0.3 0.3 0.3\nposition 0.9 0.1\nmass 1\n")) as daemon:
            simulation = daemon.text("/simulation")
            stop = threading.Event()
            watchers = []
            if spectators:
                def watch():
                    poses = daemon.text("/robot1/pose")
                    poses.must("subscribe")
                    distances = daemon.text("/robot2/distance")
                    while not stop.is_set():
                        distances.must("get_distances")
                        poses.receive()
                watchers.append(threading.Thread(target=watch, daemon=True))
            for watcher in watchers:
                watcher.start()
            robots = [daemon.text(f"/robot{i}/motors") for i in (1, 2)]
            results = [None, None]

            def run(i):
                delays = [chance.choice((0, 0, 0, 0.002)) for _ in range(self.STEPS)]
                results[i] = drive(robots[i], commands[i], delays)

            order = [0, 1]
            chance.shuffle(order)
            threads = [threading.Thread(target=run, args=(i,)) for i in order]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            stop.set()
            self.assertEqual(results, [list(range(1, self.STEPS + 1))] * 2)
            return json.loads(simulation.must("get_status").text)["hash"]

    def test_ten_runs_with_random_arrival_and_spectators_give_the_same_hash(self):
        hashes = {self.hashes_of_a_run(seed, spectators=seed % 2 == 1) for seed in range(10)}
        self.assertEqual(len(hashes), 1, hashes)


class StepTest(unittest.TestCase):
    def test_a_reply_comes_after_its_step_with_right_time_and_step(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            for k in range(1, 21):
                reply = motors.must("set_velocity 0.2 0")
                self.assertEqual(reply.params, [1])
                self.assertEqual(reply.step, k)
                self.assertEqual(reply.time_s, (k * 10_000_000) * 1e-9)

    def test_nothing_moves_until_every_participant_is_ready(self):
        with Daemon(scenario(2)) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            one.send("set_velocity 0.2 0")
            awaiting = until(lambda: [a for a in daemon.status()["awaiting"] if a["robot"] == "robot2"])
            self.assertEqual(awaiting[0]["why"], "no client")
            self.assertEqual(daemon.status()["state"], "waiting")
            self.assertFalse(one.has_bytes())
            self.assertEqual(two.must("ready").step, 1)
            self.assertEqual(one.receive().step, 1)

    def test_the_next_readings_are_those_of_the_new_step(self):
        with Daemon(scenario(1)) as daemon:
            motors, pose = daemon.text("/robot1/motors"), daemon.text("/robot1/pose")
            for k in range(1, 30):
                motors.must("set_velocity 0.3 0")
                self.assertEqual(pose.must("get_pose").step, k)

    def test_pipelined_commands_belong_to_successive_steps(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.write("".join(f"set_wheel_speeds {k} {k}\n" for k in range(1, 9)))
            self.assertEqual([motors.receive().step for _ in range(8)], list(range(1, 9)))

    def test_a_command_for_ten_steps_is_answered_after_the_tenth(self):
        with Daemon(scenario(2)) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            one.send("set_velocity (10) 0.2 0")
            for k in range(1, 10):
                self.assertEqual(two.must("set_velocity 0.1 0").step, k)
                self.assertFalse(one.has_bytes())
            two.send("ready")
            self.assertEqual(one.receive().step, 10)
            self.assertEqual(two.receive().step, 10)

    def test_ready_keeps_the_set_points(self):
        with Daemon(scenario(1)) as daemon:
            motors, pose = daemon.text("/robot1/motors"), daemon.text("/robot1/pose")
            motors.must("set_velocity 0.3 0")
            motors.must("ready 100")
            self.assertGreater(pose.must("get_pose").data[0], 0.2)

    def test_a_spectators_ready_waits_but_makes_nobody_ready(self):
        with Daemon(scenario(1)) as daemon:
            spectator, motors = daemon.text("/robot1/pose"), daemon.text("/robot1/motors")
            on_simulation = daemon.text("/simulation")
            spectator.send("ready")
            on_simulation.send("ready 2")
            until(lambda: daemon.status()["awaiting_count"] == 1)
            self.assertFalse(spectator.has_bytes())
            motors.must("ready")
            self.assertEqual(spectator.receive().step, 1)
            motors.must("ready")
            self.assertEqual(on_simulation.receive().step, 2)

    def test_an_error_reply_does_not_make_ready(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            self.assertEqual(motors.ask("set_velocity 0.2").error, 3)
            self.assertEqual(motors.ask("set_velocity nan 0").error, 4)
            self.assertEqual(daemon.status()["step"], 0)
            self.assertEqual(motors.must("set_velocity 0.2 0").step, 1)

    def test_sync_no_is_not_waited_for(self):
        with Daemon(scenario(2, robot_extra={2: "sync no"})) as daemon:
            self.assertEqual(daemon.text("/robot1/motors").must("ready").step, 1)

    def test_set_participants_changes_whom_the_world_waits_for(self):
        with Daemon(scenario(2)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            simulation.must("set_participants robot1")
            self.assertEqual(motors.must("ready").step, 1)
            self.assertEqual(simulation.ask("set_participants robot7").error, 10)
            simulation.must("set_participants")
            motors.send("ready")
            until(lambda: daemon.status()["awaiting_count"] == 1)

    def test_attached_readings_are_of_the_frame_of_the_reply(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            distance, pose = daemon.text("/robot1/distance"), daemon.text("/robot1/pose")
            motors.must("attach distance pose")
            for k in range(1, 11):
                reply = motors.must("set_velocity 0.3 0.2")
                lengths = reply.params[1:]
                self.assertEqual(reply.params[0], 1)
                self.assertEqual(lengths, [11, 5])
                self.assertEqual(len(reply.data), sum(lengths) + 2)
                self.assertEqual(reply.data[:11], distance.must("get_distances").data[:11])
                self.assertEqual(reply.data[11:16], pose.must("get_pose").data[:5])
                self.assertEqual(reply.step, k)

    def test_subscribed_readings_precede_the_reply_of_their_step(self):
        with Daemon(scenario(1)) as daemon:
            motors = daemon.text("/robot1/motors")
            motors.must("subscribe")
            for k in range(1, 20):
                motors.send("set_wheel_speeds 1 1")
                push = motors.receive()
                self.assertEqual((push.command, push.step), (-12, k))
                self.assertEqual((motors.receive().command), 10)

    def test_two_identical_runs_differ_only_if_the_commands_do(self):
        hashes = []
        for speed in ("1", "1", "1.0000000000000002"):
            with Daemon(scenario(1)) as daemon:
                daemon.text("/robot1/motors").must(f"set_wheel_speeds (50) {speed} 1")
                hashes.append(daemon.status()["hash"])
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])


CLIENT = """
import socket, sys
s = socket.create_connection((sys.argv[1], int(sys.argv[2])))
f = s.makefile("rw", newline="\\n")
def ask(line):
    f.write(line + "\\n"); f.flush(); return f.readline()
assert ask("OPEN " + sys.argv[3]) == "ok\\n"
print(ask("claim"), end="", flush=True)
while True:
    ask("set_velocity 0.1 0")
"""


def start_client(daemon, module):
    """A client in a process of its own that commands for ever; returns once it owns the module."""
    process = subprocess.Popen([sys.executable, "-c", CLIENT, daemon.names[0], str(daemon.names[1]), module],
                               stdout=subprocess.PIPE)
    assert process.stdout.readline().startswith(b"0 ")
    return process


class LostClientTest(unittest.TestCase):
    def test_a_stopped_client_stalls_the_world_and_is_named(self):
        with Daemon(scenario(2)) as daemon:
            client = start_client(daemon, "/robot2/motors")
            try:
                motors = daemon.text("/robot1/motors")
                motors.must("ready 5")
                client.send_signal(signal.SIGSTOP)
                motors.send("ready 100000")
                awaiting = until(lambda: [a for a in daemon.status()["awaiting"] if a["seconds"] > 0.2])
                self.assertEqual([a["robot"] for a in awaiting], ["robot2"])
                self.assertIn("no command from", awaiting[0]["why"])
                step = daemon.status()["step"]
                self.assertEqual(daemon.status()["step"], step)
                client.send_signal(signal.SIGCONT)
                until(lambda: daemon.status()["step"] > step)
            finally:
                client.kill()
                client.wait()
                client.stdout.close()

    def test_with_a_deadline_and_hold_the_others_go_on(self):
        text = scenario(2, robot_extra={2: "deadline 0.2\non_deadline hold"})
        with Daemon(text) as daemon:
            client = start_client(daemon, "/robot2/motors")
            try:
                motors = daemon.text("/robot1/motors")
                motors.must("ready 5")
                client.send_signal(signal.SIGSTOP)
                self.assertGreaterEqual(motors.must("ready 300").step, 300)
                self.assertTrue(any("robot2 missed its deadline" in e["text"] for e in daemon.status()["events"]))
                client.send_signal(signal.SIGCONT)
                motors.must("ready 5")
            finally:
                client.kill()
                client.wait()
                client.stdout.close()

    def test_a_killed_client_frees_its_robot(self):
        with Daemon(scenario(1)) as daemon:
            client = start_client(daemon, "/robot1/motors")
            motors = daemon.text("/robot1/motors")
            self.assertEqual(motors.ask("set_velocity 0 0").error, 6)
            client.kill()
            client.wait()
            client.stdout.close()
            reply = until(lambda: (r := motors.ask("set_velocity 0 0")).error == 0 and r)
            self.assertEqual(reply.params[0], 1)

    def test_a_client_killed_while_its_command_waits_is_noticed_at_once(self):
        with Daemon(scenario(2)) as daemon:
            client = start_client(daemon, "/robot1/motors")  # waits for robot2, which has no client
            until(lambda: daemon.status()["robots"][0]["owner"])
            client.kill()
            client.wait()
            client.stdout.close()
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_on_disconnect_hold_lets_the_others_go_on(self):
        with Daemon(scenario(2, robot_extra={2: "on_disconnect hold"})) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            two.send("set_velocity 0.2 0")
            one.must("ready")
            two.receive()
            two.close()
            self.assertEqual(one.must("ready 20").step, 21)
            self.assertGreater(daemon.text("/robot2/pose").must("get_pose").data[3], 0.1)

    def test_on_disconnect_drop_takes_the_robot_out_until_its_next_command(self):
        with Daemon(scenario(2, robot_extra={2: "on_disconnect drop"})) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            two.send("ready")
            one.must("ready")
            two.receive()
            two.close()
            one.must("ready 3")
            self.assertFalse(daemon.status()["robots"][1]["participates"])
            again = daemon.text("/robot2/motors")
            again.send("ready")
            until(lambda: daemon.status()["robots"][1]["participates"])
            one.must("ready")
            again.receive()
            one.send("ready")
            until(lambda: daemon.status()["awaiting_count"] == 1)


class InterruptionTest(unittest.TestCase):
    """reset, load, pause and mode switch while replies wait."""

    def waiting_pair(self, daemon):
        """robot1's command waits for robot2."""
        motors = daemon.text("/robot1/motors")
        motors.send("set_velocity 0.2 0")
        until(lambda: [a["robot"] for a in daemon.status()["awaiting"]] == ["robot2"])
        return motors

    def test_reset_answers_waiting_requests_with_error_5_and_keeps_the_owner(self):
        with Daemon(scenario(2)) as daemon:
            simulation = daemon.text("/simulation")
            daemon.text("/robot2/motors").send("ready 3")
            motors = daemon.text("/robot1/motors")
            motors.must("ready 3")
            motors = self.waiting_again(daemon, motors)
            self.assertEqual(simulation.must("reset").step, 0)
            reply = motors.receive()
            self.assertEqual((reply.error, reply.text), (5, "reset"))
            status = daemon.status()
            self.assertEqual((status["step"], status["revision"], status["time_s"]), (0, 0, 0))
            self.assertTrue(status["robots"][0]["owner"])

    def waiting_again(self, daemon, motors):
        motors.send("set_velocity 0.2 0")
        until(lambda: [a["robot"] for a in daemon.status()["awaiting"]] == ["robot2"])
        return motors

    def test_reset_gives_the_same_hashes_as_a_fresh_start(self):
        with Daemon(scenario(1)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            hashes = []
            for _ in range(3):
                motors.must("set_wheel_speeds (40) 3 4")
                hashes.append(daemon.status()["hash"])
                simulation.must("reset 1")
            self.assertEqual(len(set(hashes)), 1)

    def test_load_answers_waiting_requests_with_error_5_and_keeps_robots_of_the_same_name(self):
        with Daemon(scenario(2)) as daemon:
            simulation = daemon.text("/simulation")
            port = daemon.module_port("/robot1/motors")
            motors = self.waiting_pair(daemon)
            other = daemon.text("/robot2/pose")
            other.must("ping")
            text = scenario(1).replace("\n", "\\n")
            self.assertEqual(simulation.must(f'load_scenario "{text}"').step, 0)
            reply = motors.receive()
            self.assertEqual((reply.error, reply.text), (5, "load"))
            self.assertEqual(motors.must("set_velocity 0.2 0").step, 1)
            self.assertEqual(other.receive().command, -1)
            self.assertEqual(daemon.module_port("/robot1/motors"), port)

    def test_a_load_that_fails_changes_nothing(self):
        with Daemon(scenario(1)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            motors.must("ready 5")
            before = daemon.status()["hash"]
            bad = scenario(1).replace("position 0 0 0", "position 0 zero 0").replace("\n", "\\n")
            reply = simulation.ask(f'load_scenario "{bad}"')
            self.assertNotEqual(reply.error, 0)
            self.assertIn("error:", reply.text)
            self.assertEqual(simulation.ask("load_scenario no_such_thing").error, 10)
            self.assertEqual(daemon.status()["hash"], before)
            self.assertEqual(motors.must("ready").step, 6)

    def test_during_a_pause_steps_wait_and_the_rest_is_answered(self):
        with Daemon(scenario(1)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            simulation.must("pause")
            motors.send("set_velocity 0.2 0")
            self.assertEqual(daemon.text("/robot1/pose").must("get_pose").step, 0)
            self.assertEqual(daemon.status()["state"], "paused")
            self.assertFalse(motors.has_bytes())
            simulation.must("run")
            self.assertEqual(motors.receive().step, 1)

    def test_step_n_works_only_while_paused_and_is_answered_after_the_nth(self):
        with Daemon(scenario(1)) as daemon:
            simulation, motors = daemon.text("/simulation"), daemon.text("/robot1/motors")
            self.assertEqual(simulation.ask("step 3").error, 5)
            simulation.must("pause")
            simulation.send("step 3")
            for k in (1, 2, 3):
                self.assertEqual(motors.must("ready").step, k)
            self.assertEqual(simulation.receive().step, 3)
            motors.send("ready")
            until(lambda: daemon.status()["state"] == "paused")
            self.assertFalse(motors.has_bytes())

    def test_step_n_is_answered_after_the_nth_also_if_run_comes_meanwhile(self):
        with Daemon(scenario(1)) as daemon:
            stepping, simulation = daemon.text("/simulation"), daemon.text("/simulation")
            motors = daemon.text("/robot1/motors")
            simulation.must("pause")
            stepping.send("step 4")
            self.assertEqual(motors.must("ready").step, 1)
            simulation.must("run")
            motors.must("ready 3")
            self.assertEqual(stepping.receive().step, 4)

    def test_a_mode_switch_keeps_waiting_requests_which_end_in_the_new_mode(self):
        with Daemon(scenario(2)) as daemon:
            simulation = daemon.text("/simulation")
            motors = self.waiting_pair(daemon)
            simulation.must("set_mode realtime")
            reply = motors.receive()
            self.assertEqual((reply.error, reply.params[0]), (0, 0))
            until(lambda: daemon.status()["step"] > 5)
            simulation.must("set_mode lockstep")
            self.assertEqual(daemon.status()["mode"], "lockstep")

    def test_stop_all_replaces_what_has_not_run(self):
        with Daemon(scenario(2)) as daemon:
            simulation = daemon.text("/simulation")
            motors = self.waiting_pair(daemon)
            simulation.must("stop_all")
            two = daemon.text("/robot2/motors")
            two.must("ready")
            self.assertEqual(motors.receive().error, 0)
            motors.send("ready 50")
            two.must("ready 50")
            self.assertLess(abs(daemon.text("/robot1/pose").must("get_pose").data[0]), 1e-3)


class OwnershipTest(unittest.TestCase):
    def test_a_second_commander_gets_error_6_naming_the_owner(self):
        with Daemon(scenario(1)) as daemon:
            first, second = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            first.must("hello ana")
            first.must("ready")
            reply = second.ask("set_velocity 0.1 0")
            self.assertEqual(reply.error, 6)
            self.assertIn("ana", reply.text)
            self.assertEqual(second.must("get_wheels").error, 0)

    def test_release_frees_the_module(self):
        with Daemon(scenario(1)) as daemon:
            first, second = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            first.must("claim")
            self.assertEqual(second.ask("claim").error, 6)
            first.must("release")
            second.must("claim")

    def test_hello_of_the_same_name_takes_over_and_the_old_one_gets_a_notice(self):
        with Daemon(scenario(1)) as daemon:
            old, new = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            reader = daemon.text("/robot1/pose")
            for connection in (old, reader):
                connection.must("hello ana")
            old.must("claim")
            new.must("hello ana")
            self.assertEqual(old.receive().command, -1)
            self.assertEqual(old.read_to_end(), b"")
            new.must("set_velocity 0.1 0")
            reader.must("get_pose")

    def test_a_new_owners_first_command_replaces_the_old_ones_rest(self):
        with Daemon(scenario(2)) as daemon:
            old, new = daemon.text("/robot1/motors"), daemon.text("/robot1/motors")
            two = daemon.text("/robot2/motors")
            old.must("hello ana")
            old.send("set_wheel_speeds (100) 5 5")
            two.must("ready")
            new.must("hello ana")
            new.send("verbose")
            new.send("set_wheel_speeds 0 0")
            while "waiting for robot2" not in new.read_line():  # so the command has arrived
                pass
            two.must("ready")
            self.assertEqual(new.receive().step, 2)
            two.send("ready")
            until(lambda: [a["robot"] for a in daemon.status()["awaiting"]] == ["robot1"])

    def test_release_of_a_robot_by_the_simulation_closes_its_owner(self):
        with Daemon(scenario(1)) as daemon:
            motors, simulation = daemon.text("/robot1/motors"), daemon.text("/simulation")
            motors.must("claim")
            simulation.must('release_robot robot1')
            self.assertEqual(motors.receive().command, -1)
            until(lambda: not daemon.status()["robots"][0]["owner"])

    def test_half_closed_one_line_commands_are_executed_and_answered(self):
        with Daemon(scenario(1)) as daemon:
            host, port = daemon.names[0], daemon.module_port("/robot1/motors")
            for line in ("set_velocity 0.2 0", "get_wheels"):
                done = subprocess.run(["nc", "-N", host, str(port)], input=(line + "\n").encode(),
                                      stdout=subprocess.PIPE, timeout=60)
                self.assertTrue(done.stdout.startswith(b"0 "), done.stdout)
            self.assertEqual(daemon.status()["step"], 1)

    def test_pipelined_requests_of_a_half_closed_connection_run_in_their_steps(self):
        with Daemon(scenario(1)) as daemon:
            port = daemon.module_port("/robot1/motors")
            lines = "".join(f"set_wheel_speeds {k} {k}\n" for k in range(1, 6))
            done = subprocess.run(["nc", "-N", "127.0.0.1", str(port)], input=lines.encode(),
                                  stdout=subprocess.PIPE, timeout=60)
            self.assertEqual(done.stdout.count(b"\n"), 5)
            self.assertEqual(daemon.status()["step"], 5)
            self.assertFalse(daemon.status()["robots"][0]["owner"])


if __name__ == "__main__":
    unittest.main()
