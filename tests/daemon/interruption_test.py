"""Reset, load, pause and mode switches while lockstep replies are pending, over raw sockets."""
import unittest

from harness import Daemon, scenario, until


class InterruptionTest(unittest.TestCase):
    def send_to_wait_for_robot2(self, daemon, motors):
        motors.send("set_velocity 0.2 0")
        until(lambda: daemon.awaited() == ["robot2"])

    def waiting_pair(self, daemon):
        """robot1's command waits for robot2."""
        motors = daemon.text("/robot1/motors")
        self.send_to_wait_for_robot2(daemon, motors)
        return motors

    def test_reset_answers_waiting_requests_with_error_5_and_keeps_the_owner(self):
        with Daemon(scenario(2)) as daemon:
            simulation = daemon.text("/simulation")
            daemon.text("/robot2/motors").send("ready 3")
            motors = daemon.text("/robot1/motors")
            motors.must("ready 3")
            self.send_to_wait_for_robot2(daemon, motors)
            self.assertEqual(simulation.must("reset").step, 0)
            reply = motors.receive()
            self.assertEqual((reply.error, reply.text), (5, "reset"))
            status = daemon.status()
            self.assertEqual((status["step"], status["revision"], status["time_s"]), (0, 0, 0))
            self.assertTrue(status["robots"][0]["owner"])

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

    def test_loads_without_the_subscribed_robot_while_steps_run(self):
        with Daemon(scenario(1, mode="free")) as daemon:
            simulation = daemon.text("/simulation")
            robot, other = "robot1", "another"
            for _ in range(30):
                watcher = daemon.text(f"/{robot}/pose")
                watcher.send("subscribe 100")  # of who reads less than comes, not even the end is promised
                while watcher.receive().command != -40:
                    pass
                text = scenario(1, mode="free").replace("robot1", other).replace("\n", "\\n")
                simulation.must(f'load_scenario "{text}"')
                while (last := watcher.receive()).command != -1:
                    pass
                self.assertIn(f"{robot} is not in the new scenario", last.text)
                robot, other = other, robot

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
            until(lambda: not daemon.awaited())
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
            until(lambda: not daemon.awaited())
            self.assertEqual(daemon.status()["state"], "paused")
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


if __name__ == "__main__":
    unittest.main()
