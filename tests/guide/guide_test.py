"""Runs every block of docs/guide.md, chapter by chapter, as a reader would, and the programs of the README.

`sh serve` starts a daemon (on free ports), `sh` runs commands, `python` and `matlab` (in Octave) are programs, `text` is
typed into netcat, `scenario NAME` is saved as that file. Each chapter is read alone, in an empty folder, and ends the
daemons that it starts (`coopdyn quit`).
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
BINARY = Path(os.environ["COOPDYN_BINARY"])
BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```", re.M | re.S)


def chapters():
    text = (ROOT / "docs" / "guide.md").read_text()
    parts = re.split(r"^## (.*)$", text, flags=re.M)[1:]
    return {title: BLOCK.findall(body) for title, body in zip(parts[::2], parts[1::2])}


class Reader:
    """A reader in an empty folder with coopdyn on the path and both clients available."""

    def __init__(self, folder):
        self.folder = folder
        self.daemon = None
        self.env = {**os.environ, "PATH": f"{BINARY.parent}:{os.environ['PATH']}", "COOPDYN_TOKEN": "chalk-and-board",
                    "PYTHONPATH": str(ROOT / "clients" / "python"), "COOPDYN_PATH": str(ROOT)}

    def run(self, command, program=None):
        done = subprocess.run(command, cwd=self.folder, env=self.env, input=program, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=200, text=True)
        assert done.returncode == 0, f"{command}\n{program}\n{done.stdout}"
        return done.stdout

    def serve(self, command):
        assert self.daemon is None, f"the daemon before {command!r} still runs"
        words = command.split() + ["--port", "0"]
        self.daemon = subprocess.Popen(words, cwd=self.folder, env=self.env, stdout=subprocess.PIPE,
                                       stderr=subprocess.DEVNULL, text=True)
        ready = self.daemon.stdout.readline()
        match = re.match(r"ready names=\S*:(\d+) ", ready)
        assert match, f"{command}: {ready!r}"
        self.env["COOPDYN_SERVER"] = f"127.0.0.1:{match.group(1)}"

    def type_text(self, lines):
        """Sends lines, each OPEN on a new connection; no reply may be an error."""
        port = self.env["COOPDYN_SERVER"].rsplit(":", 1)[1]
        for session in re.findall(r"^OPEN .*\n(?:(?!OPEN).*\n)+", lines, flags=re.M):
            said = self.run(["nc", "-N", "127.0.0.1", port], session).splitlines()
            assert said[0] == "ok", said
            assert len(said) == session.count("\n") and all(line.startswith("0 ") for line in said[1:]), (session, said)

    def program(self, kind, body):
        if kind == "python":
            return [sys.executable, "-c", body]
        return ["octave", "--no-gui", "--norc", "--quiet", "--eval", f"addpath('{ROOT}/clients/matlab');\n" + body]

    def block(self, kind, body):
        words = kind.split()
        if words == ["sh", "serve"]:
            self.serve(body.strip())
        elif words == ["sh"]:
            self.run(["bash", "-euc", body])
            if "coopdyn quit" in body:
                self.daemon.communicate(timeout=60)
                assert self.daemon.returncode == 0, body
                self.daemon = None
        elif words in (["python"], ["matlab"]):
            self.run(self.program(kind, body))
        elif words == ["text"]:
            self.type_text(body)
        elif words[:1] == ["scenario"]:
            (self.folder / words[1]).write_text(body)
        else:
            raise AssertionError(f"a block of an unknown kind: {kind!r}")

    def close(self):
        if self.daemon is not None:
            self.daemon.terminate()
            self.daemon.communicate()
            self.daemon = None


class GuideTest(unittest.TestCase):
    def read_chapter(self, title):
        blocks = chapters()[title]
        self.assertTrue(blocks)
        with tempfile.TemporaryDirectory() as folder:
            reader = Reader(Path(folder))
            try:
                for kind, body in blocks:
                    reader.block(kind, body)
                self.assertIsNone(reader.daemon, "the chapter does not end its daemon")
            finally:
                reader.close()

    def test_the_student(self):
        self.read_chapter("The student")

    def test_the_teacher(self):
        self.read_chapter("The teacher")

    def test_the_researcher(self):
        self.read_chapter("The researcher")

    def test_a_run_that_is_worth_something(self):
        self.read_chapter("A run that is worth something")

    def test_change_the_world_while_it_runs(self):
        self.read_chapter("Change the world while it runs")

    def test_record_play_back_branch(self):
        self.read_chapter("Record, play back, branch")

    def test_swarms_a_team(self):
        self.read_chapter("Swarms: a team")

    def test_an_arm(self):
        self.read_chapter("An arm")

    def test_what_a_robot_sees_and_feels(self):
        self.read_chapter("What a robot sees and feels")

    def test_telnet(self):
        self.read_chapter("Telnet")

    def test_the_night_run(self):
        self.read_chapter("The night run")

    def test_old_coopdynsim_files(self):
        self.read_chapter("Old CoopDynSim files")

    def test_the_loop_that_catches_a_reset_goes_on_after_one(self):
        recipes = [(kind, body) for kind, body in chapters()["The student"] if "except coopdyn.WorldReset" in body
                   or "coopdyn:reset" in body]
        self.assertEqual([kind for kind, _ in recipes], ["python", "matlab"])
        with tempfile.TemporaryDirectory() as folder:
            reader = Reader(Path(folder))
            self.addCleanup(reader.close)
            for kind, body in recipes:
                reader.serve("coopdyn serve classroom --mode lockstep --speed 4")  # so that the reset comes before the end
                with subprocess.Popen(reader.program(kind, body), cwd=folder, env=reader.env, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True) as program:
                    while float(reader.run(["coopdyn", "call", "/simulation", "get_time"]).split()[-1]) < 20:
                        self.assertIsNone(program.poll())
                    reader.run(["coopdyn", "reset"])
                    said = program.communicate(timeout=200)[0]
                self.assertEqual((program.returncode, said.count("the world was reset")), (0, 1), said)
                reader.close()

    def test_the_programs_of_the_readme(self):
        programs = [(kind, body) for kind, body in BLOCK.findall((ROOT / "README.md").read_text()) if kind]
        self.assertEqual([kind for kind, _ in programs], ["python", "matlab"])
        with tempfile.TemporaryDirectory() as folder:
            reader = Reader(Path(folder))
            self.addCleanup(reader.close)
            reader.serve("coopdyn serve classroom")
            for kind, body in programs:
                reader.block(kind, body)

    def test_no_chapter_is_left_out(self):
        tested = {name[5:].replace("_", " ") for name in dir(self) if name.startswith("test_")}
        for title in chapters():
            self.assertIn(title.lower().replace(":", "").replace(",", ""), tested)


if __name__ == "__main__":
    unittest.main()
