# SPDX-License-Identifier: MIT
"""Reads assignments, which have the syntax of scenarios, and makes their seeds. Reports all mistakes at once."""
import difflib
import hashlib
import hmac
import os
import re
import shlex

import plan
from plan import Wrong

kUnits = {"": 1.0, "s": 1.0, "ms": 1e-3, "min": 60.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "rad": 1.0, "deg": 0.017453292519943295, "kg": 1.0, "g": 1e-3}
kBytes = {"": 1, "b": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "kib": 1 << 10, "mib": 1 << 20, "gib": 1 << 30}
kMostSeeds = 1000
kExample = "coopdyn grade --example FOLDER writes one"


def number(text):
    """A number with an optional unit directly behind it, converted to SI."""
    match = re.fullmatch(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)([a-z]*)", text.strip().lower())
    if not match or match[2] not in kUnits:
        raise ValueError("takes a number, with a unit if it has one, for example 2.5 or 30s")
    return float(match[1]) * kUnits[match[2]]


def seconds(text):
    value = number(text)
    if not 0.1 <= value <= 86400:
        raise ValueError("takes from 0.1s to 86400s, for example 30s")
    return value


def size(text):
    match = re.fullmatch(r"(\d+)\s*([a-z]*)", text.strip().lower())
    if not match or match[2] not in kBytes or not 1 << 20 <= int(match[1]) * kBytes[match[2]] <= 1 << 40:
        raise ValueError("takes a size from 1MiB, for example 512MiB")
    return int(match[1]) * kBytes[match[2]]


def whole(least, most):
    def read(text):
        if not re.fullmatch(r"\d{1,9}", text.strip()) or not least <= int(text) <= most:
            raise ValueError(f"takes a whole number from {least} to {most}")
        return int(text)
    return read


def seeds(text):
    try:
        found = plan.seeds_of(text)
    except Wrong as wrong:
        raise ValueError(str(wrong).removeprefix("--seeds ")) from None
    if len(found) > kMostSeeds:
        raise ValueError(f"takes at most {kMostSeeds} seeds")
    return found


def command(text):
    try:
        words = shlex.split(text)
    except ValueError:
        raise ValueError("has a quote without its partner") from None
    for word in re.findall(r"\{(\w*)\}", text):
        if word not in ("submission", "server"):
            raise ValueError(f"has {{{word}}}: write {{submission}} for its folder, {{server}} for the simulator's address")
    if "{submission}" not in text:
        raise ValueError("names no file of {submission}: write, for example, python3 {submission}/main.py")
    return words


def names(text):
    found = shlex.split(text)
    for name in found:
        if name.startswith("/") or ".." in name.split("/"):
            raise ValueError(f"has {name}: write the names of files in the submission's folder, for example main.py")
    return found


def points(text):
    value = number(text)
    if not 0 < value <= 1e6:
        raise ValueError("takes a number above 0, for example 10")
    return value


kNeeded = object()
kKeys = {
    "assignment": {
        "title": (str, ""), "scenario": (str, kNeeded), "command": (command, kNeeded), "files": (names, []), "seeds": (seeds, [1]),
        "hidden_seeds": (whole(0, kMostSeeds), 0), "duration": (seconds, None), "time": (seconds, 30.0), "clock": (seconds, None),
        "memory": (size, 512 << 20), "disk": (size, 64 << 20), "processes": (whole(1, 10000), 64), "reads": (shlex.split, []),
    },
    "points": {"score": (str, kNeeded), "from": (number, kNeeded), "to": (number, kNeeded), "points": (points, kNeeded), "needs": (str, ""),
               "text": (str, "")},
}


class Points:
    """Points of a score: 0 at `start`, all `most` points at `end`, linear in between."""

    def __init__(self, values):
        self.score, self.start, self.end, self.most = values["score"], values["from"], values["to"], values["points"]
        self.needs, self.text = values["needs"], values["text"]

    def of(self, measures):
        """The points for measures {name: value or None}."""
        value = measures.get(self.score)
        if value is None or (self.needs and not (measures.get(self.needs) or 0) > 0):
            return 0.0
        share = (value - self.start) / (self.end - self.start)
        return self.most * min(1.0, max(0.0, share))


class Assignment:
    """`values`: of [ASSIGNMENT]; `points`: a list of Points; `path`: its file; `scenario`: file of the world; `digest`: of both texts."""

    def __init__(self, path, values, points, scenario, digest):
        self.path, self.values, self.points, self.scenario, self.digest = path, values, points, scenario, digest
        self.title = values["title"] or os.path.splitext(os.path.basename(path))[0]
        self.name = os.path.splitext(os.path.basename(path))[0]
        self.most = sum(one.most for one in points)

    def seeds(self, key):
        """[(label, seed, hidden), …]; without a key only the visible seeds."""
        visible = self.values["seeds"]
        found = [(f"seed {seed}", seed, False) for seed in visible]
        taken = set(visible)
        for index in range(1, self.values["hidden_seeds"] + 1 if key else 1):
            seed, attempt = hidden_seed(key, self.digest, index), 0
            while seed in taken:
                attempt += 1
                seed = hidden_seed(key, f"{self.digest} {attempt}", index)
            taken.add(seed)
            found.append((f"hidden {index}", seed, True))
        return found


def hidden_seed(key, digest, index):
    """A seed of 31 bits, the range that the page's `reset` accepts."""
    made = hmac.new(key, f"coopdyn grade {digest} {index}".encode(), hashlib.sha256).digest()
    return int.from_bytes(made[:4], "big") >> 1


def text_of(content):
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def instead(word, known):
    near = difflib.get_close_matches(word.lower(), known, 1)
    return f"did you mean {near[0]}?" if near else f"write one of {', '.join(known)}"


class Reader:
    """Reads one text; collects mistakes as `file:line: error: …`."""

    def __init__(self, file):
        self.file, self.mistakes = file, []
        self.sections = {}  # name: (kind, line, {key: (line, value)})

    def wrong(self, line, text):
        self.mistakes.append(f"{self.file}:{line}: error: {text}")

    def read(self, text):
        section = None
        for number_, line in enumerate(re.split(r"\r\n|\r|\n", text), 1):
            line = re.sub(r"(^|\s)[#;].*", "", line).strip()
            head = re.fullmatch(r"\[\s*(.*?)\s*\]", line)
            if head:
                section = self.begin(head[1], number_)
            elif line and section is None:
                self.wrong(number_, "this line stands before the first section: begin with [ASSIGNMENT]")
            elif line:
                self.key(section, number_, *re.fullmatch(r"([^\s=:]*)\s*[=:]?\s*(.*)", line).groups())

    def begin(self, name, line):
        kind = "assignment" if name.lower() == "assignment" else "points" if re.fullmatch(r"points(_\w+)?", name.lower()) else None
        if kind is None:
            near = difflib.get_close_matches(name.lower(), ("assignment", "points_1"), 1)
            self.wrong(line, f"there is no section [{name}]: " + (f"did you mean [{near[0].upper()}]?" if near else
                                                                  "an assignment has [ASSIGNMENT] and [POINTS_1], [POINTS_2] …"))
        elif name.lower() in self.sections:
            self.wrong(line, f"[{name}] stands twice: give it another number, or join the two")
        section = (kind, line, {})
        self.sections.setdefault(name.lower() if kind else f"?{line}", section)
        return section

    def key(self, section, line, key, value):
        kind, _, values = section
        if kind is None:
            return
        known = kKeys[kind]
        if key.lower() not in known:
            return self.wrong(line, f"there is no key '{key}' in this section: {instead(key, list(known))}")
        if key.lower() in values:
            return self.wrong(line, f"{key} stands twice in this section: leave one out")
        if not value:
            return self.wrong(line, f"{key} has no value: write it behind the key, or take the line away")
        try:
            values[key.lower()] = (line, known[key.lower()][0](value))
        except ValueError as error:
            values[key.lower()] = (line, None)
            self.wrong(line, f"{key} {value}: {key} {error}")

    def finish(self, name):
        """The values of a section, including defaults."""
        kind, line, given = self.sections[name]
        for key, (_, default) in kKeys[kind].items():
            if default is kNeeded and key not in given:
                self.wrong(line, f"[{name.upper()}] needs the key {key}")
        return {key: given[key][1] if key in given else default for key, (_, default) in kKeys[kind].items()}


def read(path, folders, look):
    """Reads the assignment in a file. `look(scenario)`: the names of a scenario's scores. Raises Wrong with all mistakes."""
    try:
        content = plan.read(path)
    except OSError as error:
        raise Wrong(f"{path} cannot be read: {error.strerror}. Name the file of an assignment; {kExample}") from None
    reader = Reader(path)
    reader.read(text_of(content))
    if "assignment" not in reader.sections:
        reader.wrong(1, f"there is no [ASSIGNMENT] in it: {kExample}")
        raise Wrong("\n".join(reader.mistakes))
    values = reader.finish("assignment")
    sections = [name for name, (kind, _, _) in reader.sections.items() if kind == "points"]
    if not sections:
        reader.wrong(reader.sections["assignment"][1], "nothing earns points: add [POINTS_1] with score, from, to and points")
    every = [Points(reader.finish(name)) for name in sections]
    for name, one in zip(sections, every):
        if one.start is not None and one.start == one.end:
            reader.wrong(reader.sections[name][2]["to"][0], "from and to are the same: from is what earns nothing, to what earns all points")
    scenario = scenario_of(reader, path, folders)
    if scenario:
        scores = look(scenario)
        for name, one in zip(sections, every):
            given = reader.sections[name][2]
            for key, value in (("score", one.score), ("needs", one.needs)):
                if key in given and value not in scores:
                    reader.wrong(given[key][0], f"the scenario has no score {value}: " +
                                 (instead(value, scores) if scores else "add a [SCORE_1] to it"))
    if reader.mistakes:
        raise Wrong("\n".join(sorted(reader.mistakes, key=lambda mistake: int(mistake.removeprefix(path + ":").partition(":")[0]))))
    digest = plan.digest(content + b"\0" + plan.read(scenario))
    return Assignment(path, values, every, scenario, digest)


def scenario_of(reader, path, folders):
    """The file of the scenario: beside the assignment, or found by its name."""
    given = reader.sections["assignment"][2]
    if "scenario" not in given:
        return None
    line, name = given["scenario"]
    beside = os.path.dirname(os.path.abspath(path))
    for file in (name, name + ".scenario"):
        if os.path.isfile(os.path.join(beside, file)):
            return os.path.join(beside, file)
    try:
        return plan.find_scenario(name, folders)
    except Wrong:
        reader.wrong(line, f"there is no scenario {name} beside the assignment or on the search path")
        return None


def new_key(path):
    """Writes a new key that only its owner may read."""
    try:
        with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600), "w", encoding="ascii") as stream:
            stream.write(os.urandom(32).hex() + "\n")
    except FileExistsError:
        raise Wrong(f"{path} is there already: a new key would change the hidden seeds. Write another name") from None
    except OSError as error:
        raise Wrong(f"{path} cannot be written: {error.strerror}") from None


def read_key(path):
    try:
        text = plan.read(path).decode("ascii", "replace").strip()
    except OSError as error:
        raise Wrong(f"--key {path} cannot be read: {error.strerror}. coopdyn grade --new-key FILE makes one") from None
    if not re.fullmatch(r"[0-9a-f]{64}", text):
        raise Wrong(f"--key {path} is no key: coopdyn grade --new-key FILE makes one")
    return bytes.fromhex(text)
