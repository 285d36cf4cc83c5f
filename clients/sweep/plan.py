# SPDX-License-Identifier: MIT
"""What a sweep runs: scenario x settings x controllers x seeds, each with a key. Reads files, starts nothing."""
import csv
import hashlib
import itertools
import json
import os
import re


class Wrong(Exception):
    """What the user wrote cannot be done; says what to write instead."""


def values_of(text):
    """The values of "a,b,c". A comma before a space joins the numbers of one value: "0 0, 1 1" is one value."""
    return [value.strip() for value in re.split(r",(?!\s)", text)]


def seeds_of(text):
    """The seeds of "1..30" or "1,5,9" or both."""
    seeds = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d+)(?:\.\.(\d+))?\s*", part)
        if not match:
            raise Wrong(f"--seeds takes whole numbers and ranges, for example --seeds 1..30 or --seeds 1,5,9, not {text}")
        first, last = int(match[1]), int(match[2] or match[1])
        if last < first:
            raise Wrong(f"--seeds {part.strip()} is empty: write the smaller number first")
        if last - first >= 10_000_000:
            raise Wrong(f"--seeds {part.strip()} has more than ten million seeds")
        seeds += range(first, last + 1)
    if len(set(seeds)) < len(seeds):
        raise Wrong(f"--seeds {text} names a seed twice")
    return seeds


def settings_of(words):
    """[(SECTION.key, [value, …]), …] of the --set options."""
    settings = []
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not re.fullmatch(r"[^.\s=]+\.[^\s=]+", name):
            raise Wrong(f"a setting is SECTION.key=value, for example --set SWARM_1.count=10,20,50, not {word}")
        if any(name.lower() == other.lower() for other, _ in settings):
            raise Wrong(f"{name} is set twice: write its values in one --set, with commas and without spaces")
        settings.append((name, values_of(text)))
    return settings


def controllers_of(texts):
    """Each controller with each combination of its parameters: "diffuse speed=0.1,0.2" are two."""
    every = []
    for text in texts:
        words = text.split()
        if not words:
            raise Wrong('--controller takes a controller and its parameters, for example --controller "diffuse speed=0.1,0.2"')
        choices = []
        for word in words[1:]:
            name, equals, values = word.partition("=")
            if not equals:
                raise Wrong(f'a parameter of a controller is name=value, for example --controller "{words[0]} speed=0.1,0.2", not {word}')
            choices.append([f"{name}={value}" for value in values.split(",")])
        every += [" ".join([words[0], *choice]) for choice in itertools.product(*choices)]
    return every


def table_of(file):
    """The rows of a table of parameters: CSV, its head names settings, SECTION.key (and `seed`, `controller`)."""
    try:
        with open(file, newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
    except (OSError, UnicodeDecodeError) as error:
        raise Wrong(f"--table {file} cannot be read: {error}") from None
    if not rows:
        raise Wrong(f"--table {file} has no rows: its first line names SECTION.key, each other line is a run")
    for number, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise Wrong(f"{file}:{number}: error: this line has another number of values than the first line")
    for name in rows[0]:
        if name not in ("seed", "controller") and "." not in name:
            raise Wrong(f"{file}:1: error: '{name}' is no setting: write SECTION.key, seed or controller")
    return rows


def find_scenario(name, folders):
    """The file of a scenario, as `coopdyn serve` would take it."""
    if os.path.isfile(name):
        return os.path.abspath(name)
    for folder in [os.getcwd(), *os.environ.get("COOPDYN_PATH", "").split(":"), *folders]:
        for place in (folder, os.path.join(folder, "scenarios"), os.path.join(folder, "worlds")):
            for file in (name, *(name + end for end in (".scenario", ".world", ".sdf", ".xml"))):
                path = os.path.join(place, file)
                if folder and os.path.isfile(path):
                    return os.path.abspath(path)
    raise Wrong(f"there is no scenario {name}: write a file, or a name that `coopdyn serve` takes")


def read(path):
    with open(path, "rb") as stream:
        return stream.read()


class Files:
    """What a run reads besides its inputs: the scenario, and the worlds, robots and controllers that it or a setting names."""

    def __init__(self, scenario, folders):
        self._folders = [os.path.dirname(scenario), *os.environ.get("COOPDYN_PATH", "").split(":"), *folders]
        self._seen = {}
        self.scenario = read(scenario)
        lines = re.findall(r"^\s*(file|type|controller|supervisor)\s*[=: ]\s*(\S+)", self.scenario.decode(errors="replace"),
                           re.MULTILINE | re.IGNORECASE)
        if is_experiment(self.scenario):
            lines = [("controller", name) for name in re.findall(r"""\blibrary\s*=\s*["'](\w+)["']""", self.scenario.decode(errors="replace"))]
        self._named = [(key.lower(), name) for key, name in lines]

    def digest(self, chosen, controller):
        """Of the files of a run with these settings."""
        named = [*self._named, *((name.lower().rpartition(".")[2], value.split()[0]) for name, value in chosen.items() if value.split())]
        if controller:
            named.append(("controller", controller.split()[0]))
        parts = [hashlib.sha256(self.scenario).hexdigest(), *(self._digest_of(*one) for one in dict.fromkeys(named))]
        return hashlib.sha256("".join(parts).encode()).hexdigest()[:32]

    def _digest_of(self, key, name):
        if (key, name) not in self._seen:
            content = hashlib.sha256()
            for path in self._paths(key, name):
                content.update(f"{os.path.basename(path)}\0".encode() + hashlib.sha256(read(path)).digest())
            self._seen[key, name] = content.hexdigest()
        return self._seen[key, name]

    def _paths(self, key, name):
        places = {"file": (name, os.path.join("worlds", name)), "type": (os.path.join("robots", name), name)}
        places["controller"] = places["supervisor"] = (os.path.join("controllers", name + ".so"), name + ".so")
        for folder in filter(None, self._folders):
            for place in places.get(key, ()):
                path = os.path.join(folder, place)
                if os.path.isfile(path):
                    return [path]
                if key == "type" and os.path.isdir(path):
                    return sorted(os.path.join(top, file) for top, _, files in os.walk(path) for file in files)
        return []


def is_experiment(content):
    """An experiment of YARS, in XML."""
    return content.lstrip().startswith(b"<")


def ends_of(content):
    """The keys of a scenario that end its runs, as section.key."""
    section, ends = "", set()
    if is_experiment(content):
        elements = re.findall(r"<(simulator|score)\b([^>]*)", re.sub(r"<!--.*?-->", "", content.decode(errors="replace"), flags=re.DOTALL))
        scores = 0
        for element, attributes in elements:
            scores += element == "score"
            section = f"score_{scores}" if element == "score" else "simulation"
            ends |= {f"{section}.{key}" for key in re.findall(r"\b(duration|until|limit)\s*=", attributes)}
        return ends
    for line in content.decode(errors="replace").lower().splitlines():
        line = line.partition("#")[0].strip()
        head = re.match(r"\[\s*(.+?)\s*\]", line)
        key = re.match(r"(duration|until|limit|supervisor)\b", line)
        if head:
            section = head[1]
        elif key:
            ends.add(f"{section}.{key[1]}")
    return ends


def refuse_endless(given, ends, chosen):
    """Each run must end: by the scenario (`ends`), a setting or an option."""
    if given.duration or given.client:
        return
    ends = set(ends)
    for name, value in chosen.items():
        key = name.lower()
        ends.discard(key)
        if value.strip() and key.rpartition(".")[2] in ("duration", "until", "limit", "supervisor"):
            ends.add(key)
    if not ends:
        removed = "".join(f" with {name}={value}" for name, value in chosen.items() if not value.strip())
        raise Wrong(f"nothing ends a run of {given.scenario}{removed}: add --duration SECONDS, or a score with `until` or `limit`")


def refuse_unknown_words(client):
    """A word in braces that is none of ours would go to the client as it is."""
    for word in re.findall(r"(?<!\$)\{(\w+)\}", client or ""):
        if word not in ("server", "seed"):
            raise Wrong(f"--client has {{{word}}}: a sweep fills in {{server}} and {{seed}}")


def lay_out(given, version, program, folders):
    """All jobs of a sweep, in order: dictionaries that run.py carries out. `given`: the options."""
    scenario = find_scenario(given.scenario, folders)
    settings = settings_of(given.set)
    controllers = controllers_of(given.controller) or [None]
    seeds = seeds_of(given.seeds)
    rows = table_of(given.table) if given.table else [{}]
    files = Files(scenario, folders)
    ends = ends_of(files.scenario)
    refuse_unknown_words(given.client)
    clashes = {name.lower() for name, _ in settings} & {name.lower() for name in rows[0]}
    if clashes:
        raise Wrong(f"{clashes.pop()} is set by --set and by --table: leave one out")
    jobs = []
    for row in rows:
        row_seeds = [whole_seed(row["seed"], given.table)] if "seed" in row else seeds
        row_controllers = [row["controller"]] if row.get("controller") else controllers
        fixed = {name: value for name, value in row.items() if name not in ("seed", "controller")}
        for values in itertools.product(*(values for _, values in settings)):
            chosen = {**fixed, **{name: value for (name, _), value in zip(settings, values)}}
            refuse_endless(given, ends, chosen)
            for controller in row_controllers:
                for seed in row_seeds:
                    jobs.append(job_of(given, version, program, scenario, files, chosen, controller, seed))
    keys = [job["key"] for job in jobs]
    if len(set(keys)) < len(keys):
        raise Wrong("two runs of this sweep are the same: look for a value that is written twice")
    return jobs


def whole_seed(text, file):
    if not text.strip().isdigit():
        raise Wrong(f"--table {file}: a seed is a whole number from 0, not {text}")
    return int(text)


def job_of(given, version, program, scenario, files, chosen, controller, seed):
    inputs = {
        "scenario": os.path.splitext(os.path.basename(scenario))[0], "set": chosen, "controller": controller,
        "client": given.client, "seed": seed, "duration_s": given.duration, "version": version,
    }
    text = json.dumps([inputs, files.digest(chosen, controller)], sort_keys=True)
    key = hashlib.sha256(text.encode()).hexdigest()[:20]
    words = [program, "serve", scenario, "--no-http", "--no-render", "--seed", str(seed)]
    if given.client:
        words += ["--port", "0", "--mode", "lockstep"]
    else:
        words += ["--no-net", "--mode", "free", "--speed", "0"]
    if given.duration:
        words += ["--duration", repr(given.duration)]
    for name, value in chosen.items():
        words += ["--set", f"{name}={value}"]
    if controller:
        words += ["--set", f"ROBOTS.controller={controller}"]
    return {
        "key": key, "inputs": inputs, "words": words, "client": given.client, "record": given.record,
        "recordings": os.path.abspath(os.path.join(given.out, "recordings")), "time_limit_s": given.time_limit,
        "memory_limit_mib": given.memory_limit,
    }
