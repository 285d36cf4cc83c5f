"""Shared by tests of recordings: the program's tools, and queries of the file with plain SQLite."""
import os
import sqlite3
import subprocess
import tempfile
import unittest
from contextlib import closing
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon

# A sanitizer makes all this many times slower.
SANITIZED = any(mark in Path(BINARY).read_bytes() for mark in (b"__asan_init", b"__tsan_init"))


def tool(*words, cwd=None, env=None):
    """Runs the program; returns its exit code and output."""
    done = subprocess.run([BINARY, *map(str, words)], capture_output=True, text=True, timeout=2 * LIMIT_S, cwd=cwd,
                          env={**os.environ, **(env or {})})
    return done.returncode, done.stdout + done.stderr


def verify(*files):
    """The output of `coopdyn verify` for a recording, which must be equal."""
    code, said = tool("verify", *files)
    assert code == 0 and said.count("equal, ") == 1, f"exit code {code}\n{said}"
    return said


def equal_steps(*files):
    """The number of steps that verify finds equal."""
    said = verify(*files)
    return int(said[said.index("equal, ") + 7:].split()[0])


def rows(file, query, *values):
    with closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as database:
        return database.execute(query, values).fetchall()


def change(file, query, *values):
    with closing(sqlite3.connect(file)) as database:
        database.execute(query, values)
        database.commit()


class RecordingTestCase(unittest.TestCase):
    """An empty folder for each test, and the name of a file in it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.file = self.folder / "lesson.run"


class Play(Daemon):
    """`coopdyn play FILE`."""

    def __init__(self, file, *options, **more):
        super().__init__(None, *options, name=str(file), verb="play", **more)
