# SPDX-License-Identifier: MIT
"""read_run on recordings written by hand from docs/formats.md: returns every number, also with gaps or while the file grows."""
import array
import math
import os
import pathlib
import struct
import subprocess
import sys
import unittest

import harness
import coopdyn
import run_file as rf
from run_cases import TILTED, TURNED, ReadRunTestCase

MICROMETRE = 0.5000001e-6


def single(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def heading_of(w, x, y, z):
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


class Columns(ReadRunTestCase):
    def setUp(self):
        super().setUp()
        self.write_two()
        self.run_ = coopdyn.read_run(pathlib.Path(self.path))

    def test_times_steps_and_hashes_are_exact(self):
        self.assertEqual(list(self.run_.time), [0.1, 110000000 / 1e9, 120000000 / 1e9])
        self.assertEqual(list(self.run_.steps), [10, 11, 12])
        self.assertEqual(self.run_.hash, ["f" * 16, "4000000000000001", "4000000000000002"])

    def test_the_run_as_a_whole(self):
        self.assertEqual(self.run_.names, ["robot1", "robot2"])
        self.assertEqual(self.run_.scenario, "[FLOOR]\nsize 4 4 0.1\n# Jürgen\n")
        self.assertEqual(self.run_.info["seed"], 2**64 - 1)
        self.assertEqual((self.run_.info["mode"], self.run_.info["step_ns"]), ("lockstep", 10_000_000))
        self.assertEqual(self.run_.events, [(10, 0.1, "note", "here we go"), (11, 110000000 / 1e9, "warning", "ouch")])

    def test_a_robot_stands_where_its_frame_is_not_its_body(self):
        pose = self.run_.pose("robot1")
        self.assertEqual(pose.shape, (3, 3))
        for k, (x, y, heading) in enumerate(pose):
            self.assertAlmostEqual(x, 0.1 * k - 0.02 * math.cos(0.8), delta=3 * MICROMETRE)
            self.assertAlmostEqual(y, -0.2 - 0.02 * math.sin(0.8), delta=3 * MICROMETRE)
            self.assertAlmostEqual(heading, 0.8, delta=2e-6)
        self.assertAlmostEqual(self.run_.pose_3d("robot1")[2, 2], 0, delta=MICROMETRE)

    def test_a_robot_whose_frame_is_turned_in_its_body(self):
        w, x, y, z = TILTED
        c, _, _, s = TURNED
        expected = (w * c - z * s, x * c + y * s, y * c - x * s, w * s + z * c)
        got = self.run_.pose_3d("robot2")[1]
        for a, b in zip(got, (-3, 0.25, 0, *expected)):
            self.assertAlmostEqual(a, b, delta=2e-6)
        self.assertAlmostEqual(self.run_.pose("robot2")[1, 2], heading_of(*expected), delta=1e-5)

    def test_an_object_that_moves_has_a_pose_too(self):
        self.assertEqual(list(self.run_.pose("BOX_1")), [(1.0, 2.0, 0.0)] * 3)

    def test_readings_are_the_recorded_numbers(self):
        self.assertEqual(list(self.run_.reading("robot1", "distances")), [(single(0.1), math.inf, 2)] * 3)
        self.assertEqual(list(self.run_.reading("robot2", "distances")), [(3, 4), (4, 4), (5, 4)])
        self.assertEqual(list(self.run_.reading("robot1", "targets")), [(1, -0.5, 2, 0.5)] * 3)
        self.assertEqual(self.run_.reading("robot2", "targets")[2][:2], (5, 0.125))
        self.assertTrue(math.isnan(self.run_.reading("robot2", "targets")[2][2]))
        self.assertEqual(self.run_.joints("robot1"), ["left_wheel_joint", "right_wheel_joint"])
        left, right, *velocities = self.run_.reading("robot1", "channels")[0]
        self.assertAlmostEqual(left, -1000.5, delta=1e-9)
        self.assertAlmostEqual(right, 1e-5, delta=1e-15)
        self.assertEqual(velocities, [2.5, -2.5])
        self.assertEqual(self.run_.reading("robot2", "channels")[2], (2, -2, 0.25, 0))

    def test_commands_are_those_that_came_in_force(self):
        self.assertEqual(list(self.run_.commands("robot1")), [(10, 0.1, 0, 0, 3, 3)])
        self.assertEqual(list(self.run_.commands("robot2")), [(10, 0.1, 0.5, -0.5, 3, 3),
                                                               (12, 120000000 / 1e9, 7.25, 2**-30, 1, 4)])

    def test_a_column_of_rows_is_an_array(self):
        pose = self.run_.pose("BOX_1")
        self.assertEqual(pose[:, 1], array.array("d", [2, 2, 2]))
        self.assertEqual((pose[2, 0], pose[-1, -3]), (1, 1))
        self.assertRaises(IndexError, lambda: pose[:, 3])

    def test_wrong_names_are_answered_with_those_there_are(self):
        for call, code, hint in ((lambda: self.run_.pose("robot3"), 10, "robot1, robot2"),
                                 (lambda: self.run_.reading("BOX_1", "channels"), 10, "no robot"),
                                 (lambda: self.run_.commands("BOX_1"), 10, "no robot"),
                                 (lambda: self.run_.reading("robot1", "smell"), 4, "distances, targets, channels")):
            error = self.error_of(call)
            self.assertEqual(error.code, code)
            self.assertIn(hint, error.text)


class Names(ReadRunTestCase):
    def test_what_is_not_there_is_answered_with_all_that_pose_takes(self):
        self.write_two()
        run = coopdyn.read_run(self.path)
        self.assertEqual(len(run.pose("BOX_1")), 3)
        text = self.error_of(lambda: run.pose("box_1")).text
        self.assertIn("did you mean BOX_1? there are: robot1, robot2, BOX_1", text)
        self.assertNotIn("chassis", text)
        self.assertNotIn("did you mean", self.error_of(lambda: run.pose("table")).text)

    def test_of_many_names_twenty_are_listed(self):
        db = rf.create(self.path)
        robots = [f"bee_{i}" for i in range(1, 101)]
        rf.add_scene(db, 1, 0, [f"{name}.chassis" for name in robots],
                     [(name, i, (0, 0, 0), rf.IDENTITY, 0) for i, name in enumerate(robots)], [])
        rf.add_step(db, 0, rf.poses_blob([((0, 0, 0), rf.IDENTITY)] * 100))
        rf.close(db)
        text = self.error_of(lambda: coopdyn.read_run(self.path).pose("wasp")).text
        self.assertTrue(text.endswith("bee_19, bee_20, … (100)"), text)


class Encodings(ReadRunTestCase):
    def test_every_component_can_be_the_one_left_out(self):
        qs = []
        for largest in range(4):
            for sign in (1, -1):
                q = [0.1, -0.2, 0.3, 0.05]
                q[largest] = sign * 0.9
                norm = math.sqrt(sum(c * c for c in q))
                qs.append(tuple(c / norm for c in q))
        db = rf.create(self.path)
        rf.add_scene(db, 1, 0, [f"B_{k}" for k in range(len(qs))], [])
        rf.add_step(db, 0, rf.poses_blob([((0, 0, 0), q) for q in qs]))
        rf.close(db)
        run = coopdyn.read_run(self.path)
        for k, q in enumerate(qs):
            got = run.pose_3d(f"B_{k}")[0][3:]
            same = math.copysign(1, sum(a * b for a, b in zip(got, q)))  # q and -q are the same turn
            for a, b in zip(got, q):
                self.assertAlmostEqual(same * a, b, delta=2e-6)

    def test_positions_keep_a_micrometre_to_67_m_and_scale_beyond(self):
        for e, x, y in ((0, 67.108863, -67.108864), (1, 134.217726, -134.217728), (7, 5000.000128, -8000)):
            db = rf.create(self.path)
            rf.add_scene(db, 1, 0, ["BALL"], [])
            rf.add_step(db, 0, rf.poses_blob([((x, y, 0.000001 * 2**e), rf.IDENTITY)], e))
            rf.close(db)
            got = coopdyn.read_run(self.path).pose_3d("BALL")[0][:3]
            for a, b in zip(got, (x, y, 0.000001 * 2**e)):
                self.assertAlmostEqual(a, b, delta=1e-11)
            os.remove(self.path)


class Gaps(ReadRunTestCase):
    def test_moments_without_poses_are_left_out_but_their_commands_are_there(self):
        db = rf.create(self.path, pose_every_ns=20_000_000)
        rf.add_scene(db, 1, 0, ["robot1.chassis"], [("robot1", 0, (0, 0, 0), rf.IDENTITY, 1)])
        for k in range(6):
            shown = k % 2 == 0
            rf.add_step(db, k, rf.poses_blob([((k, 0, 0), rf.IDENTITY)]) if shown else None, hash=k,
                        commands=rf.commands_blob((0, 1, k, -k)), distances=rf.floats_blob(k) if shown else None)
        rf.close(db)
        run = coopdyn.read_run(self.path)
        self.assertEqual(list(run.steps), [0, 2, 4])
        self.assertEqual(run.pose("robot1")[:, 0], array.array("d", [0, 2, 4]))
        self.assertEqual(run.reading("robot1", "distances")[:, 0], array.array("d", [0, 2, 4]))
        self.assertEqual(len(run.hash), 3)
        self.assertEqual(run.commands("robot1")[:, 0], array.array("d", range(5)))

    def test_things_that_come_and_go_are_nan_where_they_are_not(self):
        rf.write_sample(self.path)
        run = coopdyn.read_run(self.path)
        self.assertEqual(run.names, ["a", "b"])
        self.assertEqual(str(list(run.pose("a"))), "[(5.0, 0.0, 0.0), (5.0, 1.0, 0.0), (nan, nan, nan), (nan, nan, nan)]")
        self.assertEqual(run.pose("b")[:, 0], array.array("d", [6, 6, 8, 8]))
        self.assertEqual(run.pose("b")[:, 1], array.array("d", [0, 1, 2, 3]))
        self.assertEqual(str(list(run.reading("b", "distances"))[1:3]), "[(3.0, nan, nan), (7.0, 8.0, 9.0)]")
        self.assertEqual(str(list(run.reading("b", "targets"))[1:3]), "[(3.0, 4.0, nan, nan), (7.0, 8.0, 5.0, 6.0)]")
        self.assertEqual(list(run.commands("b")), [(0, 0, 2, 0, 3, 3), (1, 0.01, 2, 1, 3, 3), (2, 0.02, 3, 2, 3, 3),
                                                     (3, 30000000 / 1e9, 3, 3, 3, 3)])
        self.assertEqual(list(run.commands("a")), [(0, 0, 1, 0, 3, 3), (1, 0.01, 1, 1, 3, 3)])

    def test_what_was_not_recorded_says_how_to_record_it(self):
        self.write_two(what="poses,controllers")
        error = self.error_of(lambda: coopdyn.read_run(self.path).reading("robot1", "distances"))
        self.assertEqual(error.code, 5)
        self.assertIn("--record-what", error.text)

    def test_what_a_controller_sent_and_was_not_recorded_is_not_as_if_it_had_stood_still(self):
        rf.write_controlled(self.path, "poses", (0, 0))
        run = coopdyn.read_run(self.path)
        error = self.error_of(lambda: run.commands("m"))
        self.assertEqual((error.code, error.text), (5, f"the commands of m, driven by controller diffuse, were not recorded in "
                                                       f"{self.path}; record with --record-what poses,controllers"))
        self.assertEqual(list(run.commands("a")), [])

    def test_of_a_robot_taken_from_its_controller_a_clients_commands_are_there(self):
        rf.write_taken(self.path)
        self.assertEqual(list(coopdyn.read_run(self.path).commands("m")), [(1, 0.01, 2, 0, 3, 3), (2, 0.02, 3, 0, 3, 3)])

    def test_what_a_controller_sent_and_was_recorded_is_all_there(self):
        rf.write_controlled(self.path, "poses,controllers", (0, 0), (0, 2))
        self.assertEqual(list(coopdyn.read_run(self.path).commands("m")), [(0, 0, 0, 0, 3, 3), (1, 0.01, 2, 0, 3, 3)])

    def test_a_robot_of_a_swarm_is_found_among_the_commands_of_all(self):
        n = 300
        db = rf.create(self.path)
        rf.add_scene(db, 1, 0, [f"m_{k}.b" for k in range(n)], [(f"m_{k}", k, (0, 0, 0), rf.IDENTITY, 0) for k in range(n)])
        still = rf.poses_blob([((0, 0, 0), rf.IDENTITY)] * n)
        rf.add_step(db, 0, still, commands=rf.commands_blob(*((k, 0, 0, k) for k in range(n))))
        rf.add_step(db, 1, still, commands=rf.commands_blob(*((k, 1, k, 0) for k in range(n - 1, -1, -1))))
        rf.close(db)
        run = coopdyn.read_run(self.path)
        for k in (0, 1, 128, 255, 256, 257, 299):
            self.assertEqual(list(run.commands(f"m_{k}")), [(0, 0, 0, k, 3, 3), (1, 0.01, k, 0, 3, 3)])
        self.assertEqual(run.reading("m_7", "distances").shape, (2, 0))


class Example(ReadRunTestCase):
    def plot(self, *arguments):
        """Exit code and output, with a fake matplotlib."""
        plots = os.path.join(os.path.dirname(self.path), "matplotlib")
        os.mkdir(plots)
        for name in ("__init__", "pyplot"):
            with open(os.path.join(plots, name + ".py"), "w", encoding="utf-8") as file:
                file.write("plot = axis = xlabel = ylabel = legend = savefig = show = lambda *_, **__: None\n")
        path = os.pathsep.join((str(harness.ROOT / "clients" / "python"), os.path.dirname(self.path)))
        run = subprocess.run([sys.executable, str(harness.ROOT / "clients/python/examples/plot_run.py"), *arguments], text=True,
                             capture_output=True, timeout=60, env=dict(os.environ, PYTHONPATH=path))
        return run.returncode, run.stderr

    def test_plot_run_draws(self):
        self.write_two()
        self.assertEqual(self.plot(self.path, "a.png"), (0, ""))

    def test_plot_run_without_a_file_says_what_to_write(self):
        self.assertEqual(self.plot(), (2, "write: python3 plot_run.py NAME.run [PATH.png]\n"))

    def test_plot_run_of_a_file_that_is_not_there_says_so(self):
        self.assertEqual(self.plot("no.run"), (1, "there is no file 'no.run'; a recording is called NAME.run\n"))


class GrowingAndCrashed(ReadRunTestCase):
    def test_a_run_that_is_being_recorded_is_read_as_far_as_it_is(self):
        db = rf.create(self.path, closed=0)
        self.addCleanup(db.close)
        rf.add_scene(db, 1, 0, ["robot1.chassis"], [("robot1", 0, (0, 0, 0), rf.IDENTITY, 0)])
        for k in range(3):
            rf.add_step(db, k, rf.poses_blob([((k, 0, 0), rf.IDENTITY)]))
        run = coopdyn.read_run(self.path)
        rf.add_step(db, 3, rf.poses_blob([((3, 0, 0), rf.IDENTITY)]))
        self.assertEqual((len(run.time), len(run.pose("robot1")), len(run.hash)), (3, 3, 3))
        self.assertEqual(len(coopdyn.read_run(self.path).time), 4)

    def test_a_file_that_a_crash_has_left_opens_with_all_that_was_committed(self):
        db = rf.create(self.path, closed=0)
        self.addCleanup(db.close)
        rf.add_scene(db, 1, 0, ["robot1.chassis"], [("robot1", 0, (0, 0, 0), rf.IDENTITY, 0)])
        rf.add_step(db, 0, rf.poses_blob([((1, 0, 0), rf.IDENTITY)]))
        left = self.path + ".left.run"
        for suffix in ("", "-wal"):  # as a power cut leaves it: the index of the WAL is gone
            pathlib.Path(left + suffix).write_bytes(pathlib.Path(self.path + suffix).read_bytes())
        self.assertEqual(list(coopdyn.read_run(left).pose("robot1")), [(1, 0, 0)])

    def test_one_without_a_step_says_so(self):
        db = rf.create(self.path, closed=0)
        self.addCleanup(db.close)
        error = self.error_of(lambda: coopdyn.read_run(self.path))
        self.assertIn("no step", error.text)


if __name__ == "__main__":
    unittest.main()
