# SPDX-License-Identifier: MIT
"""Sweeps on a Dask cluster and on Slurm give what a sweep on this machine gives."""
import os
import shutil
import signal
import subprocess
import unittest

import engines
from sweep_case import TABLE, SweepCase


class ClustersTest(SweepCase):
    @unittest.skipUnless(shutil.which("dask-scheduler"), "Dask is not installed")
    def test_dask_gives_equal_hashes_though_workers_are_killed(self):
        words = [*TABLE, "--seeds", "1..10"]
        self.sweep(*words, out="here")
        with engines.processes() as every:
            dask = engines.Dask(self.folder, every)
            sweep = subprocess.Popen(self.words(*words, "--dask", dask.address), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.addCleanup(sweep.stdout.close)
            engines.until(lambda: len(self.finished()) >= 5, "results come")
            os.killpg(dask.workers[0].pid, signal.SIGKILL)
            dask.add_worker()
            said = sweep.communicate(timeout=120)[0]
            self.assertEqual(sweep.returncode, 0, said)
        self.assertEqual(self.lines(), self.lines("here"))

    @unittest.skipUnless(shutil.which("slurmctld", path="/usr/sbin"), "Slurm is not installed")
    def test_slurm_gives_equal_hashes(self):
        words = [*TABLE, "--seeds", "1..3"]
        self.sweep(*words, out="here")
        with engines.processes() as every:
            place = self.path("slurm")
            os.mkdir(place)
            environment = engines.start_slurm(place, every)
            self.sweep(*words, "--slurm", env=environment)
        self.assertEqual(self.lines(), self.lines("here"))


if __name__ == "__main__":
    unittest.main()
