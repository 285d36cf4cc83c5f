# SPDX-License-Identifier: MIT
"""The results of a sweep on disk: OUT/results.jsonl, a line of JSON for each run, written once. One process writes."""
import csv
import fcntl
import json
import os

from plan import Wrong


class Results:
    """Opens OUT, for one sweep at a time. A line that a crash cut off is taken away: its run is done again.

    `done`: the results by key. `conflicts`: keys with two results of different hashes."""

    def __init__(self, folder):
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise Wrong(f"--out {folder} cannot be made: {error.strerror}") from None
        self.folder = folder
        self.done = {}
        self.conflicts = []
        self._lock = open(os.path.join(folder, ".lock"), "w", encoding="utf-8")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Wrong(f"another sweep writes to {folder}: wait for it, or write another --out") from None
        self._file = os.open(os.path.join(folder, "results.jsonl"), os.O_RDWR | os.O_CREAT, 0o644)
        self._end = self._read()
        os.ftruncate(self._file, self._end)

    def _read(self):
        with open(os.path.join(self.folder, "results.jsonl"), "rb") as stream:
            content = stream.read()
        end = content.rfind(b"\n") + 1
        for number, line in enumerate(content[:end].splitlines(), 1):
            try:
                result = json.loads(line)
                before = self.done.setdefault(result["key"], result)
                if before["hash"] != result["hash"]:
                    self.conflicts.append(result["key"])
            except (ValueError, KeyError, TypeError):
                raise Wrong(f"{self.folder}/results.jsonl:{number}: error: this line is no result: take it away and start again") from None
        return end

    def add(self, result):
        """Writes a result, unless its key has one. Raises OSError if the disk is full; then nothing of it is left."""
        wall_s = result.pop("wall_s", None)
        before = self.done.get(result["key"])
        if before is not None:
            if before["hash"] != result["hash"]:
                self.conflicts.append(result["key"])
            return
        line = (json.dumps(result, sort_keys=True) + "\n").encode()
        try:
            written = 0
            while written < len(line):
                written += os.pwrite(self._file, line[written:], self._end + written)
            os.fsync(self._file)
        except OSError:
            os.ftruncate(self._file, self._end)
            raise
        self._end += len(line)
        self.done[result["key"]] = result
        if wall_s is not None:
            self._add_time(result["key"], wall_s)

    def _add_time(self, key, wall_s):
        """How long a run took is no part of its result: it differs each time."""
        try:
            with open(os.path.join(self.folder, "times.csv"), "a", newline="", encoding="utf-8") as stream:
                csv.writer(stream).writerow([key, wall_s])
        except OSError:
            pass

    def forget_failed(self):
        """Takes the results with errors out of the file, so that their runs are done again."""
        kept = [one for one in self.done.values() if not one["error"]]
        part = os.path.join(self.folder, "results.jsonl.part")
        with open(part, "w", encoding="utf-8") as stream:
            stream.writelines(json.dumps(one, sort_keys=True) + "\n" for one in kept)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, os.path.join(self.folder, "results.jsonl"))
        os.close(self._file)
        self._file = os.open(os.path.join(self.folder, "results.jsonl"), os.O_RDWR)
        self._end = os.fstat(self._file).st_size
        self.done = {one["key"]: one for one in kept}

    def close(self):
        os.close(self._file)
        self._lock.close()
