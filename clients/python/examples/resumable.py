# SPDX-License-Identifier: MIT
"""Shared by the learning examples: options, and a state in a JSON file that is replaced atomically."""
import argparse
import json
import os
import sys


def options(text, name, generations, population):
    """Parses the command line; `text` is the program's docstring."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("--generations", type=_count, default=generations, help=f"how many in all (default {generations})")
    parser.add_argument("--population", type=_count, default=population, help=f"tries in each generation (default {population})")
    parser.add_argument("--seed", type=int, default=1, help="of all that is random (default 1)")
    parser.add_argument("--state", default=f"{name}.json", help=f"where it stands (default {name}.json); the run of the best is beside it")
    return parser.parse_args()


def _count(word):
    number = int(word)
    if number < 1:
        raise argparse.ArgumentTypeError(f"a whole number of at least 1, not {word}")
    return number


def load(chosen, **fresh):
    """Loads the state of an earlier start, or returns `fresh`. The earlier start must have had the same seed and population."""
    asked = {"seed": chosen.seed, "population": chosen.population}
    if not os.path.exists(chosen.state):
        return {**asked, "generation": 0, "best": None, "recorded": None, "history": [], **fresh}
    with open(chosen.state, encoding="utf-8") as file:
        try:
            state = json.load(file)
        except ValueError:
            sys.exit(f"{chosen.state} is not JSON: remove it, or write --state OTHER.json")
    for key, value in asked.items():
        if state.get(key) != value:
            sys.exit(f"{chosen.state} was begun with --{key} {state.get(key)}: write that, or --state OTHER.json")
    return state


def save(chosen, state):
    """Writes the state atomically, so that a killed program can resume."""
    part = f"{chosen.state}.part"
    with open(part, "w", encoding="utf-8") as file:
        json.dump(state, file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, chosen.state)


def run_name(chosen):
    """The name of the run file of the best individual."""
    return os.path.splitext(chosen.state)[0] + ".run"


def finish(chosen, state, record):
    """Records the best individual with record(file, best), unless already done, and prints the result."""
    file = run_name(chosen)
    if state["recorded"] != state["best"] or not os.path.exists(file):
        record(file, state["best"])
        state["recorded"] = state["best"]
        save(chosen, state)
    print(f"best {state['best']['fitness']:.3f}, recorded in {file}: coopdyn verify {file}")
