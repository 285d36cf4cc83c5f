# SPDX-License-Identifier: MIT
"""The results of a sweep or a grading on disk: OUT/results.jsonl, one line of JSON per run, written once. One process writes."""
import contextlib
import csv
import fcntl
import io
import json
import os

from plan import Wrong


def opened(path, flags):
    """Opens a file in OUT, where other users may write too: never through a link."""
    try:
        return os.open(path, flags | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
    except OSError as error:
        if os.path.islink(path):
            raise Wrong(f"{path} is a link: take it away, and do the same again") from None
        raise Wrong(f"{path} cannot be written: {error.strerror}") from None


def put(path, text):
    """Atomically replaces a file, even a link, by a new one."""
    part = path + ".part"
    try:
        with contextlib.suppress(FileNotFoundError):
            os.remove(part)
        with os.fdopen(opened(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL), "w", newline="", encoding="utf-8") as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, path)
    except OSError as error:
        raise Wrong(f"{path} cannot be written: {error.strerror}") from None


def table(rows):
    """Rows as CSV."""
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue()


def line_of(result):
    return json.dumps(result, sort_keys=True) + "\n"


class Results:
    """Opens OUT, for one sweep at a time. Removes a line cut off by a crash, so its run is repeated.

    `done`: the results by key. `older`: lines without all inputs of their runs. `conflicts`: keys with two results of
    different hashes."""

    def __init__(self, folder, what="sweep"):
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise Wrong(f"--out {folder} cannot be made: {error.strerror}") from None
        self.folder = folder
        self.done = {}
        self.older = []
        self.conflicts = []
        self._lock = os.fdopen(opened(os.path.join(folder, ".lock"), os.O_WRONLY | os.O_CREAT), "w")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Wrong(f"another {what} writes to {folder}: wait for it, or write another --out") from None
        self._file = opened(os.path.join(folder, "results.jsonl"), os.O_RDWR | os.O_CREAT)
        self._end = self._read()
        os.ftruncate(self._file, self._end)

    def _read(self):
        with os.fdopen(os.dup(self._file), "rb") as stream:
            content = stream.read()
        end = content.rfind(b"\n") + 1
        for number, line in enumerate(content[:end].splitlines(), 1):
            try:
                result = json.loads(line)
                if "digests" not in result:
                    self.older.append({**result, "key": result["key"]})
                    continue
                before = self.done.setdefault(result["key"], result)
                if before["hash"] != result["hash"]:
                    self.conflicts.append(result["key"])
            except (ValueError, KeyError, TypeError):
                raise Wrong(f"{self.folder}/results.jsonl:{number}: error: this line is not a result: remove it and start again") from None
        return end

    def add(self, result):
        """Writes a result, unless its key has one. Raises OSError if the disk is full, and then writes no part of it."""
        took = [result.pop(name, "") for name in ("wall_s", "started", "host")]
        before = self.done.get(result["key"])
        if before is not None:
            if before["hash"] != result["hash"]:
                self.conflicts.append(result["key"])
            return
        line = line_of(result).encode()
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
        # The wall time, start and machine of a run differ each time, so they are not part of its result.
        with contextlib.suppress(OSError), os.fdopen(opened(os.path.join(self.folder, "times.csv"), os.O_WRONLY | os.O_CREAT | os.O_APPEND), "w",
                                                     newline="", encoding="utf-8") as stream:
            stream.write(table([[result["key"], *took]]))

    def forget(self, unwanted):
        """Removes the results for which `unwanted(result)` holds from the file, so that their runs are repeated."""
        kept = [one for one in self.done.values() if not unwanted(one)]
        if len(kept) == len(self.done):
            return
        put(os.path.join(self.folder, "results.jsonl"), "".join(line_of(one) for one in self.older + kept))
        os.close(self._file)
        self._file = opened(os.path.join(self.folder, "results.jsonl"), os.O_RDWR)
        self._end = os.fstat(self._file).st_size
        self.done = {one["key"]: one for one in kept}

    def close(self):
        os.close(self._file)
        self._lock.close()
