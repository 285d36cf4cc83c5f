# SPDX-License-Identifier: MIT
"""The Python client against the real daemon."""
import contextlib
import io
import math
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

import harness
import coopdyn
from cases import DaemonTestCase

CLIENT = harness.ROOT / "clients" / "python"


class ProgramTestCase(DaemonTestCase):
    def run_program(self, daemon, program, *arguments):
        run = subprocess.run([sys.executable, str(CLIENT / program), *arguments], timeout=300, text=True, capture_output=True,
                             env=dict(os.environ, COOPDYN_SERVER=daemon.server))
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def assert_at_target(self, line, x, y, within):
        """The last line of hello: `x y at t = T s`."""
        at = [float(w) for w in line.split()[:2]]
        self.assertLess(math.dist(at, (x, y)), within, line)

    def in_real_time(self, program, *arguments):
        """The output of a program that drives robot1 over an open floor to the target. The robot must pass the target; its later
        position depends on the machine."""
        daemon = self.start("classroom", "--mode", "realtime", "--speed", "2", "--set", "SCORE_1.kind=reach", "--set",
                            "SCORE_1.target=red", "--set", "SCORE_1.within=0.41")
        out = self.run_program(daemon, program, *arguments)
        self.assertEqual(self.connect(daemon, watch=True).scores(), {"reach": 1})
        return out


class Programs(ProgramTestCase):
    def test_hello_reaches_the_target_in_lockstep(self):
        out = self.run_program(self.start("classroom", "--mode", "lockstep"), "hello.py")
        self.assert_at_target(out, 1.5, 0.5, 0.45)

    def test_hello_reaches_the_target_in_real_time(self):
        self.assertRegex(self.in_real_time("hello.py"), r"^\S+ \S+ at t = \S+ s\n$")

    def test_attractor_reaches_the_target_in_every_scenario_of_one_robot_that_has_one(self):
        tried = 0
        for path in sorted((harness.ROOT / "scenarios").glob("*.scenario")):
            text = path.read_text(encoding="utf-8").upper()
            if text.count("[ROBOT") == 1 and "[SWARM" not in text and "[TARGET" in text:
                with self.subTest(path.stem), harness.Daemon(path.stem, "--mode", "lockstep") as daemon:
                    tried += 1
                    self.assertIn("robot1 reached the target", self.run_program(daemon, "attractor.py"))
        self.assertGreaterEqual(tried, 6)

    def test_attractor_reaches_the_target_in_real_time(self):
        self.assertIn("robot1 reached the target", self.in_real_time("attractor.py"))

    def test_attractor_drives_five_robots(self):
        names = [f"robot{i + 1}" for i in range(5)]
        out = self.run_program(self.start("formation", "--mode", "lockstep"), "attractor.py", *names)
        self.assertEqual(sorted(line.split()[0] for line in out.splitlines() if "reached" in line), names)

    def test_transport_carries_both_bars(self):
        out = self.run_program(self.start("transport", "--mode", "lockstep"), "transport.py")
        self.assertEqual(sorted(line.split()[0] for line in out.splitlines() if "arrived" in line), ["team1", "team2"])

    def test_formation_reaches_the_target(self):
        for scenario in ("formation", "triangle"):
            with self.subTest(scenario):
                out = self.run_program(self.start(scenario, "--mode", "lockstep"), "formation.py")
                self.assertIn("the formation reached the target", out)

    def test_doctor_finds_nothing_wrong(self):
        daemon = self.start("classroom")
        out = self.run_program(daemon, "coopdyn.py", "doctor")
        self.assertNotIn("FAIL", out)
        self.assertIn("robot1", out)
        self.assertIn("hello from robot1", self.run_program(daemon, "coopdyn.py", "hello"))


class WrongNames(DaemonTestCase):
    def test_a_wrong_robot_or_module_is_error_10_with_the_hint_of_the_daemon(self):
        sim = self.connect(self.start("classroom"))
        r = sim.robot(1)
        for call, hint in ((lambda: sim.describe("/robot9/motors"), "did you mean /robot1/motors"),
                           (lambda: sim.call("/robot1/moters", "stop"), "did you mean /robot1/motors"),
                           (lambda: r.call("poze", "get_pose"), "did you mean /robot1/pose"),
                           (lambda: r.subscribe("distanc"), "did you mean /robot1/distance"),
                           (lambda: sim.call("/kitchen", 0), "no such name /kitchen"),
                           (lambda: sim.robot("robot9"), "there are: robot1")):
            with self.subTest(hint), self.assertRaises(coopdyn.Error) as caught:
                call()
            self.assertEqual((caught.exception.code, caught.exception.name), (10, "no_such_name"))
            self.assertIn(hint, caught.exception.text)
        r.set_velocity(0.1, 0)  # the sim stays usable
        sim.step()

    def test_doctor_fails_where_something_else_listens(self):
        page = self.start("classroom").http.split("://")[1].strip("/")  # the page's port instead of the daemon's
        run = subprocess.run([sys.executable, str(CLIENT / "coopdyn.py"), "doctor", page], timeout=60, text=True,
                             capture_output=True)
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stdout, "FAIL .* is not a coopdyn daemon")
        self.assertNotIn("names:", run.stdout)


class Stepping(DaemonTestCase):
    def test_a_reply_that_is_late_sets_off_no_other_step(self):
        before, coopdyn._CATCH_UP_AFTER_S = coopdyn._CATCH_UP_AFTER_S, 0.0
        self.addCleanup(setattr, coopdyn, "_CATCH_UP_AFTER_S", before)
        for n, steps in ((4, 100), (60, 10)):  # more than a status lists
            sim = self.connect(self.start(harness.scenario_of(n)))
            robots = [sim.robot(k) for k in range(3, n + 1)]
            team = sim.team(["robot1", "robot2"])
            for k in range(steps):
                for r in robots:
                    r.set_velocity(0.1, 0)
                self.assertEqual(team.step((0.1, 0.1), timeout=60).step, k + 1)


class Beside(DaemonTestCase):
    def test_robots_that_take_no_part_set_off_no_step_of_their_own(self):
        sim = self.connect(self.start("formation", "--mode", "lockstep"))
        robots = [sim.robot(f"robot{i + 1}") for i in range(3)]
        for participants, names in ((["robot1"], "one of them"), (["robot1", "robot3"], "another joins"), (["robot2"], "only a third")):
            with self.subTest(names):
                sim.set_participants(participants)
                sim.step()  # a command that arrived after the last step may have run already
                poses = [robot.get_pose() for robot in robots]
                moved = made = 0
                # Lockstep does not wait for non-participants: their commands run some steps later on a busy machine.
                while made < 20 or moved < len(robots):
                    before = sim.steps
                    for robot in robots:
                        robot.set_velocity(0.2, 0.05)
                    sim.step()
                    made += 1
                    self.assertEqual(sim.steps, before + 1)
                    if moved < len(robots) and math.dist(robots[moved].get_pose()[:2], poses[moved][:2]) > 0.01:
                        moved += 1


class Waiting(DaemonTestCase):
    def test_next_with_nobody_stepping_says_once_whom_for(self):
        daemon = self.start(harness.scenario_of(2))
        sim, other = self.connect(daemon), self.connect(daemon, name="other", watch=True)
        r = sim.robot(1)
        self.notices_after(0.1)
        r.subscribe("pose")
        with self.assertRaises(coopdyn.Error) as caught:
            r.next(timeout=0.2)
        self.assertEqual(caught.exception.code, 11)
        self.assertIn("robot2 (no client)", caught.exception.text)
        said = self.said_until(r.next, "robot2 (no client)", lambda: other.set_mode("realtime"))
        self.assertEqual(said.count("coopdyn: waiting for robot1"), 1, said)
        self.assertIn("robot2 (no client)", said)

    def test_next_of_a_world_that_goes_on_says_nothing(self):
        r = self.connect(self.start(harness.scenario_of(1, "realtime"))).robot(1)
        self.notices_after(0.05)
        r.subscribe("pose", 40)
        r.next(timeout=60)
        with contextlib.redirect_stderr(io.StringIO()) as said:
            r.next(timeout=60)
        self.assertEqual(said.getvalue(), "")

    def test_of_many_robots_four_are_named(self):
        sim = self.connect(self.start(harness.scenario_of(7)))
        with self.assertRaises(coopdyn.Error) as caught:
            sim.step(timeout=0.2)
        self.assertEqual(caught.exception.text.count("(no client)"), 4)
        self.assertIn(" s and 3 more: ", caught.exception.text)

    def test_a_daemon_that_dies_gives_one_traceback(self):
        program = "import coopdyn\nsim = coopdyn.connect()\nr = sim.robot(1)\nwhile True:\n    r.set_velocity(0.1, 0)\n" \
                  "    sim.step()\n    print('stepped', flush=True)\n"
        for mode in ("lockstep", "realtime"):
            with self.subTest(mode):
                daemon = self.start(harness.scenario_of(1, mode))
                with subprocess.Popen([sys.executable, "-c", program], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                      env=dict(os.environ, COOPDYN_SERVER=daemon.server, PYTHONPATH=str(CLIENT))) as run:
                    self.assertEqual(run.stdout.readline(), "stepped\n")
                    daemon.process.kill()
                    _, said = run.communicate(timeout=60)
                self.assertEqual(said.count("Traceback"), 1, said)
                self.assertIn("is the daemon still running?", said)


    def test_a_daemon_that_dies_while_a_command_has_no_reply_yet_is_missed(self):
        daemon = self.start(harness.scenario_of(1, "realtime"))
        sim = self.connect(daemon)
        r = sim.robot(1)
        sim.step()
        daemon.process.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, daemon.process.pid, os.WSTOPPED)
        r.set_velocity(0.1, 0)
        ask = sim._session.control

        def ask_the_dead(*request):
            daemon.process.kill()
            return ask(*request)

        sim._session.control = ask_the_dead
        with self.assertRaises(coopdyn.Error) as caught:
            sim.step()
        self.assertIn("the connection to robot1 broke; is the daemon still running?", caught.exception.text)


class Lockstep(DaemonTestCase):
    def test_five_robots_in_one_process_do_not_deadlock_and_repeat_themselves(self):
        sim = self.connect(self.start(harness.scenario_of(5)))
        robots = [sim.robot(i + 1) for i in range(5)]
        hashes = []
        for run in range(2):
            sim.reset(7)
            for k in range(100):
                for r in robots:
                    t = r.get_target("red")
                    d = r.get_distances()
                    r.set_velocity(0.3 * min(1, min(d)), 1.5 * t.bearing + 0.4 * (min(d[:5]) < 0.5))
                sim.step(timeout=60)
            hashes.append((sim.steps, sim.hash()))
        self.assertEqual(hashes[0], hashes[1])
        self.assertEqual(hashes[0][0], 100)

    def test_one_refused_robot_of_five_never_hangs_the_loop(self):
        daemon = self.start(harness.scenario_of(5))
        sim = self.connect(daemon)
        robots = [sim.robot(i + 1) for i in range(5)]
        thief = coopdyn.connect(daemon.server, name=sim._session.address.name)  # the same name takes over robot3
        thief.robot(3)
        for r in robots:
            r.set_velocity(0.1, 0)
        with self.assertRaises(coopdyn.Error) as caught:
            sim.step(timeout=60)
        self.assertEqual(caught.exception.code, 6)
        thief.close()
        robots[2] = sim.robot(3)
        for k in range(3):
            for r in robots:
                r.set_velocity(0.2, 0)
            sim.step(timeout=60)
        self.assertGreaterEqual(sim.steps, 3)

    def test_after_a_timeout_the_next_reply_is_the_right_one(self):
        daemon = self.start(harness.scenario_of(2))
        sim = self.connect(daemon)
        r = sim.robot(1)
        r.set_velocity(0.1, 0)
        with self.assertRaises(coopdyn.Error) as caught:
            sim.step(timeout=0.1)
        self.assertEqual(caught.exception.code, 11)
        self.assertIn("robot2 (no client)", caught.exception.text)
        self.assertEqual(sim.status()["robots"][0]["owner"], sim._session.address.name)
        other = sim.robot(2)
        for k in range(20):
            r.set_velocity(0.3, 0)
            other.set_velocity(0.3, 0)
            sim.step(timeout=60)
            self.assertEqual(r.sense().step, sim.steps)
        self.assertGreater(r.get_pose().x, -2)

    def test_a_reset_by_somebody_else_ends_the_wait(self):
        daemon = self.start(harness.scenario_of(2))
        sim, other = self.connect(daemon), self.connect(daemon, name="other")
        r = sim.robot(1)
        raised = []

        def wait():
            try:
                sim.step(timeout=60)
            except coopdyn.Error as e:
                raised.append(e.code)

        thread = threading.Thread(target=wait)
        thread.start()
        while [a.robot for a in other.waiting()] != ["robot2"]:
            pass
        other.reset()
        thread.join()
        self.assertEqual(raised, [5])
        other.robot(2)
        r.set_velocity(0.1, 0)
        thread = threading.Thread(target=other.step)
        thread.start()
        sim.step(timeout=60)
        thread.join()
        self.assertEqual(sim.steps, 1)

    def test_sense_has_what_the_single_readings_say(self):
        sim = self.connect(self.start("fig4", "--mode", "lockstep"))
        r = sim.robot("robot1")
        for k in range(3):
            s = r.sense("red")
            self.assertEqual(s.step, k)
            self.assertEqual(s.distances, r.get_distances())
            self.assertEqual(s.targets, r.get_targets())
            self.assertEqual((s.target.distance, s.target.bearing), tuple(r.get_target("red")))
            self.assertEqual(s.pose, r.get_pose())
            self.assertEqual(s.wheels, r.get_wheels())
            r.set_velocity(0.2, 0.1)
            sim.step()

    def test_a_loaded_scenario_without_the_robot_says_so(self):
        sim = self.connect(self.start(harness.scenario_of(2)))
        first, second = sim.robot(1), sim.robot(2)
        sim.load_scenario(harness.scenario_of(1))
        self.assertEqual(sim.robots(), ["robot1"])
        first.set_velocity(0.1, 0)
        sim.step(timeout=60)
        self.assertEqual(sim.steps, 1)
        with self.assertRaises(coopdyn.Error) as caught:
            second.set_velocity(0.1, 0)
        self.assertEqual(caught.exception.code, 10)


class Everything(DaemonTestCase):
    def test_every_call_works(self):
        sim = self.connect(self.start(harness.scenario_of(2, "realtime")))
        r = sim.robot("/robot1")
        self.assertEqual((sim.mode, sim.dt, r.name), ("realtime", 0.01, "robot1"))
        r.set_velocity(0.2, 0.1)
        first = sim.steps
        sim.step(2)
        self.assertGreaterEqual(sim.steps, first + 2)
        r.set_wheel_speeds(1, 1)
        sim.pause()
        self.assertEqual(sim.status()["state"], "paused")
        self.assertEqual(r.get_target(2), r.get_target("green"))
        sim.run()
        r.stop()
        self.assertEqual(len(r.get_geometry().bearing), 11)
        self.assertEqual([t.colour for t in r.get_targets()], ["red", "green"])
        self.assertEqual([o.name for o in r.get_robots()], ["robot2"])
        self.assertGreater(r.get_limits().track, 0.1)
        self.assertEqual(len(r.get_pose_3d()), 13)
        r.subscribe("pose", 2)
        first, second = r.next(timeout=60), r.next("pose", timeout=60)
        self.assertEqual((first.module, second.step - first.step, len(first.value)), ("pose", 2, 5))
        r.subscribe("pose", 0)
        sim.set_speed(2)
        sim.set_step(0.02)
        self.assertEqual(sim.dt, 0.02)
        sim.stop_all()
        sim.set_mode("lockstep")
        sim.set_participants(["robot1"])
        self.assertEqual([w.robot for w in sim.waiting()], ["robot1"])
        sim.step(timeout=60)
        sim.reset()
        self.assertEqual(sim.status()["step"], 0)
        self.assertEqual(len(sim.hash()), 16)
        sim.reload()
        self.assertIn("set_velocity", [c["name"] for c in sim.describe("/robot1/motors")["commands"]])
        self.assertIn("/robot2/pose", [m.name for m in sim.modules()])
        self.assertEqual(sim.call("/robot1/pose", "ping", [1], [2.0]).data, [2.0])

    def test_snapshot_writes_a_picture(self):
        sim = self.connect(self.start("classroom"))
        with tempfile.TemporaryDirectory() as folder:
            file = sim.snapshot(str(pathlib.Path(folder) / "a.png"), 160, 120, eye=(0, -5, 4), look=(0, 0, 0))
            self.assertEqual(pathlib.Path(file).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_only_the_daemons_first_port_is_needed(self):
        daemon = self.start("classroom", "--mode", "lockstep")
        used, real = set(), socket.create_connection

        def counting(address, *a, **k):
            used.add(address[1])
            return real(address, *a, **k)

        socket.create_connection = counting
        os.environ["COOPDYN_TCP"] = "1"
        try:
            sim = self.connect(daemon)
            r = sim.robot(1)
            r.sense(), r.get_pose(), r.subscribe("target"), sim.modules(), sim.describe("/robot1/pose")
            r.set_velocity(0.1, 0)
            sim.step()
        finally:
            socket.create_connection = real
            del os.environ["COOPDYN_TCP"]
        self.assertEqual(used, {int(daemon.server.rsplit(":", 1)[1])})

    def test_a_mode_switched_by_somebody_else_neither_hangs_nor_spins(self):
        daemon = self.start("classroom", "--mode", "realtime")
        sim, teacher = self.connect(daemon), self.connect(daemon, name="teacher")
        r = sim.robot(1)
        for mode in ("lockstep", "realtime", "free", "lockstep"):
            teacher.set_mode(mode)
            steps = []
            for k in range(5):
                r.set_velocity(0.1, 0)
                sim.step(timeout=60)
                steps.append(sim.steps)
            self.assertEqual(steps, sorted(set(steps)), mode)


class EndOfAProgram(ProgramTestCase):
    """A program that ends without close() stops its robot in real time."""
    PROGRAM = """
import coopdyn
sim = coopdyn.connect()
r = sim.robot(1)
while True:
    r.set_velocity(0.2, 0)
    sim.step()
"""

    def end_by(self, signum):
        daemon = self.start("classroom", "--mode", "realtime")
        watcher = self.connect(daemon, watch=True)
        r = watcher.robot(1)

        def comes(condition):
            for _ in range(6000):
                if condition(abs(r.get_wheels().left_speed)):
                    return True
                watcher.step()
            return False

        environment = dict(os.environ, COOPDYN_SERVER=daemon.server, PYTHONPATH=str(CLIENT))
        with subprocess.Popen([sys.executable, "-c", self.PROGRAM], env=environment, stderr=subprocess.DEVNULL) as program:
            try:
                self.assertTrue(comes(lambda speed: speed > 1))
                program.send_signal(signum)
                program.wait(60)
            finally:
                program.kill()
        self.assertTrue(comes(lambda speed: speed < 1e-3))
        self.assertFalse(watcher.status()["robots"][0]["still_moving"])

    def test_a_killed_program_stops_its_robot(self):
        self.end_by(signal.SIGKILL)

    def test_an_interrupted_program_stops_its_robot(self):
        self.end_by(signal.SIGINT)


if __name__ == "__main__":
    unittest.main()
