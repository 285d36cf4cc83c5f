# SPDX-License-Identifier: MIT
"""Shared by tests of read_run: a recording of two robots, written by hand."""
import math
import os
import tempfile
import unittest

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn
import run_file as rf

TURNED = (math.cos(0.4), 0.0, 0.0, math.sin(0.4))  # 0.8 rad to the left
TILTED = (0.5, -0.5, 0.5, -0.5)


class ReadRunTestCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "by hand.run")

    def write_two(self, steps=3, **meta):
        """Writes two robots, each with a body and a wheel, and a box; three sensors and two targets."""
        db = rf.create(self.path, **meta)
        db.execute("INSERT INTO text VALUES ('scenario', 'two', 'two.scenario', '[FLOOR]\nsize 4 4 0.1\n# Jürgen\n')")
        rf.add_scene(db, 1, 10, ["BOX_1", "robot1.chassis", "robot1.wheel", "robot2.chassis"],
                     [("robot1", 1, (-0.02, 0.0, -0.05), rf.IDENTITY, 3), ("robot2", 3, (0.0, 0.0, 0.0), TURNED, 2)], ["red", "green"])
        for k in range(steps):
            rf.add_step(
                db, 10 + k, rf.poses_blob([((1, 2, 0.5), rf.IDENTITY), ((0.1 * k, -0.2, 0.05), TURNED), ((0, 0, 0), rf.IDENTITY),
                                           ((-3, 0.25 * k, 0), TILTED)]),
                hash=-1 if k == 0 else 2**62 + k,
                commands=[rf.commands_blob((0, 0, 0, 0), (1, 0, 0.5, -0.5)), None, rf.commands_blob((1, 1, 7.25, 2**-30, 1, 4))][k % 3],
                channels=rf.channels_blob((-1000.5, 0.00001, 2.5, -2.5), (k, -k, 0.25, 0)),
                distances=rf.floats_blob(0.1, math.inf, 2, 3 + k, 4),
                targets=rf.floats_blob(1, -0.5, 2, 0.5, 3 + k, 0.125, math.nan, math.nan))
        db.execute("INSERT INTO event VALUES (1, 10, 100000000, 'note', 'here we go'), (2, 11, 110000000, 'warning', 'ouch')")
        rf.close(db)

    def error_of(self, call):
        with self.assertRaises(coopdyn.Error) as caught:
            call()
        return caught.exception
