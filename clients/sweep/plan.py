# SPDX-License-Identifier: MIT
"""Plans a sweep: scenario x settings x controllers x seeds, each run with a key. Reads files, starts nothing."""
import ast
import csv
import hashlib
import itertools
import json
import os
import re
import shlex
import shutil


INPUT = "input "  # prefix of the names of digests of --input


class Wrong(Exception):
    """An error of the user; says what to write instead."""


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
    """Each controller with each combination of its parameters: "diffuse speed=0.1,0.2" gives two."""
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
    """The rows of a table of parameters: CSV whose first line names settings, SECTION.key (and `seed`, `controller`)."""
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
    """The file of a scenario, found as by `coopdyn serve`."""
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


def digest(content):
    return hashlib.sha256(content).hexdigest()[:16]


def modules_of(content):
    """The modules that a Python program imports, as paths without extensions."""
    try:
        nodes = list(ast.walk(ast.parse(content)))
    except (SyntaxError, ValueError):
        return []
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    for node in nodes:
        if isinstance(node, ast.ImportFrom):
            names += [node.module] * bool(node.module) + [f"{node.module or ''}.{alias.name}".strip(".") for alias in node.names]
    return [name.replace(".", os.sep) for name in names]


def files_of_module(module, folders):
    """The files of a module in the first folder that has it, with those of its packages."""
    for folder in folders:
        files = [os.path.join(folder, module + end) for end in (".py", os.sep + "__init__.py", os.sep + "__main__.py")]
        if any(map(os.path.isfile, files)):
            while module := os.path.dirname(module):
                files.append(os.path.join(folder, module, "__init__.py"))
            return list(filter(os.path.isfile, files))
    return []


def words_inside(text):
    """The words of commands inside a word, as in sh -c "cd x; python3 mine.py"."""
    reader = shlex.shlex(text, posix=True, punctuation_chars=True)
    reader.whitespace_split = True
    try:
        words = list(reader)
    except ValueError:  # not a command
        return []
    return [inner for word in words if word != text for inner in (word, *words_inside(word))]


def files_of(client):
    """{name: path} of the files of a client's command: its program, the files and modules that it names, and the modules that
    Python programs among them import from their own folder, a folder that it names, or PYTHONPATH."""
    try:
        words = shlex.split(client or "")
    except ValueError as error:
        raise Wrong(f"--client {client} cannot be read: {error}") from None
    program = shutil.which(words[0]) if words else None
    words = [part for word in words + [inner for word in words for inner in words_inside(word)] for part in (word, word.partition("=")[2])]
    folders = [word for word in words if os.path.isdir(word)] + list(filter(None, os.environ.get("PYTHONPATH", "").split(":")))
    modules = [words[k + 2].replace(".", os.sep) for k, word in enumerate(words[:-2]) if word == "-m"]
    if modules:
        folders.append("")  # where the sweep was started
    waiting = [(word, word) for word in words if os.path.isfile(word)] + ([(words[0], program)] if program else [])
    waiting += [(path, path) for module in modules for path in files_of_module(module, folders)]
    files = {}
    while waiting:
        name, path = waiting.pop()
        if name in files:
            continue
        files[name] = path
        if not path.endswith(".py"):
            continue
        for module in modules_of(read(path)):
            waiting += [(place, place) for place in files_of_module(module, (os.path.dirname(path), *folders))]
    return files


def is_experiment(content):
    """Whether a file is an experiment of YARS, in XML."""
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
    """Raises Wrong unless each run ends: by the scenario (`ends`), a setting or an option."""
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
    """Raises Wrong for an unknown word in braces, which would be passed to the client unchanged."""
    for word in re.findall(r"(?<!\$)\{(\w+)\}", client or ""):
        if word not in ("server", "seed"):
            raise Wrong(f"--client has {{{word}}}: a sweep fills in {{server}} and {{seed}}")


def lay_out(given, version, program, folders, look):
    """All jobs of a sweep, in order: dictionaries that run.py executes. `given`: the options. `look(commands)` returns the
    digests of each of some `coopdyn check` commands."""
    scenario = find_scenario(given.scenario, folders)
    settings = settings_of(given.set)
    controllers = controllers_of(given.controller) or [None]
    seeds = seeds_of(given.seeds)
    rows = table_of(given.table) if given.table else [{}]
    ends = ends_of(read(scenario))
    refuse_unknown_words(given.client)
    clashes = {name.lower() for name, _ in settings} & {name.lower() for name in rows[0]}
    if clashes:
        raise Wrong(f"{clashes.pop()} is set by --set and by --table: leave one out")
    chosen_inputs = []
    for row in rows:
        row_seeds = [whole_seed(row["seed"], given.table)] if "seed" in row else seeds
        row_controllers = [row["controller"]] if row.get("controller") else controllers
        fixed = {name: value for name, value in row.items() if name not in ("seed", "controller")}
        for values in itertools.product(*(values for _, values in settings)):
            chosen = {**fixed, **{name: value for (name, _), value in zip(settings, values)}}
            refuse_endless(given, ends, chosen)
            for controller, seed in itertools.product(row_controllers, row_seeds):
                chosen_inputs.append({
                    "scenario": os.path.splitext(os.path.basename(scenario))[0], "set": chosen, "controller": controller,
                    "client": given.client, "seed": seed, "duration_s": given.duration, "time_limit_s": given.time_limit,
                    "memory_limit_mib": given.memory_limit, "version": version,
                })
    checks = [tuple(check_of(program, scenario, inputs)) for inputs in chosen_inputs]
    distinct = list(dict.fromkeys(checks))
    digests = dict(zip(distinct, look(distinct)))
    own = own_digests(given.client, given.input)
    jobs = [job_of({**inputs, "digests": {**digests[check], **own}}, serve_of(program, scenario, inputs), given.record, given.out)
            for inputs, check in zip(chosen_inputs, checks)]
    if len({job["key"] for job in jobs}) < len(jobs):
        raise Wrong("two runs of this sweep are the same: remove the duplicate value")
    return jobs


def whole_seed(text, file):
    if not text.strip().isdigit():
        raise Wrong(f"--table {file}: a seed is a whole number from 0, not {text}")
    return int(text)


def own_files(client, inputs):
    """{name: path} of the files that no daemon reads: those of the client, and of --input."""
    for name in inputs:
        if not os.path.isfile(name):
            raise Wrong(f"--input {name}: there is no such file here")
    return {**{f"client {name}": path for name, path in files_of(client).items()}, **{INPUT + name: name for name in inputs}}


def own_digests(client, inputs):
    return {name: digest(read(path)) for name, path in own_files(client, inputs).items()}


def inputs_among(digests):
    """The names given by --input."""
    return [name.removeprefix(INPUT) for name in digests if name.startswith(INPUT)]


def settings_words(inputs):
    settings = [f"{name}={value}" for name, value in inputs["set"].items()]
    if inputs["controller"]:
        settings.append(f"ROBOTS.controller={inputs['controller']}")
    return [word for setting in settings for word in ("--set", setting)]


def check_of(program, scenario, inputs):
    """The command that reports errors in the settings of a run, or the digests of its inputs."""
    return [program, "check", "--digests", scenario, *settings_words(inputs)]


def serve_of(program, scenario, inputs):
    """The command of a run."""
    words = [program, "serve", scenario, "--no-http", "--no-render", "--seed", str(inputs["seed"])]
    words += ["--port", "0", "--mode", "lockstep"] if inputs["client"] else ["--no-net", "--mode", "free", "--speed", "0"]
    if inputs["duration_s"]:
        words += ["--duration", repr(inputs["duration_s"])]
    return words + settings_words(inputs)


def key_of(inputs):
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()[:20]


def job_of(inputs, words, record, out):
    """`inputs`: everything that determines the run's key; copied to its result."""
    return {
        "key": key_of(inputs), "inputs": inputs, "words": words, "record": record, "recordings": os.path.abspath(os.path.join(out, "recordings")),
        "own_files": {name: path for name, path in own_files(inputs["client"], inputs_among(inputs["digests"])).items()
                      if os.path.exists(name.partition(" ")[2])},
    }
