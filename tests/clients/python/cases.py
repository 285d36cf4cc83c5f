# SPDX-License-Identifier: MIT
"""Shared by tests of the client: closes clients, checks expected errors, and starts the real or the scripted daemon."""
import contextlib
import io
import signal
import threading
import time
import unittest

import harness
import coopdyn
from fake_daemon import FakeDaemon

LIMIT_S = 60
RESET = "the world was reset: run your program again, or catch this to start over"


class ClientTestCase(unittest.TestCase):
    def connect(self, daemon, **options):
        sim = coopdyn.connect(daemon.server, **options)
        self.addCleanup(sim.close)
        return sim

    def assert_error(self, code, call, *says):
        """Expects an error; returns its text."""
        with self.assertRaises(coopdyn.Error) as caught:
            call()
        self.assertEqual(caught.exception.code, code, caught.exception.text)
        for word in says:
            self.assertIn(word, caught.exception.text)
        return caught.exception.text

    def notices_after(self, seconds):
        """Makes waits report whom they wait for after this many seconds."""
        self.addCleanup(setattr, coopdyn, "_NOTICE_AFTER_S", coopdyn._NOTICE_AFTER_S)
        coopdyn._NOTICE_AFTER_S = seconds

    def said_until(self, call, words, go_on):
        """Runs a call that waits; once it has printed these words on stderr, calls `go_on`, which ends the wait. Returns the
        output."""
        with contextlib.redirect_stderr(io.StringIO()) as said:
            def end():
                limit = time.monotonic() + LIMIT_S
                while words not in said.getvalue() and time.monotonic() < limit:
                    time.sleep(0.01)
                go_on()

            ends = threading.Thread(target=end)
            ends.start()
            try:
                call()
            finally:
                ends.join()
        return said.getvalue()


class DaemonTestCase(ClientTestCase):
    """Tests against the real daemon, started also with the class's `options`."""
    options = ()

    def start(self, scenario, *options):
        daemon = harness.Daemon(scenario, *self.options, *options)
        self.addCleanup(daemon.stop)
        return daemon


class FakeTestCase(ClientTestCase):
    """Tests against the scripted daemon."""

    def start(self, **options):
        daemon = FakeDaemon(**options)
        self.addCleanup(daemon.stop)
        return daemon

    def reset_in(self, call, daemon, other):
        """The errors, (code, text), of a call that waits for robot1's command when another sim resets."""
        raised = []

        def wait():
            try:
                call()
            except coopdyn.Error as e:
                raised.append((e.code, e.text))

        waiting = threading.Thread(target=wait)
        waiting.start()
        with daemon.lock:
            self.assertTrue(daemon.lock.wait_for(lambda: daemon.robots[0].command is not None, LIMIT_S))
        other.reset()
        waiting.join()
        return raised

    def interrupt(self, daemon, arrived, call):
        """Interrupts the call by Ctrl-C once its request has arrived at the daemon."""
        def press():
            end = time.monotonic() + LIMIT_S
            with daemon.lock:
                while not daemon.lock.wait_for(arrived, 0.01) and time.monotonic() < end:
                    pass
            signal.pthread_kill(threading.main_thread().ident, signal.SIGALRM)

        old = signal.signal(signal.SIGALRM, signal.default_int_handler)
        presses = threading.Thread(target=press)
        try:
            with self.assertRaises(KeyboardInterrupt):
                presses.start()
                call()
            self.assertTrue(arrived())
        finally:
            presses.join()
            signal.signal(signal.SIGALRM, old)
