"""The lockstep contract, clause by clause, over raw sockets."""
import json
import random
import threading
import unittest

from harness import BOX, Daemon, scenario, until


def drive(connection, commands, delays):
    """Sends each command after a random pause and waits for its reply; returns the steps of the replies."""
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
        with Daemon(scenario(2, extra=BOX)) as daemon:
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
                self.assertEqual(reply.time_s, (k * 10_000_000) / 1e9)

    def test_nothing_moves_until_every_participant_is_ready(self):
        with Daemon(scenario(2)) as daemon:
            one, two = daemon.text("/robot1/motors"), daemon.text("/robot2/motors")
            one.send("set_velocity 0.2 0")
            until(lambda: daemon.awaited() == ["robot2"])
            status = daemon.status()
            self.assertEqual((status["awaiting"][0]["why"], status["state"]), ("no client", "waiting"))
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
            spectator.send_to_wait("ready")
            on_simulation.send_to_wait("ready 2")
            self.assertEqual(daemon.awaited(), ["robot1"])
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
            until(lambda: daemon.awaited() == ["robot2"])

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


if __name__ == "__main__":
    unittest.main()
