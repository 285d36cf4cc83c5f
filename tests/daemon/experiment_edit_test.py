# SPDX-License-Identifier: MIT
"""Edits of an experiment's file that a YARS client's reset detects, the messages about them, and the seed in force afterwards."""
import tempfile
import unittest
from pathlib import Path

from channel_test import DRAWN, STILL
from harness import Daemon, until
from yars_clients import Tcp

SHORT = 'range="0.5"'
OLD_SEED = 'seed="5"'


class ExperimentEditTest(unittest.TestCase):
    def serve(self, text, *options):
        """Serves this experiment; returns a client of its robot."""
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.file = folder / "vehicle.xml"
        self.file.write_bytes(text if isinstance(text, bytes) else text.encode())
        self.daemon = self.enterContext(
            Daemon(None, "--no-render", "--channel-ports-to", str(folder / "port"), *options, name=str(self.file)))
        client = Tcp(int((folder / "port-vehicle").read_text()))
        self.addCleanup(client.close)
        return client

    def seed_after_reset(self, client, seed=None):
        client.reset(seed)
        client.sensors()
        return self.daemon.status()["seed"]

    # --- the seed

    def test_an_edit_keeps_the_seed_that_a_client_has_set(self):
        for text in (DRAWN, STILL):
            with self.subTest(random=text == DRAWN):
                client = self.serve(text)
                self.assertEqual(self.seed_after_reset(client, 9), 9)
                self.file.write_text(text.replace('range="2"', SHORT))
                self.assertEqual(self.seed_after_reset(client), 9)

    def test_an_edit_of_the_seed_counts(self):
        client = self.serve(DRAWN)
        self.assertEqual(self.seed_after_reset(client, 9), 9)
        self.file.write_text(DRAWN.replace(OLD_SEED, 'seed="6"'))
        self.assertEqual(self.seed_after_reset(client), 6)

    def test_a_seed_with_the_reset_counts_more_than_one_of_the_edit(self):
        client = self.serve(DRAWN)
        self.file.write_text(DRAWN.replace(OLD_SEED, 'seed="6"'))
        self.assertEqual(self.seed_after_reset(client, 9), 9)

    # --- no edits

    def mode_after_reset(self, client):
        """The mode after a reset: lockstep, that of the file, if it is read again."""
        self.daemon.text("/simulation").must("set_mode realtime")
        client.reset()
        client.sensors()
        return self.daemon.status()["mode"]

    def test_a_file_in_another_encoding_is_not_edited(self):
        latin = STILL.replace("<rosiml", '<?xml version="1.0" encoding="iso-8859-1"?><!-- \xe4 --><rosiml', 1)
        for name, written in (("mark", b"\xef\xbb\xbf" + STILL.encode()), ("latin-1", latin.encode("latin-1")),
                              ("line ends", STILL.replace("\n", "\r\n").encode())):
            for options in ((), ("--set", "SIMULATION.gravity=5")):
                with self.subTest(name, options=options):
                    client = self.serve(written, *options)
                    self.assertEqual(self.mode_after_reset(client), "realtime")
                    self.file.write_bytes(written.replace(b'range="2"', SHORT.encode()))
                    self.assertEqual(self.mode_after_reset(client), "lockstep")
                    self.assertEqual(self.mode_after_reset(client), "realtime")

    # --- unreadable files

    def test_a_file_that_cannot_be_read_is_told_and_the_old_world_goes_on(self):
        def write(text):
            return lambda: self.file.write_text(text)

        for name, spoil in (("cut", write(STILL[:200])), ("empty", write("")), ("gone", lambda: self.file.unlink()),
                            ("large", write(STILL + f"<!--{' ' * (5 << 20)}-->"))):
            for options in ((), ("--set", "SIMULATION.gravity=5")):
                with self.subTest(name, options=options):
                    client = self.serve(STILL, *options)
                    spoil()
                    client.reset()
                    self.assertEqual(len(client.sensors()), 6)
                    until(lambda: "asked by a client of YARS: " in self.daemon.stderr())
                    self.assertIn("vehicle.xml", self.daemon.stderr().split("asked by a client of YARS: ")[-1])


if __name__ == "__main__":
    unittest.main()
