# SPDX-License-Identifier: MIT
"""coopdyn sweep evolve: searches for values that maximise a score. Each generation is a sweep, so a run that has a result in
OUT is not run again, and the same command resumes after Ctrl-C. The same command always gives the same values."""
import argparse
import math
import os
import random
import re
import statistics

import plan
from plan import Wrong
from results import put, table


def range_of(word):
    """(name, least, most) of "swing=0.1..0.8"."""
    match = re.fullmatch(r"([A-Za-z_][\w.]*)=([^.\s]*(?:\.\d*)?)\.\.(\S+)", word)
    try:
        name, least, most = match[1], float(match[2]), float(match[3])
    except (TypeError, ValueError):
        raise Wrong(f"--vary takes NAME=LEAST..MOST, for example --vary swing=0.1..0.8, not {word}") from None
    if not (math.isfinite(least) and math.isfinite(most) and least < most):
        raise Wrong(f"--vary {word}: the first number must be less than the second")
    return name, least, most


def read_options(words, parser):
    options = parser(
        prog="coopdyn sweep evolve", allow_abbrev=False,
        description="Look for values that make a score large (an evolution strategy). Each generation is a sweep.",
        epilog='Example: coopdyn sweep evolve dog --controller "gait frequency=2" --vary swing=0.1..0.8 --vary knee=0..1 '
               "--score travelled --needs standing --duration 10 --out dogs")
    add = options.add_argument
    add("scenario", help="a file or a name, as for coopdyn serve")
    add("--vary", action="append", required=True, metavar="NAME=LEAST..MOST",
        help="a parameter of the controller, or SECTION.key of the scenario; may be repeated")
    add("--controller", help='the loaded controller of all robots, with its fixed parameters: "gait frequency=2"')
    add("--set", action="append", default=[], metavar="SECTION.key=value", help="a key of the scenario for all runs")
    add("--score", required=True, help="the score to maximise")
    add("--needs", action="append", default=[], metavar="SCORE", help="a score that must be above 0, or the run is worth 0")
    add("--generations", type=int, default=10, help="(default: 10)")
    add("--children", type=int, default=12, help="of each generation (default: 12)")
    add("--parents", type=int, default=3, help="the best of all so far have children (default: 3)")
    add("--start", action="append", default=[], metavar="NAME=VALUE", help="where to begin (default: anywhere)")
    add("--seeds", default="1", help="of the runs of each child, which is worth their mean: 1..30, or 1,5,9 (default: 1)")
    add("--random", type=int, default=1, help="seed of the evolution itself (default: 1)")
    add("--duration", help="simulated time of a run, s")
    add("--jobs", default=str(os.cpu_count()), help="runs at the same time (default: as many as cores)")
    add("--out", default="evolved", help="folder of the results (default: evolved)")
    given = options.parse_args(words)
    if min(given.generations, given.children, given.parents) < 1:
        options.error("--generations, --children and --parents take whole numbers from 1")
    return given


def starts_of(words, ranges):
    """{name: value} of --start."""
    starts = {}
    for word in words:
        name, _, value = word.partition("=")
        try:
            starts[name] = float(value)
        except ValueError:
            raise Wrong(f"--start takes NAME=VALUE, for example --start swing=0.2, not {word}") from None
        if all(name != varied for varied, _, _ in ranges):
            raise Wrong(f"--start {word}: no --vary has {name}")
    return starts


def refuse_doubles(ranges, given):
    """Raises Wrong if a varied name also has a fixed value."""
    fixed = {"--controller": (given.controller or "").split()[1:], "--set": given.set}
    varied = [name.lower() for name, _, _ in ranges]
    for name, _, _ in ranges:
        if varied.count(name.lower()) > 1:
            raise Wrong(f"{name} is in two --vary: leave one out")
        for option, words in fixed.items():
            if any(word.partition("=")[0].lower() == name.lower() for word in words):
                raise Wrong(f"{name} is in {option} and in --vary: leave one out")


class Child:
    """Values between 0 and 1, and the spread of its children around them."""

    def __init__(self, values, spread):
        self.values, self.spread, self.worth = values, spread, None


class Evolution:
    def __init__(self, ranges, given):
        self._ranges, self._given, self._random = ranges, given, random.Random(given.random)
        self._starts = starts_of(given.start, ranges)
        self._best = []

    def values_of(self, child):
        """{name: text} of a child's values in their ranges, to four digits."""
        return {name: f"{least + value * (most - least):.4g}" for (name, least, most), value in zip(self._ranges, child.values)}

    def children(self):
        count = self._given.children
        if not self._best:
            starts = self._starts
            first = [(starts[name] - least) / (most - least) if name in starts else 0.5 for name, least, most in self._ranges]
            if starts:
                return [Child(first, 0.15), *(self._changed(first, 0.15) for _ in range(count - 1))]
            return [Child([self._random.random() for _ in self._ranges], 0.2) for _ in range(count)]
        return [self._child() for _ in range(count)]

    def _child(self):
        """Takes each value from one of two parents, and changes it a little."""
        one, other = (self._random.choice(self._best) for _ in range(2))
        mixed = [self._random.choice(pair) for pair in zip(one.values, other.values)]
        spread = min(0.4, math.sqrt(one.spread * other.spread) * math.exp(0.4 * self._random.gauss(0, 1)))
        return self._changed(mixed, max(0.005, spread))

    def _changed(self, values, spread):
        return Child([min(1.0, max(0.0, value + spread * self._random.gauss(0, 1))) for value in values], spread)

    def choose(self, children):
        """Makes the best children so far the next parents. Returns the best one."""
        self._best = sorted(self._best + children, key=lambda child: -child.worth)[:self._given.parents]
        return self._best[0]


def worth_of(result, given):
    """The worth of a run; 0 if the run ended with an error."""
    for name in (given.score, *given.needs):
        if not result["error"] and name not in result["scores"]:
            raise Wrong(f"{given.scenario} has no score {name}: it has {', '.join(result['scores']) or 'none'}")
    if result["error"] or any(not (result["scores"][name] or 0) > 0 for name in given.needs):
        return 0
    return result["scores"][given.score] or 0


def controller_of(values, given):
    own = [f"{name}={value}" for name, value in values.items() if "." not in name]
    if own and not given.controller:
        raise Wrong(f'--vary {own[0].partition("=")[0]} is no SECTION.key: name the controller whose parameter it is, --controller "gait"')
    return " ".join([given.controller, *own]) if given.controller else ""


def write_rows(path, rows):
    put(path, table([rows[0], *(row.values() for row in rows)]))


def evolve(words, parser, run_sweep):
    """`run_sweep(words)` runs a sweep quietly and returns its results in order, the seeds of a row together."""
    given = read_options(words, parser)
    ranges = [range_of(word) for word in given.vary]
    refuse_doubles(ranges, given)
    evolution, story = Evolution(ranges, given), []
    try:
        os.makedirs(given.out, exist_ok=True)
    except OSError as error:
        raise Wrong(f"--out {given.out} cannot be made: {error.strerror}") from None
    seeds = len(plan.seeds_of(given.seeds))
    own_table = os.path.join(given.out, "children.csv")
    for generation in range(1, given.generations + 1):
        children = list({tuple(evolution.values_of(child).items()): child for child in evolution.children()}.values())
        rows = []
        for child in children:
            values = evolution.values_of(child)
            row = {name: value for name, value in values.items() if "." in name}
            rows.append({**row, "controller": controller_of(values, given)} if given.controller or not row else row)
        write_rows(own_table, rows)
        sweep = [given.scenario, "--table", own_table, "--seeds", given.seeds, "--jobs", given.jobs, "--out", given.out]
        sweep += [word for value in given.set for word in ("--set", value)]
        results = run_sweep(sweep + (["--duration", given.duration] if given.duration else []))
        for number, child in enumerate(children):
            child.worth = statistics.fmean(worth_of(one, given) for one in results[number * seeds:(number + 1) * seeds])
        best = evolution.choose(children)
        values = evolution.values_of(best)
        story.append({"generation": generation, given.score: best.worth, **values})
        write_rows(os.path.join(given.out, "evolved.csv"), story)
        print(f"generation {generation}: {given.score} {best.worth:.3f}", *(f"{name}={value}" for name, value in values.items()), flush=True)
    print(f"{given.out}/evolved.csv has the best of each generation; the last: {controller_of(values, given) or values}")
    return 0
