# SPDX-License-Identifier: MIT
"""Recording, copying, playing and branching against the real daemon."""
import csv
import math
import os
import pathlib
import socket
import subprocess
import tempfile
import threading
import unittest

import harness
import coopdyn
from cases import DaemonTestCase

STEPS = 120
MICROMETRE = 1e-6


def drive(sim, steps, robots):
    """Commands and poses of the robots after each step; commanded speeds depend only on the step."""
    for _ in range(steps):
        k = sim.steps
        for i, r in enumerate(robots):
            r.set_velocity(0.2 + 0.05 * i, math.sin(0.05 * k + i))
        sim.step(timeout=60)
        yield [r.get_pose() for r in robots], [r.get_distances() for r in robots], sim.hash()


class Recorded:
    """A run of two robots in lockstep: recorded from step 0, downloaded to a file, with all readings of the client."""

    def __init__(self, folder):
        self.file = os.path.join(folder, "lesson1.run")
        with harness.Daemon(harness.scenario_of(2)) as daemon, coopdyn.connect(daemon.server) as sim:
            robots = [sim.robot(1), sim.robot(2)]
            self.started = sim.record("lesson1")
            self.while_recording = sim.recording()
            self.seen = []
            for k, seen in enumerate(drive(sim, STEPS, robots)):
                self.seen.append(seen)
                if k == 49:
                    sim.note("half-time, nearly")
            self.stopped = sim.stop_recording()
            self.after = sim.recording()
            self.listed = sim.recordings()
            self.fetched = sim.fetch_run("lesson1", self.file)
            self.mat = sim.fetch_run("lesson1.run", os.path.join(folder, "lesson1.mat"))


class RecordingTest(DaemonTestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.recorded = Recorded(cls.folder.name)
        cls.run_ = coopdyn.read_run(cls.recorded.file)

    def test_the_daemon_tells_what_it_records(self):
        recorded = self.recorded
        self.assertEqual(recorded.started, "lesson1.run")
        self.assertEqual(recorded.while_recording.name, "lesson1.run")
        self.assertEqual(recorded.while_recording.begin_time, 0)
        self.assertIsNone(recorded.after)
        self.assertEqual(recorded.stopped.name, "lesson1.run")
        self.assertRegex(recorded.stopped.url, r"^http://127\.0\.0\.1:\d+/runs/lesson1\.run$")
        (listed,) = recorded.listed
        self.assertEqual((listed.name, listed.steps, listed.recording, listed.url),
                         ("lesson1.run", STEPS, False, recorded.stopped.url))
        self.assertAlmostEqual(listed.seconds, STEPS * 0.01, delta=1e-9)
        self.assertEqual(listed.bytes, os.path.getsize(recorded.file))

    def test_the_run_is_what_was_seen(self):
        self.assertEqual(self.run_.names, ["robot1", "robot2"])
        self.assertEqual(list(self.run_.steps), list(range(STEPS + 1)))
        self.assertEqual(self.run_.hash[1:], [hash_ for _, _, hash_ in self.recorded.seen])
        for i, name in enumerate(self.run_.names):
            for row, (poses, _, _) in zip(self.run_.pose(name)[1:], self.recorded.seen):
                self.assertAlmostEqual(row[0], poses[i].x, delta=2 * MICROMETRE)
                self.assertAlmostEqual(row[1], poses[i].y, delta=2 * MICROMETRE)
                self.assertAlmostEqual(row[2], poses[i].heading, delta=5e-6)
            for row, (_, distances, _) in zip(self.run_.reading(name, "distances")[1:], self.recorded.seen):
                for a, b in zip(row, distances[i]):
                    self.assertTrue(a == b or abs(a - b) < 1e-6 * b, (a, b))

    def test_commands_are_what_was_told(self):
        commands = list(self.run_.commands("robot2"))
        self.assertEqual([c[0] for c in commands], list(range(STEPS + 1)))
        difference, sum_ = commands[1][3] - commands[1][2], commands[1][3] + commands[1][2]
        for k, (step, time, left, right, *modes) in enumerate(commands[1:]):
            self.assertEqual(modes, [3, 3])
            self.assertEqual((step, time), (k + 1, self.run_.time[k + 1]))
            self.assertAlmostEqual(right - left, difference * math.sin(0.05 * k + 1) / math.sin(1), delta=1e-9)
            self.assertAlmostEqual(right + left, sum_, delta=1e-9)

    def test_a_note_is_an_event_of_its_moment(self):
        notes = [e for e in self.run_.events if e.level == "note"]
        self.assertEqual([(e.step, e.text) for e in notes], [(50, "half-time, nearly")])
        self.assertAlmostEqual(notes[0].time, 0.5, delta=1e-12)

    def test_every_number_is_that_of_the_csv_export(self):
        out = os.path.join(self.folder.name, "lesson1.csv")
        subprocess.run([os.environ["COOPDYN_BINARY"], "export", self.recorded.file, "--to", "csv", "--out", out], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
        with open(out, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))

        def column(word):
            return [float(row[word]) for row in rows]

        self.assertEqual([row["hash"] for row in rows], self.run_.hash)
        self.assertEqual(column("time_s"), list(self.run_.time))
        for name in self.run_.names:
            pose = self.run_.pose(name)
            for j, word in enumerate(("x_m", "y_m")):
                self.assertEqual(column(f"{name}.{word}"), list(pose[:, j]), word)
            for exported, own in zip(column(f"{name}.heading_rad"), pose[:, 2]):
                self.assertAlmostEqual(exported, own, delta=1e-15, msg="by another arc tangent")
            joints = [f"{name}.{joint}" for joint in self.run_.joints(name)]
            channels = self.run_.reading(name, "channels")
            for j, word in enumerate(joint + unit for unit in ("_rad", "_rad_s") for joint in joints):
                self.assertEqual(column(word), list(channels[:, j]), word)
            distances = self.run_.reading(name, "distances")
            for j in range(11):
                self.assertEqual(column(f"{name}.d{j + 1}_m"), list(distances[:, j]))
            targets = self.run_.reading(name, "targets")
            for j, word in enumerate(("red1_distance_m", "red1_bearing_rad", "green1_distance_m", "green1_bearing_rad")):
                self.assertEqual(column(f"{name}.{word}"), list(targets[:, j]))
            in_force = {int(c[0]): c[2:4] for c in self.run_.commands(name)}
            self.assertEqual(list(zip(*(column(joint + "_setpoint_rad_s") for joint in joints))),
                             [in_force[k] for k in range(STEPS + 1)])

    def test_a_run_is_copied_as_a_mat_file_too(self):
        self.assertEqual(pathlib.Path(self.recorded.mat).read_bytes()[:10], b"MATLAB 5.0")

    def test_playing_shows_the_run_to_a_program_that_reads(self):
        daemon = self.start(self.recorded.file, "--paused")
        sim = self.connect(daemon)
        r = sim.robot("robot1")
        p = sim.playback()
        self.assertEqual((p.begin_time, p.playing, p.loop, p.growing), (0, False, False, False))
        self.assertAlmostEqual(p.end_time, STEPS * 0.01, delta=1e-9)
        self.assertEqual(p.file, "lesson1.run")
        pose, distances = self.run_.pose("robot1"), self.run_.reading("robot1", "distances")
        for time in (0.5, 0.1, 1.2, 0.0):
            sim.seek(time)
            k = round(time / 0.01)
            self.assertEqual((sim.steps, sim.hash()), (k, self.run_.hash[k]))
            got = r.get_pose()
            for a, b in zip(got[:3], pose[k]):
                self.assertAlmostEqual(a, b, delta=1e-9)
            for a, b in zip(r.get_distances(), distances[k]):
                self.assertTrue(a == b or abs(a - b) < 1e-4, (a, b))
            self.assertEqual(r.sense().step, k)
        sim.seek(0.5)
        sim.skip(10)
        self.assertEqual(sim.steps, 60)
        self.assert_error(11, lambda: sim.step(timeout=0.1), "the simulation is paused")
        sim.seek(9)
        self.assert_error(11, lambda: sim.step(timeout=0.1), "the recording has ended; sim.run() plays it again")
        sim.seek(0.6)
        sim.skip(-20)
        self.assertEqual((sim.steps, sim.playback().time), (40, self.run_.time[40]))
        sim.set_loop(True)
        self.assertTrue(sim.playback().loop)

    def test_step_waits_for_the_next_frame_that_is_shown(self):
        sim = self.connect(self.start(self.recorded.file, "--paused"))
        sim.robot("robot1")
        sim.set_loop(True)
        sim.play(0.25)  # so slow that no round ends even if the machine stops the test
        self.assertTrue(sim.playback().playing)
        self.assertEqual(sim.playback().speed, 0.25)
        before = sim.steps
        sim.step(timeout=60)
        self.assertNotEqual(sim.steps, before)
        sim.set_play_speed(-0.25)
        sim.step(3, timeout=60)
        first = sim.steps
        sim.step(timeout=60)
        self.assertNotEqual(sim.steps, first)
        sim.pause()
        self.assertFalse(sim.playback().playing)
        sim.run()
        self.assertTrue(sim.playback().playing)

    def test_robots_of_a_recording_obey_nobody(self):
        sim = self.connect(self.start(self.recorded.file, "--paused"))
        r = sim.robot("robot1")
        for _ in range(2):  # the connection stays usable
            self.assert_error(5, lambda: r.set_velocity(0.1, 0), "playing a recording")
            self.assertAlmostEqual(r.get_pose().x, self.run_.pose("robot1")[0, 0], delta=1e-9)
        self.assert_error(4, lambda: sim.play(100))
        self.assert_error(4, lambda: sim.set_play_speed(0))

    def test_a_team_reads_a_recording_and_drives_after_a_branch(self):
        sim = self.connect(self.start(self.recorded.file, "--paused"))
        single = sim.robot("robot1")
        team, second = sim.team(), sim.team("robot2")
        self.assertEqual((team.names, second.names), (["robot1", "robot2"], ["robot2"]))
        for k in (10, 70):
            sim.seek(k * 0.01)
            s = team.read()
            self.assertEqual(s.step, k)
            for i, name in enumerate(team.names):
                for j, x in enumerate(self.run_.pose(name)[k]):
                    self.assertAlmostEqual(s.pose[i][j], x, delta=1e-9)
                for a, b in zip(s.distances[i], self.run_.reading(name, "distances")[k]):
                    self.assertTrue(a == b or abs(a - b) < 1e-4, (a, b))
            self.assertEqual(len(s.distances[0]), 11)
            self.assertEqual(second.read().pose[0], s.pose[1])
        second.select("wheels", "distances", "pose")
        self.assertEqual(second.read().pose[0], s.pose[1])
        self.assertEqual(second.read().distances[0], s.distances[1])
        for drives in (lambda: team.step((0.1, 0)), lambda: team.step_wheels((1, 1)), team.stop):
            self.assert_error(5, drives, "playing a recording")
        sim.set_loop(True)
        sim.play(0.25)
        before = team.read().step
        self.assertNotEqual(team.step(timeout=60).step, before)
        sim.step(timeout=60)
        self.assert_error(10, lambda: sim.team("robot9"), "robot9")
        sim.pause()
        sim.branch(0.5)
        sim.run()
        second.close()
        there = team.read().pose[0]
        self.assertEqual(single.get_pose()[:3], there)
        self.assert_error(5, lambda: single.set_velocity(0, 0), "its team")
        for _ in range(5):
            s = team.step((0.3, 0.0), timeout=60)
        self.assertEqual(s.step, 55)
        self.assertNotEqual(s.pose[0], there)

    def test_a_swarm_that_is_played_is_found_by_either_name(self):
        daemon = self.start("arena20", "--mode", "lockstep")
        with tempfile.TemporaryDirectory() as folder:
            sim = self.connect(daemon)
            sim.record("swarm")
            live = sim.team("swarm1").step((0.1, 0.0), timeout=60)
            sim.stop_recording()
            sim = self.connect(self.start(sim.fetch_run("swarm", os.path.join(folder, "swarm.run")), "--paused"))
            sim.seek(live.time)
            for names in ("swarm1", "robot"):
                team = sim.team(names)
                s = team.read()
                self.assertEqual((team.n, s.step), (20, live.step))
                self.assertAlmostEqual(s.pose[19][0], live.pose[19][0], delta=MICROMETRE)

    def test_arguments_of_a_playback_are_looked_at(self):
        sim = self.connect(self.start(self.recorded.file, "--paused"))
        self.assert_error(3, lambda: sim.seek("1"), "one number, not '1'")
        self.assert_error(3, lambda: sim.set_loop("yes"), "True or False, not 'yes'")
        self.assertEqual((sim.playback().time, sim.playback().loop), (0, False))

    def test_a_mat_file_is_not_what_python_reads(self):
        self.assert_error(7, lambda: coopdyn.read_run(self.recorded.mat), "MATLAB", "lesson1.run")

    def test_a_branch_goes_on_live_with_the_programs_that_were_there(self):
        sim = self.connect(self.start(self.recorded.file, "--paused"))
        robots = [sim.robot(1), sim.robot(2)]
        self.assert_error(5, lambda: robots[0].set_velocity(0.1, 0), "playing a recording")
        sim.branch(0.6)
        self.assertEqual((sim.status()["step"], sim.hash()), (60, self.run_.hash[60]))
        sim.run()
        hashes = [hash_ for _, _, hash_ in drive(sim, STEPS - 60, robots)]
        self.assertEqual(hashes, self.run_.hash[61:])  # the same commands repeat the run
        self.assert_error(5, lambda: sim.playback(), "coopdyn play")

    def test_a_branch_with_other_commands_goes_elsewhere(self):
        sim = self.connect(self.start(self.recorded.file, "--paused"))
        sim.seek(0.3)
        sim.branch()
        sim.run()
        robots = [sim.robot(1), sim.robot(2)]
        for r in robots:
            r.set_velocity(0, 1)
        sim.step(10, timeout=60)
        self.assertEqual(sim.steps, 40)
        self.assertNotEqual(sim.hash(), self.run_.hash[40])


class Requests(DaemonTestCase):
    def test_wrong_names_and_states_are_errors_that_say_what_to_do(self):
        sim = self.connect(self.start("classroom"))
        self.assert_error(5, sim.stop_recording)
        self.assert_error(5, lambda: sim.note("nothing is recorded"))
        self.assert_error(5, sim.playback, "coopdyn play")
        self.assert_error(5, lambda: sim.seek(1), "coopdyn play")
        self.assert_error(4, lambda: sim.record("no/name"), "lesson1")
        self.assertGreater(len(sim.record("a")), 0)
        self.assert_error(5, lambda: sim.record("b"))
        while not any(f.steps for f in sim.recordings()):  # a separate thread writes the file
            sim.step(timeout=60)
        self.assert_error(5, lambda: sim.fetch_run("a"), "being recorded")
        sim.stop_recording()
        self.assert_error(5, lambda: sim.record("a"), "a.run")  # nothing is overwritten

    def test_what_cannot_be_copied_leaves_nothing(self):
        daemon = self.start("classroom")
        sim = self.connect(daemon)
        with tempfile.TemporaryDirectory() as folder:
            self.assert_error(10, lambda: sim.fetch_run("never", os.path.join(folder, "x.run")))
            sim.record("here")
            sim.step(timeout=60)
            sim.stop_recording()
            self.assert_error(5, lambda: sim.fetch_run("here", os.path.join(folder, "no folder", "x.run")), "cannot write")
            pathlib.Path(folder, "x.run").write_text("old")
            self.assert_error(10, lambda: sim.fetch_run("never", os.path.join(folder, "x.run")),
                              "there is no recording never.run; there are: here.run")
            self.assertEqual(os.listdir(folder), ["x.run"])
            self.assertEqual(pathlib.Path(folder, "x.run").read_text(), "old")
            sim.fetch_run("here", pathlib.Path(folder, "x.run"))
            self.assertEqual(os.listdir(folder), ["x.run"])
            self.assertEqual(coopdyn.read_run(os.path.join(folder, "x.run")).names, ["robot1"])

    def test_a_copy_that_breaks_off_leaves_what_was_there(self):
        with socket.create_server(("127.0.0.1", 0)) as listener, tempfile.TemporaryDirectory() as folder:
            def answer():
                connection, _ = listener.accept()
                with connection:
                    connection.recv(65536)
                    connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 3000000\r\n\r\n" + bytes(2_000_000))

            server = threading.Thread(target=answer)
            server.start()
            self.addCleanup(server.join)
            file = os.path.join(folder, "x.run")
            pathlib.Path(file).write_text("old")
            url = f"http://127.0.0.1:{listener.getsockname()[1]}/runs/x.run"
            self.assert_error(-1, lambda: coopdyn._download(url, file), "2000000")
            self.assertEqual((os.listdir(folder), pathlib.Path(file).read_text()), (["x.run"], "old"))

    def test_without_a_page_there_is_nothing_to_copy_from(self):
        sim = self.connect(self.start("classroom", "--no-http"))
        sim.record("a")
        self.assertEqual(sim.stop_recording(), ("a.run", ""))
        self.assertEqual([f.url for f in sim.recordings()], [""])
        self.assert_error(5, lambda: sim.fetch_run("a"), "--no-http")

    def test_a_live_run_is_put_aside_for_a_recording_and_goes_on(self):
        sim = self.connect(self.start(harness.scenario_of(1)))
        r = sim.robot(1)
        sim.record("opened")
        for _ in drive(sim, 10, [r]):
            pass
        sim.stop_recording()
        before = sim.hash()
        sim.open_run("opened")
        self.assertEqual(sim.playback().file, "opened.run")
        self.assert_error(5, lambda: r.set_velocity(0.1, 0), "playing a recording")
        sim.close_run()
        self.assertEqual(sim.hash(), before)
        self.assert_error(5, sim.close_run)
        self.assert_error(10, lambda: sim.open_run("never"))

    def test_a_saved_state_is_gone_on_from(self):
        sim = self.connect(self.start(harness.scenario_of(2)))
        robots = [sim.robot(1), sim.robot(2)]
        for _ in drive(sim, 20, robots):
            pass
        there = sim.hash()
        sim.save_state("before")
        first = [hash_ for _, _, hash_ in drive(sim, 15, robots)]
        sim.restore_state("before")
        self.assertEqual((sim.status()["step"], sim.hash()), (20, there))
        self.assertEqual([hash_ for _, _, hash_ in drive(sim, 15, robots)], first)
        states = {s.name: s.time for s in sim.saved_states()}
        self.assertAlmostEqual(states["before"], 0.2, delta=1e-12)
        sim.restore_state("start")
        self.assertEqual(sim.status()["step"], 0)
        self.assert_error(10, lambda: sim.restore_state("never"), "before")

    def test_a_state_of_another_scenario_brings_its_robots_back(self):
        sim = self.connect(self.start(harness.scenario_of(2), "--mode", "lockstep"))
        sim.robot("robot2")
        team = sim.team("robot1")
        sim.save_state("two")
        sim.load_scenario("classroom")
        self.assertEqual(sim.robots(), ["robot1"])
        sim.save_state("one")
        sim.restore_state("two")
        r = sim.robot("robot2")
        r.set_velocity(0.1, 0)
        self.assertEqual(team.step((0.1, 0.1), timeout=60).step, 1)
        sim.restore_state("one")
        self.assert_error(10, lambda: r.set_velocity(0.1, 0), "no robot2")
        self.assertEqual(sim.robots(), ["robot1"])

    def test_a_robot_is_taken_from_whoever_drives_it(self):
        daemon = self.start("classroom")
        ana, ben = self.connect(daemon, name="ana"), self.connect(daemon, name="ben")
        r = ana.robot("robot1")
        ben.release_robot("robot1")
        mine = ben.robot("robot1")
        mine.set_velocity(0.1, 0)
        self.assert_error(6, lambda: r.set_velocity(0.2, 0), "no longer driven by this sim")

    def test_a_team_goes_on_after_a_restore(self):
        sim = self.connect(self.start(harness.scenario_of(3)))
        team = sim.team()
        team.step((0.2, 0.1), timeout=60)
        sim.save_state("here")
        first = team.step((0.2, -0.5), timeout=60).pose
        team.step((0.2, 0.5), timeout=60)
        sim.restore_state("here")
        self.assertEqual(team.step((0.2, -0.5), timeout=60).pose, first)


if __name__ == "__main__":
    unittest.main()
