# SPDX-License-Identifier: MIT
"""Grades submissions: plans and executes runs, computes their points, and stores the results."""
import compileall
import hashlib
import hmac
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile

import box_run
import engines
import plan
import run
import sandbox
import submissions
from common import Bar, look
from plan import Wrong
from results import Results, put


def version_of(program):
    return subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()


def scores_of(program):
    """Returns a function of a scenario: the names of its scores, and `NAME met` for those with a goal."""
    def names(scenario):
        words = [program, "serve", scenario, "--no-net", "--no-http", "--no-render", "--mode", "free", "--speed", "0", "--steps", "1",
                 "--summary", "/dev/stdout"]
        done = subprocess.run(words, capture_output=True, check=False)
        try:
            scores = json.loads(done.stdout[done.stdout.index(b"{"):])["scores"]
        except ValueError:
            raise Wrong(done.stderr.decode(errors="replace").strip() or f"{scenario} cannot be run: exit code {done.returncode}") from None
        return [one["name"] for one in scores] + [f"{one['name']} met" for one in scores if one["until"]]
    return names


class Stage:
    """A temporary folder with copies of the submissions and the clients."""

    def __init__(self, root, wants_sandbox):
        self.folder = tempfile.mkdtemp(prefix="coopdyn-grade-")
        self.clients = os.path.join(self.folder, "clients")
        self.none = os.path.join(self.folder, "none")  # the folder of recordings that a submission may list; does not exist
        try:
            for name in ("python", "matlab"):
                shutil.copytree(os.path.join(root, "clients", name), os.path.join(self.clients, name),
                                ignore=shutil.ignore_patterns("__pycache__", "examples", "*.pyc"))
            for name, text in sandbox.kUsers.items():
                put(os.path.join(self.clients, name), text)
            compileall.compile_dir(self.clients, quiet=2)  # once, instead of in each run
            submissions.open_to_all(self.clients)
            if wants_sandbox and sandbox.is_root():
                sandbox.Sandbox("root").may_read(self.folder)
            self.sandbox = sandbox.choose(wants_sandbox, self.clients)
        except BaseException:
            self.close()
            raise

    def take(self, every, needed):
        for number, one in enumerate(every):
            submissions.take(one, os.path.join(self.folder, str(number)), needed)
            submissions.open_to_all(os.path.join(self.folder, str(number)))

    def close(self):
        submissions.remove(self.folder)


class Grading:
    """All runs of an assignment's submissions. `key`: the teacher's; None: only visible seeds."""

    def __init__(self, assignment, every, key, program, out, stage):
        self.assignment, self.submissions, self.program, self.out, self.stage = assignment, every, program, out, stage
        self.key, self.seeds, self.version = key, assignment.seeds(key), version_of(program)
        [self.digests] = look([plan.check_of(program, assignment.scenario, {"set": {}, "controller": None})])
        self._refuse_endless()
        self._refuse_missing_program()

    def _refuse_endless(self):
        if not self.assignment.values["duration"] and not plan.ends_of(plan.read(self.assignment.scenario)):
            raise Wrong(f"{self.assignment.path}: nothing ends a run: add `duration 60s` to [ASSIGNMENT], or a score with `until` or `limit` to the scenario")

    def _refuse_missing_program(self):
        word = self.assignment.values["command"][0]
        if "{submission}" not in word and not shutil.which(word, path="/usr/local/bin:/usr/bin:/bin"):
            raise Wrong(f"{self.assignment.path}: the command's program {word} is not in /usr/local/bin, /usr/bin or /bin, where the sandbox looks")
        for path in self.assignment.values["reads"]:
            if not os.path.isabs(path) or not os.path.exists(path):
                raise Wrong(f"{self.assignment.path}: reads {path}: write the absolute path of a file or folder that is there")

    def jobs(self, submission):
        values = dict(self.assignment.values)
        values["clock"] = values["clock"] or 10 + 4 * values["time"]
        found = []
        for label, seed, hidden in self.seeds:
            inputs = {"assignment": self.assignment.digest, "name": submission.name, "submission": submission.digest, "seed": seed, "digests": self.digests,
                      "version": self.version, "sandbox": self.stage.sandbox.who != "none", "hidden": hidden}
            key = keyed(self.key, inputs) if hidden else plan.key_of(inputs)
            # Results of hidden seeds are stored outside the folder that may be handed back.
            own = os.path.join(self.out, *(["hidden"] if hidden else []), submission.name)
            recording = os.path.join(own, label.replace(" ", "-") + ".run")
            serve = {"seed": seed, "client": True, "duration_s": values["duration"], "set": {}, "controller": None}
            words = plan.serve_of(self.program, self.assignment.scenario, serve)
            words += ["--token-for-all", "--log-level", "warning", "--record", recording + ".part.run", "--recordings", self.stage.none]
            found.append({"key": key, "inputs": inputs, "words": words, "label": label, "hidden": hidden, "seed": seed, "values": values,
                          "folder": submission.folder, "clients": self.stage.clients, "command": values["command"], "sandbox": self.stage.sandbox,
                          "recording": recording, "part": recording + ".part.run", "out": self.out})
        return found

    def run(self, processes, again=False, quiet=False):
        """{name: [result, …]} of all submissions that are not refused."""
        jobs = {one.name: self.jobs(one) for one in self.submissions if not one.refused}
        results = Results(self.out, "grading")
        try:
            every = {job["key"]: job for some in jobs.values() for job in some}
            if again:
                results.forget(lambda one: one["key"] in every)
            missing = [job for key, job in every.items() if key not in results.done or self._lost(results.done[key])]
            results.forget(lambda one: any(job["key"] == one["key"] for job in missing))
            if not quiet:
                print(f"{counted(len(self.submissions), 'submission')}, {counted(len(self.seeds), 'seed')} each: {counted(len(every), 'run')}, {len(missing)} to do", flush=True)
            self._carry_out(missing, results, processes, None if quiet or not missing else Bar(len(missing)))
            return {name: [dict(results.done.get(job["key"]) or self.troubles[job["key"]]) for job in some] for name, some in jobs.items()}
        finally:
            results.close()

    def _lost(self, result):
        return result["recording"] and not os.path.exists(os.path.join(self.out, result["recording"]))

    def _carry_out(self, missing, results, processes, bar):
        self.troubles = {}
        engine = engines.local(missing, processes, box_run.carry_out)
        try:
            for result in engine:
                if "sentence" not in result:  # lost too often
                    job = next(job for job in missing if job["key"] == result["key"])
                    result = {**empty(job), "trouble": f"The simulator was ended from outside: {result['error']}."}
                if result["trouble"]:
                    self.troubles[result["key"]] = result
                else:
                    results.add({**result, "digests": self.digests})
                if bar:
                    bar.add(bool(result["trouble"]))
        except OSError as error:
            raise Wrong(f"{self.out} cannot be written: {error.strerror}. Make room, and run the same command again: it does what is missing") from None
        finally:
            engine.close()


def counted(count, what):
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def empty(job):
    return {"key": job["key"], "label": job["label"], "hidden": job["hidden"], "seed": None, "steps": None, "time_s": None, "hash": None, "scores": {},
            "units": {}, "met": {}, "met_s": {}, "ended": "lost", "void": True, "sentence": "", "recording": None, "output": ""}


def keyed(key, inputs):
    """The key of a run on a hidden seed, from which nobody can find the seed by trial."""
    return hmac.new(key, json.dumps(inputs, sort_keys=True).encode(), hashlib.sha256).hexdigest()[:20]


def measures_of(result):
    """The values that earn points: scores, and the times at which goals were met."""
    return {**result["scores"], **{f"{name} met": when for name, when in result["met_s"].items()}}


def earn(result, points):
    """Adds a run's points to its result."""
    result["earned"] = [0.0 if result["void"] else one.of(measures_of(result)) for one in points]
    result["points"] = sum(result["earned"])


class Grade:
    """The grade of a submission: the mean of its runs. `runs`: their results, including points; `sandbox`: whether they ran in one."""

    def __init__(self, assignment, submission, runs, sandbox):
        self.assignment, self.submission, self.runs, self.sandbox = assignment, submission, runs, sandbox
        for one in runs:
            earn(one, assignment.points)
        self.points = statistics.fmean(one["points"] for one in runs) if runs else 0.0
        self.earned = [statistics.fmean(one["earned"][k] for one in runs) if runs else 0.0 for k in range(len(assignment.points))]
        self.troubles = [one for one in runs if one["trouble"]]

    @property
    def name(self):
        return self.submission.name

    @property
    def sentence(self):
        """The reason for lost points, in short."""
        if self.submission.refused:
            return self.submission.refused
        void = [one for one in self.runs if one["void"]]
        if not void:
            return ""
        first = next((one for one in void if not one["hidden"]), void[0])
        return first["sentence"] if len(void) == len(self.runs) else f"{len(void)} of {len(self.runs)} runs earn nothing. {first['label']}: {first['sentence']}"

    def improvements(self):
        """[(Points, mean value of the runs that have one, points earned), …] of all Points not earned completely."""
        found = []
        for one, earned in zip(self.assignment.points, self.earned):
            values = [measures_of(run_)[one.score] for run_ in self.runs if measures_of(run_).get(one.score) is not None]
            if earned < one.most - 1e-9:
                found.append((one, statistics.fmean(values) if values else None, earned))
        return found

    def worst(self):
        """The visible run with a recording that earns the fewest points."""
        seen = [one for one in self.runs if not one["hidden"] and one["recording"] and one["steps"]]
        return min(seen, key=lambda one: one["points"], default=None)


def store(grading, grade, text):
    """Writes OUT/NAME: results.json, and the submission itself for appeals."""
    folder = os.path.join(grading.out, grade.name)
    os.makedirs(folder, exist_ok=True)
    put(os.path.join(folder, "results.json"), text)
    if not grade.submission.refused:
        submissions.keep(grade.submission, os.path.join(folder, "submission.tar"))


def remember(grading):
    """Writes grading.json, which an appeal needs."""
    put(os.path.join(grading.out, "grading.json"), json.dumps({
        "assignment": os.path.abspath(grading.assignment.path), "digest": grading.assignment.digest, "version": grading.version,
        "digests": grading.digests, "sandbox": grading.stage.sandbox.who != "none"}, indent=1, sort_keys=True) + "\n")


def warn_of_no_sandbox(stage):
    if stage.sandbox.who == "none":
        print("NO SANDBOX: the submissions run with your rights, with the network and all your files. The results say so.", file=sys.stderr)
