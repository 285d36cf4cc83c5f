# SPDX-License-Identifier: MIT
"""The same program takes a seat of a class in Python, Octave and C++, and by the commands of coopdyn."""
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from classes import LIMIT_S, Host

HERE = Path(__file__).resolve().parent
CLIENTS = HERE.parents[1] / "clients"
NO_SEAT = "this is a class, where each student has a seat"


class HostTestCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.host = cls.enterClassContext(Host())
        cls.pins = {seat: row["pin"] for seat, row in cls.host.roll().items()}
        cls.page = f"http://127.0.0.1:{cls.host.http_port}/"

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.variables = dict(os.environ, PYTHONPATH=str(CLIENTS / "python"), COOPDYN=os.environ["COOPDYN_BINARY"],
                              COOPDYN_SERVER=f"127.0.0.1:{self.host.port}")
        for name in ("COOPDYN_SEAT", "DISPLAY"):
            self.variables.pop(name, None)

    def kill_daemon(self, seat):
        """Kills the daemon of a seat, and waits for its end."""
        process = self.host.daemon(seat)
        handle = os.pidfd_open(process)
        os.kill(process, signal.SIGKILL)
        select.select([handle], [], [], LIMIT_S)
        os.close(handle)


class Programs:
    """Tests of every client; `command()` returns the command of its program."""

    def start(self, seat, *actions, pin=None, **variables):
        words = self.command(self.variables["COOPDYN_SERVER"], seat, pin or self.pins.get(seat, "-"), *actions)
        process = subprocess.Popen(words, cwd=self.folder, env=dict(self.variables, **variables), stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(process.__exit__, None, None, None)
        self.addCleanup(process.kill)
        return process

    def act(self, seat, *actions, **how):
        return self.start(seat, *actions, **how).communicate(timeout=600)[0].splitlines()

    def test_a_program_drives_in_its_own_seat_and_the_wall_knows_its_language(self):
        page, driven, modules = self.act("ana", "connect", "drive", "modules")
        self.assertEqual((page, driven), (f"page {self.page}s/ana/", "driven"))
        self.assertGreater(int(modules.split()[1]), 5)
        self.host.tile("ana", lambda tile: tile["language"] == self.language)

    def test_a_variable_names_the_seat_of_an_unchanged_program(self):
        self.assertEqual(self.act("-", "connect", COOPDYN_SEAT=f"ben:{self.pins['ben']}"), [f"page {self.page}s/ben/"])

    def test_pictures_and_recordings_come_from_the_page_of_the_seat(self):
        self.assertEqual(self.act("ben", "connect", "picture", "run")[1:], ["picture picture.png", "run fetched.run"])
        self.assertTrue((self.folder / "picture.png").read_bytes().startswith(b"\x89PNG"))
        self.assertTrue((self.folder / "fetched.run").read_bytes().startswith(b"SQLite format 3"))

    def test_refusals_are_the_words_of_the_class(self):
        self.assertIn("error not_allowed no seat 'ana' with this PIN", self.act("ana", "connect", pin="0000")[0])
        self.assertIn("error not_allowed " + NO_SEAT, self.act("-", "connect")[0])

    def test_a_killed_daemon_is_told_and_the_seat_can_be_taken_again_at_once(self):
        process = self.start("ana", "connect", "drive", "wait", "drive", "connect", "drive")
        for line in process.stdout:
            if line == "waits\n":
                break
        self.kill_daemon("ana")
        after = process.communicate("go\n", timeout=600)[0].splitlines()
        self.assertEqual(after[0], "goes on")
        self.assertIn("the class restarts the seat ana where it was: run your program again", after[1])
        self.assertEqual(after[2:4], [f"page {self.page}s/ana/", "driven"])

    def test_a_daemon_of_its_own_has_no_seat(self):
        self.assertEqual(self.act("-", "launch", COOPDYN_SEAT=f"ana:{self.pins['ana']}"), ["launched"])

    def test_doctor_finds_the_seat(self):
        said = self.act("ana", "doctor")
        self.assertIn("ok    seat: ana is yours, by its PIN", said)
        self.assertIn("healthy", said)


class Python(Programs, HostTestCase):
    language = "python"

    def command(self, *words):
        return [sys.executable, str(HERE / "clients_program.py"), *words]

    def test_the_file_is_a_command_that_reads_the_variable(self):
        client = str(CLIENTS / "python" / "coopdyn.py")
        said = subprocess.run([sys.executable, client, "hello"], env=dict(self.variables, COOPDYN_SEAT=f"ana:{self.pins['ana']}"), text=True,
                              stdout=subprocess.PIPE, timeout=600).stdout
        self.assertIn("hello from robot1", said)


@unittest.skipUnless(shutil.which("octave"), "no Octave")
class Octave(Programs, HostTestCase):
    language = "octave"

    def command(self, *words):
        paths = "".join(f"addpath('{folder}'); " for folder in (CLIENTS / "matlab", HERE))
        listed = ", ".join(f"'{word}'" for word in words)
        return ["octave", "--no-gui", "--norc", "--no-history", "--eval", f"{paths}clients_program({listed})"]


class Cpp(Programs, HostTestCase):
    language = "cpp"

    def command(self, *words):
        return [os.environ["CLIENTS_PROGRAM"], *words]


class Commands(HostTestCase):
    def run_coopdyn(self, *words, **variables):
        run = subprocess.run([os.environ["COOPDYN_BINARY"], *words], env=dict(self.variables, **variables), text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT_S)
        return run.returncode, run.stdout

    def test_each_takes_the_seat_that_it_or_the_variable_names(self):
        ana = f"ana:{self.pins['ana']}"
        for words, says in ((["status"], "lockstep"), (["list"], "/robot1/motors"), (["doctor"], "OPEN gives /simulation"),
                            (["call", "/robot1/pose", "get_pose"], '0 "" 40')):
            for options, variables in ((["--seat", ana], {}), ([], {"COOPDYN_SEAT": ana})):
                with self.subTest(words=words, options=options):
                    code, said = self.run_coopdyn(words[0], *options, *words[1:], **variables)
                    self.assertEqual(code, 0, said)
                    self.assertIn(says, said)

    def test_refusals_are_the_words_of_the_class(self):
        for words in (["status"], ["list"], ["doctor"]):
            code, said = self.run_coopdyn(*words)
            self.assertEqual(code, 1, said)
            self.assertIn(NO_SEAT, said)
        self.assertIn("no seat 'ana' with this PIN", self.run_coopdyn("status", "--seat", "ana:0000")[1])

    def test_a_wrong_form_says_what_to_write(self):
        for wrong in ("ana", "ana:", ":0912", "ana:0912:1", "ana: 0912"):
            code, said = self.run_coopdyn("status", "--seat", wrong)
            self.assertEqual(code, 2, said)
            self.assertIn("--seat is NAME:PIN as on your sheet, e.g. ana:7305", said)


if __name__ == "__main__":
    unittest.main()
