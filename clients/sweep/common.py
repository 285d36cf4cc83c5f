# SPDX-License-Identifier: MIT
"""Shared by the commands that start runs: reads options, shows progress, and shuts down on signals."""
import argparse
import concurrent.futures
import json
import os
import signal
import subprocess
import sys
import threading
import time

from plan import Wrong

kGrace_s = 20


def positive(text):
    value = float(text)
    if not 0 < value < float("inf"):
        raise ValueError
    return value


class Parser(argparse.ArgumentParser):
    def error(self, message):
        print(f"{self.prog}: {message} ({self.prog} --help shows how to write it)", file=sys.stderr)
        sys.exit(2)


class Bar:
    """The progress of a sweep: a bar on a terminal; elsewhere a line for each tenth."""

    def __init__(self, count):
        self._count, self._done, self._failed, self._began, self._told = count, 0, 0, time.monotonic(), 0

    def add(self, failed):
        self._done += 1
        self._failed += failed
        spent_s = time.monotonic() - self._began
        left_s = spent_s / self._done * (self._count - self._done)
        text = f"{self._done}/{self._count}" + (f", {self._failed} with errors" if self._failed else "") + f", {left_s:.0f} s left"
        if sys.stderr.isatty():
            width = 30 * self._done // self._count
            print(f"\r\033[K[{'#' * width:<30}] {text}", end="\n" if self._done == self._count else "", file=sys.stderr, flush=True)
        elif 10 * self._done // self._count > self._told:
            self._told = 10 * self._done // self._count
            print(text, file=sys.stderr, flush=True)


def check_one(words):
    """Runs `coopdyn check --digests`; returns the digests, and the lines of its warnings. Raises Wrong for a mistake."""
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return json.loads(done.stdout), done.stderr.splitlines()
    raise Wrong(done.stderr.strip() or done.stdout.strip() or f"coopdyn check ended with exit code {done.returncode}")


def look(commands, processes=1):
    """Runs check commands; returns the digests of each, and prints each warning once."""
    with concurrent.futures.ThreadPoolExecutor(processes) as pool:
        found = list(pool.map(check_one, commands))
    for line in dict.fromkeys(line for _, lines in found for line in lines):
        print(line, file=sys.stderr)
    return [digests for digests, _ in found]


def stop(*_):
    """Handles a signal: shuts down in order, or exits after kGrace_s. Daemons exit with this process."""
    force = threading.Timer(kGrace_s, os._exit, [130])
    force.daemon = True
    force.start()
    raise KeyboardInterrupt


def catch_signals():
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
