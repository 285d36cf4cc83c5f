# SPDX-License-Identifier: MIT
"""When the client polls before it waits."""
import importlib.util
import sys
import unittest
import unittest.mock

import harness  # finds the client
import coopdyn
from coopdyn import _Polling


class PollingTest(unittest.TestCase):
    def setUp(self):
        self.polling = _Polling()
        self.polling.spin_s = 50e-6
        self.now = 3600.0

    def lose_core(self):
        """A wait that is preempted for 4 ms."""
        self.polling.start(self.now)
        self.now += 4e-3
        self.polling.goes(self.now)

    def polls(self):
        return self.polling.start(self.now)

    def test_goes_on_for_the_spin(self):
        self.assertTrue(self.polls())
        self.assertTrue(self.polling.goes(self.now + 30e-6))
        self.assertFalse(self.polling.goes(self.now + 51e-6))

    def test_pauses_once_the_core_was_lost(self):
        self.lose_core()
        self.assertFalse(self.polls())
        self.now += 11e-3
        self.assertTrue(self.polls())

    def test_a_wait_longer_than_the_spin_is_no_loss(self):
        self.polling.start(self.now)
        while self.polling.goes(self.now):
            self.now += 10e-6
        self.now += 3.0  # it slept until the reply came
        self.polling.goes(self.now)
        self.assertTrue(self.polls())

    def test_the_pause_grows_to_a_second_and_is_short_again_after_a_quiet_time(self):
        for _ in range(12):
            self.lose_core()
            while not self.polls():
                self.now += 1e-3
        self.lose_core()
        self.now += 0.99
        self.assertFalse(self.polls())
        self.now += 0.5
        self.lose_core()
        self.now += 11e-3
        self.assertTrue(self.polls())

    def test_polls_also_where_the_system_has_no_yield(self):
        with unittest.mock.patch.object(coopdyn.os, "sched_yield", create=True):
            del coopdyn.os.sched_yield
            again = importlib.util.spec_from_file_location("coopdyn_elsewhere", coopdyn.__file__)
            module = importlib.util.module_from_spec(again)
            sys.modules[again.name] = module
            self.addCleanup(sys.modules.pop, again.name)
            again.loader.exec_module(module)
            polling = module._Polling()
            polling.spin_s = 50e-6
            polling.start(self.now)
            self.assertTrue(polling.goes(self.now + 30e-6))


if __name__ == "__main__":
    unittest.main()
