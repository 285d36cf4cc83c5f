# SPDX-License-Identifier: MIT
"""coopdyn grade --appeal: repeats each run from its recording, bit by bit, and then runs the program again."""
import importlib
import json
import math
import os
import subprocess
import sys

import assignment as assignments
import grading
import submissions
from plan import Wrong


def found(path):
    """(OUT, content of results.json) for OUT/NAME, OUT/NAME/results.json or OUT/results.json."""
    file = os.path.join(path, "results.json") if os.path.isdir(path) else path
    try:
        with open(file, encoding="utf-8") as stream:
            result = json.load(stream)
        data = result["extra_data"]
        name = data["name"]
        for one in data["runs"]:
            float(one["points"]), one["key"], one["label"], one["hash"], one["recording"], one["void"]
        if submissions.safe(name) != name:
            raise ValueError
    except (OSError, ValueError, KeyError, TypeError):
        raise Wrong(f"--appeal {path}: there is no results.json of a grading: name OUT/NAME") from None
    folder = os.path.dirname(os.path.abspath(file))
    for out in (os.path.dirname(folder), folder):
        if os.path.isfile(os.path.join(out, "grading.json")) and os.path.isdir(os.path.join(out, name)):
            return out, result
    raise Wrong(f"--appeal {path}: it is no longer in the folder of a grading with its grading.json: move it back")


def facts_of(program, recording):
    """The output of `coopdyn info` for a recording; None if it cannot be read."""
    done = subprocess.run([program, "info", "--json", recording], capture_output=True, text=True, check=False)
    try:
        return json.loads(done.stdout)[0]
    except (ValueError, IndexError):
        return None


class Appeal:
    """The appeal of one submission. `same` is false once anything differs."""

    def __init__(self, path, program, folders):
        self.program, self.folders, self.same = program, folders, True
        self.out, self.result = found(path)
        self.data = self.result["extra_data"]
        sys.path.append(os.path.join(folders[-1], "clients", "python"))
        self.reader = importlib.import_module("coopdyn")
        with open(os.path.join(self.out, "grading.json"), encoding="utf-8") as stream:
            self.graded = json.load(stream)

    def say(self, label, text, differs=False):
        self.same = self.same and not differs
        print(f"{label}: {text}", flush=True)

    def hear(self, options):
        """Repeats all runs. Returns the exit code."""
        version = grading.version_of(self.program)
        if version != self.data["version"]:
            print(f"This is {version}; it was graded with {self.data['version']}: hashes may differ by that.", flush=True)
        assignment = self.assignment(options.moved or self.graded["assignment"])
        for one in self.data["runs"]:
            self.recording(one, assignment)
        if self.data["runs"] and assignment:
            self.total(assignment)
            self.again(assignment, options)
        if not self.data["runs"]:
            print(f"There are no runs: {self.result['output'].splitlines()[0]}")
        print("The grade stands: all that was repeated is the same." if self.same else "Something differs: see above.")
        return 0 if self.same else 1

    def assignment(self, path):
        try:
            found_ = assignments.read(path, self.folders, grading.scores_of(self.program))
        except Wrong as wrong:
            print(f"The assignment {path} cannot be read, so points and programs are not repeated: {wrong}", flush=True)
            return None
        if found_.digest == self.data["assignment_digest"]:
            return found_
        print(f"The assignment {path} or its scenario has changed since, so points and programs are not repeated. Put the old text back for that.", flush=True)
        return None

    def recording(self, one, assignment):
        """Repeats a run from its recorded inputs."""
        if not one["recording"]:
            return self.say(one["label"], f"there is no recording: {one['sentence']}")
        path = os.path.join(self.out, one["recording"])
        if not os.path.isfile(path) or not os.path.realpath(path).startswith(os.path.realpath(self.out) + os.sep):
            return self.say(one["label"], f"differs: its recording {one['recording']} is gone", True)
        done = subprocess.run([self.program, "verify", path], capture_output=True, text=True, check=False)
        said = (done.stdout.strip() or done.stderr.strip()).replace(path, one["recording"])
        if done.returncode != 0:
            return self.say(one["label"], f"differs: the recording does not repeat: {said}. It was changed, or another build reads it", True)
        facts = facts_of(self.program, path)
        if facts is None or facts["last_hash"] != one["hash"]:
            return self.say(one["label"], f"differs: the recording ends with the hash {facts and facts['last_hash']}, the result says {one['hash']}: one of "
                            "them was changed", True)
        self.say(one["label"], f"same: the recording repeats bit by bit, {one['steps']} steps, hash {one['hash']}")
        scores = {name: None if math.isnan(value) else value for name, value in self.reader.read_run(path).scores().items()}
        if scores != one["scores"]:
            return self.say(one["label"], f"differs: the recording has the scores {scores}, the result says {one['scores']}: the result was changed", True)
        if assignment:
            self.points(one, assignment)

    def points(self, one, assignment):
        earned = dict(one)
        grading.earn(earned, assignment.points)
        if abs(earned["points"] - one["points"]) > 1e-3:
            self.say(one["label"], f"differs: its scores earn {earned['points']:.4g} points, the result says {one['points']:.4g}: the result was changed", True)

    def total(self, assignment):
        runs = self.data["runs"]
        mean = sum(one["points"] for one in runs) / len(runs)
        if abs(mean - self.result["score"]) > 1e-3:
            self.say("the grade", f"differs: the mean of the runs is {mean:.4g} points, the result says {self.result['score']:.4g}: the result was changed", True)

    def again(self, assignment, options):
        """Runs the program again, if possible, from the copy that the grading stored."""
        copy = os.path.join(self.out, self.data["name"], "submission.tar")
        if not os.path.isfile(copy):
            return print("The program is not repeated: submission.tar is gone.")
        seeds = {}
        for one in self.data["runs"]:
            facts = one["recording"] and facts_of(self.program, os.path.join(self.out, one["recording"]))
            if facts:
                seeds[one["label"]] = int(facts["seed"])
        stage = grading.Stage(self.folders[-1], not options.no_sandbox)
        try:
            submission = submissions.Submission(self.data["name"], self.data["id"], copy)
            stage.take([submission], assignment.values["files"])
            if submission.refused or submission.digest != self.data["submission_digest"]:
                return self.say("the program", "differs: submission.tar is not what was graded" + (f": {submission.refused}" if submission.refused else ""), True)
            out = os.path.join(stage.folder, "out")
            again = grading.Grading(assignment, [submission], None, self.program, out, stage)
            again.seeds = [(one["label"], seeds[one["label"]], False) for one in self.data["runs"] if one["label"] in seeds]
            runs = {one["label"]: one for one in again.run(options.jobs, quiet=True)[submission.name]}
        finally:
            stage.close()
        for one in self.data["runs"]:
            if one["label"] in runs:
                self.compare(one, runs[one["label"]], assignment)

    def compare(self, one, again, assignment):
        grading.earn(again, assignment.points)
        if again["trouble"]:
            return self.say(one["label"], f"the program was not repeated: {again['trouble']}")
        if again["hash"] == one["hash"] and all(again[name] == one[name] for name in ("scores", "met_s", "void")):
            return self.say(one["label"], "same: the program drives it to the same hash and scores again")
        if again["hash"] == one["hash"]:
            return self.say(one["label"], f"differs: the program drives it to the same hash, but {again['points']:.4g} points instead of {one['points']:.4g}: the "
                            "result was changed, or a limit has stopped the program this time", True)
        if one["void"]:
            return self.say(one["label"], f"the program ends at another moment, as it was stopped by a limit or failed: {again['sentence']} That changes nothing in "
                            "the grade")
        self.say(one["label"], f"differs: the program drives it to another hash, {again['hash']}, and {again['points']:.4g} points instead of {one['points']:.4g}. It looks "
                 "at the clock or at chance, or was written for another machine. The recorded run counts", True)


def appeal(options, program, folders):
    return Appeal(options.appeal, program, folders).hear(options)
