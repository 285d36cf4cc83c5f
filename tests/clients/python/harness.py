# SPDX-License-Identifier: MIT
"""Starts the real daemon for a test; COOPDYN_BINARY names it."""
from __future__ import annotations

import os
import pathlib
import re
import select
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "clients" / "python"))
LIMIT_S = 60


class Daemon:
    """`with Daemon("classroom", "--mode", "lockstep") as d:` – a shipped scenario, the text of a scenario, or a recording to
    play (a path to NAME.run). Records into the folder `recordings`."""

    def __init__(self, scenario: str, *options: str) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.recordings = pathlib.Path(self.folder.name) / "runs"
        self.recordings.mkdir()
        verb = "play" if scenario.endswith(".run") else "serve"
        if verb == "play":
            path = pathlib.Path(scenario)
        elif "\n" in scenario:
            path = pathlib.Path(self.folder.name) / "test.scenario"
            path.write_text(scenario, encoding="utf-8")
        else:
            path = ROOT / "scenarios" / f"{scenario}.scenario"
        self.log = open(pathlib.Path(self.folder.name) / "log", "w+", encoding="utf-8")
        if verb == "serve":
            options += ("--recordings", str(self.recordings))
        self.process = subprocess.Popen([os.environ["COOPDYN_BINARY"], verb, str(path), "--port", "0", *options],
                                        stdout=subprocess.PIPE, stderr=self.log, text=True)
        assert self.process.stdout is not None
        readable, _, _ = select.select([self.process.stdout], [], [], LIMIT_S)
        line = self.process.stdout.readline() if readable else ""
        found = re.search(r"^ready names=(\S+) http=(\S+) robots=(\d+)", line)
        if not found:
            self.stop()
            raise AssertionError(f"the daemon did not get ready: {line!r}\n{self.text}")
        self.server, self.http, self.robots = found.group(1), found.group(2), int(found.group(3))

    def stop(self) -> None:
        if self.process.poll() is None:
            self.process.terminate()
        try:
            self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()
        self.log.flush()
        self.log.seek(0)
        self.text = self.log.read()
        self.log.close()
        self.folder.cleanup()

    def __enter__(self) -> "Daemon":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def scenario_of(robots: int, mode: str = "lockstep") -> str:
    """Robots in a row before a red target."""
    text = f"[SIMULATION]\nmode {mode}\n[FLOOR]\nsize 20 20 0.1\n[TARGET]\nred 5 0\ngreen -2 3\n"
    for i in range(robots):
        text += f"[ROBOT_{i + 1}]\ntype single\nname robot{i + 1}\nposition -2 {1.0 * (i - robots // 2):g}\n"
    return text


def swarm_of(count: int, more: str = "", mode: str = "lockstep", floor: int = 6) -> str:
    """Minibots mini_1, mini_2 ... on a floor, and a red target."""
    return (f"[SIMULATION]\nmode {mode}\n[FLOOR]\nsize {floor} {floor} 0.1\n[TARGET]\nred 2 0\n"
            f"[SWARM_1]\ntype minibot\nname mini\ncount {count}\nfidelity rolling\n{more}")
