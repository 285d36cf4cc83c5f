# SPDX-License-Identifier: MIT
"""coopdyn as learning environments: Gymnasium's Env and VectorEnv, PettingZoo's ParallelEnv. Standard library only.

    import coopdyn_gym
    env = coopdyn_gym.Env("lamps", "moth1", observation=("light",), reward=lambda m: sum(m.reading.light), max_steps=300, repeat=10)
    obs, info = env.reset(seed=7)
    obs, reward, terminated, truncated, info = env.step([0.1, 0.5])          # m/s, rad/s

Each world is a private daemon in lockstep (`coopdyn.launch`), which exits on `env.close()` and with the program. If gymnasium or
pettingzoo are installed, the classes here derive from theirs and the spaces are gymnasium's. With numpy, observations are float32
arrays; without, an array.array("f") of the same numbers. The same seed and actions yield the same observations, bit for bit.
"""
from __future__ import annotations

import array
import concurrent.futures
import copy
import itertools
import json
import math
import operator
import os
import random
import re
import struct
import tempfile
import zlib
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import coopdyn

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]
try:
    import gymnasium
except ImportError:
    gymnasium = None  # type: ignore[assignment]
try:
    import pettingzoo
except ImportError:
    pettingzoo = None  # type: ignore[assignment]

Error = coopdyn.Error
_WRONG, _RANGE, _ORDER = 3, 4, 5  # codes of Error: wrong arguments, value out of range, not possible now


# --- numbers and spaces -----------------------------------------------------------------------------------------------

def numbers(values: Any) -> Any:
    """Converts values to an observation: a float32 array of numpy, or an array.array("f")."""
    return numpy.asarray(values, dtype=numpy.float32) if numpy is not None else array.array("f", values)


def _generator(seed: Optional[int]) -> Any:
    """A random generator: numpy's, as in Gymnasium, or random.Random."""
    if seed is not None and (isinstance(seed, bool) or not hasattr(seed, "__index__") or operator.index(seed) < 0):
        raise Error(_WRONG, f"a seed is a whole number of at least 0, not {seed!r}: write env.reset(seed=7)")
    if numpy is None:
        return random.Random(None if seed is None else operator.index(seed))
    return numpy.random.Generator(numpy.random.PCG64(numpy.random.SeedSequence(None if seed is None else operator.index(seed))))


def _drawn(generator: Any) -> int:
    """Draws a seed for a world."""
    return int(generator.integers(2**31)) if hasattr(generator, "integers") else generator.randrange(2**31)


class _Space:
    """Common base of Box and Discrete if gymnasium is not installed."""

    def __init__(self, shape: Tuple[int, ...], seed: Optional[int]) -> None:
        self.shape = shape
        self._random: Any = None if seed is None else _generator(seed)

    @property
    def np_random(self) -> Any:
        """The generator that `sample` draws from."""
        if self._random is None:
            self._random = _generator(None)
        return self._random

    def seed(self, seed: Optional[int] = None) -> Optional[int]:
        """Reseeds the generator of `sample`."""
        self._random = _generator(seed)
        return seed

    def contains(self, x: Any) -> bool:
        """Whether x is in the space."""
        raise NotImplementedError

    def __contains__(self, x: Any) -> bool:
        return self.contains(x)


class _Box(_Space):
    """Vectors of `shape` (n,) within low and high, which are one number for all elements, or n numbers."""

    def __init__(self, low: Any, high: Any, shape: Optional[Sequence[int]] = None, dtype: Any = "float32",
                 seed: Optional[int] = None) -> None:
        n = shape[0] if shape is not None else len(low)
        super().__init__((n,), seed)
        self.low, self.high = (numbers(list(bound) if hasattr(bound, "__len__") else [float(bound)] * n) for bound in (low, high))
        self.dtype = numpy.dtype("float32") if numpy is not None else "float32"

    def sample(self) -> Any:
        """A random vector; an element with an infinite bound is drawn from the normal distribution around the other bound."""
        draw, out = self.np_random, []
        for low, high in zip(map(float, self.low), map(float, self.high)):
            if math.isfinite(low) and math.isfinite(high):
                out.append(draw.uniform(low, high))
            else:
                gauss = float(draw.normal() if hasattr(draw, "normal") else draw.gauss(0, 1))
                out.append(low + abs(gauss) if math.isfinite(low) else high - abs(gauss) if math.isfinite(high) else gauss)
        return numbers(out)

    def contains(self, x: Any) -> bool:
        try:
            return len(x) == self.shape[0] and all(low <= value <= high for low, value, high in zip(self.low, map(float, x), self.high))
        except (TypeError, ValueError):
            return False

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Box) and list(self.low) == list(other.low) and list(self.high) == list(other.high)

    def __repr__(self) -> str:
        return f"Box({min(self.low, default=0.0)}, {max(self.high, default=0.0)}, {self.shape}, float32)"


class _Discrete(_Space):
    """The integers 0 to n - 1."""

    def __init__(self, n: int, seed: Optional[int] = None) -> None:
        super().__init__((), seed)
        self.n, self.start = int(n), 0
        self.dtype = numpy.dtype("int64") if numpy is not None else "int64"

    def sample(self) -> Any:
        """A random integer of the space."""
        draw = self.np_random
        return numpy.int64(draw.integers(self.n)) if numpy is not None else draw.randrange(self.n)

    def contains(self, x: Any) -> bool:
        return not isinstance(x, (bool, float)) and hasattr(x, "__index__") and 0 <= operator.index(x) < self.n

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Discrete) and self.n == other.n

    def __repr__(self) -> str:
        return f"Discrete({self.n})"


Box: Any = gymnasium.spaces.Box if gymnasium is not None else _Box
Discrete: Any = gymnasium.spaces.Discrete if gymnasium is not None else _Discrete


def _box(low: Sequence[float], high: Sequence[float]) -> Any:
    if gymnasium is not None:
        return Box(numbers(low), numbers(high), dtype=numpy.float32)
    return Box(low, high)


# --- a world ----------------------------------------------------------------------------------------------------------

_OPERATORS = {">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt}


class _World:
    """A daemon, the conditions that end its runs, and its picture. `until`, `limit` and `duration` would end the daemon, so they
    are removed from the scenario and checked here after each step."""

    def __init__(self, scenario: str, changes: Optional[Dict[str, Any]], render_mode: Optional[str], size: Tuple[int, int],
                 view: Optional[Tuple[Any, Any]], how: Dict[str, Any]) -> None:
        if render_mode not in (None, "rgb_array"):
            raise Error(_RANGE, f'there is no render_mode {render_mode!r}; write render_mode="rgb_array", or leave it out')
        self.render_mode, self.size, self.view = render_mode, size, view or (None, None)
        how = {**how, "options": [*how.get("options", ()), *([] if render_mode else ["--no-http"])]}
        written = _sections(_text_of(scenario, how))
        changes = {key: " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)
                   for key, value in (changes or {}).items()}
        sections = _changed(written, changes)
        self.ends, self.limit = [], _seconds(sections.get("SIMULATION", {}).get("duration"))
        enders = ["SIMULATION.duration"]
        for section, keys in sections.items():
            if section.startswith("SCORE"):
                enders += [f"{section}.until", f"{section}.limit"]
                self.limit = min(self.limit, _seconds(keys.get("limit")))
                if "until" in keys:
                    self.ends.append((keys.get("name", keys.get("kind", "")), keys["until"], keys.get("of", "")))
        changes = {key: value for key, value in changes.items() if key not in enders}
        changes.update((key, "") for key in enders if key.split(".")[1] in written.get(key.split(".")[0], {}))
        self.sim = coopdyn.launch(scenario, set=changes, mode="lockstep", **how)
        try:
            status = self.sim.status()
            self.dt = float(status["step_s"])
            self.scored = [score["name"] for score in status["scores"]]
            swarms = {section.replace("_", "").lower(): keys["name"] for section, keys in sections.items()
                      if section.startswith("SWARM") and "name" in keys}
            self.ends = [(name, *self._aim(until, of.split(), swarms)) for name, until, of in self.ends]
        except BaseException:
            self.sim.close()
            raise

    def _aim(self, until: str, of: List[str], swarms: Dict[str, str]) -> Tuple[Callable[[float, float], bool], float]:
        """The comparison and the threshold of `until`."""
        if until != "all":
            found = re.fullmatch(r"([<>]=?)\s*(\S+)", until)
            if not found:
                raise Error(_RANGE, f"until is >= 3, < 0.5 or all, not {until!r}")
            return _OPERATORS[found.group(1)], float(found.group(2))
        robots = self.sim.robots()
        if not of:
            return operator.ge, len(robots)
        count = 0
        for word in of:
            members = re.compile(re.escape(swarms.get(word.lower(), word)) + r"_\d+")
            count += sum(1 for name in robots if members.fullmatch(name)) or 1
        return operator.ge, count

    def scores(self) -> Dict[str, float]:
        """The present scores; queries the status without the long list of robots."""
        if not self.scored:
            return {}
        status = json.loads(self.sim.call("/simulation", "get_status", [1, 0]).text)
        return {s["name"]: math.nan if s["value"] is None else float(s["value"]) for s in status["scores"]}

    def met(self, scores: Dict[str, float]) -> bool:
        """True if one of the scenario's `until` holds."""
        return any(compare(scores[name], aim) for name, compare, aim in self.ends)

    def picture(self) -> Any:
        """Height x width x 3 bytes: numpy's array, or a coopdyn.Image."""
        if self.render_mode is None:
            raise Error(_ORDER, 'there is no picture: make the environment with render_mode="rgb_array"')
        with tempfile.TemporaryDirectory() as folder:
            file = self.sim.snapshot(os.path.join(folder, "now.png"), *self.size, *self.view)
            with open(file, "rb") as png:
                image = coopdyn.Image(*read_png(png.read()))
        return image.numpy().copy() if numpy is not None else image


def _seconds(text: Optional[str]) -> float:
    return float(text[:-1] if text.endswith("s") and not text.endswith("ms") else text) if text else math.inf


def _text_of(scenario: str, how: Dict[str, Any]) -> str:
    """The text of a scenario. For a name, only the daemon knows the text, so this reads it from a recording."""
    if isinstance(scenario, str) and "\n" in scenario:
        return scenario
    if isinstance(scenario, str) and os.path.isfile(scenario):
        with open(scenario, encoding="utf-8-sig", errors="replace") as file:
            return file.read()
    with tempfile.TemporaryDirectory() as folder:
        record = os.path.join(folder, "text.run")
        how = {**how, "record": record, "options": ["--no-http", "--no-render", "--paused"], "mode": "realtime"}
        with coopdyn.launch(scenario, **how) as sim:
            sim.call("/simulation", "step", [1])  # a recording without a step is discarded
        return coopdyn.read_run(record).scenario


def _sections(text: str) -> Dict[str, Dict[str, str]]:
    """The keys of a scenario's sections, with those of [SET] applied to their sections."""
    found: Dict[str, Dict[str, str]] = {}
    here, changes = "", {}
    for line in text.splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("["):
            here = line.strip("[] ")
        elif line:
            key, value = (line.split(None, 1) + [""])[:2]
            (changes if here == "SET" else found.setdefault(here, {}))[key] = value
    return _changed(found, changes)


def _changed(sections: Dict[str, Dict[str, str]], changes: Dict[str, str]) -> Dict[str, Dict[str, str]]:
    """Sections with changed values of keys SECTION.key; an empty value removes the key."""
    out = {section: dict(keys) for section, keys in sections.items()}
    for key, value in changes.items():
        section, _, key = key.partition(".")
        out.setdefault(section, {})[key] = value
    return {section: {key: value for key, value in keys.items() if value} for section, keys in out.items()}


def read_png(data: bytes) -> Tuple[int, int, bytes]:
    """Width, height and the bytes (red, green, blue of each pixel) of a PNG picture with 8 bits per colour."""
    at, packed, width, height, channels = 8, b"", 0, 0, 0
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", data, at + 8)
            channels = {2: 3, 6: 4}.get(colour, 0) if depth == 8 else 0
        elif kind == b"IDAT":
            packed += data[at + 8 : at + 8 + size]
        at += 12 + size
    if data[:8] != b"\x89PNG\r\n\x1a\n" or not channels:
        raise Error(7, "this is no PNG picture with 8 bits for each of red, green and blue")
    raw, row = zlib.decompress(packed), width * channels
    above, out = bytearray(row), bytearray()
    for k in range(height):
        line = _unfiltered(raw[k * (row + 1)], bytearray(raw[k * (row + 1) + 1 : (k + 1) * (row + 1)]), above, channels)
        above = line
        if channels == 4:
            line = bytearray(b"".join(bytes(line[i : i + 3]) for i in range(0, row, 4)))
        out += line
    return width, height, bytes(out)


def _unfiltered(kind: int, line: bytearray, above: bytearray, step: int) -> bytearray:
    """Undoes the filter of a row of a PNG picture: 0 none, 1 left, 2 above, 3 mean, 4 Paeth's."""
    if kind:
        for i in range(len(line)):
            left, up, corner = (line[i - step], above[i], above[i - step]) if i >= step else (0, above[i], 0)
            if kind == 4:
                guess = left + up - corner
                a, b, c = abs(guess - left), abs(guess - up), abs(guess - corner)
                add = left if a <= b and a <= c else up if b <= c else corner
            else:
                add = (left, up, (left + up) // 2)[kind - 1]
            line[i] = line[i] + add & 255
    return line


# --- the argument of the user's functions -----------------------------------------------------------------------------

class Moment:
    """The state after a step, passed to `observation`, `reward` and `done`. `reading`: all readings of the robot (a
    coopdyn.Reading; in a ParallelEnv a TeamReading with one row per robot); `before`: the previous step's readings; `action`:
    the requested action, None after a reset; `scores`: of the scenario; `step`: number of the environment's step."""

    __slots__ = ("env", "sim", "reading", "before", "action", "step", "_world", "_scores")

    def __init__(self, env: Any, world: _World, reading: Any, before: Any, action: Any, step: int) -> None:
        self.env, self.sim, self.reading, self.before, self.action, self.step = env, world.sim, reading, before, action, step
        self._world, self._scores = world, None

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.reading.time

    @property
    def scores(self) -> Dict[str, float]:
        """The scores of the scenario. Costs one round trip."""
        if self._scores is None:
            self._scores = self._world.scores()
        return self._scores


def _far(distances: Sequence[float], reach: Sequence[float]) -> List[float]:
    return list(map(min, distances, reach))


def _finite(values: Sequence[float], instead: float = -1.0) -> Sequence[float]:
    return values if math.isfinite(sum(values)) else [value if math.isfinite(value) else instead for value in values]


_WORDS: Dict[str, Callable[[Any], Sequence[float]]] = {
    "pose": lambda r: r.pose[:3],
    "wheels": lambda r: (r.wheels.left_speed, r.wheels.right_speed),
    "targets": lambda r: _finite([value for t in r.targets for value in (t.distance, t.bearing)]),
    "light": lambda r: r.light,
    "sonar": lambda r: _finite(r.sonar),
    "infrared": lambda r: _finite(r.infrared),
    "compass": lambda r: (r.compass,),
    "imu": lambda r: r.imu,
    "odometry": lambda r: r.odometry,
    "joints": lambda r: [value for group in r.joints.values() for values in (group.position, group.velocity) for value in values],
}


def _score_of(reward: Any, world: _World) -> Optional[str]:
    """The name of the score whose rise is the reward; None if a function computes it."""
    if callable(reward):
        return None
    if reward is None and not world.scored:
        raise Error(_WRONG, "the scenario has no [SCORE_n], so there is no reward: write reward=lambda m: -m.reading.pose.x, or "
                            'set={"SCORE_1.kind": "distance"}')
    if reward is not None and reward not in world.scored:
        raise Error(_RANGE, f"the scenario has no score {reward!r}; there are: {coopdyn._list_of(world.scored)}")
    return reward or world.scored[0]


def _row(action: Any, low: Sequence[float], high: Sequence[float], what: str) -> List[float]:
    """The numbers of an action, clamped to the bounds."""
    try:
        row = list(map(float, action))
        if len(row) == len(low):
            for value, least, most in zip(row, low, high):
                if not least <= value <= most:
                    break
            else:
                return row
    except (TypeError, ValueError):
        pass
    try:
        row = [float(value) for value in action]
    except (TypeError, ValueError):
        wrong, code = f"{what} is {action!r}", _WRONG
    else:
        if len(row) == len(low) and not any(map(math.isnan, row)):
            return [min(max(value, least), most) for value, least, most in zip(row, low, high)]
        wrong, code = f"{what} has {len(row)} numbers, not {len(low)}", _WRONG
        if len(row) == len(low):
            wrong, code = f"{what} holds nan, {_short(row)}", _RANGE
    raise Error(code, f"{wrong}: write {len(low)} number{'s' if len(low) > 1 else ''} within {_short(low)} and {_short(high)}")


def _short(row: Sequence[float]) -> str:
    return "[" + ", ".join(f"{value:.4g}" for value in row) + "]"


def _index(action: Any, n: int, what: str) -> int:
    if isinstance(action, (bool, float)) or not hasattr(action, "__index__") or not 0 <= operator.index(action) < n:
        raise Error(_WRONG, f"{what} is {action!r}: write a whole number from 0 to {n - 1}")
    return operator.index(action)


_JOINT_COMMANDS = {"positions": "set_positions", "joint_velocities": "set_velocities", "efforts": "set_efforts"}


class _Actions:
    """Converts actions to robot commands, and defines their space."""

    def __init__(self, action: Any, space: Any, robot: coopdyn.Robot) -> None:
        self.rows: Optional[List[List[float]]] = None
        self.bounds: Any = None  # bounds of the space, as floats
        self.function = action if callable(action) else None
        self.kind = action
        if self.function is not None:
            if space is None:
                raise Error(_WRONG, "with a function as action write action_space=coopdyn_gym.Box(-1, 1, (2,)), too")
            self.space = space
        elif isinstance(action, (list, tuple)) and action:
            self.rows = [[coopdyn._number(value, "a choice") for value in row] for row in action]
            self.kind, self.space = "velocity", space or Discrete(len(self.rows))
        elif action in ("velocity", "wheels"):
            try:
                limits = robot.get_limits()
            except Error as e:
                if e.code != 10:
                    raise
                raise Error(10, f'{robot.name} has no wheels: write action="positions", "joint_velocities" or "efforts"') from None
            wheel, speed = limits.max_wheel_speed, limits.max_wheel_speed * limits.wheel_radius
            high = [speed, 2 * speed / limits.track] if action == "velocity" else [wheel, wheel]
            self.space = space or _box([-value for value in high], high)
        elif isinstance(action, str) and action.split("/")[0] in _JOINT_COMMANDS:
            self.kind, _, group = action.partition("/")
            low, high = [], []
            self.groups: List[Tuple[Any, int]] = []  # command of each group, and the end of its numbers
            for name in [group] if group else list(robot.sense().joints) or [None]:
                joints = robot.joints(name)
                limits = joints.get_limits()
                most = {"positions": limits.upper, "joint_velocities": limits.velocity, "efforts": limits.effort}[self.kind]
                low += limits.lower if self.kind == "positions" else [-value for value in most]
                high += most
                self.groups.append((getattr(joints, _JOINT_COMMANDS[self.kind]), len(high)))
            self.space = space or _box(low, high)
        else:
            raise Error(_WRONG, f'there is no action {action!r}; write action="velocity", "wheels", "positions", "joint_velocities" '
                                'or "efforts" (of one group: "positions/arm"), a list of choices [(0.2, 0), (0, 1)], or a function of '
                                'robot and action')

    def row(self, action: Any, what: str = "the action") -> Any:
        """Checks an action; returns its numbers, or for a function the action itself."""
        if self.rows is not None:
            return self.rows[_index(action, len(self.rows), what)]
        if hasattr(self.space, "n"):
            return _index(action, self.space.n, what)
        if self.bounds is None:
            self.bounds = tuple([float(value) for value in bound] for bound in (self.space.low, self.space.high))
        return _row(action, *self.bounds, what)

    def tell(self, robot: coopdyn.Robot, row: Any) -> None:
        """Sends the robot its command for the next step of the world."""
        if self.function is not None:
            self.function(robot, row)
        elif self.kind == "velocity":
            robot.set_velocity(row[0], row[1])
        elif self.kind == "wheels":
            robot.set_wheel_speeds(row[0], row[1])
        else:
            first = 0
            for command, end in self.groups:
                command(row[first:end])
                first = end


class _Episodes:
    """Common base of Env and ParallelEnv: the world, its seeds, the end of episodes."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10, "name": "coopdyn"}
    _world: _World
    _moment: Optional[Moment] = None

    def _begin(self, repeat: int, max_steps: Optional[int], done: Any, start: Any) -> None:
        self._repeat = coopdyn._count(repeat, "repeat")
        self._max_steps = None if max_steps is None else coopdyn._count(max_steps, "max_steps")
        for name, function in (("done", done), ("start", start)):
            if function is not None and not callable(function):
                raise Error(_WRONG, f"{name} is a function, not {function!r}: write {name}=lambda "
                                    f"{'m: m.reading.pose.x > 2' if name == 'done' else 'sim, rng: None'}")
        self._done, self._start, self._seed, self._running = done, start, 0, False
        self.render_mode = self._world.render_mode

    @property
    def sim(self) -> coopdyn.Simulation:
        """The simulation, for direct access."""
        return self._world.sim

    def _restart(self, generator: Any) -> None:
        self._seed = _drawn(generator)
        self._world.sim.reset(self._seed)
        if self._start is not None:
            self._start(self._world.sim, generator)

    def _need_running(self) -> None:
        if not self._running:
            raise Error(_ORDER, "the episode has ended, or has not begun: write obs, info = env.reset()")

    def _ended(self, moment: Moment) -> Tuple[bool, bool]:
        """Whether an `until` of the scenario is met, and whether the time is over."""
        world = self._world
        over = self._max_steps is not None and moment.step >= self._max_steps or moment.reading.time >= world.limit - 1e-9
        return bool(world.ends) and world.met(moment.scores), over

    def _info(self, moment: Moment) -> Dict[str, Any]:
        info: Dict[str, Any] = {"time": moment.reading.time, "seed": self._seed}
        if moment._scores is not None:
            info["scores"] = moment._scores
        return info

    def render(self) -> Any:
        """A picture of the world, height x width x 3 bytes: numpy's array, or without numpy a coopdyn.Image."""
        return self._world.picture()

    def close(self) -> None:
        """Ends the daemon. May be called twice."""
        self._running = False
        self._world.sim.close()

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


# --- one robot --------------------------------------------------------------------------------------------------------

class _PlainEnv:
    """Replaces gymnasium.Env if gymnasium is not installed."""

    spec = None

    @property
    def unwrapped(self) -> Any:
        """The environment without wrappers: itself."""
        return self

    @property
    def np_random(self) -> Any:
        """The generator from which reset draws the worlds' seeds."""
        if self._np_random is None:
            self._np_random = _generator(None)
        return self._np_random

    @np_random.setter
    def np_random(self, generator: Any) -> None:
        self._np_random = generator

    _np_random: Any = None

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Any:
        """Reseeds the generator if a seed is given."""
        if seed is not None:
            self._np_random = _generator(seed)


_EnvBase: Any = gymnasium.Env if gymnasium is not None else _PlainEnv


class Env(_Episodes, _EnvBase):
    """A robot in its own world, as Gymnasium's Env.

    scenario: a file, a name or the text of a scenario; other robots stand still, or are driven by their controllers. robot: its name.
    observation: a list of words: "distances" (m, clamped to the sensors' range), "targets" (m, rad; -1: not seen), "pose" (m, m,
      rad), "wheels" (rad/s), "light", "sonar", "infrared", "compass", "imu", "odometry", "joints"; or a function of a Moment that
      returns numbers.
    action: "velocity" (m/s, rad/s), "wheels" (rad/s), "positions", "joint_velocities", "efforts" of the joints, or of one
      group ("positions/arm"); a list of velocities [(0.2, 0), (0, 1)] to choose from, by an integer action; or a function of robot
      and action, with action_space.
    reward: a function of a Moment, or the name of a score, whose increase is the reward (default: the first score).
    done: a function of a Moment; an episode also terminates when an `until` of the scenario is met.
    start: a function of sim and generator, called after each reset, e.g. to move things: lambda sim, rng: sim.move("robot1",
      (rng.uniform(-1, 1), 0)).
    max_steps: an episode is truncated after max_steps. repeat: steps of the world (10 ms each) per environment step.
    set, record, options, program: as in coopdyn.launch; each episode has its own run file: best.run, best-2.run …
    """

    def __init__(self, scenario: str = "classroom", robot: str = "robot1", *, observation: Any = ("distances",),
                 observation_space: Any = None, action: Any = "velocity", action_space: Any = None, reward: Any = None,
                 done: Optional[Callable[[Moment], Any]] = None, start: Optional[Callable[[Any, Any], Any]] = None,
                 max_steps: Optional[int] = 1000, repeat: int = 1, render_mode: Optional[str] = None, size: Tuple[int, int] = (320, 240),
                 view: Optional[Tuple[Any, Any]] = None, set: Optional[Dict[str, Any]] = None, **how: Any) -> None:
        self._world = _World(scenario, set, render_mode, size, view, how)
        try:
            self._begin(repeat, max_steps, done, start)
            self._robot = self.sim.robot(robot)
            self.sim.set_participants([robot])
            self._actions = _Actions(action, action_space, self._robot)
            self.action_space = self._actions.space
            self._score, self._reward = _score_of(reward, self._world), reward
            self._observe = self._observer(observation)
            first = Moment(self, self._world, self._robot.sense(), None, None, 0)
            shown = self._observe(first)
            n = len(shown)
            self.observation_space = observation_space or _box(*(self._bounds(n)))
        except BaseException:
            self._world.sim.close()
            raise

    def _observer(self, observation: Any) -> Callable[[Moment], Any]:
        self._reach: List[float] = []
        if callable(observation):
            self._words: Sequence[str] = ()
            return lambda m: numbers(observation(m))
        words = [observation] if isinstance(observation, str) else list(observation)
        for word in words:
            if word not in _WORDS and word != "distances":
                raise Error(_RANGE, f"there is no observation {word!r}; there are: {coopdyn._list_of(['distances', *_WORDS])}")
        reading = self._robot.sense()
        for word in words:
            if not getattr(reading, word):
                raise Error(10, f"{self._robot.name} has no {word}: choose other words in observation")
        if "distances" in words:
            self._reach = list(self._robot.get_geometry().max_range)
        parts = [(lambda r: _far(r.distances, self._reach)) if word == "distances" else _WORDS[word] for word in words]
        self._words = words
        if len(parts) == 1:
            part = parts[0]
            return lambda m: numbers(part(m.reading))
        return lambda m: numbers([value for part in parts for value in part(m.reading)])

    def _bounds(self, n: int) -> Tuple[List[float], List[float]]:
        """The bounds of the n numbers: distances are bounded, other readings are not."""
        low, high = [-math.inf] * n, [math.inf] * n
        if list(self._words[:1]) == ["distances"]:
            low[: len(self._reach)], high[: len(self._reach)] = [0.0] * len(self._reach), self._reach
        return low, high

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Tuple[Any, Dict[str, Any]]:
        """Begins an episode; returns the observation and an info (time [s], seed of the world, scores). A seed reseeds the
        generator; without one, the generator continues."""
        _generator(seed) if seed is not None else None  # raises our own error for a wrong seed
        super().reset(seed=seed, options=options)
        self._restart(self.np_random)
        self._moment = moment = Moment(self, self._world, self._robot.sense(), None, None, 0)
        self._kept = moment.scores if self._score else {}
        self._running = True
        return self._observe(moment), self._info(moment)

    def step(self, action: Any) -> Tuple[Any, float, bool, bool, Dict[str, Any]]:
        """Runs a step; returns observation, reward, terminated, truncated, info."""
        self._need_running()
        row = self._actions.row(action)
        before = self._moment
        assert before is not None
        self._actions.tell(self._robot, row)
        self._world.sim.step(self._repeat)
        self._moment = moment = Moment(self, self._world, self._robot.sense(), before.reading, row, before.step + 1)
        terminated, truncated = self._ended(moment)
        terminated = terminated or self._done is not None and bool(self._done(moment))
        if self._score:
            reward, self._kept = moment.scores[self._score] - self._kept[self._score], moment.scores
        else:
            reward = float(self._reward(moment))
        self._running = not (terminated or truncated)
        return self._observe(moment), float(reward), terminated, truncated, self._info(moment)


# --- many worlds ------------------------------------------------------------------------------------------------------

class _Batch(_Space):
    """n copies of a space, without gymnasium."""

    def __init__(self, single: Any, n: int) -> None:
        super().__init__((n, *single.shape), None)
        self.single, self.n, self.dtype = single, n, single.dtype

    def seed(self, seed: Optional[int] = None) -> Optional[int]:
        return self.single.seed(seed)

    def sample(self) -> Any:
        return _stacked([self.single.sample() for _ in range(self.n)])

    def contains(self, x: Any) -> bool:
        return hasattr(x, "__len__") and len(x) == self.n and all(self.single.contains(row) for row in x)

    def __repr__(self) -> str:
        return f"Batch({self.single!r}, {self.n})"


def _rows(values: Any, dtype: Any, n: int = 0) -> Any:
    """One row per robot, as a numpy array or a list; a single value is repeated n times."""
    if hasattr(values, "__len__"):
        return numpy.asarray(values, dtype=dtype) if numpy is not None else list(values)
    return numpy.full(n, values, dtype=dtype) if numpy is not None else [values] * n


def _stacked(rows: List[Any], dtype: Any = None) -> Any:
    """Rows as one array of numpy, or as a list."""
    return numpy.array(rows, dtype=dtype) if numpy is not None else rows


def _batched(single: Any, n: int) -> Any:
    if gymnasium is not None:
        return gymnasium.vector.utils.batch_space(single, n)
    return _Batch(single, n)


_VectorBase: Any = gymnasium.vector.VectorEnv if gymnasium is not None else _PlainEnv


class VectorEnv(_VectorBase):
    """num_envs worlds with one robot each, as Gymnasium's VectorEnv: VectorEnv("lamps", "moth1", num_envs=4, ...); other arguments
    as for Env.

    Each world is a daemon process, and a thread of this program waits for it, so the functions need not be picklable. A world
    whose episode has ended begins the next episode in the next step: that step returns the first observation and reward 0, and
    ignores its action (autoreset mode NextStep). With seed=s, world k has seed s + k.
    """

    metadata: Dict[str, Any] = {**_Episodes.metadata, "autoreset_mode": "NextStep" if gymnasium is None else
                                gymnasium.vector.AutoresetMode.NEXT_STEP}

    def __init__(self, scenario: str = "classroom", robot: str = "robot1", *, num_envs: int = 2, **how: Any) -> None:
        if how.get("record"):
            raise Error(_WRONG, 'worlds side by side cannot share a recording: write Env(..., record="best.run") for the one to keep')
        self.num_envs = coopdyn._count(num_envs, "num_envs")
        self.closed = False
        self._threads = [concurrent.futures.ThreadPoolExecutor(1) for _ in range(self.num_envs)]  # a sim belongs to one thread
        self.envs: List[Env] = []
        starts = [thread.submit(Env, scenario, robot, **how) for thread in self._threads]
        concurrent.futures.wait(starts)
        self.envs = [start.result() for start in starts if start.exception() is None]
        if len(self.envs) < self.num_envs:
            failed = next(start.exception() for start in starts if start.exception() is not None)
            self.close()
            raise failed  # type: ignore[misc]
        self.render_mode = self.envs[0].render_mode
        self.single_observation_space, self.single_action_space = self.envs[0].observation_space, self.envs[0].action_space
        self.observation_space = _batched(self.single_observation_space, self.num_envs)
        self.action_space = _batched(self.single_action_space, self.num_envs)
        self._over = [True] * self.num_envs
        self._begun = False

    def _all(self, calls: Sequence[Callable[[], Any]]) -> List[Any]:
        """Runs one call per world concurrently; raises an error after all have finished."""
        done = [thread.submit(call) for thread, call in zip(self._threads, calls)]
        concurrent.futures.wait(done)
        return [call.result() for call in done]

    def reset(self, *, seed: Union[int, Sequence[Optional[int]], None] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Any, Dict[str, Any]]:
        """Begins an episode in every world; returns observations (num_envs rows) and infos."""
        self._need_open()
        n = self.num_envs
        seeds: List[Optional[int]] = ([None] * n if seed is None else [int(seed) + k for k in range(n)] if hasattr(seed, "__index__")
                                      else list(seed))  # type: ignore[arg-type, call-overload]
        if len(seeds) != n:
            raise Error(_WRONG, f"there are {len(seeds)} seeds for {n} worlds: write seed=7, or a list of {n}")
        results = self._all([lambda env=env, s=s: env.reset(seed=s, options=options) for env, s in zip(self.envs, seeds)])
        self._over, self._begun = [False] * n, True
        return _stacked([obs for obs, _ in results]), self._infos([info for _, info in results])

    def step(self, actions: Any) -> Tuple[Any, Any, Any, Any, Dict[str, Any]]:
        """Runs a step of every world with num_envs rows of actions; returns observations, rewards, terminations, truncations,
        infos."""
        self._need_open()
        if not self._begun:
            raise Error(_ORDER, "no episode has begun: write obs, infos = envs.reset()")
        if not hasattr(actions, "__len__") or len(actions) != self.num_envs:
            raise Error(_WRONG, f"there must be an action for each of {self.num_envs} worlds, as envs.action_space.sample() has them; "
                                f"not {actions!r}")
        for k, (env, action) in enumerate(zip(self.envs, actions)):
            if not self._over[k]:
                env._actions.row(action, f"the action of world {k}")  # before any world steps
        results = self._all([(lambda env=env: (lambda obs, info: (obs, 0.0, False, False, info))(*env.reset())) if over
                             else (lambda env=env, action=action: env.step(action))
                             for env, action, over in zip(self.envs, actions, self._over)])
        obs, rewards, terminated, truncated, infos = zip(*results)
        self._over = [a or b for a, b in zip(terminated, truncated)]
        return _stacked(list(obs)), _stacked(list(rewards)), _stacked(list(terminated)), _stacked(list(truncated)), self._infos(infos)

    def _infos(self, infos: Sequence[Dict[str, Any]]) -> Dict[str, Any]:
        """Merges infos into one dictionary of rows; _key says which worlds have `key`."""
        out: Dict[str, Any] = {}
        for key in {key: None for info in infos for key in info}:
            has = [key in info for info in infos]
            values = [info.get(key) for info in infos]
            if isinstance(next(v for v in values if v is not None), dict):
                out[key] = self._infos([value or {} for value in values])
            else:
                out[key] = _stacked([0 if value is None else value for value in values])
            out[f"_{key}"] = _stacked(has)
        return out

    def _need_open(self) -> None:
        if self.closed:
            raise Error(_ORDER, "the environment is closed: make a new one")

    def render(self) -> Tuple[Any, ...]:
        """A picture of each world."""
        self._need_open()
        return tuple(self._all([env.render for env in self.envs]))

    def close(self, **_: Any) -> None:
        """Ends all daemons. May be called twice."""
        if not self.closed:
            self.closed = True
            for env in self.envs:
                env.close()
            for thread in self._threads:
                thread.shutdown()

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    @property
    def np_random(self) -> Tuple[Any, ...]:
        """The generators of the worlds."""
        return tuple(env.np_random for env in self.envs)


# --- many robots in one world -----------------------------------------------------------------------------------------

_TEAM_READINGS = ("pose", "distances", "targets", "neighbours", "wheels", "compass", "support", "joints")
_ParallelBase: Any = pettingzoo.ParallelEnv if pettingzoo is not None else _PlainEnv


class ParallelEnv(_Episodes, _ParallelBase):
    """Many robots in one world, driven together through one connection, as PettingZoo's ParallelEnv.

    robots: as in `sim.team`: a swarm, a list of names, or None for all.
    observation: a list of words: "distances" (m), "pose" (m, m, rad), "targets" (m, rad), "neighbours" (id, m, rad of each of the
      `neighbours` nearest), "wheels", "compass", "support", "joints" (missing or unseen values are -1); or a function of a Moment and
      the robot's row. readings: further readings of m.reading.
    action: "velocity" (m/s, rad/s), "wheels" (rad/s), or a list of choices, as in Env.
    reward, done: functions of a Moment, m.reading.pose[i] …, that return one value for all robots, or one per row; reward may also be
      the name of a score, whose increase all robots receive.
    start, max_steps, repeat, set and the rest: as in Env. The daemon's seed (seed=7 here) places a swarm. A reset does not place it
      anew; `start` can move robots.
    """

    def __init__(self, scenario: str, robots: Any = None, *, observation: Any = ("distances",),
                 readings: Sequence[str] = ("pose", "distances"), neighbours: int = 8, action: Any = "velocity", reward: Any = None,
                 done: Optional[Callable[[Moment], Any]] = None, start: Optional[Callable[[Any, Any], Any]] = None,
                 max_steps: Optional[int] = 1000, repeat: int = 1, render_mode: Optional[str] = None, size: Tuple[int, int] = (320, 240),
                 view: Optional[Tuple[Any, Any]] = None, set: Optional[Dict[str, Any]] = None, **how: Any) -> None:
        self._world = _World(scenario, set, render_mode, size, view, how)
        try:
            self._begin(repeat, max_steps, done, start)
            self._team = self.sim.team(robots)
            self.possible_agents = self._team.names
            self.sim.set_participants(self.possible_agents)
            self.agents: List[str] = []
            self._place = {name: k for k, name in enumerate(self.possible_agents)}
            first = self.sim.robot(self.possible_agents[0])
            self._actions = _Actions(action, None, first)
            if self._actions.kind not in ("velocity", "wheels"):
                raise Error(_WRONG, 'for a team write action="velocity", "wheels" or a list of choices')
            self._drive = self._team.step_wheels if self._actions.kind == "wheels" else self._team.step
            self._function = observation if callable(observation) else None
            self._words = [] if callable(observation) else [observation] if isinstance(observation, str) else list(observation)
            self._team.select(*dict.fromkeys([*self._words, *readings]), neighbours=neighbours)
            self._reach = numbers(first.get_geometry().max_range if "distances" in self._words else [])
            self._score, self._reward = _score_of(reward, self._world), reward
            self._shape: Optional[Tuple[int, int]] = None
            if numpy is not None and not hasattr(self._actions.space, "n"):
                self._low, self._high = (numpy.asarray(bound, dtype=float) for bound in (self._actions.space.low, self._actions.space.high))
                self._shape = (len(self.possible_agents), len(self._low))
            now = self._team.read()
            self._are_finite = {"distances", "pose"}.issuperset(self._words) and all(  # nan for a robot with fewer sensors than another
                not math.isnan(value) for word in self._words for row in getattr(now, word) for value in row)
            n = len(self._observations(Moment(self, self._world, now, None, None, 0))[0])
            self.observation_spaces = {name: _box([-math.inf] * n, [math.inf] * n) for name in self.possible_agents}
            self.action_spaces = {name: copy.deepcopy(self._actions.space) for name in self.possible_agents}
        except BaseException:
            self._world.sim.close()
            raise

    def _observations(self, moment: Moment) -> Any:
        """The observations, one row per robot."""
        n = len(self.possible_agents)
        if self._function is not None:
            return [numbers(self._function(moment, i)) for i in range(n)]
        parts = [getattr(moment.reading, word) for word in self._words]
        if numpy is not None:
            tables = [numpy.minimum(part, self._reach) if word == "distances" else numpy.asarray(part)
                      for word, part in zip(self._words, parts)]
            table = (numpy.concatenate(tables, axis=1) if len(tables) > 1 else tables[0]).astype(numpy.float32)
            return table if self._are_finite else numpy.where(numpy.isfinite(table), table, numpy.float32(-1.0))
        if "distances" in self._words:
            k = self._words.index("distances")
            parts[k] = [_far(row, self._reach) for row in parts[k]]
        if len(parts) == 1:
            return [numbers(_finite(row)) for row in parts[0]]
        return [numbers(_finite(list(itertools.chain.from_iterable(rows)))) for rows in zip(*parts)]

    def observation_space(self, agent: str) -> Any:
        """The observation space of a robot."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        """The action space of a robot."""
        return self.action_spaces[agent]

    @property
    def num_agents(self) -> int:
        """The number of robots whose episode has not ended."""
        return len(self.agents)

    @property
    def max_num_agents(self) -> int:
        """The number of robots."""
        return len(self.possible_agents)

    def state(self) -> Any:
        """x, y [m] and heading [rad] of all robots in a row."""
        if self._moment is None:
            raise Error(_ORDER, "no episode has begun: write obs, infos = env.reset()")
        return numbers([value for name in self.possible_agents for value in self._poses()[self._place[name]]])

    def _poses(self) -> Any:
        assert self._moment is not None
        if "pose" not in self._moment.reading.__dict__:
            raise Error(_ORDER, 'state needs the poses: write observation=("distances", "pose")')
        return self._moment.reading.pose

    def reset(self, seed: Optional[int] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Dict[str, Any], Dict[str, Dict[str, Any]]]:
        """Begins an episode with all robots; returns observations and infos by name."""
        if seed is not None or self._np_random is None:
            self._np_random = _generator(seed)
        self._restart(self._np_random)
        self.agents = list(self.possible_agents)
        self._moment = moment = Moment(self, self._world, self._team.read(), None, None, 0)
        self._kept = moment.scores if self._score else {}
        self._running = True
        return dict(zip(self.agents, self._observations(moment))), {name: self._info(moment) for name in self.agents}

    _np_random: Any = None

    def step(self, actions: Dict[str, Any]) -> Tuple[Dict[str, Any], Dict[str, float], Dict[str, bool], Dict[str, bool],
                                                     Dict[str, Dict[str, Any]]]:
        """Runs a step; returns observations, rewards, terminations, truncations and infos of the robots in `agents` before the
        step. A robot that has terminated stands still from then on and leaves `agents`."""
        self._need_running()
        acted, n = self.agents, len(self.possible_agents)
        seen, rewards, ended, over, info = self._advance(self._checked(actions))
        rewards = [rewards] * n if not hasattr(rewards, "__len__") else rewards
        ended = [ended] * n if not hasattr(ended, "__len__") else ended
        if len(acted) < len(self.possible_agents):
            places = [self._place[name] for name in acted]
            seen, rewards, ended = ([column[k] for k in places] for column in (seen, rewards, ended))
        return (dict(zip(acted, seen)), dict(zip(acted, map(float, rewards))), dict(zip(acted, map(bool, ended))),
                dict.fromkeys(acted, over), {name: info.copy() for name in acted})

    def step_rows(self, actions: Any) -> Tuple[Any, Any, Any, bool, Dict[str, Any]]:
        """Like step(), without dictionaries, which for a thousand robots cost more time than the world. actions has one row for each
        of possible_agents (a numpy array n x 2, or a list). Returns observations, rewards and terminations in rows; whether the time
        is over; and one info. Robots that have terminated stand still, and their rows are ignored."""
        self._need_running()
        seen, rewards, ended, over, info = self._advance(self._checked_rows(actions))
        return _rows(seen, None), _rows(rewards, float, len(seen)), _rows(ended, bool, len(seen)), over, info

    def _advance(self, rows: Any) -> Tuple[Any, Any, Any, bool, Dict[str, Any]]:
        """Runs a step with one row per robot; returns observations, rewards and terminations (one per robot, or one for all),
        whether the time is over, and info."""
        try:
            reading = self._drive(rows)
        except Error:
            for name, row in zip(self.possible_agents, rows if self._shape else ()):
                self._actions.row(row, f"the action of {name}")  # reports whose action is nan
            raise
        if self._repeat > 1:
            self.sim.step(self._repeat - 1)  # the robots keep their commands; far cheaper than single steps
            reading = self._team.read()
        assert self._moment is not None
        self._moment = moment = Moment(self, self._world, reading, self._moment.reading, rows, self._moment.step + 1)
        met, over = self._ended(moment)
        ended = met or (self._done is not None and self._per_robot(self._done(moment), "done"))
        if self._score:
            rewards = moment.scores[self._score] - self._kept[self._score]
            self._kept = moment.scores
        else:
            rewards = self._per_robot(self._reward(moment), "reward")
        if over or ended is True:
            self.agents = []
        elif ended is not False:
            self.agents = [name for name in self.agents if not ended[self._place[name]]]
        self._running = bool(self.agents)
        return self._observations(moment), rewards, ended, over, self._info(moment)

    def _checked(self, actions: Any) -> Any:
        """Checks actions by name; returns one row per robot of the team."""
        if not hasattr(actions, "items"):
            raise Error(_WRONG, f"actions are a dict by robots' names, not {actions!r}: write "
                                "{name: env.action_space(name).sample() for name in env.agents}")
        every = len(self.agents) == len(self.possible_agents)
        if every and len(actions) == len(self.agents):
            try:
                rows = self._limited([actions[name] for name in self.agents])
            except KeyError:
                rows = None
            if rows is not None:
                return rows
        active = set(self.agents)
        missing = [name for name in self.agents if name not in actions]
        foreign = [name for name in actions if name not in self._place or not every and name not in active]
        if missing or foreign:
            raise Error(_WRONG, "; ".join([f"no action for {coopdyn._list_of(missing[:5])}"] * bool(missing) +
                                          [f"{coopdyn._list_of(foreign[:5])} takes no part (now)"] * bool(foreign)) +
                        ": write one for each of env.agents")
        rows = [[0.0, 0.0] for _ in self.possible_agents]
        for name, action in actions.items():
            rows[self._place[name]] = self._actions.row(action, f"the action of {name}")
        return rows

    def _checked_rows(self, actions: Any) -> Any:
        """Checks actions in the order of possible_agents; returns one row per robot of the team."""
        n = len(self.possible_agents)
        if not hasattr(actions, "__len__") or len(actions) != n:
            raise Error(_WRONG, f"actions are a row for each of {n} robots, in the order of env.possible_agents, not {actions!r}")
        rows = self._limited(actions)
        if rows is None:
            rows = [self._actions.row(action, f"the action of {name}") for name, action in zip(self.possible_agents, actions)]
        if len(self.agents) < n:
            active = set(self.agents)
            for k, name in enumerate(self.possible_agents):
                if name not in active:
                    rows[k] = [0.0, 0.0]
        return rows

    def _limited(self, actions: Any) -> Any:
        """Clamps all actions at once as a numpy array; None: they must be checked one by one."""
        if self._shape is None:
            return None
        try:
            rows = numpy.array(actions, dtype=float)
        except (TypeError, ValueError):
            return None
        if rows.shape != self._shape:
            return None
        return numpy.minimum(numpy.maximum(rows, self._low, out=rows), self._high, out=rows)  # nan stays; the team reports it

    def _per_robot(self, values: Any, what: str) -> Any:
        """Checks a value for all robots, or one per robot."""
        n = len(self.possible_agents)
        if getattr(values, "shape", None) == () or not hasattr(values, "__len__"):
            return bool(values) if what == "done" else float(values)
        if len(values) != n:
            raise Error(_WRONG, f"{what} returned {len(values)} values for {n} robots: return one for each, or one for all")
        return values
