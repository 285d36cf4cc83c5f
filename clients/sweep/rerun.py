# SPDX-License-Identifier: MIT
"""coopdyn sweep rerun: repeats the run of one line of OUT/results.jsonl, and compares."""
import os
import shlex

import plan
import run
from plan import Wrong
from results import Results

kCompared = ("ended", "steps", "time_s", "hash", "scores", "met", "met_s", "logged")
kInputs = ("scenario", "set", "controller", "client", "seed", "duration_s", "time_limit_s", "memory_limit_mib", "version", "digests")


def line_of(folder, key):
    results = Results(folder)
    results.close()
    found = [one for name, one in results.done.items() if name.startswith(key)]
    if len(found) == 1:
        return found[0]
    if found:
        raise Wrong(f"{len(found)} keys of {folder} begin with {key}: write more of it")
    if any(one["key"].startswith(key) for one in results.older):
        raise Wrong(f"{key} was written by an older coopdyn without all inputs of its run: run its sweep again")
    raise Wrong(f"{folder}/results.jsonl has no result {key}: runs.csv of `coopdyn sweep report` lists the keys")


def changes(before, now):
    """The differences between two dictionaries, in words."""
    return [f"{name} is {now.get(name)}, was {before.get(name)}" for name in sorted({**before, **now}) if before.get(name) != now.get(name)]


def rerun(words, parser, program, look):
    """`look(commands)` returns the digests of each of some `coopdyn check` commands. Returns the exit code."""
    options = parser(prog="coopdyn sweep rerun", allow_abbrev=False, description="Repeat the run of one line of a sweep, and compare.",
                     epilog="Start it in the folder of the sweep. Example: coopdyn sweep rerun results --key 1f0c")
    options.add_argument("out", nargs="?", default="results", help="the sweep's folder (default: results)")
    options.add_argument("--key", required=True, help="of the line, or its beginning")
    given = options.parse_args(words)
    if not os.path.isfile(os.path.join(given.out, "results.jsonl")):
        raise Wrong(f"{given.out} has no results.jsonl: name the --out of a sweep")
    line = line_of(given.out, given.key)
    inputs = {name: line[name] for name in kInputs}
    scenario = shlex.split(line["command"])[2]
    if not os.path.isfile(scenario):
        raise Wrong(f"{scenario}, the scenario of {line['key']}, has been removed")
    [digests] = look([plan.check_of(program, scenario, inputs)])
    inputs["digests"] = {**digests, **plan.own_digests(inputs["client"], plan.inputs_among(line["digests"]))}
    differ = [name for name in sorted({**line["digests"], **inputs["digests"]}) if line["digests"].get(name) != inputs["digests"].get(name)]
    if differ:
        print(f"{line['key']}: not what it was: {', '.join(differ)}", flush=True)
    try:
        result = run.run_one(dict(plan.job_of(inputs, plan.serve_of(program, scenario, inputs), "none", given.out), key=line["key"]))
    except run.Lost as lost:
        raise Wrong(f"{line['key']} did not finish: {lost}") from None
    if result["error"]:
        print(f"{line['key']}: {result['error']}")
    told = [text for name in kCompared for text in (changes(line[name], result[name]) if isinstance(line[name], dict) else
                                                    changes({name: line[name]}, {name: result[name]}))]
    print(f"{line['key']}: " + ("; ".join(told) if told else f"the same: {result['steps']} steps, hash {result['hash']}"))
    return 1 if told else 0
