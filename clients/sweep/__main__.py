# SPDX-License-Identifier: MIT
"""coopdyn sweep: many runs of a scenario with different values, controllers and seeds. Started by the program coopdyn."""
import contextlib
import io
import os
import subprocess
import sys

import engines
import evolve
import plan
import report
import rerun
from common import Bar, Parser, catch_signals, look, positive
from plan import Wrong
from results import Results

kShownRuns = 20


def read_options(words):
    options = Parser(
        prog="coopdyn sweep", allow_abbrev=False,
        description="Run a scenario many times. Each run has a key; one that has a result in OUT is not run again.",
        epilog='Example: coopdyn sweep arena20 --set SWARM_1.count=10,20,50 --controller "diffuse speed=0.1,0.2" --seeds 1..30 '
               "--duration 60 --out results    then: coopdyn sweep report results. "
               "coopdyn sweep evolve looks for values that make a score large: coopdyn sweep evolve --help; coopdyn sweep rerun --key KEY repeats one run")
    add = options.add_argument
    add("scenario", help="a file or a name, as for coopdyn serve")
    add("--set", action="append", default=[], metavar="SECTION.key=a,b", help="values of a key of the scenario; may be repeated")
    add("--controller", action="append", default=[], help='a loaded controller for all robots, with values of its parameters: "diffuse speed=0.1,0.2"')
    add("--client", help='a program that drives, started for each run: "python3 mine.py {server}"; also {seed}, and COOPDYN_SERVER is set')
    add("--input", action="append", default=[], metavar="FILE",
        help="a file that runs read though no command names it, such as a program started by a script: if it changes, they run again; may be repeated")
    add("--table", metavar="FILE.csv", help="rows of values: the first line names SECTION.key, seed or controller")
    add("--seeds", default="1", help="1..30, or 1,5,9 (default: 1)")
    add("--duration", type=positive, help="simulated time of a run, s; needed unless a score or the scenario ends it")
    add("--out", default="results", help="folder of the results (default: results)")
    add("--jobs", type=int, default=os.cpu_count(), help="runs at the same time on this machine (default: as many as cores)")
    add("--record", choices=("none", "failed", "all"), default="none", help="keep recordings in OUT/recordings (default: none)")
    add("--time-limit", type=positive, metavar="S", help="limit of a run's wall time, s")
    add("--memory-limit", type=int, metavar="MIB", help="address space of a run, MiB; a small run needs about 200")
    add("--again-failed", action="store_true", help="run again what ended with an error")
    add("--dry-run", action="store_true", help="only show what would run")
    add("--dask", metavar="ADDRESS", help="run on Dask: tcp://HOST:PORT of a scheduler, or local for a cluster on this machine")
    add("--slurm", nargs="?", const="", metavar="OPTIONS", help='run as a Slurm array; options for sbatch: --slurm="--partition=short"')
    add("--no-wait", action="store_true", help="with --slurm: submit and return; the same command later collects")
    given = options.parse_args(words)
    if given.jobs < 1:
        options.error("--jobs takes a whole number from 1")
    if given.memory_limit is not None and given.memory_limit < 64:
        options.error("--memory-limit takes MiB, from 64")
    if given.dask and given.slurm is not None:
        options.error("--dask and --slurm are two engines: leave one out")
    if given.no_wait and given.slurm is None:
        options.error("--no-wait goes with --slurm")
    if given.client and given.controller:
        options.error("--client and --controller both drive the robots: leave one out")
    return given


def show_plan(jobs, done):
    """Prints the table of missing runs. Returns their jobs."""
    missing = [job for job in jobs if job["key"] not in done]
    print(f"{len(jobs)} runs, {len(missing)} to do")
    for job in missing[:kShownRuns]:
        inputs = job["inputs"]
        values = [f"{name}={value}" for name, value in inputs["set"].items()]
        print("  ".join([job["key"], *values, *([inputs["controller"]] if inputs["controller"] else []), f"seed={inputs['seed']}"]))
    if len(missing) > kShownRuns:
        print(f"and {len(missing) - kShownRuns} more")
    return missing


def show_conflicts(results):
    for key in results.conflicts:
        print(f"{key}: two results of this run have different hashes, though files, build and libraries are the same: a client or a controller "
              "computes something else, or reads a file that no --input names", file=sys.stderr)


def show_older(results):
    if results.older:
        keys = ", ".join(one["key"] for one in results.older[:3]) + (", …" if len(results.older) > 3 else "")
        print(f"{results.folder}: {len(results.older)} lines of an older coopdyn lack some inputs of their runs, and do not count: "
              f"{keys}", file=sys.stderr)


def jobs_of(given, program, folders):
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return plan.lay_out(given, version, program, folders, lambda commands: look(commands, given.jobs))


def sweep(given, jobs):
    """Runs `jobs`. Returns the exit code."""
    if given.dry_run and not os.path.exists(given.out):
        show_plan(jobs, {})
        return 0
    results = Results(given.out)
    show_older(results)
    if given.again_failed:
        results.forget(lambda one: one["error"])
    missing = show_plan(jobs, results.done)
    if given.dry_run:
        return 0
    if not missing:
        return summarize(given, jobs, results)
    if given.dask:
        engine = engines.dask(missing, given.dask, given.jobs)
    elif given.slurm is not None:
        engine = engines.slurm(missing, given.slurm, given.out, not given.no_wait)
    else:
        engine = engines.local(missing, given.jobs)
    bar = Bar(len(missing))
    try:
        for result in engine:
            results.add(result)
            bar.add(bool(result["error"]))
    except OSError as error:
        raise Wrong(f"{given.out} cannot be written: {error.strerror}. Make room, and run the same command again: it does what is missing") from None
    finally:
        engine.close()
        results.close()
        with contextlib.suppress(OSError):
            os.rmdir(os.path.join(given.out, "recordings"))  # only if empty
    return summarize(given, jobs, results)


def summarize(given, jobs, results):
    """Prints how the runs of this sweep have ended. Returns the exit code."""
    failed = [job for job in jobs if results.done.get(job["key"], {}).get("error")]
    for job in failed[:3]:
        print(f"{job['key']}: {results.done[job['key']]['error']}", file=sys.stderr)
    if failed:
        print(f"{len(failed)} of {len(jobs)} runs ended with an error (--again-failed runs them again)", file=sys.stderr)
    show_conflicts(results)
    print(f"{given.out}/results.jsonl has {sum(job['key'] in results.done for job in jobs)} of {len(jobs)} results; next: coopdyn sweep report {given.out}")
    return 1 if failed or results.conflicts else 0


def make_report(words):
    options = Parser(prog="coopdyn sweep report", description="Tables, plots and a page of the results of a sweep.")
    options.add_argument("out", nargs="?", default="results", help="its folder (default: results)")
    folder = options.parse_args(words).out
    if not os.path.isfile(os.path.join(folder, "results.jsonl")):
        raise Wrong(f"{folder} has no results.jsonl: name the --out of a sweep")
    results = Results(folder)
    try:
        show_older(results)
        if not results.done:
            raise Wrong(f"{folder}/results.jsonl has no results yet" + (" but those of an older coopdyn" if results.older else ""))
        print(report.write(folder, list(results.done.values()), results.older))
        show_conflicts(results)
    finally:
        results.close()
    return 1 if results.conflicts else 0


def results_of(words, program, folders):
    """Runs a sweep without output. Returns the results of its runs, in order."""
    given = read_options(words)
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        jobs = jobs_of(given, program, folders)
        sweep(given, jobs)
    results = Results(given.out)
    results.close()
    return [results.done[job["key"]] for job in jobs]


def main():
    program, root, *words = sys.argv[1:]
    folders = [os.path.dirname(program), root]
    try:
        if words[:1] == ["report"]:
            return make_report(words[1:])
        if words[:1] == ["evolve"]:
            return evolve.evolve(words[1:], Parser, lambda own: results_of(own, program, folders))
        if words[:1] == ["rerun"]:
            return rerun.rerun(words[1:], Parser, program, look)
        given = read_options(words)
        return sweep(given, jobs_of(given, program, folders))
    except Wrong as wrong:
        print(f"coopdyn sweep: {wrong}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nThe sweep stopped. The same command does what is missing.", file=sys.stderr)
        return 130


if __name__ == "__main__":
    catch_signals()
    sys.exit(main())
