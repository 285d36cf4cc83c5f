# SPDX-License-Identifier: MIT
"""Drives the robots of a coopdyn daemon from Python: one file, standard library only, Python 3.8 or newer.

    import coopdyn
    sim = coopdyn.connect()                  # this machine, or COOPDYN_SERVER; "labserver", "labserver:10100"
    # in a class: coopdyn.connect("labserver", seat="ana", pin="7305"), or COOPDYN_SEAT=ana:7305
    r = sim.robot("robot1")
    r.set_velocity(0.2, 0.5)                 # m/s, rad/s; left is positive
    sim.step()                               # waits for the next step of time
    print(r.get_pose())
    sim.close()

    team = sim.team("swarm1")                # five robots or five thousand, through one connection
    s = team.read()
    for k in range(1000):
        s = team.step([(0.1, 0.5 if min(d) < 0.05 else 0.0) for d in s.distances])

The same program runs in every time mode and with one or many robots. In lockstep, `set_velocity` does not wait: the
command is kept (the last wins) until `sim.step()`, which sends the commands of all robots of this `sim` and waits for
the step. In real time, the command is sent immediately, and `sim.step()` waits for the next step.

All connections use one port of the daemon (10000 by default). Units are m, rad, s, m/s, rad/s; headings and bearings
are 0 ahead, left positive, in (-pi, pi]. Failures raise `coopdyn.Error` with `.code` and `.text`. If another client
resets the world or loads a scenario, the next reading, command or step raises `coopdyn.WorldReset`, once.
Use a `sim` and its robots from one thread; concurrent calls from another thread raise an error.
On the command line: `python3 coopdyn.py doctor|hello [SERVER]`.
"""
from __future__ import annotations

import array
import collections
import contextlib
import functools
import getpass
import itertools
import json
import math
import operator
import os
import queue
import re
import select
import shutil
import socket
import struct
import subprocess
import sys
import threading
import time as _clock
import urllib.parse
import weakref
import zlib
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple, TypeVar, Union

__version__ = "0.1.0"
PROTOCOL = 1
DEFAULT_PORT = 10000

MODES = ("realtime", "lockstep", "free")
JOINT_MODES = ("idle", "position", "direct", "velocity", "effort", "pwm")
_LOCKSTEP = 1

# Numbers of the commands that this file uses; docs/protocol.md has the whole table.
_READY, _GET_TIME, _SUBSCRIBE, _HELLO, _CLAIM, _RELEASE, _ATTACH, _DESCRIBE = 2, 3, 4, 6, 7, 8, 9, 1
_SET_WHEEL_SPEEDS, _SET_VELOCITY, _GET_WHEELS, _GET_LIMITS, _STOP = 10, 11, 12, 13, 14
_GET_DISTANCES, _GET_GEOMETRY = 20, 21
_GET_TARGETS, _GET_TARGET, _GET_ROBOTS = 30, 31, 32
_GET_POSE, _GET_POSE_3D = 40, 41
_GET_COMPASS, _GET_SUPPORT = 300, 280
_GET_IMU, _GET_WRENCH, _GET_SCAN, _GET_SCAN_GEOMETRY, _GET_CONTACTS, _GET_BUMPER = 230, 240, 250, 251, 260, 261
_GET_IMAGE, _GET_CAMERA, _GET_BATTERY, _GET_LIGHT, _GET_SONAR, _GET_INFRARED, _GET_ODOMETRY = 270, 271, 290, 310, 320, 330, 340
_RGB, _JPEG, _DEPTH, _SEGMENTATION = 0, 1, 2, 3
_GET_JOINTS, _SET_POSITIONS, _SET_POSITIONS_DIRECT, _SET_VELOCITIES, _SET_EFFORTS, _SET_MODES = 203, 204, 205, 206, 207, 208
_GET_MODES, _SET_COMPLIANCE, _GET_COMPLIANCE, _SET_PROFILE, _GET_PROFILE, _SET_GAINS, _GET_GAINS = 209, 210, 211, 212, 213, 214, 215
_GET_JOINT_LIMITS, _GET_MOTION, _GET_REFERENCES, _HOLD, _GET_CHAIN, _SET_PWM, _GET_DRIVE_TRAINS = 216, 217, 218, 219, 220, 222, 223
_SET_ACTIVATIONS, _GET_MUSCLES, _GET_MUSCLE_LIMITS, _SET_THRUSTS, _GET_THRUSTS, _GET_THRUSTER_LIMITS = range(224, 230)
_GET_VALUES, _SET_MOTORS, _GET_CHANNEL = 350, 351, 352
_GET_STATUS, _RUN, _PAUSE, _RESET, _SET_MODE, _SET_STEP, _SET_SPEED = 100, 101, 102, 104, 105, 106, 107
_LOAD_SCENARIO, _STOP_ALL, _SET_PARTICIPANTS, _RELOAD, _RELEASE_ROBOT = 108, 190, 191, 192, 193
_SIMULATION, _RECORDER, _PLAYBACK, _WORLD = "/simulation", "/recorder", "/playback", "/world"
_INSERT, _REMOVE, _SET_POSE, _SET_THING, _RENAME, _LIST_WORLD, _SAVE_WORLD, _UNDO, _REDO, _PICK = range(140, 150)
_SAVE_STATE, _RESTORE_STATE, _GET_SAVED, _LOG, _END_RUN = 194, 195, 196, 197, 198
_GET_RECORDING, _START_RECORDING, _STOP_RECORDING, _NOTE, _LIST_RUNS = 120, 121, 122, 123, 124
_GET_PLAYBACK, _SEEK, _PLAY, _SET_PLAY_SPEED, _SKIP, _SET_LOOP, _BRANCH, _OPEN, _CLOSE = 130, 131, 132, 134, 135, 136, 137, 138, 139
_STEP_ALL, _SELECT_READINGS, _READ_ALL, _GET_TEAM, _STOP_TEAM = 110, 111, 112, 113, 114
_OF_JOINTS = {_SET_POSITIONS: "set_positions", _SET_POSITIONS_DIRECT: "set_positions_direct", _SET_VELOCITIES: "set_velocities",
              _SET_EFFORTS: "set_efforts", _SET_PWM: "set_pwm", _SET_MODES: "set_modes", _HOLD: "hold"}  # they take effect with a step
_CARRY_MODE = frozenset((_READY, _GET_TIME, _SET_VELOCITY, _SET_WHEEL_SPEEDS, _STOP, _STEP_ALL, *_OF_JOINTS, _SET_ACTIVATIONS,
                         _SET_THRUSTS, _SET_MOTORS))
_PARTS = ("joints", "muscles", "thrusters")  # types of actuators whose commands name what they move
_LAST = {"motors": _STOP, "joints": _HOLD}  # commands to actuators when a sim is closed
_GET_NEIGHBOURS, _SEND_MESSAGE, _GET_MESSAGES = 200, 201, 202

_CLOSE_S = 0.2
_SEAT_AGAIN_S = 0.2
_SEAT_START_S = 20.0  # for a seat's daemon: all start at once when a class begins
_REQUEST_TIMEOUT_S = 10.0  # of requests that are answered immediately
_LOAD_TIMEOUT_S = 60.0  # of requests that build a world, close a file, or repeat a part of a run
_END_TIMEOUT_S = 10.0  # of a launched daemon
_EXPORT_TIMEOUT_S = 600.0  # of converting a long recording to a MAT file
_COMMAND_WAIT_S = 0.1  # for the reply to an actuator command in real time
_CATCH_UP_AFTER_S = 0.1  # of silence before _Session.catch_up
_NOTICE_AFTER_S = 2.0  # a longer wait reports once which robots the world waits for
_HELD_UP_S = 0.5  # lockstep waits for its robots before every step; shorter waits are not reported
_NAMED_ROBOTS = 4
_LISTED_NAMES = 20
_SAID_LINES = 200  # kept output of a launched daemon
_PLAYING = "playing a recording"  # start of an error text
_ANEW = ("reset", "load")  # texts of errors that end a wait
_NOT_IN_SCENARIO = "is not in the new scenario"  # end of a notice
_ENDED = "the run has ended: "
_UNSTEPPED = 200  # commands to one robot without a step before a notice, printed once
_MOST_GAPS = 100000
_MOST_STEPS = 10_000_000  # of one request
_FEW = 8  # more replies are not read one by one as they arrive: a step waits for the reply
_AT_ONCE = 256  # this many places ahead,
_GLANCE_S = 0.01  # at most this long, so that it notices errors and closed connections, too
_GROUP = "joints/"  # prefix of the name of a group of joints where types of modules are expected
_LABELS_LIVE_S = 0.5  # lifetime of cached ids and colours of targets
_LISTED = 1000  # robots in one status
_READINGS = ("pose", "distances", "targets", "neighbours", "wheels", "compass", "support", "joints")  # of a team
_TEAM_WORDS = ("velocities", "wheels", "positions", "positions_direct", "joint_velocities", "efforts")
_NEIGHBOURS = 8  # of each robot of a team, by default
_MAX_MESSAGE = 8  # numbers in one message between robots
_MANY_PARAMS = 1024  # more params, such as the bytes of a picture, are kept as an array
# Modules that `sense` reads, in addition to groups of joints: the first of each type.
_SENSED = ("motors", "distance", "target", "pose", "compass", "support", "imu", "wrench", "lidar", "contact", "sonar", "infrared",
           "light", "battery", "odometry")
# For each module, a shipped type of robot that has it; "": none.
_HAVE = {"neighbours": "minibot", "compass": "minibot", "support": "transporter", "imu": "balancer", "wrench": "humanoid",
         "lidar": "turtle", "contact": "turtle", "camera": "coopbot_camera", "sonar": "", "infrared": "", "light": "moth",
         "battery": "turtle", "odometry": "turtle"}

_ERROR_NAMES = {
    -1: "connection",
    1: "unknown_command",
    2: "wrong_params",
    3: "wrong_data",
    4: "out_of_range",
    5: "not_possible",
    6: "owned",
    7: "malformed",
    8: "too_large",
    9: "internal",
    10: "no_such_name",
    11: "timed_out",
    12: "not_allowed",
}


class Error(Exception):
    """An error of the daemon or of the connection to it.

    `code` is a protocol error (6: owned by another client, 10: no such name, 11: timed out …) or -1 if there is no
    connection; `name` is its word ("owned"); `text` says what is wrong and what to do instead.
    """

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text

    @property
    def name(self) -> str:
        return _ERROR_NAMES.get(self.code, "error")

    def __str__(self) -> str:
        return f"{self.text} [{self.name}]"


class WorldReset(Error):
    """Another client has reset the world or loaded a scenario. Raised once, by the reading, command or step that notices.
    Commands kept for the next step are discarded; the sim, and its robots and teams that exist in the new world, stay
    usable."""

    @property
    def name(self) -> str:
        return "reset"


_F = TypeVar("_F", bound=Callable[..., Any])
_C = TypeVar("_C", bound=type)


def _usage(example: str) -> Callable[[_F], _F]:
    """Decorates a public call. Wrong arguments raise an error that shows the correct call; concurrent use by a second thread
    raises an error that states the rule. Tracebacks of Error end here, because its text is sufficient."""

    def decorate(function: _F) -> _F:
        @functools.wraps(function)
        def call(*args: Any, **kwargs: Any) -> Any:
            session = getattr(args[0], "_session", None) if args else None
            if session is not None and not session.in_use.acquire(False):
                raise Error(5, "another thread uses this sim at this moment: use a sim, its robots and teams from one thread; let "
                               "each other thread have its own coopdyn.connect()")
            try:
                return function(*args, **kwargs)
            except Error as e:
                error: BaseException = e.with_traceback(None)
            except TypeError as e:
                if e.__traceback__ is None or e.__traceback__.tb_next is not None:
                    raise  # raised inside the function
                said = str(e)  # its counts include the object
                why = "an argument is missing" if " missing " in said else "too many arguments" if " given" in said else said
                error = Error(2, f"{why}: write {example}")
            finally:
                if session is not None:
                    session.in_use.release()
            try:
                raise error
            finally:
                del error  # breaks the cycle between the error and this frame

        return call  # type: ignore[return-value]

    return decorate


def _usages(variable: str) -> Callable[[_C], _C]:
    """Applies _usage() to all public calls of a class that lack it; these have no arguments."""

    def decorate(cls: _C) -> _C:
        for name, call in list(vars(cls).items()):
            if callable(call) and not name.startswith("_") and not hasattr(call, "__wrapped__"):
                setattr(cls, name, _usage(f"{variable}.{name}()")(call))
        return cls

    return decorate


class Message(NamedTuple):
    """The protocol's only message format, in both directions."""

    error: int
    text: str
    command: int
    params: List[int]
    data: List[float]


class Reply(NamedTuple):
    """The raw reply of `call`. `data` lacks the final two values, which are `time` [s] and `step`."""

    text: str
    command: int
    params: List[int]
    data: List[float]
    time: float
    step: int


class Pose(NamedTuple):
    """Pose and velocity of a robot in the world frame: m, rad, m/s, rad/s."""

    x: float
    y: float
    heading: float
    forward: float
    turn: float


class Pose3d(NamedTuple):
    """Position [m], quaternion, velocity [m/s] and angular velocity [rad/s] in the world frame."""

    x: float
    y: float
    z: float
    qw: float
    qx: float
    qy: float
    qz: float
    vx: float
    vy: float
    vz: float
    wx: float
    wy: float
    wz: float


class Bearing(NamedTuple):
    """Distance [m] and bearing [rad], left is positive."""

    distance: float
    bearing: float


class Target(NamedTuple):
    """A target as a robot sees it: distance [m], bearing [rad]."""

    id: int
    colour: str
    distance: float
    bearing: float


class OtherRobot(NamedTuple):
    """Another robot as a robot sees it: distance [m], bearing [rad]."""

    id: int
    name: str
    distance: float
    bearing: float


class Heard(NamedTuple):
    """A message from another robot, and where that robot is now: distance [m], bearing [rad]."""

    id: int
    distance: float
    bearing: float
    values: List[float]


class Geometry(NamedTuple):
    """Bearing [rad], opening [rad] and maximal range [m] of each distance sensor, right to left."""

    bearing: List[float]
    opening: List[float]
    max_range: List[float]


class Wheels(NamedTuple):
    """Angles [rad] and speeds [rad/s] of the wheels."""

    left_angle: float
    right_angle: float
    left_speed: float
    right_speed: float


class Limits(NamedTuple):
    """Maximal wheel speed [rad/s], wheel radius and track [m]."""

    max_wheel_speed: float
    wheel_radius: float
    track: float


class Support(NamedTuple):
    """Displacement of the support by its load, in the robot's frame."""

    x: float  # [m]
    y: float
    angle: float  # [rad]


class Imu(NamedTuple):
    """The sensor's orientation in the world as a quaternion; angular velocity [rad/s] and acceleration [m/s2] in the sensor's
    frame: at rest and level, az = 9.81."""

    qw: float
    qx: float
    qy: float
    qz: float
    wx: float
    wy: float
    wz: float
    ax: float
    ay: float
    az: float


class Wrench(NamedTuple):
    """Force [N] and torque [N m] through a joint, in the sensor's frame."""

    fx: float
    fy: float
    fz: float
    tx: float
    ty: float
    tz: float


class Scan(NamedTuple):
    """Ranges [m] of a lidar: `ranges[row]` is a row from right to left, the lowest row first; inf = nothing in range, 0 = nearer
    than min_range. `azimuth` [rad] of each column, left positive; `elevation` [rad] of each row, up positive."""

    ranges: "Rows"
    azimuth: List[float]
    elevation: List[float]
    min_range: float
    max_range: float


class Contact(NamedTuple):
    """A contact of the robot: id and name of the other thing (0: the floor; in `sense` -1 and ""), force [N], point [m] and the
    direction of the force on the robot, in the robot's frame."""

    id: int
    name: str
    force: float
    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float


class Camera(NamedTuple):
    """Size, focal lengths and principal point of a camera [pixels], near and far limit of its view [m], and its rate
    [Hz; 0 = each step]."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    near: float
    far: float
    rate: float


class Battery(NamedTuple):
    """Remaining energy of the battery [J, and as a fraction 0 to 1], and the power drawn [W]."""

    energy: float
    fraction: float
    power: float


class Odometry(NamedTuple):
    """Pose since the start (x ahead) and velocity by the wheels' encoders [m, rad, m/s, rad/s]."""

    x: float
    y: float
    heading: float
    forward: float
    turn: float


class JointReading(NamedTuple):
    """Position [rad or m] and velocity [rad/s, m/s] of each joint of a group, and its motor's effort [N m, N; nan before the
    first step]."""

    position: List[float]
    velocity: List[float]
    effort: List[float]


class JointLimits(NamedTuple):
    """Limits of each joint of a group: position [rad or m; inf = none], velocity [rad/s, m/s] and effort [N m, N]."""

    lower: List[float]
    upper: List[float]
    velocity: List[float]
    effort: List[float]


class Compliance(NamedTuple):
    """Stiffness k [N m/rad; inf = a servo], damping d [N m s/rad] and offset [N m] of each joint."""

    k: List[float]
    d: List[float]
    offset: List[float]


class Profile(NamedTuple):
    """Speed [rad/s] and acceleration [rad/s2] with which each joint moves to a position."""

    speed: List[float]
    acceleration: List[float]


class Gains(NamedTuple):
    """Gains of each joint's servo: p [1/s], i [1/s2], d."""

    p: List[float]
    i: List[float]
    d: List[float]


class DriveTrains(NamedTuple):
    """Rotor position [rad] and velocity [rad/s] of each joint's drive train, on the joint side, the motor's current [A] and the
    energy drawn [J]; nan without a drive train."""

    rotor_position: List[float]
    rotor_velocity: List[float]
    current: List[float]
    energy: List[float]


class MuscleReading(NamedTuple):
    """Activation (0 to 1), force [N], length [m] and lengthening velocity [m/s] of each muscle, and the force-length and
    force-velocity factors."""

    activation: List[float]
    force: List[float]
    length: List[float]
    velocity: List[float]
    length_factor: List[float]
    velocity_factor: List[float]


class MuscleLimits(NamedTuple):
    """For each muscle: maximal force [N], the length at which it occurs [m], and the velocity at which the force vanishes [m/s]."""

    max_force: List[float]
    optimal_length: List[float]
    max_velocity: List[float]


class ThrusterReading(NamedTuple):
    """Force or torque of each thruster on its link [N, N m], and the link's velocity along or about the thrust direction
    [m/s, rad/s]."""

    thrust: List[float]
    velocity: List[float]


class ThrusterLimits(NamedTuple):
    """Maximal force or torque of each thruster, in both directions [N, N m]."""

    max_thrust: List[float]


class Mapped(NamedTuple):
    """A motor or value of a channel. Maps internal_min..internal_max in the robot [SI units] to external_min..external_max
    here; inf = not mapped. `auxiliary`: only for the experimenter."""

    name: str
    internal_min: float
    internal_max: float
    external_min: float
    external_max: float
    auxiliary: bool


class Motion(NamedTuple):
    """Whether each joint has completed its motion, and its target [rad or m]."""

    arrived: List[bool]
    target: List[float]


class Reading(NamedTuple):
    """All readings of a robot in one step. Readings that the robot lacks are None (or empty)."""

    time: float
    step: int
    distances: List[float]
    targets: List[Target]
    target: Optional[Target]
    pose: Optional[Pose]
    wheels: Optional[Wheels]
    compass: Optional[float]
    support: Optional[Support]
    joints: Dict[str, JointReading]  # by group name
    imu: Optional[Imu]  # this and the following: the first sensor of the type
    wrench: Optional[Wrench]
    scan: Optional[Scan]
    contacts: List[Contact]
    sonar: List[float]
    infrared: List[float]
    light: List[float]
    battery: Optional[Battery]
    odometry: Optional[Odometry]


class Rows:
    """Rows of numbers, one per robot of a team or per moment of a run: `rows[i]` is a tuple, `rows[i][j]` or `rows[i, j]` a
    number, `rows[:, j]` a column; iterate by `for x, y, heading in s.pose`. `numpy.asarray(rows)` shares the memory."""

    __slots__ = ("_data", "_stride", "_first", "shape")

    def __init__(self, data: "array.array[float]", stride: int, first: int, shape: Tuple[int, int]) -> None:
        self._data, self._stride, self._first, self.shape = data, stride, first, shape

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, tuple):
            return self._column(*i)
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(self.shape[0]))]
        if not -self.shape[0] <= i < self.shape[0]:
            raise IndexError(f"there is no row {i} of {self.shape[0]}")
        at = i % self.shape[0] * self._stride + self._first
        return tuple(self._data[at : at + self.shape[1]])

    def _column(self, i: Any, j: int) -> Any:
        rows, columns = self.shape
        if not -columns <= j < columns:
            raise IndexError(f"there is no column {j} of {columns}")
        column = self._data[self._first + j % columns : self._first + rows * self._stride : self._stride]
        return column[i]

    def __iter__(self) -> Iterator[Tuple[float, ...]]:
        rows, columns = self.shape
        if columns == 0:
            return iter([()] * rows)
        end, first = rows * self._stride, self._first
        return zip(*(self._data[k : end : self._stride] for k in range(first, first + columns)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rows) and self.shape == other.shape and list(self) == list(other)

    def __repr__(self) -> str:
        return f"<{self.shape[0]} x {self.shape[1]} numbers>"

    @property
    def __array_interface__(self) -> Dict[str, Any]:
        return {"version": 3, "typestr": "<f8" if sys.byteorder == "little" else ">f8", "shape": self.shape,
                "data": self._data, "offset": 8 * self._first, "strides": (8 * self._stride, 8)}


class _Raster:
    """The pixels of a picture, row by row from the upper left corner, taken at `time` [s] in `step`."""

    __slots__ = ("width", "height", "data", "time", "step")
    _code = ""  # type code of the values, as in module array
    _channels = 1  # values of a pixel

    def __init__(self, width: int, height: int, data: Any, time: float = math.nan, step: int = -1) -> None:
        self.width, self.height, self.data, self.time, self.step = width, height, data, time, step
        if len(data) != width * height * self._channels:
            raise Error(7, f"a picture of {width} x {height} has {len(data)} values, not {width * height * self._channels}")

    def __repr__(self) -> str:
        return f"<{type(self).__name__.lower()} of {self.width} x {self.height} pixels, step {self.step}>"

    def at(self, x: int, y: int) -> Any:
        """The value of the pixel in column x and row y, from 0; (0, 0) is the upper left one."""
        return self.data[self._index(x, y)]

    def numpy(self) -> Any:
        """A numpy array that shares the memory: height x width; for a colour picture height x width x 3."""
        import numpy

        shape = (self.height, self.width) + ((self._channels,) if self._channels > 1 else ())
        return numpy.frombuffer(self.data, dtype=self._code).reshape(shape)

    def _index(self, x: int, y: int) -> int:
        if not (0 <= x < self.width and 0 <= y < self.height):
            raise IndexError(f"there is no pixel {x}, {y} in {self.width} x {self.height}")
        return (y * self.width + x) * self._channels


class Image(_Raster):
    """A colour picture. `data` has the bytes red, green, blue of each pixel, row by row from the upper left corner.
    `image.rgb(x, y)`, `image.numpy()` (height x width x 3), `image.save("x.png")`; taken at `time` [s] in `step`."""

    __slots__ = ()
    _code = "B"
    _channels = 3

    def rgb(self, x: int, y: int) -> Tuple[int, int, int]:
        """Red, green and blue of a pixel, 0 to 255."""
        k = self._index(x, y)
        return self.data[k], self.data[k + 1], self.data[k + 2]

    at = rgb

    def save(self, file: Union[str, "os.PathLike[str]"]) -> str:
        """Writes the picture as a PNG file; returns its name."""
        path = _path(file, "the name of a picture")
        if not str(path).lower().endswith(".png"):
            raise Error(4, f"pictures are saved as PNG: write e.g. {os.path.splitext(str(path))[0]}.png; get_jpeg() returns a JPEG")
        row = 3 * self.width
        raw = b"".join(b"\0" + self.data[k : k + row] for k in range(0, len(self.data), row))

        def chunk(kind: bytes, content: bytes) -> bytes:
            return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

        with open(path, "wb") as out:
            out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", self.width, self.height, 8, 2, 0, 0, 0))
                      + chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b""))
        return str(path)


class Depth(_Raster):
    """The distance of each pixel along the camera's axis [m]: `depth.at(x, y)`, `depth.numpy()`, or `data`, an array of floats;
    inf = nothing there, 0 = nearer than the camera sees."""

    __slots__ = ()
    _code = "f"


class Segmentation(_Raster):
    """The object that each pixel shows, as a number, `segmentation.at(x, y)`, with the name `names[number]`; 0 = nothing."""

    __slots__ = ("names",)
    _code = "H"
    names: Dict[int, str]


class TeamReading:
    """The readings of a team in one step that `team.select` chose, one row per robot in the order of `team.names`: `pose` (x, y
    [m], heading [rad]), `distances` [m], `targets` (distance [m], bearing [rad] of each), `neighbours` (id, distance, bearing
    of each; 0, inf, nan: no more), `wheels` (as get_wheels), `compass` (heading [rad]; nan without one), `support` (x, y [m],
    angle [rad] of the load; nan without one), `joints` (position, velocity, effort of each; nan: no more); sensor modules by
    their names, e.g. `s.lidar`. `text` reports limited commands and robots taken from the team."""

    time: float
    step: int
    text: str
    pose: Rows
    distances: Rows
    targets: Rows
    neighbours: Rows
    wheels: Rows
    compass: Rows
    support: Rows
    joints: Rows

    def __init__(self, names: Sequence[str], columns: Sequence[int], reply: Message) -> None:
        data: "array.array[float]" = reply.data  # type: ignore[assignment]
        n = reply.params[-2]
        self.time, self.step, self.text = data[-2], int(data[-1]), reply.text
        stride, first = sum(columns), 0
        for name, count in zip(names, columns):
            self.__dict__[name] = Rows(data, stride, first, (n, count))
            first += count

    def __getattr__(self, name: str) -> Any:
        if name in _READINGS:
            chosen = [word for word in _READINGS if word in self.__dict__] + [name]
            raise AttributeError(f'{name} was not chosen; write team.select({", ".join(map(repr, chosen))})')
        raise AttributeError(f"a reading of a team has no {name!r}")

    def __repr__(self) -> str:
        rows = ", ".join(f"{k} {v.shape[0]} x {v.shape[1]}" for k, v in self.__dict__.items() if isinstance(v, Rows))
        return f"<readings of step {self.step}: {rows}>"


class Update(NamedTuple):
    """A pushed reading (`Robot.next`); `value` is the result of the module's get command."""

    module: str
    time: float
    step: int
    value: Any
    text: str


class Awaited(NamedTuple):
    """A robot that the world waits for, why, and for how long [s]."""

    robot: str
    why: str
    seconds: float


class Module(NamedTuple):
    """A module's name and address. Port 0: reachable only through the daemon's port."""

    name: str
    host: str
    port: int


class Recording(NamedTuple):
    """The recording in progress: the file's name, its simulated times [s], its steps, the steps lost because the disk was too
    slow, and its size."""

    name: str
    begin_time: float
    end_time: float
    steps: int
    lost: int
    bytes: int


class RunFile(NamedTuple):
    """A recording on the daemon. Seconds (simulated) and steps are None if it cannot be read, url is empty if it cannot be
    downloaded now."""

    name: str
    bytes: int
    seconds: Optional[float]
    steps: Optional[int]
    recording: bool
    url: str


class Recorded(NamedTuple):
    """A completed recording: its name, and its URL on the daemon's page ("": the daemon has no page)."""

    name: str
    url: str


class Playback(NamedTuple):
    """The state of a playback: the recording's first and last simulated time [s], the time shown, the speed, whether it is
    playing, loops, and is still being recorded, and the recording's name."""

    begin_time: float
    end_time: float
    time: float
    speed: float
    playing: bool
    loop: bool
    growing: bool
    file: str


class Picked(NamedTuple):
    """The first hit of a ray: its name ("": no hit), the point [m] and its distance [m]."""

    name: str
    point: Tuple[float, ...]
    distance: float


class SavedState(NamedTuple):
    """A state saved on the daemon, and its simulated time [s]."""

    name: str
    time: float


# --- the wire ---------------------------------------------------------------------------------------------------------

_HEADER = struct.Struct("<IiiIII")
_MAGIC = b"CDS1"


def encode(command: int, params: Sequence[int] = (), data: Sequence[float] = (), text: str = "", error: int = 0) -> bytes:
    """The binary frame of a message."""
    raw = text.encode("utf-8")
    t, m, n = len(raw), len(params), len(data)
    return struct.pack(f"<IiiIII{t}s{m}i{n}d", 20 + t + 4 * m + 8 * n, error, command, t, m, n, raw, *params, *data)


def decode(buffer: Union[bytes, bytearray], bulk: bool = False) -> Tuple[Optional[Message], int]:
    """The first message of `buffer` and its size in bytes; (None, 0) if it is incomplete. `bulk`: data as an array."""
    if len(buffer) < 24:
        return None, 0
    size, error, command, t, m, n = _HEADER.unpack_from(buffer)
    if size != 20 + t + 4 * m + 8 * n:
        raise Error(7, "the bytes received are not a coopdyn message")
    end = 4 + size
    if len(buffer) < end:
        return None, 0
    text = bytes(buffer[24 : 24 + t]).decode("utf-8", "replace") if t else ""
    params: Any
    if m <= _MANY_PARAMS:
        params = list(struct.unpack_from(f"<{m}i", buffer, 24 + t))
    else:
        params = array.array("i")
        with memoryview(buffer) as whole, whole[24 + t : 24 + t + 4 * m] as part:
            params.frombytes(part)
        if sys.byteorder == "big":
            params.byteswap()
    if not bulk:
        return Message(error, text, command, params, list(struct.unpack_from(f"<{n}d", buffer, end - 8 * n))), end
    data = array.array("d")
    with memoryview(buffer) as whole, whole[end - 8 * n : end] as part:
        data.frombytes(part)
    if sys.byteorder == "big":
        data.byteswap()
    return Message(error, text, command, params, data), end  # type: ignore[arg-type]


def _list_of(words: Any) -> str:
    """Lists words for an error; of many, the first and their total number."""
    words = [str(w) for w in words]
    return (", ".join(words[:_LISTED_NAMES]) or "none") + (f", … ({len(words)})" if len(words) > _LISTED_NAMES else "")


def _nearest(name: str, known: Sequence[str]) -> str:
    """Suggests, as part of an error, the known name most similar to `name`, ignoring case; else empty."""
    import difflib

    lower = {k.lower(): k for k in reversed(known)}
    found = difflib.get_close_matches(name.lower(), list(lower), 1, 0.7)
    return f"did you mean {lower[found[0]]}? " if found else ""


def _parse_server(server: Union[str, int, None]) -> Tuple[str, int]:
    """Host and port; for a unix socket "unix:/PATH" and 0."""
    forms = 'write HOST, HOST:PORT, or a port of this machine, e.g. "labserver:10100"; for a unix socket unix:/PATH'
    is_port = not isinstance(server, (str, type(None)))
    try:
        given = str(operator.index(server)) if is_port else server or os.environ.get("COOPDYN_SERVER") or "127.0.0.1"
    except TypeError:
        raise Error(4, f"cannot read the server {server!r}; {forms}") from None
    host, port = given.strip(), str(DEFAULT_PORT)
    if host.startswith("unix:/"):
        return host, 0
    if "://" in host:
        raise Error(4, f"{host} is the address of the page; a program connects to the name server, whose HOST:PORT "
                       '`coopdyn serve` prints: write e.g. connect("127.0.0.1:10000")')
    if host.isdigit() or is_port:
        host, port = "127.0.0.1", host
    elif host.startswith("[") and "]" in host:  # [::1]:10000
        host, rest = host[1:].split("]", 1)
        port = rest[1:] if rest.startswith(":") else port
    elif host.count(":") == 1:
        host, port = host.split(":")
    if not host or not port.isdigit() or not 0 < int(port) < 65536:
        raise Error(4, f"cannot read the server {given!r}; {forms}")
    return host, int(port)


def _seat_and_pin(seat: Optional[str], pin: Optional[str]) -> Tuple[str, str]:
    """A seat of a class and its PIN: as given, else from COOPDYN_SEAT; both "": none."""
    if seat is None and pin is None:
        seat, _, pin = os.environ.get("COOPDYN_SEAT", "").strip().partition(":")
    how = '; write connect(seat="ana", pin="7305") as on your sheet, or COOPDYN_SEAT=ana:7305'
    if isinstance(pin, int):
        raise Error(3, f'a PIN is a text, since a number loses the zeros at its beginning: write pin="{pin:04d}"')
    if not seat and not pin:
        return "", ""
    if not seat or not pin:
        raise Error(3, (f"the seat {seat} needs its PIN" if seat else "a PIN needs its seat") + how)
    if not isinstance(seat, str) or not re.fullmatch("[a-z0-9][a-z0-9_-]{0,31}", seat):
        raise Error(3, f"the name of a seat has only a-z, 0-9, - and _, not {seat!r}{how}")
    if not isinstance(pin, str) or not re.fullmatch("[A-Za-z0-9]{4,16}", pin):
        raise Error(3, f"a PIN has 4 to 16 letters or digits, not {pin!r}{how}")
    return seat, pin


def _default_name() -> str:
    try:
        user = getpass.getuser()
    except Exception:  # no such user in a container
        user = "user"
    return "".join(f"{user}@{socket.gethostname()}:{os.getpid()}".split())


def _spin_s(lockstep: bool, robots: int) -> float:
    given = os.environ.get("COOPDYN_SPIN")
    if given is None:
        return 50e-6 if lockstep and robots <= 4 else 0.0
    try:
        return max(0.0, float(given)) * 1e-6
    except ValueError:
        raise Error(4, f"COOPDYN_SPIN is {given!r}; write microseconds, e.g. 50") from None


class _Polling:
    """Polls for a while at the start of each wait, which saves the wake-up latency while a core is idle. If other threads
    compete for the core, polling uses up the client's share, and the kernel preempts it for milliseconds. So once preempted
    while polling, the client stops polling for a pause, which doubles if preempted again soon after it."""

    _LOST_S = 0.5e-3
    _TRIAL_S = 0.3
    _LEAST_PAUSE_S = 10e-3
    _MOST_PAUSE_S = 1.0
    _yield_core = staticmethod(getattr(os, "sched_yield", lambda: _clock.sleep(0)))  # Windows has none

    def __init__(self) -> None:
        self.spin_s = 0.0
        self.until = self.looked_at = self.resumes_at = -math.inf
        self.pause_s = self._LEAST_PAUSE_S

    def start(self, now: float) -> bool:
        """Begins a wait. True if the caller must check the sockets immediately."""
        self.until = now + self.spin_s if now >= self.resumes_at else now
        self.looked_at = now
        return now < self.until

    def goes(self, now: float) -> bool:
        """Call after each check of the sockets. True if the caller must check again immediately."""
        if self.looked_at < self.until and now - self.looked_at > self._LOST_S:
            soon = now - self.resumes_at < self._TRIAL_S
            self.pause_s = min(2 * self.pause_s, self._MOST_PAUSE_S) if soon else self._LEAST_PAUSE_S
            self.resumes_at = now + self.pause_s
            self.until = now
        self.looked_at = now
        if now >= self.until:
            return False
        # If other threads want the core, a yield loses it at once, which shows here. A yield costs as much as a check, so
        # once the core has been kept for a while, only the second half of the spin yields.
        if now - self.resumes_at < self._TRIAL_S or self.until - now < self.spin_s / 2:
            self._yield_core()
        return True


def _wait_readable(sockets: Sequence[socket.socket], timeout_s: float) -> bool:
    """Waits until a socket is readable. False on timeout."""
    if hasattr(select, "poll"):
        poll = select.poll()
        for s in sockets:
            poll.register(s, select.POLLIN)
        return bool(poll.poll(math.ceil(max(0.0, timeout_s) * 1000)))
    return bool(select.select(sockets, [], [], max(0.0, timeout_s))[0])


def _dial_local(host: str, port: int) -> Optional[socket.socket]:
    """A connection to the unix socket of a daemon that listens only on this machine; an exchange costs half as much as over
    TCP. None if there is no such socket. Any user can bind the name while no daemon has it, so the listener must belong to
    this user or root."""
    local = sys.platform.startswith("linux") and host in ("127.0.0.1", "localhost", "::1")
    if not local or os.environ.get("COOPDYN_TCP", "0") not in ("", "0"):
        return None
    try:
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    except OSError:
        return None
    try:
        sock.setblocking(False)
        sock.connect(f"\0coopdyn-{port}")
        peer = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
        if struct.unpack("3i", peer)[1] in (0, os.geteuid()):
            return sock
    except OSError:
        pass
    sock.close()
    return None


class _Address:
    """The daemon's address and the client's identity, shared by all connections."""

    def __init__(
        self, server: Union[str, int, None], name: Optional[str], token: Optional[str], timeout: float,
        seat: Optional[str] = None, pin: Optional[str] = None,
    ) -> None:
        self.host, self.port = _parse_server(server)
        self.seat, self.pin = _seat_and_pin(seat, pin)
        if type(name) is int:
            self.port = name
            raise Error(3, f'a client name is a text, not {name}; a port is part of the server: write connect("{self}")')
        self.name = name or _default_name()
        if not isinstance(self.name, str) or len(self.name.split()) != 1:
            raise Error(3, f"a client name has no spaces, not {self.name!r}; write e.g. \"ana\"")
        self.token = token or ""
        self.timeout = timeout
        self.ended = ""  # why the run and its daemon have ended, once the daemon has reported it

    def __str__(self) -> str:
        if self.port == 0:
            return self.host
        return f"{'[' + self.host + ']' if ':' in self.host else self.host}:{self.port}"

    def hello_text(self, drives: bool, number: int = 1) -> str:
        """The text of `hello`. Only connections that may drive use the plain name: a client of the same name takes over an
        actuator module, which a reader must not do."""
        suffix = ":reader" if not drives else "" if number == 1 else f":{number}"
        return f"{self.name}{suffix} {self.token}".rstrip()

    def page_headers(self) -> Dict[str, str]:
        """Headers of requests to the page."""
        return {"Authorization": f"Bearer {self.seat}:{self.pin}"} if self.seat else {}

    def why_lost(self) -> str:
        """The hint in the error if the daemon closed a connection without a notice."""
        if self.seat:
            return f"the class restarts the seat {self.seat} where it was: run your program again"
        return "is the daemon still running?"

    def dial(self, deadline: float) -> socket.socket:
        """Returns a connected socket: the daemon's unix socket if it runs on this machine and has one (and COOPDYN_TCP is not
        set), else TCP. Error -1 or 11 with cause and cure. A class is reached only by TCP: a unix socket of that name would
        belong to another daemon."""
        sock = None if self.seat else _dial_local(self.host, self.port)
        if sock is None:
            return self.dial_port(deadline)
        sock.settimeout(max(0.01, deadline - _clock.monotonic()))
        return sock

    def dial_port(self, deadline: float) -> socket.socket:
        """Dials the address as given: a TCP port, or a unix socket's path."""
        return self.dial_tcp(deadline) if self.port else self.dial_unix(deadline)

    def dial_unix(self, deadline: float) -> socket.socket:
        """Dials the unix socket at the path."""
        if not hasattr(socket, "AF_UNIX"):
            raise Error(-1, f"this system has no unix sockets for Python: write HOST:PORT instead of {self}")
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        sock.settimeout(max(0.01, deadline - _clock.monotonic()))
        try:
            sock.connect(self.host[len("unix:"):])
        except OSError as e:
            sock.close()
            raise Error(-1, f"nothing can be reached at {self}: {e.strerror or e}; a daemon's port is HOST:PORT") from None
        return sock

    def dial_tcp(self, deadline: float) -> socket.socket:
        """Dials the TCP port."""
        try:
            sock = socket.create_connection((self.host, self.port), max(0.01, deadline - _clock.monotonic()))
        except socket.gaierror:
            raise Error(-1, f"no machine is called {self.host!r}; check the name, or write its address") from None
        except (socket.timeout, TimeoutError):
            raise Error(11, f"no answer from {self} within {self.timeout:g} s: the machine is off, the address is wrong, or a "
                            "firewall drops the packets; try `ping`, or a tunnel: ssh -L 10000:127.0.0.1:10000 HOST") from None
        except ConnectionRefusedError:
            if self.ended:
                raise Error(5, self.ended) from None
            raise Error(-1, f"nothing listens at {self}: start the daemon there (coopdyn serve; for other machines add "
                            '--host 0.0.0.0), or name the server: connect("HOST:PORT") or COOPDYN_SERVER') from None
        except OSError as e:
            raise Error(-1, f"cannot reach {self}: {e.strerror or e}") from None
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return sock

    def not_a_daemon(self, said: str) -> Error:
        heard = f"it said {said[:60]!r}" if said else "it closed the connection without an answer"
        return Error(-1, f"what listens at {self} is not a coopdyn daemon ({heard}); name the server's port, which "
                         "`coopdyn serve` prints: HOST:PORT")

    def refusal(self, said: str) -> Error:
        """The error that an unexpected answer line stands for."""
        words = said.split(" ", 2)  # error 10 no such name /robot9/motors; did you mean /robot1/motors
        if len(words) == 3 and words[0] == "error" and words[1].isdigit():
            return Error(int(words[1]), words[2])
        if self.seat and not said:
            return Error(-1, f"{self} closed the connection of the seat {self.seat} without an answer; ask your teacher whether "
                             "the class runs there, and this seat")
        return self.not_a_daemon(said)

    def begin(self, sock: socket.socket, line: str, deadline: float) -> float:
        """Sends a connection's first line, in a class after a line with seat and PIN. Returns the deadline of the answer, which
        is later in a class: the seat's daemon may have to start first."""
        entry = f"SEAT {self.seat} {self.pin} python\n" if self.seat else ""
        with contextlib.suppress(OSError):  # the daemon's last line is still read
            sock.sendall(f"{entry}{line}\n".encode())
        if not entry:
            return deadline
        said = self._line(sock, deadline)
        if said.startswith("***"):  # a name server's answer to an unknown word
            raise Error(5, f"{self} is not a class: leave seat and pin out" +
                        (", and COOPDYN_SEAT, too" if os.environ.get("COOPDYN_SEAT") else ""))
        if said != "ok":
            raise self.refusal(said)
        return max(deadline, _clock.monotonic() + _SEAT_START_S)

    def ask_names(self, command: str) -> List[str]:
        """The lines of the name server's answer, without the last."""
        deadline = _clock.monotonic() + self.timeout
        with self.dial(deadline) as sock:
            deadline = self.begin(sock, f"NAME_SERVER {command}", deadline)
            received = b""
            while b"*** end of message" not in received:
                more = self._receive(sock, deadline)
                received += more
                first = received.split(b"\n")[0]
                known = first.startswith((b"registration ", b"***"))
                if not more or (b"\n" in received and not known):
                    raise self.refusal(first.decode("utf-8", "replace").strip())
        lines = received.decode("utf-8", "replace").splitlines()
        return [line for line in lines if not line.startswith("***")]

    def modules(self) -> List[Module]:
        found = []
        for line in self.ask_names("list"):
            words = line.split()  # registration name /robot1/motors ip 127.0.0.1 port 10002 type tcp
            if len(words) >= 7 and words[0] == "registration" and words[2].startswith("/"):
                found.append(Module(words[2], words[4], int(words[6])))
        if not found:
            raise self.not_a_daemon("a list without modules")
        return found

    def _receive(self, sock: socket.socket, deadline: float, size: int = 65536) -> bytes:
        sock.settimeout(max(0.01, deadline - _clock.monotonic()))
        try:
            return sock.recv(size)
        except (socket.timeout, TimeoutError):
            raise Error(11, f"{self} accepts connections but does not answer: the daemon is stopped or busy, or something else "
                            "listens there; try `coopdyn status`") from None
        except OSError:
            return b""

    def _line(self, sock: socket.socket, deadline: float) -> str:
        line = b""
        while not line.endswith(b"\n"):
            byte = self._receive(sock, deadline, 1)
            if not byte:
                break
            line += byte
        return line.decode("utf-8", "replace").strip()

    def open_module(self, module: str, deadline: float) -> socket.socket:
        """Returns a socket to `module` in binary mode. Error 10 if the daemon has no such name."""
        sock = self.dial(deadline)
        try:
            said = self._line(sock, self.begin(sock, f"OPEN {module}", deadline))
            if self.seat and not said and _clock.monotonic() + _SEAT_AGAIN_S < deadline:  # the daemon is restarting
                sock.close()
                _clock.sleep(_SEAT_AGAIN_S)
                return self.open_module(module, deadline)
            if said != "ok":
                raise self.refusal(said)
            sock.sendall(_MAGIC)
            sock.setblocking(False)
            return sock
        except OSError as e:
            sock.close()
            raise Error(-1, f"the connection to {self} broke: {e.strerror or e}") from None
        except BaseException:
            sock.close()
            raise


class _Connection:
    """A connection to a module. `busy`: a reply is pending, and the connection accepts no other request. `bulk`: the data of
    its replies are arrays. `number`: distinguishes this client's connections to one module."""

    def __init__(
        self, address: _Address, module: str, drives: bool = False, bulk: bool = False, number: int = 1
    ) -> None:
        self.address = address
        self.module = module
        self.drives = drives
        self.bulk = bulk
        self.number = number
        self.sock: Optional[socket.socket] = None
        self.buffer = bytearray()
        self.busy = False
        self.pushes: List[Message] = []

    def open(self, timeout_s: float) -> None:
        self.close()
        self.sock = self.address.open_module(self.module, _clock.monotonic() + timeout_s)
        try:
            self.request(_HELLO, text=self.address.hello_text(self.drives, self.number), timeout=timeout_s)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        if self.sock is not None:
            self.sock.close()
        self.sock = None
        self.busy = False
        self.buffer.clear()
        self.pushes.clear()

    def send(self, frame: bytes) -> None:
        assert self.sock is not None
        self.busy = True
        try:
            try:
                sent = self.sock.send(frame)
            except BlockingIOError:
                sent = 0
            if sent < len(frame):
                self.sock.settimeout(_REQUEST_TIMEOUT_S)
                self.sock.sendall(frame[sent:])
                self.sock.setblocking(False)
        except OSError:
            self._raise_lost()

    def try_read(self) -> Optional[Message]:
        """Returns the reply if it has arrived; appends readings pushed before it to `pushes`. Error -1 if the peer closed."""
        assert self.sock is not None
        while True:
            message, used = decode(self.buffer, self.bulk)
            if message is not None:
                del self.buffer[:used]
                if (message.error or message.command == -1) and message.text.startswith(_ENDED):
                    self.address.ended = message.text
                if message.command < 0 and message.error == 0:
                    if message.command == -1:
                        self.close()
                        raise _Closed(message.text, self.address)
                    self.pushes.append(message)
                    continue
                self.busy = False
                return message
            try:
                more = self.sock.recv(262144)
            except (BlockingIOError, InterruptedError):
                return None
            except OSError:
                more = b""
            if not more:
                self.close()
                raise _Closed("", self.address)
            self.buffer += more

    def _raise_lost(self) -> None:
        """After a failed write: raises with the daemon's closing notice, if it sent one."""
        assert self.sock is not None
        self.sock.setblocking(False)
        while self.try_read() is not None:
            pass
        self.close()
        raise _Closed("", self.address)

    def __del__(self) -> None:
        if self.sock is not None:
            self.sock.close()

    def alive(self) -> bool:
        """False if closed, busy, or meanwhile closed by the peer."""
        if self.sock is None or self.busy:
            return False
        try:
            self.try_read()
        except Error:
            return False
        return True

    def receive(self, timeout: float, polling: Optional[_Polling] = None) -> Message:
        """Waits for the reply. After `timeout` seconds closes the connection and raises Error 11."""
        message = self.try_read()
        if message is not None:
            return message
        now = _clock.monotonic()
        deadline = now + timeout
        polls = polling is not None and polling.start(now)
        while True:
            assert self.sock is not None
            if not polls:
                _wait_readable((self.sock,), deadline - now)
            message = self.try_read()
            now = _clock.monotonic()
            polls = polling is not None and polling.goes(now)
            if message is not None:
                return message
            if now >= deadline:
                self.close()
                raise Error(11, f"no answer from {self.module} within {timeout:g} s; is the daemon stopped or overloaded?")

    def request(
        self, command: int, params: Sequence[int] = (), data: Sequence[float] = (), text: str = "",
        timeout: float = _REQUEST_TIMEOUT_S, polling: Optional[_Polling] = None,
    ) -> Message:
        """Sends a request and returns its reply; raises an error reply. Closes the connection if no reply arrives."""
        self.send(encode(command, params, data, text))
        try:
            reply = self.receive(timeout, polling)
        except BaseException:
            self.close()
            raise
        return _checked(reply)


class _Closed(Error):
    """The daemon closed the connection; `notice` is its reason, empty if it sent none."""

    def __init__(self, notice: str, address: _Address) -> None:
        self.notice = notice
        super().__init__(-1, "the daemon closed the connection" + (f": {notice}" if notice else f"; {address.why_lost()}"))


def _checked(reply: Message, who: str = "") -> Message:
    """Raises an error reply. If a reset or load ended the wait, raises WorldReset with a one-word text, which world_reset()
    turns into a message."""
    if reply.error == 5 and reply.text in _ANEW:
        raise WorldReset(reply.error, reply.text)
    if reply.error:
        raise Error(reply.error, who + (reply.text or _ERROR_NAMES.get(reply.error, "error")))
    return reply


# --- checks before anything is written --------------------------------------------------------------------------------


def _number(value: Any, what: str) -> float:
    try:
        number = float(None if isinstance(value, (str, bytes)) else value)
    except (TypeError, ValueError):
        raise Error(3, f"{what} must be one number, not {value!r}") from None
    except OverflowError:
        raise Error(4, f"{what} is too large for a number: it ends at 1.8e308") from None
    if not math.isfinite(number):
        raise Error(4, f"{what} must be finite, not {number}")
    return number


def _pair(v: Any, w: Any, call: str, units: Tuple[str, str]) -> Tuple[float, float]:
    """Two numbers, given as two or as one row."""
    if w is None:
        try:
            row = list(v)
            v, w = row[0] if len(row) == 1 else row
        except (TypeError, ValueError):
            raise Error(3, f"{call} takes {' and '.join(units)}: write r.{call}(0.2, 0.5) or r.{call}([0.2, 0.5])") from None
    return _number(v, units[0]), _number(w, units[1])


def _whole(value: Any, what: str) -> int:
    """A 32-bit integer."""
    try:
        if isinstance(value, bool) or isinstance(value, float) and not value.is_integer():
            raise TypeError
        number = int(value) if isinstance(value, float) else operator.index(value)
    except TypeError:
        raise Error(2, f"{what} must be a whole number, not {value!r}") from None
    if not -(2**31) <= number < 2**31:
        raise Error(4, f"{what} must be a whole number of 32 bits, not {number}")
    return number


def _count(value: Any, what: str) -> int:
    number = _whole(value, what)
    if number < 1:
        raise Error(4, f"{what} must be at least 1, not {number}")
    return number


def _play_speed(value: Any) -> float:
    speed = _number(value, "the speed")
    if not -4 <= speed <= 64 or speed == 0:
        raise Error(4, f"a recording is played at -4 to 64 times its speed (negative: backwards), not {speed:g}: write "
                       "sim.play(2), or sim.pause() to hold it")
    return speed


def _path(file: Any, what: str) -> str:
    try:
        return os.fspath(file)
    except TypeError:
        raise Error(3, f"{what} is a text, not {file!r}") from None


def _speeds(values: Any, names: Sequence[str], what: str, columns: str) -> bytes:
    """Two numbers per robot, row by row, from rows of two, one row for all, a flat list, or an object with the buffer
    protocol, such as a numpy array."""
    n = len(names)
    flat: "array.array[float]" = array.array("d")
    regular = True
    try:
        view = memoryview(values)
    except TypeError:
        view = None
    try:
        if view is None:
            rows = list(values)
            lengths = set(map(len, rows)) if rows and hasattr(rows[0], "__len__") else set()
            shape, regular = (len(rows), *sorted(lengths)[-1:]), len(lengths) <= 1
        else:
            rows, shape = None, tuple(view.shape or ())
            if view.format in ("d", "=d", "@d", "<d" if sys.byteorder == "little" else ">d"):
                flat.frombytes(view.tobytes())
            else:
                rows = view.tolist()
        if rows is not None:
            flat = array.array("d", list(itertools.chain.from_iterable(rows)) if len(shape) == 2 else rows)
    except (TypeError, NotImplementedError):
        raise Error(3, f"{what} is one row [{columns}] for each robot, or one for all, of numbers only") from None
    if not regular or shape not in ((n, 2), (1, 2), (2,), (2 * n,)):
        said = " x ".join(map(str, shape)) + (" numbers" if len(shape) == 1 else "" if regular else " at most")
        raise Error(3, f"{what} is {said}, the team has {n} robots; write {n} x 2, one row [{columns}] for each robot, "
                       "or one row for all")
    if not math.isfinite(sum(flat)):
        for k, number in enumerate(flat):
            if not math.isfinite(number):
                whose = f"row {k // 2} of {what} ({names[k // 2]})" if len(flat) == 2 * n else what
                raise Error(4, f"{whose} must be finite, not {flat[k // 2 * 2]}, {flat[k // 2 * 2 + 1]}")
    if len(flat) == 2 and n != 1:
        flat = flat * n
    if sys.byteorder == "big":
        flat.byteswap()
    return flat.tobytes()


def _team_commands(commands: Dict[str, Any], names: Sequence[str]) -> Tuple[str, bytes]:
    """The text and data of step_all: for each word one row per robot; short rows are padded with nan."""
    if not commands:
        raise Error(3, f"no command was given; there are: {_list_of(_TEAM_WORDS)}")
    n = len(names)
    rows: List[List[float]] = [[] for _ in range(n)]
    for word, values in commands.items():
        if not isinstance(word, str) or word.split("/")[0] not in _TEAM_WORDS:
            raise Error(4, f"there is no command {word!r}; there are: {_list_of(_TEAM_WORDS)}; of one group of joints: positions/arm")
        values = values.tolist() if hasattr(values, "tolist") else values
        try:
            given = list(values)
            if not given or not hasattr(given[0], "__len__"):
                given = [given]
            given = [[float(value) for value in row] for row in given]
        except (TypeError, ValueError):
            raise Error(3, f"{word} is one row of numbers for each robot, or one for all") from None
        width = max(map(len, given))
        if len(given) not in (1, n) or width == 0:
            raise Error(3, f"{word} has {len(given)} rows of up to {width}, the team has {n} robots; write a row for each "
                           "robot, or one for all")
        for k, row in enumerate(given):
            if any(map(math.isinf, row)):
                whose = f" ({names[k]})" if len(given) == n else ""
                raise Error(4, f"row {k} of {word}{whose} must be finite, or nan: this joint keeps its command")
        for k in range(n):
            row = given[k % len(given)]
            rows[k] += row + [math.nan] * (width - len(row))
    flat = array.array("d", itertools.chain.from_iterable(rows))
    if sys.byteorder == "big":
        flat.byteswap()
    return " ".join(commands), flat.tobytes()


# --- readings out of messages -----------------------------------------------------------------------------------------


def _pairs(data: Sequence[float]) -> List[Tuple[float, float]]:
    return list(zip(data[0::2], data[1::2]))


def _targets(params: Sequence[int], text: str, data: Sequence[float]) -> List[Target]:
    return [Target(i, c, d, b) for i, c, (d, b) in zip(params, text.split(), _pairs(data))]


def _heard(params: Sequence[int], data: Sequence[float]) -> List[Heard]:
    messages, at = [], 0
    for sender, count in zip(params[0::2], params[1::2]):
        messages.append(Heard(sender, data[at], data[at + 1], list(data[at + 2 : at + 2 + count])))
        at += 2 + count
    return messages


def _choose(targets: Sequence[Target], x: Union[str, int]) -> Target:
    fits = [t for t in targets if x in (t.id, t.colour)]
    if not fits:
        raise Error(10, f"there is no target {x!r}; there are: {_list_of(t.colour for t in targets)}")
    return min(fits, key=lambda t: t.distance)


def _contacts(params: Sequence[int], text: str, data: Sequence[float]) -> List[Contact]:
    names = text.split()
    named = len(params) == len(names) == len(data) // 7
    return [Contact(*((params[k], names[k]) if named else (-1, "")), *data[7 * k : 7 * k + 7]) for k in range(len(data) // 7)]


class _ScanGeometry(NamedTuple):
    """The reply to get_scan_geometry."""

    first: float
    increment: float
    min_range: float
    max_range: float
    rows: int
    columns: int
    low: float
    step: float

    def scan(self, ranges: Sequence[float]) -> Scan:
        rows, columns = int(self.rows), int(self.columns)
        if len(ranges) != rows * columns:
            raise Error(7, f"a scan of {rows} x {columns} has {len(ranges)} ranges")
        return Scan(Rows(array.array("d", ranges), columns, 0, (rows, columns)),
                    [self.first + k * self.increment for k in range(columns)],
                    [self.low + k * self.step for k in range(rows)], self.min_range, self.max_range)


def _image_bytes(reply: Message) -> Tuple[int, int, bytes]:
    """Width, height and bytes of a picture, four per param after the first three."""
    if len(reply.params) < 3:
        raise Error(7, "a reply of the daemon has too few values")
    width, height, count = reply.params[0:3]
    words = array.array("i", reply.params[3:])
    if sys.byteorder == "big":
        words.byteswap()
    with memoryview(words) as whole, whole.cast("B") as part:
        if not 0 <= count <= len(part):
            raise Error(7, "a reply of the daemon has too few values")
        return width, height, part[:count].tobytes()


def _pixels(code: str, raw: bytes) -> "array.array[Any]":
    """Decodes values of this type, little-endian on the wire."""
    values = array.array(code)
    values.frombytes(raw)
    if sys.byteorder == "big":
        values.byteswap()
    return values


def _image_value(reply: Message, kind: int) -> Any:
    """Decodes the reply to get_image by kind: Image, bytes of a JPEG, Depth or Segmentation."""
    width, height, raw = _image_bytes(reply)
    when = reply.data[-2], int(reply.data[-1])
    if kind == _RGB:
        return Image(width, height, raw, *when)
    if kind == _JPEG:
        return raw
    if kind == _DEPTH:
        return Depth(width, height, _pixels("f", raw), *when)
    labels = Segmentation(width, height, _pixels("H", raw), *when)
    pairs = (word.partition("=") for word in reply.text.split())
    labels.names = {int(number): name for number, _, name in pairs if number.isdigit()}
    return labels


# Readings of joints, muscles and thrusters: replies have a row per part, these have columns.
_COLUMNS: Dict[int, Any] = {_GET_JOINTS: JointReading, _GET_COMPLIANCE: Compliance, _GET_PROFILE: Profile, _GET_GAINS: Gains,
                            _GET_JOINT_LIMITS: JointLimits, _GET_DRIVE_TRAINS: DriveTrains, _GET_MUSCLES: MuscleReading,
                            _GET_MUSCLE_LIMITS: MuscleLimits, _GET_THRUSTS: ThrusterReading,
                            _GET_THRUSTER_LIMITS: ThrusterLimits}


def _reading_value(command: int, message: Message) -> Any:
    """Decodes the reply to the get command number `command`."""
    data = message.data[:-2]
    if command == _GET_TARGETS:
        return _targets(message.params, message.text, data)
    if command in (_GET_ROBOTS, _GET_NEIGHBOURS):
        return [OtherRobot(i, c, d, b) for i, c, (d, b) in zip(message.params, message.text.split(), _pairs(data))]
    if command == _GET_MESSAGES:
        return _heard(message.params, data)
    if command == _GET_GEOMETRY:
        return Geometry(data[0::3], data[1::3], data[2::3])
    if command == _GET_COMPASS:
        return data[0]
    if command == _GET_CONTACTS:
        return _contacts(message.params, message.text, data)
    if command == _GET_BUMPER:
        return [pressed != 0 for pressed in data]
    if command == _GET_CAMERA:
        return Camera(int(data[0]), int(data[1]), *data[2:9])
    columns = _COLUMNS.get(command)
    if columns is not None:
        width = len(columns._fields)
        return columns(*(data[k::width] for k in range(width)))
    if command == _GET_MOTION:
        return Motion([arrived != 0 for arrived in message.params], data)
    if command == _GET_MODES:
        return [JOINT_MODES[mode] if 0 <= mode < len(JOINT_MODES) else str(mode) for mode in message.params]
    kinds = {_GET_WHEELS: Wheels, _GET_LIMITS: Limits, _GET_TARGET: Bearing, _GET_POSE: Pose, _GET_POSE_3D: Pose3d,
             _GET_SUPPORT: Support, _GET_IMU: Imu, _GET_WRENCH: Wrench, _GET_SCAN_GEOMETRY: _ScanGeometry, _GET_BATTERY: Battery,
             _GET_ODOMETRY: Odometry}
    return kinds[command](*data) if command in kinds else data


# --- kinematics of a serial chain: needs no daemon ---------------------------------------------------------------------


_Vector = Tuple[float, float, float]
_Rotation = Tuple[_Vector, _Vector, _Vector]  # rows


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Sequence[float], b: Sequence[float]) -> _Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _turned(R: _Rotation, v: Sequence[float]) -> _Vector:
    return _dot(R[0], v), _dot(R[1], v), _dot(R[2], v)


def _product(A: _Rotation, B: _Rotation) -> _Rotation:
    columns = list(zip(*B))
    return tuple(tuple(_dot(row, column) for column in columns) for row in A)  # type: ignore[return-value]


def _rotation(axis: Sequence[float], angle: float) -> _Rotation:
    """Rotation about a unit axis (Rodrigues)."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    d = 1 - c
    return ((c + x * x * d, x * y * d - z * s, x * z * d + y * s),
            (y * x * d + z * s, c + y * y * d, y * z * d - x * s),
            (z * x * d - y * s, z * y * d + x * s, c + z * z * d))


def _rotation_vector(R: _Rotation) -> _Vector:
    """Axis times angle."""
    v = (R[2][1] - R[1][2]) / 2, (R[0][2] - R[2][0]) / 2, (R[1][0] - R[0][1]) / 2
    cosine, sine = (R[0][0] + R[1][1] + R[2][2] - 1) / 2, math.sqrt(_dot(v, v))
    if sine > 1e-9:
        scale = math.atan2(sine, cosine) / sine
    elif cosine > 0:
        scale = 1.0
    else:  # half a turn: a column of R + 1 is along the axis
        k = max(range(3), key=lambda i: R[i][i])
        v = tuple(R[i][k] + (1.0 if i == k else 0.0) for i in range(3))  # type: ignore[assignment]
        scale = math.pi / math.sqrt(_dot(v, v))
    return v[0] * scale, v[1] * scale, v[2] * scale


def _solved(A: List[List[float]], b: List[float]) -> List[float]:
    """x of A x = b, for a positive definite A, which is overwritten."""
    n = len(b)
    x = list(b)
    for i in range(n):
        for k in range(i + 1, n):
            factor = A[k][i] / A[i][i]
            for j in range(i, n):
                A[k][j] -= factor * A[i][j]
            x[k] -= factor * x[i]
    for i in reversed(range(n)):
        x[i] = (x[i] - sum(A[i][j] * x[j] for j in range(i + 1, n))) / A[i][i]
    return x


@_usages("chain")
class Chain:
    """A serial chain of joints from a base to a tool, as product of exponentials: X(q) = exp([S1] q1) ... exp([Sn] qn) X(0)
    (Lynch and Park, Modern Robotics, 4.1). `r.joints("arm").get_chain()` returns that of a robot's arm.

    `kinds`: 0 hinge or 1 slider, per joint; `points`: x, y, z [m] of a point on each axis and `axes` its direction, in the
    base frame with all joints at 0; `tool`: the tool's pose in this frame, a 4 x 4 matrix; `lower` and `upper`: limits
    [rad, m].
    """

    def __init__(
        self, kinds: Sequence[int], points: Sequence[Sequence[float]], axes: Sequence[Sequence[float]],
        tool: Sequence[Sequence[float]], lower: Optional[Sequence[float]] = None, upper: Optional[Sequence[float]] = None,
    ) -> None:
        n = len(kinds)
        self.lower = [-math.inf] * n if lower is None else [float(x) for x in lower]
        self.upper = [math.inf] * n if upper is None else [float(x) for x in upper]
        if not n == len(points) == len(axes) == len(self.lower) == len(self.upper):
            raise Error(3, f"a chain of {n} joints has {n} points, {n} axes and {n} limits")
        if any(kind not in (0, 1) for kind in kinds):
            raise Error(4, f"the kinds of a chain's joints are 0 (hinge) or 1 (slider), not {list(kinds)}")
        if any(len(vector) != 3 for vector in (*points, *axes)):
            raise Error(3, "points and axes of a chain are x, y, z each")
        self._sliders = [int(kind) == 1 for kind in kinds]
        self.points = [(float(p[0]), float(p[1]), float(p[2])) for p in points]
        self.axes: List[_Vector] = []
        for x, y, z in axes:
            length = math.sqrt(x * x + y * y + z * z)
            if not 0 < length < math.inf:
                raise Error(4, "an axis is a direction: its length is not 0")
            self.axes.append((x / length, y / length, z / length))
        self._tool = _pose_parts(tool)

    def __len__(self) -> int:
        return len(self.axes)

    @_usage("chain.forward([0.1, 0.2])")
    def forward(self, q: Sequence[float]) -> List[List[float]]:
        """The tool's pose in the base frame, a 4 x 4 matrix, with the joints at q [rad, m]."""
        R, p, _ = self._forward(self._posture(q, "q"))
        return [[*R[0], p[0]], [*R[1], p[1]], [*R[2], p[2]], [0.0, 0.0, 0.0, 1.0]]

    @_usage("chain.inverse(pose) or chain.inverse([0.3, 0, 0.5], q0)")
    def inverse(self, pose: Any, q0: Optional[Sequence[float]] = None) -> List[float]:
        """Returns a posture within the limits that brings the tool to a pose, a 4 x 4 matrix as of forward(), or only to a
        position x, y, z [m]: the first found, starting at q0. Error 4 if none is found.
        Damped least squares on the chain's Jacobian, restarted at random postures, the same on each call."""
        target: Tuple[Optional[_Rotation], _Vector]
        try:
            whole = hasattr(pose[0], "__len__")
        except (TypeError, IndexError, KeyError):
            raise Error(3, f"a pose is a 4 x 4 matrix or a position x, y, z [m], not {pose!r}") from None
        if whole:
            target = _pose_parts(pose)
        elif len(pose) == 3:
            target = None, (_number(pose[0], "x [m]"), _number(pose[1], "y [m]"), _number(pose[2], "z [m]"))
        else:
            raise Error(3, f"a pose is a 4 x 4 matrix or a position x, y, z [m], not {len(pose)} numbers")
        ranges = [(low if math.isfinite(low) else min(-math.pi, high - 1), high if math.isfinite(high) else max(math.pi, low + 1))
                  for low, high in zip(self.lower, self.upper)]
        start = [(low + high) / 2 for low, high in ranges] if q0 is None else self._posture(q0, "q0")
        best, nearest, dice = math.inf, (math.inf, math.inf), 1
        for _ in range(_STARTS):
            q, error, off = self._descend(target, [min(max(x, lo), hi) for x, lo, hi in zip(start, self.lower, self.upper)])
            if error < _REACHED:
                return q
            if error < best:
                best, nearest = error, off
            start = []
            for low, high in ranges:
                dice = (1664525 * dice + 1013904223) % 2**32
                start.append(low + (high - low) * dice / 2**32)
        angle = "" if target[0] is None else f" and {nearest[1]:.3g} rad"
        raise Error(4, f"no posture within the limits was found that brings the tool there: the nearest is {nearest[0]:.3g} m{angle} "
                       "off; choose a pose within reach, or give only a position x, y, z")

    # --- inside ---
    def _posture(self, q: Sequence[float], what: str) -> List[float]:
        try:
            numbers = [_number(value, f"a value of {what}") for value in q]
        except TypeError:
            numbers = [_number(q, what)]
        if len(numbers) != len(self.axes):
            raise Error(3, f"{what} has {len(numbers)} values, the chain {len(self.axes)} joints")
        return numbers

    def _forward(self, q: Sequence[float]) -> Tuple[_Rotation, _Vector, List[Tuple[_Vector, _Vector]]]:
        """Rotation and position of the tool; a point and the direction of each axis, moved by the joints before it."""
        R: _Rotation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        t: _Vector = (0.0, 0.0, 0.0)
        moved = []
        for slider, point, axis, angle in zip(self._sliders, self.points, self.axes, q):
            p, a = _turned(R, point), _turned(R, axis)
            p = p[0] + t[0], p[1] + t[1], p[2] + t[2]
            moved.append((p, a))
            if slider:
                t = t[0] + a[0] * angle, t[1] + a[1] * angle, t[2] + a[2] * angle
            else:
                R = _product(R, _rotation(axis, angle))
                turned = _turned(R, point)
                t = p[0] - turned[0], p[1] - turned[1], p[2] - turned[2]
        R_0, p_0 = self._tool
        p = _turned(R, p_0)
        return _product(R, R_0), (p[0] + t[0], p[1] + t[1], p[2] + t[2]), moved

    def _descend(
        self, target: Tuple[Optional[_Rotation], _Vector], q: List[float]
    ) -> Tuple[List[float], float, Tuple[float, float]]:
        """Moves from q to a local minimum of the error; returns the posture, its error, and the offsets [m] and [rad]."""
        R_T, p_T = target
        size = 3 if R_T is None else 6
        for _ in range(_ROUNDS):
            R, p, moved = self._forward(q)
            error = [p_T[0] - p[0], p_T[1] - p[1], p_T[2] - p[2]]
            if R_T is not None:
                error += _rotation_vector(_product(R_T, tuple(zip(*R))))  # type: ignore[arg-type]
            square = sum(e * e for e in error)
            off = math.sqrt(_dot(error, error)), math.sqrt(_dot(error[3:], error[3:])) if size == 6 else 0.0
            if square < _EXACT**2:
                break
            columns = []
            for slider, (point, axis) in zip(self._sliders, moved):
                if slider:
                    column = (*axis, 0.0, 0.0, 0.0)
                else:
                    column = (*_cross(axis, (p[0] - point[0], p[1] - point[1], p[2] - point[2])), *axis)
                columns.append(column[:size])
            free = []
            for i, column in enumerate(columns):
                slope = sum(c * e for c, e in zip(column, error))
                if not (q[i] >= self.upper[i] and slope > 0 or q[i] <= self.lower[i] and slope < 0):
                    free.append(i)
            A = [[sum(columns[i][j] * columns[i][k] for i in free) for k in range(size)] for j in range(size)]
            for j in range(size):
                A[j][j] += square / 2 + _LEAST_DAMPING
            x = _solved(A, error)
            step = {i: sum(c * s for c, s in zip(columns[i], x)) for i in free}
            longest = max(map(abs, step.values()), default=0.0)
            if longest < 1e-14:
                break
            scale = min(1.0, _LONGEST_STEP / longest)
            for i, change in step.items():
                q[i] = min(max(q[i] + scale * change, self.lower[i]), self.upper[i])
        return q, math.sqrt(square), off


_STARTS, _ROUNDS = 30, 100  # of Chain.inverse
_EXACT, _REACHED = 1e-10, 1e-7  # errors [m, rad] at which the search stops, and which it accepts
_LEAST_DAMPING = 1e-12
_LONGEST_STEP = 0.7  # [rad, m]


def _pose_parts(pose: Any) -> Tuple[_Rotation, _Vector]:
    """Rotation and position of a 4 x 4 matrix."""
    try:
        rows = [[float(value) for value in row] for row in pose]
    except (TypeError, ValueError):
        rows = []
    if [len(row) for row in rows] != [4, 4, 4, 4] or not all(math.isfinite(sum(row)) for row in rows):
        raise Error(3, "a pose is a 4 x 4 matrix of numbers: rotation and position [m], and the row 0 0 0 1 below")
    R = tuple((row[0], row[1], row[2]) for row in rows[:3])
    if any(abs(_dot(a, b) - (a is b)) > 1e-6 for a in R for b in R) or _dot(_cross(R[0], R[1]), R[2]) < 0:
        raise Error(4, "the upper left 3 x 3 of a pose is a rotation: its rows are at right angles and of length 1")
    return R, (rows[0][3], rows[1][3], rows[2][3])  # type: ignore[return-value]


# --- shared by a simulation and its robots ----------------------------------------------------------------------------


class _Command(NamedTuple):
    """An actuator command. Commands to joints, muscles and thrusters name them, with one value for each."""

    command: int
    params: Tuple[int, ...] = ()
    data: Tuple[float, ...] = ()

    def after(self, kept: Optional["_Command"], whose: str) -> "_Command":
        """Merges this command with `kept`, an earlier one for the same step. Where both name a joint, this one wins."""
        if kept is None or set(kept.params) <= set(self.params):
            return self
        if kept.command != self.command:
            raise Error(5, f"{_OF_JOINTS[kept.command]} and {_OF_JOINTS[self.command]} of different joints cannot go with one "
                           f"step of {whose}: write sim.step() between them")
        values = dict(zip(kept.params, kept.data or kept.params))
        values.update(zip(self.params, self.data or self.params))
        return _Command(self.command, tuple(values), tuple(values.values()) if self.data else ())


class _Link:
    """The connections to an actuator module of a robot, and the command kept for the next step. A robot's first link, its
    motors if it has any, also owns the robot's other connections."""

    def __init__(self, session: "_Session", robot: str, actuator: str = "motors", kind: str = "motors") -> None:
        self.robot = robot
        self.actuator = actuator  # "motors", or the name of a module of the type
        self.kind = kind  # motors, channel or one of _PARTS
        self.last = b""  # request to send when the sim closes, instead of that of _LAST
        self.others: List["_Link"] = []  # the robot's further actuators
        self.label = robot  # in errors
        self.in_team = False  # a team of this sim drives it; it can only be read
        self.motors: Optional[_Connection] = _Connection(session.address, f"/{robot}/{actuator}", drives=not session.watch)
        self.readers: Dict[str, _Connection] = {}
        self.pushers: Dict[str, _Connection] = {}
        self.modules: Dict[str, str] = {}  # names by type; queried when first needed
        self.kept: Optional[_Command] = None  # for the next step
        self.sent: Optional[_Command] = None  # reply pending
        self.sent_at = 0  # newest step when `sent` was sent
        self.commanded_at = -1  # newest step when the last command was answered immediately: it runs in a later step
        self.unstepped = 0  # commands since the last step
        self.unstepped_since = 0  # the step of the first of them
        self.lost: Optional[Error] = None  # why this client no longer drives it
        self.commanded = False  # by this program, ever
        self.unclaimed = False  # read-only: the last claim failed, in a playback or because
        self.another = False  # another program had it; then claimed again only by a command
        self.beside = False  # no participant in lockstep: steps do not wait for its reply
        self.attached: Dict[str, str] = {}  # modules by type (joints: by name), in the order of their readings
        self.carried: Optional[Message] = None  # readings in the reply to the last step
        self.labels: Tuple[int, float, List[int], List[str]] = (-1, 0.0, [], [])  # step, time, ids, colours
        self.scans: Dict[str, _ScanGeometry] = {}  # of lidars, by module; queried when first needed

    @property
    def has_parts(self) -> bool:
        """True for joints, muscles and thrusters: a command lasts one step and names the parts."""
        return self.kind != "motors"

    def connections(self) -> List[_Connection]:
        return ([self.motors] if self.motors else []) + list(self.readers.values()) + list(self.pushers.values())

    def forget_commands(self) -> None:
        self.kept = self.sent = self.carried = None
        self.commanded_at = -1
        self.scans.clear()

    def path(self, module: str) -> str:
        """The path of the module of this type or name."""
        return f"/{self.robot}/{self.modules.get(module, module)}"

    def is_among(self, awaited: "set[str]") -> bool:
        """True if the world waits for this actuator. For a robot with several actuators the status names ROBOT/MODULE; its
        channel drives them all."""
        return any(robot == self.robot and (not module or module == self.actuator or self.kind == "channel")
                   for robot, _, module in (name.partition("/") for name in awaited))

    def robots(self) -> int:
        return 1

    def reopen(self, session: "_Session") -> None:
        session.open_motors(self)

    def take_again(self) -> str:
        return f'sim.robot("{self.robot}")'


class _TeamLink:
    """A connection to /swarm that owns all robots of a team."""

    def __init__(self, address: _Address, text: str, number: int) -> None:
        self.text = text  # the names as given by the program
        self.connection = _Connection(address, "/swarm", drives=True, bulk=True, number=number)
        self.selected: Tuple[str, int] = ("pose distances", _NEIGHBOURS)
        self.names: List[str] = []
        self.ids: List[int] = []
        self.readings: List[str] = []  # in the order of a row
        self.columns: List[int] = []
        self.stale = False  # the members must be queried again
        self.reply: Optional[Message] = None
        self.gone: List[str] = []  # robots lost since the team's last step
        self.lost: Optional[Error] = None
        self.playing = ""  # error text if a recording is played, and the team only reads; else empty

    @property
    def label(self) -> str:
        """The name in errors."""
        return f"team {self.text}" if len(self.text.split()) == 1 else f"team of {len(self.names)} robots"

    def open(self, session: "_Session") -> None:
        """(Re)opens the connection: `hello` takes over from an older connection of this client, `claim` claims the robots."""
        timeout = session.address.timeout
        self.connection.open(timeout)
        try:
            if not self.names:
                self.connection.request(_RELEASE)  # drop the robots of an older team
            self.take(session)
            if not self.names:
                raise Error(10, "no robot is free: other programs, loaded controllers or other objects of this "
                                "program drive them all. What a scenario's controller drives is free without it: "
                                "launch(..., set={\"SWARM_1.controller\": \"\"})")
            self.ask_for(*self.selected)
            session.note(self.connection.request(_GET_TIME, timeout=timeout))
        except BaseException:
            self.connection.close()
            raise

    def take(self, session: "_Session") -> None:
        """Claims the robots; while a recording is played, only looks them up."""
        try:
            reply = self.claim(session)
        except Error as e:
            if e.code == 6 and self.playing:  # a branch has ended the playback
                raise Error(6, f"{self.label} {_owned_text(e.text)}") from None
            if e.code != 5 or not e.text.startswith(_PLAYING):
                raise
            playing = e.text
        else:
            playing = "" if reply.params or not session.plays() else f"{_PLAYING}: sim.branch() goes on live from here"
            if not playing:
                self.playing = ""
                self.named(reply)
                return
        self.find(session)
        self.playing = playing

    def find(self, session: "_Session") -> None:
        """Looks up the members in a played recording: `claim` has checked their names, but returns no ids."""
        there = session.robot_names()
        ids = dict(zip(there, self.known_ids(len(there))))
        words = set(self.text.split())
        swarm_of = {name: name.rsplit("_", 1)[0] if "_" in name and name.rsplit("_", 1)[1].isdigit() else "" for name in there}
        swarms = set(swarm_of.values()) - {""}
        if len(swarms) == 1 and words - set(there) - swarms:
            words |= swarms  # `swarm1`, the section, stands for the only swarm
        chosen = {name for name in there if not words or name in words or swarm_of[name] in words}
        if words and not chosen:
            raise Error(10, f"none of {_list_of(self.text.split())} is there at this moment of the recording under that name, write the NAME "
                            f"of a swarm or robots; there are: {_list_of(there)}")
        self.names = [name for name in ids if name in chosen]
        self.ids, self.stale = [ids[name] for name in self.names], False
        for link in session.links:  # after a branch the team drives these
            if link.unclaimed and link.motors is not None and link.robot in chosen:
                link.in_team = True
                link.motors.close()
                link.motors = None

    def known_ids(self, n: int) -> List[int]:
        """The ids of the n robots in ascending order, with gaps where robots have been removed."""
        if not n:
            return []
        ids: List[int] = list(range(1, n + 1))
        try:
            self.connection.request(_READ_ALL, ids)
            return ids
        except Error as e:
            if e.code != 10:
                raise
        ids = []
        for k in itertools.count(1):
            try:
                self.connection.request(_READ_ALL, (k,))
                ids.append(k)
            except Error as e:
                if e.code != 10 or k > n + _MOST_GAPS:
                    raise
            if len(ids) == n:
                break
        return ids

    def claim(self, session: "_Session") -> Message:
        """Claims the team's previous robots, not those that its name refers to now, and none that another team has."""
        others = {name for team in session.teams if team is not self and team.lost is None for name in team.names}
        wanted = [name for name in self.names if name not in others]
        while wanted:
            try:
                return self.connection.request(_CLAIM, text=" ".join(wanted))
            except Error as e:
                taken = e.text.split(" ", 1)[0]
                if e.code == 6 and taken in wanted:
                    wanted.remove(taken)
                elif e.code == 10:  # another world
                    break
                else:
                    raise
        if self.names and not wanted:
            return self.connection.request(_GET_TEAM)  # no robot is left
        return self.connection.request(_CLAIM, text=self.text)

    def named(self, reply: Message) -> None:
        """Stores the team's members. A team that has lost all its robots is lost, too."""
        before = self.names
        self.ids, self.names, self.stale = reply.params, reply.text.split(), False
        if len(self.names) < len(before):
            left = set(self.names)
            self.gone += [name for name in before if name not in left]
        if before and not self.names:
            what = f"team {self.text}" if len(self.text.split()) == 1 else f"the team of {len(before)} robots"
            again = "" if self.text and len(self.text.split()) != 1 else f": {self.take_again()} takes those that it names now"
            self.lost = Error(5, f"{what} has lost all its robots, to other programs or another scenario{again}")
            self.connection.close()
            raise self.lost

    def ask_for(self, words: str, neighbours: int) -> None:
        params = (neighbours,) if "neighbours" in words.split() else ()
        reply = self.connection.request(_SELECT_READINGS, params, (), words)
        self.selected = (words, neighbours)
        self.readings, self.columns = reply.text.split(), reply.params

    def fit(self, width: int) -> None:
        """Sets the number of distances from the width of a row: for robots that the team does not own, `select_readings`
        does not return it."""
        if "distances" in self.readings:
            self.columns[self.readings.index("distances")] += width - sum(self.columns)

    def forget_commands(self) -> None:
        self.reply = None

    def is_among(self, awaited: "set[str]") -> bool:
        return not self.playing and not {name.partition("/")[0] for name in awaited}.isdisjoint(self.names)

    def robots(self) -> int:
        return len(self.names)

    def reopen(self, session: "_Session") -> None:
        self.open(session)

    def take_again(self) -> str:
        if not self.text:
            return "sim.team()"
        return f'sim.team("{self.text}")' if len(self.text.split()) == 1 else "sim.team([...])"


_Driven = Union[_Link, _TeamLink]


class _Session:
    """The connections of one `connect`, shared by the simulation and its robots. Has no references to them."""

    def __init__(self, address: _Address, watch: bool) -> None:
        self.address = address
        self.watch = watch
        self.links: List[_Link] = []
        self.teams: List[_TeamLink] = []
        self.others: Dict[str, _Connection] = {}  # to modules of the whole simulation, and of call()
        self.commands: Dict[str, Dict[str, int]] = {}  # numbers of commands by module and name
        # Types of each robot's actuator modules by name; empty: not queried yet.
        self.actuators: Dict[str, Dict[str, str]] = {}
        self.mode = 0
        self.time = 0.0
        self.steps = 0
        self.reached = 0  # the newest step of this world reported by a reading, command or step; 0 again after a reset
        self.scenario: Any = None  # name of the present world's scenario
        self.told_to_step = False
        self.closed = False
        self.polls = _Polling()
        self.in_use = threading.RLock()  # held by the thread whose public call is running; others are refused
        self.on_closed: Optional[Callable[[], Any]] = None  # ends the daemon that launch() started

    def polling(self) -> _Polling:
        """The polling before a wait."""
        self.polls.spin_s = _spin_s(self.mode == _LOCKSTEP, len(self.links) + len(self.teams))
        return self.polls

    def note(self, reply: Message) -> Message:
        """Stores the reply's time and step, and its mode if it carries one."""
        if len(reply.data) >= 2:
            self.time, self.steps = reply.data[-2], int(reply.data[-1])
        if reply.params and reply.command in _CARRY_MODE:
            self.mode = reply.params[0]
        return reply

    def fresh(self, reply: Message, since: int) -> Message:
        """Like note(), for a request sent when the world had reached step `since`; see go_on()."""
        self.note(reply)
        self.go_on(self.steps, since)
        return reply

    def go_on(self, step: int, since: int) -> None:
        """Checks the reply's step against `since`, the step that the world had reached when the request was sent: raises
        WorldReset if `step` is earlier, except in a playback, where time may go back."""
        if step >= since:
            self.reached = max(self.reached, step)
        elif self.watch or self.plays():
            self.reached = step
        else:
            raise self.world_reset()

    def world_reset(self, word: str = "") -> "WorldReset":
        """Another client has reset the world or (`word` "load", or the scenario differs) loaded a scenario: discards the
        state of the old world and returns the error to raise."""
        before, self.scenario = self.scenario, self.status().get("scenario")
        if word != "load" and self.scenario == before:
            self.started_anew()
            return WorldReset(5, "the world was reset: run your program again, or catch this to start over")
        gone = self.loaded()
        which = f"scenario {self.scenario} was loaded" if self.scenario else "a scenario was loaded"
        if gone:
            there = _list_of(self.robot_names())
            return WorldReset(5, f"{which}, which has no {_list_of(gone)}; there are: {there}. Run your program again with these")
        return WorldReset(5, f"{which}: run your program again, or catch this to start over")

    def is_new(self, status: Dict[str, Any]) -> bool:
        """True if `status` belongs to a world that another client has reset or loaded."""
        same = status.get("scenario") == self.scenario and status["step"] >= self.reached
        return not same and status.get("playback") is None

    def behind(self, e: Error) -> Error:
        """The error of a team to raise: WorldReset if a scenario was loaded, else `e`."""
        return e if isinstance(e, WorldReset) or not self.is_new(self.status()) else self.world_reset("load")

    def status(self) -> Dict[str, Any]:
        """The status of the simulation, with one robot."""
        return json.loads(self.control(_GET_STATUS, (1, 1)).text)

    def require_open(self) -> None:
        if self.closed:
            raise Error(-1, "this sim is closed; connect() again")

    # --- requests that are answered immediately ---
    def connection(self, module: str) -> _Connection:
        """The open connection to a module, other than those of the driven robots."""
        self.require_open()
        if module not in self.others:
            self.others[module] = _Connection(self.address, module, drives=module == _SIMULATION or not self.watch)
        if not self.others[module].alive():
            self.others[module].open(self.address.timeout)
        return self.others[module]

    def tell(
        self, module: str, command: int, params: Sequence[int] = (), data: Sequence[float] = (), text: str = "",
        timeout: float = _REQUEST_TIMEOUT_S,
    ) -> Message:
        """Sends a request to a module of the whole simulation."""
        reply = self.connection(module).request(command, params, data, text, timeout)
        self.forget_carried()
        return self.note(reply)

    def control(self, command: int, *values: Any, **named: Any) -> Message:
        """Sends a request to /simulation."""
        return self.tell(_SIMULATION, command, *values, **named)

    def forget_carried(self) -> None:
        for link in self.links:
            link.carried = None

    def read(
        self, link: _Link, module: str, command: int, params: Sequence[int] = (), text: str = "",
        data: Sequence[float] = (),
    ) -> Message:
        """Returns a reading of the newest frame. Reopens a connection that broke since its last use."""
        self.require_open()
        if link.lost is not None and link.lost.code == 10:
            raise link.lost
        if module == link.actuator and link.motors is not None and link.lost is None:
            self.settle(link)
            since = self.reached
            try:
                return self.fresh(link.motors.request(command, params, data, text, polling=self.polling()), since)
            except _Closed as e:
                raise self.lose(link, e) from None
        sends = module == "neighbours" and not self.watch  # only a robot's driver may send its messages
        connection = link.readers.setdefault(module, _Connection(self.address, link.path(module), drives=sends))
        try:
            reply = self.ask(connection, command, params, data, text)
            if int(reply.data[-1]) >= self.reached:
                return self.fresh(reply, self.reached)
            # Sensors with a rate or a delay return an earlier step: query the present one.
            self.fresh(self.ask(connection, _GET_TIME, (), (), ""), self.reached)
            return reply
        except Error as e:
            if e.code != 10 or connection.sock is not None:
                raise
            if link.robot not in self.robot_names():
                raise self.world_reset("load") from None
            if self.find_again(link, module, connection):
                return self.read(link, module, command, params, text, data)
            if module not in _HAVE:
                raise
            there = f"a robot of type {_HAVE[module]} has one, or " if _HAVE[module] else ""
            raise Error(5, f"{link.robot} has no module {module}, its type has none: {there}add it to the robot's model.sdf "
                           "(docs/formats.md)") from None

    def ask(
        self, connection: _Connection, command: int, params: Sequence[int], data: Sequence[float], text: str
    ) -> Message:
        if connection.sock is not None and not connection.busy:
            try:
                return self.note(connection.request(command, params, data, text, polling=self.polling()))
            except _Closed:
                pass
        connection.open(self.address.timeout)
        return self.note(connection.request(command, params, data, text, polling=self.polling()))

    # --- driving ---
    def drive(self, robot: str) -> _Link:
        """The link to `robot`, opened and (unless watching) claimed."""
        self.require_open()
        in_team = self.has_team_with(robot)
        for link in self.links:
            if link.robot == robot and link.lost is None and link.in_team == in_team:
                return link
        link = _Link(self, robot)
        try:
            self.take(link, in_team)
        except BaseException:
            for opened in (link, *link.others):
                for connection in opened.connections():
                    connection.close()
            raise
        self.links = [other for other in self.links if other.robot != robot] + [link, *link.others]
        return link

    def take(self, link: _Link, in_team: bool) -> None:
        """Opens the connections to all actuators of a robot."""
        robot = link.robot
        try:
            if not in_team:
                self.open_motors(link)
        except Error as e:
            if e.code != 10:
                raise
            robots = self.robot_names()
            if robot not in robots:
                raise Error(10, f"there is no robot {robot!r}; {_nearest(robot, robots)}there are: {_list_of(robots)}") from None
            assert link.motors is not None
            if self.find_again(link, "motors", link.motors):
                self.open_motors(link)
            else:
                link.motors = None  # it has no motors
        parts = [(name, kind) for name, kind in self.actuators_of(robot).items() if kind in _PARTS]
        if parts and link.motors is None and not in_team:
            link.actuator, link.kind = parts[0]
            link.motors = _Connection(self.address, link.path(link.actuator), drives=not self.watch)
            self.open_motors(link)
        link.others = [_Link(self, robot, name, kind) for name, kind in parts if name != link.actuator]
        for one in (link, *link.others):
            one.in_team = in_team
            if in_team:
                one.motors = None
            elif one is not link:
                self.open_motors(one)

    def drive_channel(self, first: _Link, name: str) -> _Link:
        """Returns the link to the robot's channel, and gives up the robot's other actuators, which the channel now drives."""
        channel = _Link(self, first.robot, name, "channel")
        channel.in_team = first.in_team
        if first.in_team:
            channel.motors = None
        else:
            for link in (first, *first.others):
                if link.motors is None:
                    continue
                self.settle(link)
                if not (self.watch or link.unclaimed):
                    link.motors.request(_RELEASE)
                link.motors.close()
                link.motors = None
                link.forget_commands()
            self.open_motors(channel)
        first.others.append(channel)
        self.links.append(channel)
        return channel

    def actuators_of(self, robot: str) -> Dict[str, str]:
        """The types of a robot's actuator modules by name, in the robot's order."""
        if robot not in self.actuators:
            self.actuators = {status["name"]: {module["name"].split("/")[-1]: module["type"]
                                               for module in status.get("modules", [])
                                               if module["type"] in ("motors", *_PARTS, "channel")} for status in self.robots()}
        return self.actuators.get(robot, {})

    def groups_of(self, robot: str) -> List[str]:
        """The names of a robot's groups of joints, in the robot's order."""
        return [name for name, kind in self.actuators_of(robot).items() if kind == "joints"]

    def open_motors(self, link: _Link) -> None:
        """(Re)opens the connection for commands: `hello` takes the module back, `claim` claims it."""
        assert link.motors is not None
        link.sent = link.carried = None
        link.motors.open(self.address.timeout)
        try:
            if not self.watch:
                try:
                    self.claim(link)
                except Error as e:
                    if e.code != 5 and not link.another:  # 5: a recording is played; reading still works
                        raise
            if link.attached:
                link.motors.request(_ATTACH, text=" ".join(link.attached.values()))
            if self.watch or link.unclaimed:
                self.note(link.motors.request(_GET_TIME))
        except BaseException:
            link.motors.close()
            raise

    def claim(self, link: _Link) -> None:
        assert link.motors is not None
        link.unclaimed = True
        try:
            link.motors.request(_CLAIM)
        except Error as e:
            if e.code != 6:
                raise
            if self.has_team_with(link.robot):
                raise Error(5, f"{link.robot} is driven by its team") from None
            raise Error(6, f"{link.robot} {_owned_text(e.text)}") from None
        link.unclaimed = link.another = False
        self.note(link.motors.request(_GET_TIME))  # a branch may have changed the mode

    def takes_part(self, link: _Link) -> bool:
        """True if the robot steps with this sim. Claims an unclaimed robot if it is free."""
        if link.motors is None:
            return False
        self.settle(link)
        if link.unclaimed and not link.another:
            try:
                self.claim(link)
            except Error as e:
                if e.code not in (5, 6):
                    raise
                link.another = not e.text.startswith(_PLAYING)
        return not link.unclaimed

    def let_go(self, robot: str) -> bool:
        """Releases a robot for a team if this program never commanded it. True if released."""
        links = [link for link in self.links if link.robot == robot and link.motors is not None]
        if not links or any(link.commanded or link.unclaimed or link.lost for link in links):
            return False
        for link in links:
            self.settle(link)
            assert link.motors is not None
            link.motors.request(_RELEASE)
            link.forget_commands()
            link.unclaimed = link.another = True
        return True

    def settle(self, link: _Link) -> None:
        """Makes the connection for commands ready for a request: reopens it if it broke, and receives an overdue reply."""
        assert link.motors is not None
        if link.lost is not None:
            raise link.lost
        connection = link.motors
        if connection.sock is None or (connection.busy and link.sent is None):  # interrupted, or not reopened
            self.open_motors(link)
        if link.sent is None:
            return
        if self.await_command(link):
            return
        # No reply: in lockstep it arrives only after the step. Withdraw the command, and keep it.
        try:
            waits_for_step = self.control(_GET_TIME).params[0] == _LOCKSTEP
        except Error as e:
            if e.code != -1:
                raise
            raise self.lose(link, _Closed("", self.address)) from None  # the daemon has ended meanwhile
        if waits_for_step:
            link.kept = link.kept or link.sent
            self.open_motors(link)
        else:
            try:
                self.note(_checked(connection.receive(_REQUEST_TIMEOUT_S)))
            except _Closed as e:
                raise self.lose(link, e) from None
            link.sent = None

    def await_command(self, link: _Link, wait_s: float = _COMMAND_WAIT_S) -> bool:
        """Waits briefly for the reply to a command; True if it arrived."""
        assert link.motors is not None and link.motors.sock is not None
        deadline = _clock.monotonic() + wait_s
        while True:
            try:
                reply = link.motors.try_read()
            except _Closed as e:
                raise self.lose(link, e) from None
            if reply is not None:
                link.sent = None
                self.fresh(_checked(reply), link.sent_at)
                return True
            left = deadline - _clock.monotonic()
            if left <= 0:
                return False
            _wait_readable((link.motors.sock,), left)

    def lose(self, link: _Driven, closed: _Closed) -> Error:
        """The daemon closed the connection for commands: returns the error to raise. With a notice (taken over, freed,
        removed) the connection is not reopened: that would take the robot back from its new driver."""
        link.forget_commands()
        if not closed.notice:
            return Error(-1, f"the connection to {link.label} broke; {self.address.why_lost()}")
        if closed.notice.endswith(_NOT_IN_SCENARIO):
            return self.world_reset("load")
        if closed.notice.startswith(_ENDED):
            link.lost = Error(5, closed.notice)
            return link.lost
        link.lost = Error(6, f"{link.label} is no longer driven by this sim: {closed.notice}; "
                             f"{link.take_again()} takes it again")
        if isinstance(link, _Link):
            for other in self.links:
                if other.robot == link.robot and other is not link and not other.in_team:
                    other.lost = link.lost
                    other.forget_commands()
                    if other.motors is not None:
                        other.motors.close()
        return link.lost

    def command(self, link: _Link, command: int, data: Tuple[float, ...] = (), joints: Tuple[int, ...] = ()) -> None:
        """In lockstep keeps an actuator command, otherwise sends it."""
        self.require_open()
        if self.watch:
            raise Error(5, "this sim only watches; connect() without watch=True to drive")
        if link.motors is None or link.has_parts != bool(joints):
            through_channel = any(other.robot == link.robot and other.kind == "channel" for other in self.links)
            raise Error(5, f"{link.robot} " + ("is driven by its team" if link.in_team else "is driven through its channel"
                                               if through_channel else "has no motors"))
        if link.lost is not None:
            raise link.lost
        if self.mode != _LOCKSTEP or link.unclaimed:
            self.settle(link)
        if link.unclaimed:
            self.claim(link)  # a branch may have ended the playback
        link.commanded = True
        if self.mode == _LOCKSTEP:
            if link.kept is not None:
                self.count_unstepped(link)
            link.kept = _Command(command, joints, data).after(link.kept, f"{link.robot}/{link.actuator}")
            return
        link.kept = None
        self.count_unstepped(link)
        link.sent_at = self.reached
        try:
            link.motors.send(encode(command, joints, data))
        except _Closed as e:
            raise self.lose(link, e) from None
        link.sent = _Command(command, joints, data)
        self.await_command(link)
        link.commanded_at = self.steps

    def count_unstepped(self, link: _Link) -> None:
        """Reports once that the program never calls `sim.step()`, unless time passes in another way, e.g. by sleeping."""
        link.unstepped += 1
        if link.unstepped == 1:
            link.unstepped_since = self.steps
        if link.unstepped < _UNSTEPPED or self.told_to_step:
            return
        link.unstepped = 0
        if self.mode == _LOCKSTEP:
            why = "nothing moves"
        elif 2 * (self.steps - link.unstepped_since) < _UNSTEPPED:
            why = "your loop runs faster than time"
        else:
            return
        self.told_to_step = True
        print(f"coopdyn: {_UNSTEPPED} commands to {link.robot} without a step, {why}: write sim.step() at the end of your "
              "loop", file=sys.stderr, flush=True)

    def robot_names(self) -> List[str]:
        """The names of all robots, in the order of the scenario."""
        return [robot["name"] for robot in self.robots()]

    def robots(self) -> List[Dict[str, Any]]:
        """The status of all robots."""
        robots: List[Dict[str, Any]] = []
        while True:  # one status lists only some of them
            status = json.loads(self.control(_GET_STATUS, (len(robots) + 1, _LISTED)).text)
            robots += status["robots"]
            if not status["robots"] or len(robots) >= int(status.get("robot_count") or 0):
                return robots

    def modules_of(self, robot: str) -> Dict[str, str]:
        """The names of a robot's modules by type: among several of a type, the one named like it, else the first."""
        names: Dict[str, str] = {}
        for status in self.robots():
            if status["name"] == robot:
                for module in status.get("modules", []):
                    name = module["name"].split("/")[-1]
                    if name == module["type"] or module["type"] not in names:
                        names[module["type"]] = name
        return names

    def find_again(self, link: _Link, module: str, connection: _Connection) -> bool:
        """After error 10: looks up the module's name by its type, as a model may call its motors `legs`. True if the
        connection's module has changed."""
        link.modules = self.modules_of(link.robot)
        before, connection.module = connection.module, link.path(module)
        return connection.module != before

    def plays(self) -> bool:
        """True if a recording is played."""
        return self.status().get("playback") is not None

    # --- teams ---
    def has_team_with(self, robot: str) -> bool:
        return any(robot in team.names for team in self.teams if team.lost is None)

    def team(self, text: str) -> _TeamLink:
        """The team of these names, opened and claimed."""
        self.require_open()
        if self.watch:
            raise Error(5, "this sim only watches; connect() without watch=True to drive a team")
        self.teams = [team for team in self.teams if team.lost is None]
        for team in self.teams:
            if team.text == text:
                try:
                    self.settle_team(team)  # updates its members
                    return team
                except Error:
                    if team.lost is None:
                        raise
                    self.teams.remove(team)
                    break
        for team in list(self.teams):  # robots that one of our teams lost only for a moment are not free
            if team.names and (team.connection.sock is None or team.connection.busy):
                try:
                    self.settle_team(team)
                except Error:
                    pass  # its next use reports the error
        taken = {team.connection.number for team in self.teams}
        team = _TeamLink(self.address, text, next(k for k in itertools.count(1) if k not in taken))
        try:
            team.open(self)
        except Error as e:
            if e.code == 6:
                robot = e.text.split(" ", 1)[0]
                if self.let_go(robot):
                    return self.team(text)
                for other in self.teams:
                    if other.lost is None and robot in other.names:
                        raise Error(6, f"robot {robot} belongs to your {other.label}: drive it there, or release that "
                                       "team first") from None
                label = team.label if len(text.split()) == 1 else f"the team with {robot}"
                raise Error(6, f"{label} {_owned_text(e.text)}") from None
            raise
        self.teams.append(team)
        return team

    def settle_team(self, team: _TeamLink) -> _Connection:
        """Makes the connection of a team ready for a request."""
        self.require_open()
        if team.lost is not None:
            raise team.lost
        if team.connection.sock is None or team.connection.busy:  # interrupted, or not reopened
            team.open(self)
        elif team.stale and team.playing:
            team.take(self)
        elif team.stale:
            self.name_team(team, team.connection.request(_GET_TEAM))
        return team.connection

    def name_team(self, team: _TeamLink, reply: Message) -> None:
        try:
            team.named(reply)
        except Error as e:
            raise self.behind(e) from None

    def own_team(self, team: _TeamLink) -> None:
        """Claims the robots if a branch has ended the playback. Error 5 while a recording is played."""
        self.settle_team(team)
        if team.playing:
            team.take(self)
        if team.playing:
            raise Error(5, team.playing)

    def read_team(self, team: _TeamLink) -> Message:
        """The readings of the newest step."""
        self.settle_team(team)
        if not team.playing:
            return self.ask_team(team, _READ_ALL)
        try:
            reply = self.ask_team(team, _READ_ALL, team.ids)
        except Error as e:
            if e.code != 10:
                raise
            team.find(self)  # the recording has other robots at this moment
            reply = self.ask_team(team, _READ_ALL, team.ids)
        team.ask_for(*team.selected)
        team.fit(reply.params[-1])
        return reply

    def ask_team(self, team: _TeamLink, command: int, params: Sequence[int] = ()) -> Message:
        """Sends a request that is answered immediately."""
        connection, since = self.settle_team(team), self.reached
        try:
            return self.fresh(connection.request(command, params, polling=self.polling()), since)
        except _Closed as e:
            raise self.lose(team, e) from None
        except Error as e:
            raise self.behind(e) from None

    def step_team(self, team: _TeamLink, frame: bytes, timeout: Optional[float]) -> Message:
        """Runs one step of the world with the team's command in `frame`."""
        self.step(1, timeout, team, frame)
        reply, team.reply = team.reply, None
        team.gone = []
        assert reply is not None
        return reply

    # --- a step of the world ---
    def step(self, n: int, timeout: Optional[float], team: Optional[_TeamLink] = None, frame: bytes = b"") -> None:
        """Runs n steps: sends the kept command (or `ready`) for every robot and team of this sim, then collects the replies."""
        self.require_open()
        if n > 1 and any(link.has_parts and link.kept is not None for link in self.links):
            wait = _Wait(self, timeout, "the step did not run")
            self.step(1, timeout)  # such a command lasts one step
            wait.check()
            n, timeout = n - 1, None if timeout is None else wait.deadline - wait.now
        waiting: Dict[_Connection, Optional[_Driven]] = {}
        teams = []
        for link in self.links:
            link.unstepped = 0
        for other in self.teams:
            try:
                self.settle_team(other)
                teams.append(other)
            except Error:
                if other is team or other.lost is None and other.names:
                    raise  # other teams continue without a lost one, or one whose robots another client got after a load
        self.teams = [other for other in self.teams if other.lost is None]
        driven = self.who_steps(bool(teams))
        if not (driven or teams):
            connection = self.connection(_SIMULATION)
            waiting[connection] = None
            connection.send(encode(_READY, (n,)))
        else:
            try:
                for link in driven:
                    self.send_step(link, n, waiting)
                for other in teams:
                    waiting[other.connection] = other
                    other.connection.send(frame if other is team else encode(_READY, (n,)))
            except BaseException as e:
                raise self.give_up(waiting, e) from None
        since = self.reached + 1
        try:
            earliest = self.collect(waiting, timeout)
        except BaseException as e:
            raise self.give_up(waiting, e) from None
        self.go_on(earliest, since)

    def who_steps(self, with_teams: bool) -> List[_Link]:
        """The robots whose replies a step awaits. Sends the commands of robots `beside` that await no reply."""
        if self.watch:
            return []
        driven = [link for link in self.links if not link.beside and self.takes_part(link)]
        for link in self.links:
            if not link.beside:
                continue
            if not (driven or with_teams):  # without others, this robot makes the step
                link.beside = False
            elif not self.is_free(link):
                continue
            if self.takes_part(link):
                if not link.beside:
                    driven.append(link)
                elif link.kept:
                    try:
                        self.send_step(link, 1, {})
                    except _Closed as e:
                        raise self.lose(link, e) from None
        return driven

    def is_free(self, link: _Link) -> bool:
        """True if no reply to a command is pending."""
        return link.sent is None or self.await_command(link, 0)

    def send_step(self, link: _Link, n: int, waiting: Dict[_Connection, Optional[_Driven]]) -> None:
        """Sends the kept command, or `ready`."""
        assert link.motors is not None
        link.sent, link.sent_at = link.kept or _Command(_READY, (), ()), self.reached
        link.kept = link.carried = None
        waiting[link.motors] = link
        command, joints, data = link.sent
        link.motors.send(encode(command, joints or (n,), data))

    def collect(self, waiting: Dict[_Connection, Optional[_Driven]], timeout: Optional[float]) -> int:
        """Collects the replies of all connections in `waiting`, and removes these; returns the earliest step of the replies.
        Raises the first error."""
        wait = _Wait(self, timeout, "the step did not run", in_step=any(link is not None for link in waiting.values()))
        stepped: List[_Driven] = []
        earliest = sys.maxsize
        catch_up_at = math.inf
        if any(link.beside for link in self.links):  # one may be a participant by now
            catch_up_at = _clock.monotonic() + _CATCH_UP_AFTER_S

        def glance(count: int) -> bool:
            """True if the reply _AT_ONCE places ahead, among the first `count`, has arrived."""
            ahead = list(itertools.islice(waiting, min(count, _AT_ONCE)))[-1].sock
            return ahead is not None and _wait_readable((ahead,), min(_GLANCE_S, wait.deadline - wait.now))

        # Else only up to the first pending one. The last request triggered the step: its reply arrives first.
        every = len(waiting) <= _FEW or not glance(len(waiting) - 1)
        self.polling().start(_clock.monotonic())
        while True:
            before = len(waiting)
            for connection, link in list(waiting.items()):
                reply = connection.try_read()
                if reply is None:
                    if not every:
                        break
                    continue
                del waiting[connection]
                if link is not None:
                    stepped.append(link)
                    link.sent = None
                    catch_up_at = _clock.monotonic() + _CATCH_UP_AFTER_S
                if reply.error:
                    if isinstance(link, _TeamLink):
                        link.stale = True  # it may have lost a robot
                    _checked(reply, f"{link.label}: " if link else "")
                self.note(reply)
                earliest = min(earliest, self.steps)
                if isinstance(link, _TeamLink):
                    link.reply = reply
                elif link is not None and link.attached and reply.params[0] == _LOCKSTEP:
                    link.carried = reply
            polls = self.polls.goes(_clock.monotonic())
            if not waiting:
                return earliest
            progress, every = len(waiting) < before, True
            if polls:
                continue
            wait.check()
            if wait.now >= catch_up_at:
                catch_up_at = wait.now + _CATCH_UP_AFTER_S
                self.catch_up(stepped, waiting)
                if not waiting:
                    return min(earliest, self.steps)
            if progress and len(waiting) > _FEW:
                every = not glance(len(waiting))
            else:
                wait.readable(waiting, catch_up_at)

    def catch_up(self, stepped: List[_Driven], waiting: Dict[_Connection, Optional[_Driven]]) -> None:
        """Resolves a deadlock: after an error or timeout, an old command may still run while its successor is on the way. Its
        robot is then one step behind the others, and both would wait for each other forever. If the status says that the
        world waits for robots of ours that have stepped already, steps these once more with their present commands. If it
        also waits for a robot whose reply is pending, that reply will arrive: does nothing. Sets robots that are no
        participants (among the first that the status lists) `beside`, because their commands may have arrived after the
        others' step and then run in the next."""
        status = self.fresh_status()
        awaited = {a["robot"] for a in status.get("awaiting") or []}  # the first of them
        before = self.reached
        joining = [own for own in self.links if own.beside and self.is_free(own) and own.is_among(awaited)]
        has_stepped = bool(stepped) or self.reached > before
        takes_no_part = {robot["name"] for robot in status.get("robots") or [] if not robot.get("participates", True)}
        for own in self.links:
            if has_stepped and own.motors is not None and own.robot in takes_no_part:
                own.beside = True
                waiting.pop(own.motors, None)
        for own in joining:
            own.beside = False
            if not has_stepped:
                self.send_step(own, 1, waiting)
        if not waiting or any(link is not None and link.is_among(awaited) for link in waiting.values()):
            return
        if int(status.get("awaiting_count") or 0) > max(len(awaited), sum(link.robots() for link in stepped)):
            return
        for link in list(stepped):
            if not link.is_among(awaited):
                continue
            stepped.remove(link)
            if isinstance(link, _TeamLink):
                waiting[link.connection] = link
                link.connection.send(encode(_STEP_ALL))
            elif link.motors is not None:
                waiting[link.motors] = link
                link.motors.send(encode(_READY, (1,)))

    def fresh_status(self) -> Dict[str, Any]:
        """Queries the status on a separate connection, because the others may have replies pending."""
        connection = _Connection(self.address, _SIMULATION)
        try:
            connection.open(self.address.timeout)
            return json.loads(connection.request(_GET_STATUS, timeout=self.address.timeout).text)
        finally:
            connection.close()

    def give_up(self, waiting: Dict[_Connection, Optional[_Driven]], cause: BaseException) -> BaseException:
        """Closes connections whose reply is pending, and reopens them if the cause was an error: otherwise the late reply
        would be mistaken for the next one."""
        if isinstance(cause, _Closed):
            for connection, link in waiting.items():
                if connection.sock is None and link is not None:
                    cause = self.lose(link, cause)
                    break
        again = []
        for connection, link in waiting.items():
            connection.close()
            if link is not None:
                link.forget_commands()
                again.append(link)
        if isinstance(cause, Exception):
            for link in again:
                if link.lost is None:
                    try:
                        link.reopen(self)
                    except Error:
                        pass  # the next use tries again, and reports the error
            if isinstance(cause, WorldReset):
                return self.world_reset(cause.text) if cause.text in _ANEW else cause
            if isinstance(cause, Error) and any(team.stale for team in self.teams):
                cause = self.behind(cause)
            for team in self.teams:
                if team.stale and team.lost is None:
                    try:
                        self.settle_team(team)
                    except Error:
                        if team.lost is not None and isinstance(cause, Error) and cause.code == 5:
                            cause = team.lost
        return cause

    def whom(self, held_up: bool = False, in_step: bool = False) -> str:
        """One line that says what the world waits for; with `held_up`, empty if steps still run. With `in_step`, raises
        WorldReset if the world was reset or loaded meanwhile."""
        try:
            status = self.fresh_status()
        except Error as e:
            return f"no answer from the daemon ({e.text})"
        if in_step and not self.watch and self.is_new(status):
            raise WorldReset(5, "reset")  # give_up() completes the text
        playback = status.get("playback")
        if playback and playback["step"] == playback["end_step"] and not (playback["playing"] or playback["growing"]):
            return "the recording has ended; sim.run() plays it again"
        if status.get("state") == "paused":
            return "the simulation is paused; continue with sim.run() or on the page"
        if status.get("state") == "ended":
            return "the run has ended; sim.reset() starts again"
        awaiting = status.get("awaiting") or []
        if held_up and max((a["seconds"] or 0 for a in awaiting), default=0) < _HELD_UP_S:
            return ""
        if not awaiting:
            return f"waiting for the next step, {status.get('state')}"
        first = ", ".join(f"{a['robot']} ({a['why']}), {a['seconds'] or 0:.1f} s" for a in awaiting[:_NAMED_ROBOTS])
        more = int(status.get("awaiting_count") or len(awaiting)) - _NAMED_ROBOTS
        cure = next((a["cure"] for a in awaiting if a.get("cure")), None)  # how to continue without one of them
        return f"waiting for {first}" + (f" and {more} more" if more > 0 else "") + (f": {cure}" if cure else "")

    def started_anew(self) -> None:
        """After a reset or load: discards kept commands, which belong to the old world."""
        self.reached = 0
        self.actuators = {}
        self.forget_commands()

    def forget_commands(self) -> None:
        for link in self.links:
            link.forget_commands()
            link.another = False
        for team in self.teams:
            team.stale = True

    def loaded(self) -> List[str]:
        """After a load: makes teams reopen with the present robots. Returns those of this sim's robots that the new scenario
        lacks."""
        self.started_anew()
        for team in self.teams:
            team.connection.close()
            team.names = []
            team.lost = team.lost if team.lost is not None and team.lost.code != 5 else None  # 5: it had no robots left
        self.scenario = self.status().get("scenario")
        names = self.robot_names()
        gone = [link for link in self.links if link.robot not in names]
        for link in gone:
            link.lost = Error(10, f"the scenario that was loaded has no {link.robot}; there are: {_list_of(names)}")
            for connection in link.connections():
                connection.close()
        self.links = [link for link in self.links if link.lost is None]
        for link in self.links:
            link.modules = {}
        return list(dict.fromkeys(link.robot for link in gone))

    def jumped(self) -> None:
        """After this sim's restore or branch: the world continues from another state, possibly of another scenario."""
        self.started_anew()
        self.control(_GET_TIME)  # updates the mode
        here = set(self.robot_names())
        if any(link.robot not in here for link in self.links) or any(set(team.names) - here for team in self.teams):
            self.loaded()

    def close_team(self, team: _TeamLink, stop: bool) -> None:
        """Releases the robots of a team; stops them before if `stop`."""
        connection = team.connection
        if connection.sock is not None and team.lost is None:
            try:
                connection.send((encode(_STOP_TEAM) if stop else b"") + encode(_RELEASE))
                connection.sock.shutdown(socket.SHUT_WR)
                _await_ends([connection.sock])
            except (Error, OSError):
                pass
        connection.close()
        team.lost = team.lost or Error(5, f"{team.label} was given up; {team.take_again()} takes it again")
        if team in self.teams:
            self.teams.remove(team)

    def close(self) -> None:
        if self.on_closed is not None:
            self.on_closed()  # first: a robot's last `stop` would run another step
        for team in list(self.teams):
            self.close_team(team, True)
        stopping = []
        for link in self.links:
            if link.motors is not None and link.motors.sock is not None and not (self.watch or link.unclaimed or link.lost):
                try:
                    link.motors.send(link.last or encode(_LAST.get(link.kind, _READY)))
                    link.motors.try_read()  # closing with unread bytes would reset the connection and lose the stop
                    assert link.motors.sock is not None
                    link.motors.sock.shutdown(socket.SHUT_WR)
                    stopping.append(link.motors.sock)
                except (Error, OSError):
                    pass
        _await_ends(stopping)
        for link in self.links:
            for connection in link.connections():
                connection.close()
        for connection in self.others.values():
            connection.close()
        self.closed = True


class _Wait:
    """A wait with a timeout: Error 11, "`what` within 5 s", after `timeout` seconds. A long wait reports once on stderr what
    the world waits for; with `held_up`, only if no steps run. With `in_step`, raises WorldReset if the world was reset or
    loaded meanwhile."""

    def __init__(
        self, session: _Session, timeout: Optional[float], what: str, held_up: bool = False, in_step: bool = False
    ) -> None:
        self.session, self.what, self.held_up, self.in_step = session, what, held_up, in_step
        self.timeout = math.inf if timeout is None else _number(timeout, "timeout [s]")
        self.now = _clock.monotonic()
        self.deadline = self.now + self.timeout
        self.notice_at = self.now + _NOTICE_AFTER_S

    def check(self) -> None:
        self.now = _clock.monotonic()
        if self.now >= self.deadline:
            raise Error(11, f"{self.what} within {self.timeout:g} s; {self.session.whom(in_step=self.in_step)}")
        if self.now >= self.notice_at:
            whom = self.session.whom(self.held_up, self.in_step)
            self.notice_at = math.inf if whom else self.now + _NOTICE_AFTER_S
            if whom:
                print(f"coopdyn: {whom}", file=sys.stderr, flush=True)

    def readable(self, connections: Iterable[_Connection], until: float = math.inf) -> None:
        """Waits until a connection is readable, or until there is something to check."""
        sockets = [c.sock for c in connections if c.sock is not None]
        _wait_readable(sockets, min(self.deadline, self.notice_at, until, self.now + 3600) - self.now)


def _await_ends(sockets: List[socket.socket]) -> None:
    """Gives the daemon time to read the last `stop`, so that this program's next request, e.g. a reset, comes after it. In
    lockstep the step may be far off, so waits at most _CLOSE_S for all connections together."""
    deadline = _clock.monotonic() + _CLOSE_S
    for sock in sockets:
        try:
            while select.select([sock], [], [], max(0.0, deadline - _clock.monotonic()))[0] and sock.recv(65536):
                pass
        except OSError:
            pass


def _owned_text(text: str) -> str:
    return f"cannot be driven: {text}; to watch only: connect(watch=True)"


# --- public interface -------------------------------------------------------------------------------------------------


@_usages("r")
class Robot:
    """One robot. Readings always belong to the newest step."""

    def __init__(self, session: _Session, link: _Link) -> None:
        self._session = session
        self._link = link

    def __repr__(self) -> str:
        return f"<coopdyn robot {self.name}>"

    @property
    def name(self) -> str:
        return self._link.robot

    # --- commands ---
    @_usage("r.set_velocity(0.2, 0.5) or r.set_velocity([0.2, 0.5])")
    def set_velocity(self, v: Union[float, Sequence[float]], w: Optional[float] = None) -> None:
        """Forward speed v [m/s] and turn rate w [rad/s], left is positive, as two numbers or one row of two. Beyond the limits
        both are scaled."""
        self._session.command(self._link, _SET_VELOCITY, _pair(v, w, "set_velocity", ("v [m/s]", "w [rad/s]")))

    @_usage("r.set_wheel_speeds(2, 3) or r.set_wheel_speeds([2, 3])")
    def set_wheel_speeds(self, l: Union[float, Sequence[float]], r: Optional[float] = None) -> None:
        """Speeds of the left and right wheel [rad/s], as two numbers or one row of two."""
        self._session.command(self._link, _SET_WHEEL_SPEEDS, _pair(l, r, "set_wheel_speeds", ("l [rad/s]", "r [rad/s]")))

    def stop(self) -> None:
        """Stops both wheels; like the other commands, in lockstep with the next `sim.step()`."""
        self._session.command(self._link, _STOP, ())

    @_usage("r.send_message([1, 0.5])")
    def send_message(self, values: Sequence[float]) -> None:
        """Broadcasts one to eight numbers with the next step to the robots within range. The last message before the step
        wins. For robots with a module `neighbours`."""
        try:
            numbers = [_number(value, "a value of a message") for value in values]
        except TypeError:
            numbers = [_number(values, "a message")]
        if not 1 <= len(numbers) <= _MAX_MESSAGE:
            raise Error(3, f"a message has 1 to {_MAX_MESSAGE} numbers, not {len(numbers)}")
        if self._session.watch:
            raise Error(5, "this sim only watches; connect() without watch=True to drive")
        self._session.read(self._link, "neighbours", _SEND_MESSAGE, data=numbers)

    # --- readings ---
    def get_neighbours(self) -> List[OtherRobot]:
        """Id, name, distance [m] and bearing [rad] of every robot within range. For robots with a module `neighbours`."""
        return self._get("neighbours", _GET_NEIGHBOURS)

    def get_messages(self) -> List[Heard]:
        """The messages received in this step: id, distance [m] and bearing [rad] of the sender, and its values. For robots
        with a module `neighbours`."""
        return self._get("neighbours", _GET_MESSAGES)

    def get_pose(self) -> Pose:
        """x, y [m], heading [rad], forward [m/s], turn [rad/s], in the world frame."""
        return self._get("pose", _GET_POSE)

    def get_pose_3d(self) -> Pose3d:
        """Position [m], quaternion and both velocities [m/s, rad/s] in the world frame (ground truth)."""
        return self._get("pose", _GET_POSE_3D)

    def get_compass(self, module: str = "compass") -> float:
        """The robot's heading [rad]: 0 along the world's x, left positive. For robots with a module `compass`; pass the
        module's name for another compass."""
        return self._get(module, _GET_COMPASS)

    def get_support(self, module: str = "support") -> Support:
        """x, y [m] and angle [rad] by which the load has displaced its support, in the robot's frame. For robots with a module
        `support`."""
        return self._get(module, _GET_SUPPORT)

    def get_imu(self, module: str = "imu") -> Imu:
        """Quaternion, angular velocity [rad/s] and acceleration [m/s2] of an inertial sensor: at rest and level 9.81 along z.
        Here and below: for robots with a module of this type; pass the module's name for another of the same type."""
        return self._get(module, _GET_IMU)

    def get_wrench(self, module: str = "wrench") -> Wrench:
        """Force [N] and torque [N m] through a joint, in the sensor's frame."""
        return self._get(module, _GET_WRENCH)

    def get_scan(self, module: str = "lidar") -> Scan:
        """Ranges [m] of a lidar in rows, right to left, with their angles: `scan.ranges[0]`, `scan.azimuth`."""
        link, ranges = self._link, self._get(module, _GET_SCAN)
        geometry = link.scans.get(module)
        if geometry is None or len(ranges) != geometry.rows * geometry.columns:
            geometry = link.scans[module] = self._get(module, _GET_SCAN_GEOMETRY)
        return geometry.scan(ranges)

    def get_contacts(self, module: str = "contact") -> List[Contact]:
        """The contacts of the sensor: id, name, force [N], point [m] and direction, in the robot's frame."""
        return self._get(module, _GET_CONTACTS)

    def get_bumper(self, module: str = "contact") -> List[bool]:
        """Whether each zone of the bumper is pressed, right to left."""
        return self._get(module, _GET_BUMPER)

    def get_image(self, module: str = "camera") -> Image:
        """A camera's colour picture: `image.width`, `image.height`, `image.rgb(x, y)`, `image.data`, `image.numpy()`,
        `image.save("x.png")`. If the camera has a rate, its latest picture, taken at `image.step`."""
        return _image_value(self._session.read(self._link, module, _GET_IMAGE, (_RGB,)), _RGB)

    def get_jpeg(self, module: str = "camera") -> bytes:
        """The same as the bytes of a JPEG file."""
        return _image_value(self._session.read(self._link, module, _GET_IMAGE, (_JPEG,)), _JPEG)

    def get_depth(self, module: str = "camera") -> Depth:
        """The distance of each pixel along the camera's axis [m]: `depth.at(x, y)`; inf = nothing there."""
        return _image_value(self._session.read(self._link, module, _GET_IMAGE, (_DEPTH,)), _DEPTH)

    def get_segmentation(self, module: str = "camera") -> Segmentation:
        """The object that each pixel shows: `names[at(x, y)]`; 0 = nothing."""
        return _image_value(self._session.read(self._link, module, _GET_IMAGE, (_SEGMENTATION,)), _SEGMENTATION)

    def get_camera(self, module: str = "camera") -> Camera:
        """Picture size, focal lengths and principal point [pixels], near and far limit [m] and rate [Hz] of a camera."""
        return self._get(module, _GET_CAMERA)

    def get_battery(self, module: str = "battery") -> Battery:
        """Remaining energy of the battery [J, and as a fraction 0 to 1], and the power drawn [W]."""
        return self._get(module, _GET_BATTERY)

    def get_light(self, module: str = "light") -> List[float]:
        """The brightness that each light sensor measures."""
        return self._get(module, _GET_LIGHT)

    def get_sonar(self, module: str = "sonar") -> List[float]:
        """One range per sonar [m]; inf = nothing in range, 0 = nearer than the minimum."""
        return self._get(module, _GET_SONAR)

    def get_infrared(self, module: str = "infrared") -> List[float]:
        """The output of each infrared sensor, by its curve."""
        return self._get(module, _GET_INFRARED)

    def get_odometry(self, module: str = "odometry") -> Odometry:
        """x, y [m], heading [rad] since the start and speeds [m/s, rad/s], by the wheels' encoders."""
        return self._get(module, _GET_ODOMETRY)

    def get_distances(self) -> List[float]:
        """One range per sensor [m], right to left, from the surface of the robot; inf = nothing there."""
        return self._get("distance", _GET_DISTANCES)

    def get_geometry(self) -> Geometry:
        """Bearing [rad], opening [rad] and range [m] of each distance sensor, right to left."""
        return self._get("distance", _GET_GEOMETRY)

    def get_targets(self) -> List[Target]:
        """Id, colour, distance [m] and bearing [rad] of every target."""
        return self._get("target", _GET_TARGETS)

    @_usage('r.get_target("red") or r.get_target(1)')
    def get_target(self, x: Union[str, int]) -> Bearing:
        """Distance [m] and bearing [rad] of the nearest target of a colour, or of the target with an id."""
        if isinstance(x, str) and x:
            return self._get("target", _GET_TARGET, (), x)
        if isinstance(x, (str, list, tuple, dict)) or x is None:
            raise Error(3, f'a target is a colour or an id, not {x!r}; write r.get_target("red") or r.get_target(1)')
        return self._get("target", _GET_TARGET, (_count(x, "the id of a target"),))

    def get_robots(self) -> List[OtherRobot]:
        """Id, name, distance [m] and bearing [rad] of every other robot."""
        return self._get("target", _GET_ROBOTS)

    def get_wheels(self) -> Wheels:
        """Angles [rad] and speeds [rad/s] of the wheels."""
        return self._get("motors", _GET_WHEELS)

    def get_limits(self) -> Limits:
        """Maximal wheel speed [rad/s], wheel radius and track [m]."""
        return self._get("motors", _GET_LIMITS)

    @_usage('r.sense() or r.sense("red")')
    def sense(self, x: Union[str, int, None] = None) -> Reading:
        """All readings of one step in one round trip; in lockstep, directly after `sim.step()`, without one, because the step's
        reply carried them. `sense("red").target` is the nearest target of that colour (or with that id). Has the first sensor
        of each type; read others by name: `r.get_scan("rear_lidar")`."""
        session, link = self._session, self._link
        session.require_open()
        if link.lost is not None and link.lost.code == 10:
            raise link.lost
        if not link.attached:
            self._attach(link)
        reply, link.carried = link.carried, None
        if reply is None:
            reply = self._ask_attached(link)
        step, ends = int(reply.data[-1]), 0
        parts: Dict[str, List[float]] = {}
        for module, length in zip(link.attached, reply.params[1:]):
            parts[module] = reply.data[ends : ends + length]
            ends += length
        targets: List[Target] = []
        if parts.get("target"):
            ids, colours = self._labels(link, step, len(parts["target"]) // 2)
            targets = [Target(i, c, d, b) for i, c, (d, b) in zip(ids, colours, _pairs(parts["target"]))]
        target = _choose(targets, x) if x is not None else None
        pose = Pose(*parts["pose"]) if "pose" in parts else None
        wheels = Wheels(*parts["motors"]) if "motors" in parts else None
        compass = parts["compass"][0] if parts.get("compass") else None
        support = Support(*parts["support"]) if parts.get("support") else None
        joints = {name[len(_GROUP):]: JointReading(values[0::3], values[1::3], values[2::3])
                  for name, values in parts.items() if name.startswith(_GROUP)}
        scan = None
        if parts.get("lidar"):
            geometry = link.scans.get("lidar")
            if geometry is None or len(parts["lidar"]) != geometry.rows * geometry.columns:
                geometry = link.scans["lidar"] = self._get("lidar", _GET_SCAN_GEOMETRY)
            scan = geometry.scan(parts["lidar"])

        def one(kind: Any, module: str) -> Any:
            return kind(*parts[module]) if parts.get(module) else None

        return Reading(reply.data[-2], step, parts.get("distance", []), targets, target, pose, wheels, compass, support,
                       joints, one(Imu, "imu"), one(Wrench, "wrench"), scan, _contacts((), "", parts.get("contact", [])),
                       parts.get("sonar", []), parts.get("infrared", []), parts.get("light", []), one(Battery, "battery"),
                       one(Odometry, "odometry"))

    @_usage('r.joints() or r.joints("arm")')
    def joints(self, name: Optional[str] = None) -> "Joints":
        """A group of joints: a `<coopdyn:group>` of the robot's model, or "joints" if the model names none. Without a name, the
        only group. Error 5 if there are several, or none."""
        session, link = self._session, self._link
        session.require_open()
        if link.lost is not None and link.lost.code == 10:
            raise link.lost
        groups = session.groups_of(self.name)
        if not groups:
            raise Error(5, f"{self.name} has no joints with motors of their own")
        if name is None and len(groups) > 1:
            raise Error(5, f'{self.name} has several groups of joints; write r.joints("{groups[0]}"); there are: {_list_of(groups)}')
        group = groups[0] if name is None else name
        for one in (link, *link.others):
            if one.actuator == group and group in groups:
                return Joints(session, one)
        raise Error(10, f"{self.name} has no joints {name!r}; {_nearest(str(name), groups)}there are: {_list_of(groups)}")

    def muscles(self) -> "Muscles":
        """The robot's muscles. Error 5 if it has none."""
        return Muscles(self._session, self._part("muscles"))

    def thrusters(self) -> "Thrusters":
        """The robot's thrusters. Error 5 if it has none."""
        return Thrusters(self._session, self._part("thrusters"))

    def channel(self) -> "Channel":
        """The robot's channel: exchanges all motors and values that the model maps at once. From then on only the channel
        drives the robot: commands to its wheels, joints, muscles or thrusters are error 5. Error 5 if the robot has no
        channel."""
        return Channel(self._session, self._part("channel"))

    # --- pushed readings ---
    @_usage('r.subscribe("distance")')
    def subscribe(self, module: str, n: int = 1) -> None:
        """Subscribes to a module's first reading ("distance", "motors", "imu", ...; no pictures) every n steps; `next` returns
        them. n = 0 unsubscribes. Up to 64 readings are queued; then the oldest is dropped."""
        self._session.require_open()
        module = _word(module, 'a module, as "distance",')
        old = self._link.pushers.pop(module, None)
        if old is not None:
            old.close()
        if n == 0:
            return
        connection = _Connection(self._session.address, self._link.path(module))
        try:
            connection.open(self._session.address.timeout)
        except Error as e:
            if e.code != 10 or not self._session.find_again(self._link, module, connection):
                raise
            connection.open(self._session.address.timeout)
        connection.request(_SUBSCRIBE, (_count(n, "n"),))
        self._link.pushers[module] = connection

    @_usage('r.next("distance") or r.next("distance", timeout=5)')
    def next(self, module: Optional[str] = None, timeout: Optional[float] = None) -> Update:
        """Waits for the next pushed reading, of one module or of any subscription. Error 11 after `timeout` seconds. If robots
        hold the world up for more than 2 s, reports them once on stderr."""
        pushers = self._link.pushers
        chosen = [module] if module else list(pushers)
        if not chosen or any(m not in pushers for m in chosen):
            raise Error(5, f'nothing is subscribed to; write r.subscribe("{module or "distance"}") first')
        wait = _Wait(self._session, timeout, f"no reading of {_list_of(chosen)}", held_up=True)
        while True:
            for m in chosen:
                connection = pushers[m]
                if not connection.pushes:
                    try:
                        connection.try_read()
                    except _Closed as e:
                        del pushers[m]
                        if e.notice.endswith(_NOT_IN_SCENARIO):
                            raise self._session.lose(self._link, e) from None
                        raise
                if connection.pushes:
                    pushed = connection.pushes.pop(0)
                    self._session.note(pushed)
                    value = _reading_value(-pushed.command, pushed)
                    return Update(m, pushed.data[-2], int(pushed.data[-1]), value, pushed.text)
            wait.check()
            wait.readable([pushers[m] for m in chosen])

    @_usage('r.call("motors", "set_velocity", data=[0.2, 0])')
    def call(
        self, module: str, command: Union[str, int], params: Sequence[int] = (), data: Sequence[float] = (),
        text: str = "", timeout: Optional[float] = None,
    ) -> Reply:
        """Sends a raw message to one of this robot's modules, e.g. `r.call("motors", "set_velocity", data=[0.2, 0])`."""
        self._session.require_open()
        if not self._link.modules:
            self._link.modules = self._session.modules_of(self.name)
        return _call(self._session, self._link.path(module), command, params, data, text, timeout)

    # --- inside ---
    def _part(self, kind: str) -> _Link:
        """The link to the robot's actuator of this type."""
        session, link = self._session, self._link
        session.require_open()
        if link.lost is not None and link.lost.code == 10:
            raise link.lost
        for one in (link, *link.others):
            if one.kind == kind:
                return one
        actuators = session.actuators_of(self.name)
        for name, its_kind in actuators.items():
            if its_kind == kind == "channel":
                return session.drive_channel(link, name)
        raise Error(5, f"{self.name} has no {kind}; its actuators: {_list_of(list(actuators))}")

    def _get(self, module: str, command: int, params: Sequence[int] = (), text: str = "") -> Any:
        return _reading_value(command, self._session.read(self._link, module, command, params, text))

    def _attach(self, link: _Link) -> None:
        names = link.modules = self._session.modules_of(link.robot)
        readable = {m: names[m] for m in _SENSED if m in names}
        readable.update((_GROUP + group, group) for group in self._session.groups_of(link.robot))
        if not readable:
            raise Error(10, f"{link.robot} has no readings")
        connection = self._attached_connection(link, readable)
        connection.request(_ATTACH, text=" ".join(readable.values()))
        link.attached = readable

    def _attached_connection(self, link: _Link, readable: Dict[str, str]) -> _Connection:
        session = self._session
        if link.motors is not None:
            session.settle(link)
            return link.motors
        first = next(iter(readable.values()))
        connection = link.readers.setdefault("attached", _Connection(session.address, f"/{link.robot}/{first}"))
        if connection.sock is None or connection.busy:
            connection.open(session.address.timeout)
            if link.attached:
                connection.request(_ATTACH, text=" ".join(link.attached.values()))
        return connection

    def _ask_attached(self, link: _Link) -> Message:
        session = self._session
        connection, since = self._attached_connection(link, link.attached), session.reached
        try:
            return session.fresh(connection.request(_GET_TIME, polling=session.polling()), since)
        except _Closed as e:
            if connection is link.motors or e.notice.endswith(_NOT_IN_SCENARIO):
                raise session.lose(link, e) from None
            raise

    def _labels(self, link: _Link, step: int, count: int) -> Tuple[List[int], List[str]]:
        """Ids and colours of the targets. They change only with a reset, load or edit: queries them again if the step did not
        advance, if their number changed, or after _LABELS_LIVE_S."""
        last, when, ids, colours = link.labels
        now = _clock.monotonic()
        if step <= last or now - when > _LABELS_LIVE_S or len(ids) != count:
            targets = self.get_targets()
            ids, colours = [t.id for t in targets], [t.colour for t in targets]
        link.labels = (step, now, ids, colours)
        return ids, colours


Names = Union[str, int, Sequence[Union[str, int]], None]  # of joints, muscles, …: by name or by id, from 1; None: all


def _chosen(given: Names, names: List[str], one: str, whose: str) -> Tuple[int, ...]:
    """Ids of joints or other parts (`one`: their singular), from names or ids."""
    if given is None:
        return tuple(range(1, len(names) + 1))
    ids = []
    for part in [given] if isinstance(given, (str, int)) or not hasattr(given, "__iter__") else list(given):
        if isinstance(part, str):
            if part not in names:
                raise Error(10, f"{whose} has no {one} {part!r}; {_nearest(part, names)}there are: {_list_of(names)}")
            ids += [i + 1 for i, name in enumerate(names) if name == part]  # values of a channel may share a name
        else:
            number = _count(part, f"the id of a {one}")
            if number > len(names):
                raise Error(4, f"{whose} has {len(names)} {one}s, not {number}")
            ids.append(number)
    if not ids or len(set(ids)) < len(ids):
        raise Error(2, f"name each {one} once, not {given!r}; there are: {_list_of(names)}")
    return tuple(ids)


def _spread(values: List[float], count: int, what: str, one: str) -> Tuple[float, ...]:
    if len(values) == 1:
        return tuple(values * count)
    if len(values) != count:
        raise Error(3, f"write {what} for each of the {count} {one}s, or one for all, not {len(values)}")
    return tuple(values)


def _numbers(values: Any, count: int, what: str, one: str, finite: bool = True) -> Tuple[float, ...]:
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        values = [values]
    return _spread([value if value == math.inf and not finite else _number(value, what) for value in values], count, what, one)


class _Parts:
    """Common base of a robot's joints, muscles and thrusters, which are addressed by name or id."""

    _ONE = "joint"

    def __init__(self, session: _Session, link: _Link, limits: int) -> None:
        self._session = session
        self._link = link
        reply = session.read(link, link.actuator, limits)
        self._names = reply.text.split()
        self._limits = _reading_value(limits, reply)

    def __repr__(self) -> str:
        return f"<coopdyn {type(self).__name__.lower()} {self._link.robot}/{self.name}: {', '.join(self._names)}>"

    def __len__(self) -> int:
        return len(self._names)

    @property
    def name(self) -> str:
        return self._link.actuator

    @property
    def names(self) -> List[str]:
        """The names of all parts in order; the first has id 1."""
        return list(self._names)

    # --- inside ---
    def _ids(self, chosen: Names) -> Tuple[int, ...]:
        return _chosen(chosen, self._names, self._ONE, f"{self._link.robot}/{self.name}")

    def _command(self, command: int, values: Any, chosen: Names, what: str) -> None:
        ids = self._ids(chosen)
        self._session.command(self._link, command, _numbers(values, len(ids), what, self._ONE), ids)

    def _get(self, command: int, chosen: Names) -> Any:
        ids = () if chosen is None else self._ids(chosen)
        return _reading_value(command, self._session.read(self._link, self.name, command, ids))


@_usages("arm")
class Joints(_Parts):
    """A group of joints that are driven together, such as an arm. Made by `r.joints("arm")`.

        arm = r.joints("arm")
        arm.set_positions([0.5, -0.3, 0, 1.2, 0, 0.4, 0])     # rad, or m of a slider: a smooth move within the profile
        while not arm.arrived():
            sim.step()
        arm.set_positions(0.5, "elbow")                       # one joint, by its name or its number from 1

    Commands accept one value per named joint (none named: all), or one value for all of them. Like set_velocity, they are sent
    with the next `sim.step()` in lockstep, and immediately in real time. Each switches its joints to the corresponding mode.
    """

    def __init__(self, session: _Session, link: _Link) -> None:
        super().__init__(session, link, _GET_JOINT_LIMITS)
        self._chain: Optional[Tuple[List[int], Chain]] = None

    # --- commands ---
    @_usage('arm.set_positions([0.5, 0.2]) or arm.set_positions(0.5, "elbow")')
    def set_positions(self, positions: Any, joints: Names = None) -> None:
        """Moves joints smoothly to positions [rad, m], within their profile of speed and acceleration."""
        self._command(_SET_POSITIONS, positions, joints, "a position")

    @_usage('arm.set_positions_direct([0.5, 0.2]) or arm.set_positions_direct(0.5, "elbow")')
    def set_positions_direct(self, positions: Any, joints: Names = None) -> None:
        """Sets positions for the end of the step [rad, m], for your own trajectories."""
        self._command(_SET_POSITIONS_DIRECT, positions, joints, "a position")

    @_usage('arm.set_velocities([0.5, 0.2]) or arm.set_velocities(0.5, "elbow")')
    def set_velocities(self, velocities: Any, joints: Names = None) -> None:
        """Velocities of joints [rad/s, m/s]."""
        self._command(_SET_VELOCITIES, velocities, joints, "a velocity")

    @_usage('arm.set_efforts([0.5, 0.2]) or arm.set_efforts(0.5, "elbow")')
    def set_efforts(self, efforts: Any, joints: Names = None) -> None:
        """Efforts of the motors [N m, N]."""
        self._command(_SET_EFFORTS, efforts, joints, "an effort")

    @_usage('arm.set_pwm([0.5, 0.2]) or arm.set_pwm(0.5, "elbow")')
    def set_pwm(self, duties: Any, joints: Names = None) -> None:
        """Duties of the motors of drive trains, -1 to 1: the sign is the direction, 0 short-circuits the motor. Error 5 for a
        joint without a drive train."""
        self._command(_SET_PWM, duties, joints, "a duty")

    @_usage('arm.set_modes("idle") or arm.set_modes(["position", "idle"], joints=[1, 3])')
    def set_modes(self, modes: Any, joints: Names = None) -> None:
        """Sets control modes: "idle", "position", "direct", "velocity", "effort" or, with a drive train, "pwm". Each joint stays
        where it is (idle and effort: without effort; pwm: braked) until its next command."""
        ids = self._ids(joints)
        given = [modes] if isinstance(modes, (str, int, float)) else list(modes)
        numbers = []
        for mode in given:
            if mode in JOINT_MODES:
                mode = JOINT_MODES.index(mode)
            if mode not in range(len(JOINT_MODES)):
                raise Error(4, f"there is no mode {mode!r}; write one of: {_list_of(JOINT_MODES)}")
            numbers.append(float(mode))
        self._session.command(self._link, _SET_MODES, _spread(numbers, len(ids), "a mode", self._ONE), ids)

    @_usage('arm.hold() or arm.hold("elbow")')
    def hold(self, joints: Names = None) -> None:
        """Holds joints at their present positions."""
        self._session.command(self._link, _HOLD, (), self._ids(joints))

    # --- how joints are driven ---
    @_usage("arm.set_compliance(50, 2) or arm.set_compliance(50, 2, 0, joints=[1, 2])")
    def set_compliance(self, k: Any, d: Any = 0.0, offset: Any = 0.0, joints: Names = None) -> None:
        """Turns joints into springs in the modes "position" and "direct": effort = k (reference - position) - d velocity + offset;
        k [N m/rad], d [N m s/rad], offset [N m]. k = inf: a servo again."""
        self._tune(_SET_COMPLIANCE, (k, d, offset), ("a k [N m/rad]", "a d [N m s/rad]", "an offset [N m]"), joints)

    @_usage("arm.set_profile(0.5, 2) or arm.set_profile(0.5, 2, joints=[1, 2])")
    def set_profile(self, speed: Any, acceleration: Any, joints: Names = None) -> None:
        """Sets speed [rad/s, m/s] and acceleration [rad/s2, m/s2] of the moves of set_positions."""
        self._tune(_SET_PROFILE, (speed, acceleration), ("a speed [rad/s]", "an acceleration [rad/s2]"), joints)

    @_usage("arm.set_gains(20, 0, 0) or arm.set_gains(20, 0, 0, joints=[1, 2])")
    def set_gains(self, p: Any, i: Any = 0.0, d: Any = 0.0, joints: Names = None) -> None:
        """Gains of the position servos: reference velocity = p error + i integral of it (docs/physics.md)."""
        self._tune(_SET_GAINS, (p, i, d), ("a p [1/s]", "an i [1/s2]", "a d"), joints)

    # --- readings ---
    @_usage('arm.get() or arm.get("elbow")')
    def get(self, joints: Names = None) -> JointReading:
        """Position [rad, m], velocity and effort of joints."""
        return self._get(_GET_JOINTS, joints)

    @_usage('arm.get_modes() or arm.get_modes("elbow")')
    def get_modes(self, joints: Names = None) -> List[str]:
        """The control modes of joints, as words of set_modes."""
        return self._get(_GET_MODES, joints)

    @_usage('arm.get_compliance() or arm.get_compliance("elbow")')
    def get_compliance(self, joints: Names = None) -> Compliance:
        """k, d and offset of joints."""
        return self._get(_GET_COMPLIANCE, joints)

    @_usage('arm.get_profile() or arm.get_profile("elbow")')
    def get_profile(self, joints: Names = None) -> Profile:
        """Speed and acceleration with which joints move to a position."""
        return self._get(_GET_PROFILE, joints)

    @_usage('arm.get_gains() or arm.get_gains("elbow")')
    def get_gains(self, joints: Names = None) -> Gains:
        """p, i and d of the position servos."""
        return self._get(_GET_GAINS, joints)

    @_usage('arm.get_limits() or arm.get_limits("elbow")')
    def get_limits(self, joints: Names = None) -> JointLimits:
        """Limits of position, velocity and effort of joints."""
        return self._get(_GET_JOINT_LIMITS, joints)

    @_usage('arm.get_motion() or arm.get_motion("elbow")')
    def get_motion(self, joints: Names = None) -> Motion:
        """Which joints have completed the motion of set_positions, and their targets."""
        return self._get(_GET_MOTION, joints)

    @_usage('arm.arrived() or arm.arrived("elbow")')
    def arrived(self, joints: Names = None) -> bool:
        """True if the joints have reached the targets of set_positions; False until a step has run since."""
        session, link = self._session, self._link
        if link.kept is not None:
            return False
        motion: Motion = self.get_motion(joints)
        return session.steps > link.commanded_at and all(motion.arrived)

    @_usage('arm.get_references() or arm.get_references("elbow")')
    def get_references(self, joints: Names = None) -> List[float]:
        """The active references: position, velocity, effort or duty, by mode."""
        return self._get(_GET_REFERENCES, joints)

    @_usage('arm.get_drive_trains() or arm.get_drive_trains("elbow")')
    def get_drive_trains(self, joints: Names = None) -> DriveTrains:
        """Rotor, current and energy of joints that have a drive train."""
        return self._get(_GET_DRIVE_TRAINS, joints)

    # --- kinematics ---
    def get_chain(self) -> Chain:
        """The chain from the robot's frame R to the tool, for its forward() and inverse(). Error 5 if the joints branch."""
        return self._kinematics()[1]

    @_usage("arm.forward() or arm.forward([0.1, 0.2])")
    def forward(self, q: Optional[Sequence[float]] = None) -> List[List[float]]:
        """The tool's pose in the robot's frame R, a 4 x 4 matrix, with all joints of the group at q [rad, m]; without q, at
        their present positions."""
        ids, chain = self._kinematics()
        q = self._posture(q)
        return chain.forward([q[i - 1] for i in ids])

    @_usage("arm.inverse(pose) or arm.inverse([0.3, 0, 0.5], q0)")
    def inverse(self, pose: Any, q0: Optional[Sequence[float]] = None) -> List[float]:
        """Positions of all joints, within their limits, that bring the tool to a pose in R (a 4 x 4 matrix as of forward(), or
        only a position x, y, z [m]); near q0 if possible (default: the present positions). Error 4 if none are found."""
        ids, chain = self._kinematics()
        q = list(self._posture(q0))
        for i, angle in zip(ids, chain.inverse(pose, [q[i - 1] for i in ids])):
            q[i - 1] = angle
        return q

    # --- inside ---
    def _tune(self, command: int, columns: Sequence[Any], whats: Sequence[str], joints: Names) -> None:
        if self._session.watch:
            raise Error(5, "this sim only watches; connect() without watch=True to drive")
        ids = self._ids(joints)
        rows = zip(*(_numbers(column, len(ids), what, self._ONE, what != "a k [N m/rad]")
                     for column, what in zip(columns, whats)))
        self._session.read(self._link, self.name, command, ids, data=list(itertools.chain.from_iterable(rows)))

    def _posture(self, q: Optional[Sequence[float]]) -> Sequence[float]:
        if q is None:
            return self.get().position
        if not hasattr(q, "__len__") or len(q) != len(self._names):
            raise Error(3, f"a posture has a value for each of the {len(self._names)} joints: {_list_of(self._names)}")
        return q

    def _kinematics(self) -> Tuple[List[int], Chain]:
        """Ids of the joints between base and tool, and their chain."""
        if self._chain is None:
            reply = self._session.read(self._link, self.name, _GET_CHAIN)
            ids, kinds, data = reply.params[0::2], reply.params[1::2], reply.data[:-2]
            rows = [data[6 * k : 6 * k + 6] for k in range(len(ids))]
            x, y, z, qw, qx, qy, qz = data[6 * len(ids):]
            tool = [[1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy), x],
                    [2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx), y],
                    [2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy), z], [0, 0, 0, 1]]
            limits = self._limits
            self._chain = ids, Chain(kinds, [row[:3] for row in rows], [row[3:] for row in rows], tool,
                                     [limits.lower[i - 1] for i in ids], [limits.upper[i - 1] for i in ids])
        return self._chain


@_usages("m")
class Muscles(_Parts):
    """The muscles of a robot. Made by `r.muscles()`.

        m = r.muscles()
        m.set_activations(0.2)                # all muscles: fraction of their force, 0 to 1
        m.set_activations(0.8, "biceps")      # one muscle, by its name or its number from 1
        sim.step()
        print(m.get().force)                  # N, of each

    In lockstep, commands are sent with the next `sim.step()`; in real time, immediately, as for Joints. An activation holds
    until the next.
    """

    _ONE = "muscle"

    def __init__(self, session: _Session, link: _Link) -> None:
        super().__init__(session, link, _GET_MUSCLE_LIMITS)
        link.last = encode(_SET_ACTIVATIONS, data=[0.0] * len(self))

    @_usage('m.set_activations([0.5, 0.2]) or m.set_activations(0.5, "biceps")')
    def set_activations(self, activations: Any, muscles: Names = None) -> None:
        """Sets fractions of the muscles' force, 0 to 1: one value for each, or one for all."""
        self._command(_SET_ACTIVATIONS, activations, muscles, "an activation")

    @_usage('m.get() or m.get("biceps")')
    def get(self, muscles: Names = None) -> MuscleReading:
        """Activation, force [N], length [m], velocity [m/s; positive when lengthening] and the factors of these two."""
        return self._get(_GET_MUSCLES, muscles)

    def get_limits(self) -> MuscleLimits:
        """Maximal force [N], optimal length [m] and maximal velocity [m/s] of all muscles."""
        return self._limits


@_usages("t")
class Thrusters(_Parts):
    """The thrusters of a robot. Made by `r.thrusters()`.

        t = r.thrusters()
        t.set_thrusts([2.0, 0.1])             # N; N m for thrusters that turn their link
        t.set_thrusts(0, "jet")               # one thruster, by its name or its number from 1

    In lockstep, commands are sent with the next `sim.step()`; in real time, immediately, as for Joints. A thrust holds until
    the next.
    """

    _ONE = "thruster"

    def __init__(self, session: _Session, link: _Link) -> None:
        super().__init__(session, link, _GET_THRUSTER_LIMITS)
        link.last = encode(_SET_THRUSTS, data=[0.0] * len(self))

    @_usage('t.set_thrusts([2, 0.1]) or t.set_thrusts(2, "jet")')
    def set_thrusts(self, thrusts: Any, thrusters: Names = None) -> None:
        """Forces [N] and torques [N m] of thrusters: a value for each, or one for all."""
        self._command(_SET_THRUSTS, thrusts, thrusters, "a thrust")

    @_usage('t.get() or t.get("jet")')
    def get(self, thrusters: Names = None) -> ThrusterReading:
        """Thrust [N, N m], and the link's velocity along or about the thrust direction [m/s, rad/s]."""
        return self._get(_GET_THRUSTS, thrusters)

    def get_limits(self) -> ThrusterLimits:
        """Maximal force [N] or torque [N m] of all thrusters."""
        return self._limits


@_usages("c")
class Channel:
    """All motors and values that a robot's model maps (docs/yars.md), in one exchange. Made by `r.channel()`.

        c = r.channel()
        print([motor.name for motor in c.motors], [value.name for value in c.values])
        c.set([0.5, 0.5])                     # all motors
        c.set(0.2, "left_motor")              # one motor, by its name or its number from 1; the others keep their values
        sim.step(c.steps)                     # one exchange
        print(c.get(), c.get("right_motor_velocity"))

    In lockstep, values are sent with the next `sim.step()`; in real time, immediately.
    """

    def __init__(self, session: _Session, link: _Link) -> None:
        self._session = session
        self._link = link
        reply = session.read(link, link.actuator, _GET_CHANNEL)
        count, _, self.steps = reply.params[:3]  # steps of one exchange
        mapped = [Mapped(name, *reply.data[6 * k : 6 * k + 4], reply.data[6 * k + 4] != 0)
                  for k, name in enumerate(reply.text.split())]
        self.motors, self.values = mapped[:count], mapped[count:]
        self._told: List[float] = []

    def __repr__(self) -> str:
        return f"<coopdyn channel {self._link.robot}/{self._link.actuator}: {len(self.motors)} motors, {len(self.values)} values>"

    @_usage('c.set([0.5, 0.2]) or c.set(0.5, "left_motor")')
    def set(self, values: Any, motors: Names = None) -> None:
        """Sets motors in external units: one value for each, or one for all. Motors that are not named keep their values."""
        ids = self._ids(motors, self.motors, "motor")
        numbers = _numbers(values, len(ids), "a value", "motor")
        if len(ids) < len(self.motors) and not self._told:
            raise Error(5, f"set all {len(self.motors)} motors first: c.set([…]), then one by its name")
        told = dict(enumerate(self._told, 1))
        told.update(zip(ids, numbers))
        data = tuple(told[i + 1] for i in range(len(self.motors)))
        self._session.command(self._link, _SET_MOTORS, data, (1,))  # for one step; the values then hold
        self._told = list(data)

    @_usage('c.get() or c.get("left_motor_velocity")')
    def get(self, values: Names = None) -> List[float]:
        """Values in external units; a name returns all values of that name."""
        ids = self._ids(values, self.values, "value")
        data = self._session.read(self._link, self._link.actuator, _GET_VALUES).data
        return [data[i - 1] for i in ids]

    def aborted(self) -> bool:
        """True if the trial must end: a contact that the model declares as terminating is pressed."""
        return self._session.read(self._link, self._link.actuator, _GET_VALUES).text == "aborted"

    def _ids(self, chosen: Names, mapped: List[Mapped], one: str) -> Tuple[int, ...]:
        return _chosen(chosen, [part.name for part in mapped], one, f"{self._link.robot}/{self._link.actuator}")


@_usages("team")
class Team:
    """Drives any number of robots together through one connection. Made by `sim.team`.

        team = sim.team("swarm1")
        s = team.read()
        for k in range(1000):
            s = team.step([(0.1, 0.0)] * team.n)       # forward [m/s], turn [rad/s] for each robot
            print(s.time, s.pose[0], min(s.distances[0]))
    """

    def __init__(self, session: _Session, link: _TeamLink) -> None:
        self._session = session
        self._link = link

    def __repr__(self) -> str:
        return f"<coopdyn team of {self.n} robots>"

    def __len__(self) -> int:
        return len(self._link.names)

    @property
    def n(self) -> int:
        """The number of robots."""
        return len(self._link.names)

    @property
    def names(self) -> List[str]:
        """The names of the robots, in the order of the rows."""
        return list(self._link.names)

    @property
    def ids(self) -> List[int]:
        """The ids of the robots in the same order, as `get_neighbours` returns them."""
        return list(self._link.ids)

    @_usage('team.step([0.1, 0.5]), team.step([[0.1, 0.5], [0.1, 0]], timeout=5) or team.step({"positions": Q})')
    def step(self, V: Any = None, timeout: Optional[float] = None) -> TeamReading:
        """Runs one step of the world: sets each robot's forward speed [m/s] and turn rate [rad/s], waits until the step has
        run, in every mode, and returns the readings after it. V has one row of two per robot (or one for all): a list of
        pairs, an array("d"), or a numpy array; without V the robots keep their speeds. In lockstep the other robots of this
        sim step, too, with their kept commands. Error 11 after `timeout` seconds.

        Commands for joints, and several kinds of commands in one step, have names:

            team.step({"velocities": V, "positions": Q})
            team.step({"positions/legs": [0, 0.6, -1.2], "joint_velocities/head": [0.1]})    # one row for all

        The names: `velocities` (forward, turn), `wheels` (left, right [rad/s]); `positions`, `positions_direct`,
        `joint_velocities`, `efforts` of all joints, or after a / of one group, with one value for each joint [rad,
        rad/s, N m; m, m/s, N]. Rows of robots with fewer joints may be shorter. nan: this joint keeps its command."""
        return self._step(V, "V", "forward, turn", "", timeout)

    @_usage("team.step_wheels([3, 3])")
    def step_wheels(self, W: Any, timeout: Optional[float] = None) -> TeamReading:
        """The same with the speeds of the left and right wheel [rad/s]."""
        return self._step(W, "W", "left, right", "wheels", timeout)

    def read(self) -> TeamReading:
        """The readings of the newest step, without a step."""
        return self._reading(self._session.read_team(self._link))

    @_usage('team.select("pose", "neighbours", neighbours=4)')
    def select(self, *readings: Union[str, Sequence[str]], neighbours: int = _NEIGHBOURS) -> None:
        """Selects the readings that `step` and `read` return: "pose", "distances", "targets", "neighbours" (the `neighbours`
        nearest), "wheels", "compass", "support", "joints", and names of sensor modules such as "lidar": the module's first
        get command, in `s.lidar`; nan where a robot has fewer values. Default: "pose" and "distances". Other readings cost
        nothing."""
        words: List[str] = []
        for given in readings:
            words += given.split() if isinstance(given, str) else given if isinstance(given, (list, tuple)) else [given]
        for word in words:
            if not isinstance(word, str):
                raise Error(4, f"there is no reading {word!r}; there are: {_list_of(_READINGS)}, and sensors' modules by name")
        if not words:
            raise Error(3, f"nothing was chosen; there are: {_list_of(_READINGS)}, and sensors' modules by name")
        self._session.settle_team(self._link)
        try:
            self._link.ask_for(" ".join(words), _count(neighbours, "neighbours"))
        except Error as e:
            if e.code != 2:
                raise
            raise Error(4, f"{e.text}; there are: {_list_of(_READINGS)}, and sensors' modules by name") from None

    def stop(self) -> None:
        """Stops all robots of the team."""
        self._session.own_team(self._link)
        self._session.ask_team(self._link, _STOP_TEAM)

    def release(self) -> None:
        """Releases the robots; they keep executing their last commands."""
        self._session.close_team(self._link, False)

    def close(self) -> None:
        """Stops and releases the robots."""
        self._session.close_team(self._link, True)

    # --- inside ---
    def _step(self, values: Any, what: str, columns: str, text: str, timeout: Optional[float]) -> TeamReading:
        session, link = self._session, self._link
        session.settle_team(link)
        if values is not None and not hasattr(values, "__len__"):
            values = list(values) if hasattr(values, "__iter__") else values  # may be needed twice
        limit = None if timeout is None else _number(timeout, "timeout [s]")
        kept = [(other, other.kept) for other in session.links]
        n, frame = len(link.names), self._frame(values, what, columns, text)
        if link.playing:
            try:
                session.own_team(link)
            except Error as e:
                if e.code != 5 or values is not None:
                    raise
                session.step(1, limit)  # to the playback's next step
                return self.read()
            return self._step(values, what, columns, text, timeout)
        try:
            return self._reading(session.step_team(link, frame, limit))
        except Error as e:
            if e.code != 3 or "no longer in the team" not in e.text or link.lost is not None or len(link.names) == n:
                raise
        for other, command in kept:  # the step did not run
            other.kept = command
        return self._reading(session.step_team(link, self._frame(values, what, columns, text), limit))

    def _frame(self, values: Any, what: str, columns: str, text: str) -> bytes:
        """Encodes the request to step."""
        link = self._link
        try:
            if isinstance(values, dict):
                what = "each command"
                text, data = _team_commands(values, link.names)
            else:
                data = _speeds(values, link.names, what, columns) if values is not None else b""
        except Error as e:
            if e.code != 3 or not link.gone:
                raise
            more = len(link.gone) - _NAMED_ROBOTS
            gone = _list_of(link.gone[:_NAMED_ROBOTS]) + (f" and {more} more" if more > 0 else "")
            raise Error(3, f"{link.label} has lost {gone}: {what} must have {len(link.names)} rows now, in "
                           "the order of team.names, or one row for all") from None
        raw = text.encode()
        return _HEADER.pack(20 + len(raw) + len(data), 0, _STEP_ALL, len(raw), 0, len(data) // 8) + raw + data

    def _reading(self, reply: Message) -> TeamReading:
        """Decodes a reply. Queries the columns again if robots or targets were added or removed."""
        link = self._link
        n, m = reply.params[-2:]
        if n != len(link.names):
            self._session.name_team(link, self._session.ask_team(link, _GET_TEAM))
        if m != sum(link.columns):
            self._session.settle_team(link)
            link.ask_for(*link.selected)
        if (n, m) != (len(link.names), sum(link.columns)):  # the team has changed again meanwhile
            return self.read()
        return TeamReading(link.readings, link.columns, reply)


@_usages("sim")
class Simulation:
    """A connection to a daemon: controls its time and its robots. Made by `connect` and `launch`; also a context manager."""

    def __init__(self, session: _Session) -> None:
        self._session = session

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<coopdyn simulation at {self._session.address}>"

    # --- robots ---
    @_usage('sim.robot("robot1") or sim.robot(1)')
    def robot(self, which: Union[str, int]) -> Robot:
        """Claims a robot, by name or number (from 1), for this sim to drive. Error 6 if another client owns it. While a
        recording is played, the robot can only be read; after a branch, the first step or command claims it if it is free."""
        if isinstance(which, str):
            name = which.strip().lstrip("/")
        elif isinstance(which, (list, tuple, dict)) or which is None:
            raise Error(3, f'a robot is named or numbered, not {which!r}; write sim.robot("robot1") or sim.robot(1)')
        else:
            number, names = _count(which, "the number of a robot"), self.robots()
            if number > len(names):
                raise Error(10, f"there is no robot {number}; there are: {_list_of(names)}")
            name = names[number - 1]
        if not name or "/" in name or len(name.split()) != 1:
            raise Error(10, f'{which!r} is not the name of a robot; write e.g. sim.robot("robot1")')
        return Robot(self._session, self._session.drive(name))

    def robots(self) -> List[str]:
        """The names of all robots, in the order of the scenario."""
        return self._session.robot_names()

    @_usage('sim.team("swarm1"), sim.team(["robot1", "robot2"]) or sim.team()')
    def team(self, names: Union[str, Sequence[str], None] = None) -> Team:
        """Claims robots to be driven together through one connection: the name of a swarm or robot, a list of names, or all
        free robots. `names` of the team has the order of the scenario. Error 6 if another client owns one of them, or if this
        sim has driven one singly; then no robot is claimed. While a recording is played a team can only be read (without
        names: all robots); driving it is error 5."""
        if names is not None and not isinstance(names, str):
            if not isinstance(names, (list, tuple)) or not all(isinstance(name, str) for name in names):
                raise Error(3, f'the robots of a team are named, not {names!r}; write e.g. sim.team("swarm1"), '
                               'sim.team(["robot1", "robot2"]), or sim.team() for all that are free')
        words = [] if names is None else names.split() if isinstance(names, str) else [str(name) for name in names]
        if names is not None and not words:
            raise Error(3, 'no names: write e.g. sim.team("swarm1"), or sim.team() for all robots that are free')
        words = [word.lstrip("/") for word in words]
        for word in words:
            if not word or "/" in word or len(word.split()) != 1:
                raise Error(10, f'{word!r} is not the name of a robot or swarm; write e.g. sim.team("swarm1")')
        return Team(self._session, self._session.team(" ".join(words)))

    # --- time ---
    @_usage("sim.step(), sim.step(10) or sim.step(timeout=5)")
    def step(self, n: int = 1, timeout: Optional[float] = None) -> None:
        """Runs n steps. In lockstep: sends the commands of this sim's robots and waits until the steps have run; otherwise
        waits for the n-th next step. Teams keep their speeds. Error 11 after `timeout` seconds (default: never). After 2 s of
        waiting, reports once on stderr which robots the world waits for."""
        if timeout is not None:
            timeout = _number(timeout, "timeout [s]")
        n = _count(n, "n")
        if n > _MOST_STEPS:
            raise Error(4, f"n must be at most {_MOST_STEPS}, not {n}: write sim.step({_MOST_STEPS}) and the rest after it")
        self._session.step(n, timeout)

    @property
    def time(self) -> float:
        """Simulated time [s] of the newest reply."""
        return self._session.time

    @property
    def steps(self) -> int:
        """Step number of the newest reply."""
        return self._session.steps

    @property
    @_usage("sim.mode")
    def mode(self) -> str:
        """"realtime", "lockstep" or "free". Queries the daemon."""
        self._session.mode = self._session.control(_GET_TIME).params[0]
        return MODES[self._session.mode]

    @property
    def dt(self) -> float:
        """Length of a step [s]. Queries the daemon."""
        return float(self.status()["step_s"])

    # --- control ---
    def run(self) -> None:
        """Runs the simulation after a pause."""
        self._session.control(_RUN)

    def pause(self) -> None:
        """Pauses the simulation."""
        self._session.control(_PAUSE)

    def stop_all(self) -> None:
        """Stops all robots, including those of other clients."""
        self._session.control(_STOP_ALL)
        self._session.forget_commands()

    @_usage("sim.reset() or sim.reset(7)")
    def reset(self, seed: Optional[int] = None) -> None:
        """Restarts at step 0; with a seed, also draws [RANDOM] anew from it."""
        params = () if seed is None else (_whole(seed, "a seed"),)
        if params and params[0] < 0:
            raise Error(4, f"a seed is at least 0, not {params[0]}: write sim.reset(7)")
        self._session.control(_RESET, params, timeout=_LOAD_TIMEOUT_S)
        self._session.started_anew()

    def reload(self) -> None:
        """Reloads the scenario file from disk."""
        self._session.control(_RELOAD, timeout=_LOAD_TIMEOUT_S)
        self._session.loaded()

    @_usage('sim.load_scenario("corridor")')
    def load_scenario(self, x: str) -> None:
        """Loads a scenario: a name on the daemon's search path, a local file, or the text of a scenario."""
        x = _path(x, "a scenario")
        if not x:
            raise Error(3, 'no scenario: write sim.load_scenario("corridor")')
        if "\n" not in x and os.path.isfile(x):
            with open(x, encoding="utf-8-sig", errors="surrogateescape") as file:
                text = file.read().encode("utf-8", "surrogateescape").decode("utf-8", "replace")
            x = f"{text}\n# file: {os.path.basename(x)}\n"  # the last line tells the daemon the file's name
        self._session.control(_LOAD_SCENARIO, text=x, timeout=_LOAD_TIMEOUT_S)
        self._session.loaded()

    @_usage('sim.set_mode("lockstep")')
    def set_mode(self, mode: Union[str, int]) -> None:
        """"realtime", "lockstep" or "free"."""
        if mode not in MODES and mode not in range(len(MODES)):
            raise Error(4, f"there is no mode {mode!r}; write one of {_list_of(MODES)}")
        number = MODES.index(mode) if isinstance(mode, str) else int(mode)
        self._session.control(_SET_MODE, (number,))
        self._session.mode = number

    @_usage("sim.set_step(0.01)")
    def set_step(self, s: float) -> None:
        """Length of a step, 0.0005 to 0.1 s."""
        s = _number(s, "the step [s]")
        if not 0.0005 <= s <= 0.1:
            raise Error(4, f"a step lasts 0.0005 to 0.1 s, not {s:g}: write sim.set_step(0.01)")
        if abs(s - round(s, 6)) > 1e-9:
            raise Error(4, f"a step lasts whole microseconds, not {s:.9g} s: write sim.set_step({s:.6f})")
        self._session.control(_SET_STEP, (), (s,))

    @_usage("sim.set_speed(2)")
    def set_speed(self, x: float) -> None:
        """Sets the real-time factor; 0 or less: no limit."""
        self._session.control(_SET_SPEED, (), (_number(x, "the speed factor"),))

    @_usage('sim.set_participants(["robot1", "robot2"])')
    def set_participants(self, names: Sequence[str] = ()) -> None:
        """Sets the participants, the robots that lockstep waits for; empty: those of the scenario."""
        words = [names] if isinstance(names, str) else names
        if not isinstance(words, (list, tuple)) or not all(isinstance(word, str) for word in words):
            raise Error(3, f'robots are named, not {names!r}; write sim.set_participants(["robot1", "robot2"])')
        self._session.control(_SET_PARTICIPANTS, text=" ".join(words))

    @_usage('sim.release_robot("robot1")')
    def release_robot(self, name: str) -> None:
        """Frees a robot: closes the connection of the program that drives it, or unloads its controller."""
        self._session.control(_RELEASE_ROBOT, text=_word(name, "the name of a robot"))

    # --- live edits of the world ---
    @_usage('sim.insert("[BOX_*] | type box | size 0.5 0.5 0.5 | position 2 1")')
    def insert(self, sections: str) -> List[str]:
        """Inserts things, robots, targets and lights: sections of a scenario, or a file of sections. Returns their names.
        [BOX_*] uses the next free number; a text in one line has | between lines. Error 5 if they would overlap."""
        sections = _path(sections, "a text with sections")
        if "[" not in sections and os.path.isfile(sections):
            with open(sections, encoding="utf-8-sig") as file:
                sections = file.read()
        return self._edit(_INSERT, text=sections)

    @_usage('sim.remove("BOX_1") or sim.remove(["BOX_1", "robot2"])')
    def remove(self, names: Union[str, Sequence[str]]) -> None:
        """Removes things, robots, targets or lights."""
        words = [names] if isinstance(names, str) else names
        if not isinstance(words, (list, tuple)) or not words:
            raise Error(3, f'remove takes names, not {names!r}: write sim.remove("BOX_1")')
        self._edit(_REMOVE, text=" ".join(_word(name, "a name") for name in words))

    @_usage('sim.move("BOX_1", (2, 1)) or sim.move("BOX_1", (2, 1, 0.25), 1.57)')
    def move(self, name: str, position: Sequence[float], turn: Union[float, Sequence[float], None] = None) -> None:
        """Moves an object and stops it. `position`: x, y or x, y, z [m]; `turn`: a yaw [rad] or a quaternion w, x, y, z, which
        needs x, y and z. Omitted components stay unchanged. Error 5 if it would overlap."""
        if not hasattr(position, "__len__") or len(position) not in (2, 3):
            raise Error(3, f'a position is x, y or x, y, z, not {position!r}: write sim.move("BOX_1", (2, 1))')
        data = [_number(x, "a position") for x in position]
        if turn is not None:
            turns = turn if hasattr(turn, "__len__") else (turn,)
            if len(data) != 3 or len(turns) not in (1, 4):
                raise Error(3, 'a turn is a yaw or w, x, y, z, and needs x, y and z: write sim.move("BOX_1", (2, 1, 0.25), 1.57)')
            data += [_number(x, "a turn") for x in turns]
        self._edit(_SET_POSE, data=data, text=_word(name, "a name"))

    @_usage('sim.change("BOX_1", color="red", mass=2)')
    def change(self, name: str, **keys: Any) -> None:
        """Changes keys of a thing's section in the scenario: color, size, mass, friction, bounce, velocity,
        controller, … Lists of numbers are written (1, 2, 3)."""
        if not keys:
            raise Error(3, 'nothing to change: write sim.change("BOX_1", color="red", mass=2)')
        values = {key: " ".join(str(x) for x in value) if isinstance(value, (list, tuple)) else str(value)
                  for key, value in keys.items()}
        lines = "\n".join(f"{key} {value}" for key, value in values.items())
        self._edit(_SET_THING, text=f"{_word(name, 'a name')}\n{lines}")

    @_usage('sim.rename("BOX_1", "crate")')
    def rename(self, name: str, new_name: str) -> None:
        """Renames a thing, a robot (including its modules) or a light."""
        self._edit(_RENAME, text=f"{_word(name, 'a name')} {_word(new_name, 'a name')}")

    def undo(self) -> str:
        """Undoes the last edit, by any client; returns the object concerned. Error 5 if there is no edit."""
        return " ".join(self._edit(_UNDO))

    def redo(self) -> str:
        """Redoes the edit that undo() or a reset undid last."""
        return " ".join(self._edit(_REDO))

    def world(self) -> Dict[str, Any]:
        """All present objects of the world: lists of things, robots, targets and lights with ids, names and poses."""
        return json.loads(self._session.tell(_WORLD, _LIST_WORLD).text)

    @_usage('sim.save_scenario("mine.scenario")')
    def save_scenario(self, file: Union[str, "os.PathLike[str]"]) -> str:
        """Writes the present world, with all poses, as a scenario; returns the file's name."""
        file = _path(file, "the name of a file")
        if not file:
            raise Error(3, 'no name: write sim.save_scenario("mine.scenario")')
        text = self._session.tell(_WORLD, _SAVE_WORLD).text
        with open(file, "w", encoding="utf-8") as out:
            out.write(text)
        return file

    @_usage("sim.pick((0, 0, 5), (0, 0, -1))")
    def pick(self, origin: Sequence[float], direction: Sequence[float]) -> Picked:
        """The first hit of a ray from a point in a direction: its name ("": no hit), the point and the distance [m]."""
        if any(not hasattr(v, "__len__") or len(v) != 3 for v in (origin, direction)):
            raise Error(3, "origin and direction are x, y, z: write sim.pick((0, 0, 5), (0, 0, -1))")
        reply = self._session.tell(_WORLD, _PICK, (), [_number(x, "a ray") for x in (*origin, *direction)])
        return Picked(reply.text, tuple(reply.data[:3]), reply.data[3])

    def _edit(self, command: int, data: Sequence[float] = (), text: str = "") -> List[str]:
        reply = self._session.tell(_WORLD, command, (), data, text, timeout=_LOAD_TIMEOUT_S)
        names, _, warnings = reply.text.partition("\n")
        for warning in warnings.splitlines():
            print(f"coopdyn: {warning}", file=sys.stderr)
        return names.split()

    # --- saved states ---
    @_usage('sim.save_state("before_turn")')
    def save_state(self, name: str) -> None:
        """Saves the complete state of the simulation under a name; replaces an older state of that name."""
        name = _word(name, "the name of a state")
        if not (name.isascii() and name[0].isalpha() and name.translate({45: "", 95: ""}).isalnum() and len(name) < 64):
            raise Error(4, "the name of a state is a letter, then letters, digits, _ and -, at most 63: write "
                           'sim.save_state("before_turn")')
        self._session.control(_SAVE_STATE, text=name)

    @_usage('sim.restore_state("before_turn")')
    def restore_state(self, name: str) -> None:
        """Continues from a saved state, bit for bit; "start" is the start of the run."""
        self._session.control(_RESTORE_STATE, text=_word(name, "the name of a state"), timeout=_LOAD_TIMEOUT_S)
        self._session.jumped()

    def saved_states(self) -> List[SavedState]:
        """The states that can be restored, and their simulated times [s]."""
        reply = self._session.control(_GET_SAVED)
        return [SavedState(name, time) for name, time in zip(reply.text.split(), reply.data)]

    # --- recording ---
    @_usage('sim.record() or sim.record("lesson1")')
    def record(self, name: str = "") -> str:
        """Starts recording into the daemon's folder; returns the file's name. The default name is run-DATE-TIME. Error 5 if the
        file exists."""
        return self._session.tell(_RECORDER, _START_RECORDING, text=_run_name(name) if name != "" else "").text

    def stop_recording(self) -> Recorded:
        """Stops the recording; returns its name and URL once the file is closed."""
        text = self._session.tell(_RECORDER, _STOP_RECORDING, timeout=_LOAD_TIMEOUT_S).text
        name, http, url = text.partition(" http://")  # the name may contain blanks
        return Recorded(name, _here(self._session.address, http + url) if url else "")

    @_usage('sim.note("half-time")')
    def note(self, text: str) -> None:
        """Adds a note to the recording at the present time; `Run.events` returns it."""
        if text == "":
            raise Error(3, 'no note: write sim.note("half-time")')
        self._session.tell(_RECORDER, _NOTE, text=str(text))

    def recording(self) -> Optional[Recording]:
        """The recording in progress; None if there is none."""
        reply = self._session.tell(_RECORDER, _GET_RECORDING)
        if not reply.params[0]:
            return None
        begin, end, steps, lost, size = reply.data[:5]
        return Recording(reply.text, begin, end, int(steps), int(lost), int(size))

    def recordings(self) -> List[RunFile]:
        """The daemon's recordings, newest first."""
        address = self._session.address
        files = json.loads(self._session.tell(_RECORDER, _LIST_RUNS, timeout=_LOAD_TIMEOUT_S).text)
        return [RunFile(f["name"], int(f["bytes"]), f["seconds"], None if f["steps"] is None else int(f["steps"]),
                        bool(f["recording"]), _here(address, f["url"]) if f["url"] else "") for f in files]

    @_usage('sim.fetch_run("lesson1")')
    def fetch_run(self, name: str, file: Union[str, "os.PathLike[str]"] = "") -> str:
        """Downloads a recording to `file` (default: its own name, in the current folder) and returns the file's name. For a
        file *.mat the daemon converts the run to a MAT file. An existing file is replaced once the download is complete."""
        name = _run_name(name)
        name = name[:-4] if name.endswith(".run") else name
        file = _path(file, "the name of a file") or f"{name}.run"
        kind = ".mat" if file.lower().endswith(".mat") else ".run"
        url = f"{_page(self._session.address, self.status())}/runs/{urllib.parse.quote(name + kind)}"
        try:
            _download(url, file, headers=self._session.address.page_headers())
        except Error as e:
            if e.code != 10:
                raise
            raise Error(10, f"there is no recording {name}.run; there are: {_list_of(f.name for f in self.recordings())}") from None
        return file

    # --- playing a recording: `coopdyn play RUN` ---
    def playback(self) -> Playback:
        """The state of the playback. Error 5 in a live run."""
        reply = self._session.tell(_PLAYBACK, _GET_PLAYBACK)
        begin, end, time, speed = reply.data[:4]
        playing, loop, growing = map(bool, reply.params[:3])
        return Playback(begin, end, time, speed, playing, loop, growing, reply.text)

    @_usage("sim.seek(12.5)")
    def seek(self, time: float) -> None:
        """Shows the last step up to a simulated time [s], clamped to the recording."""
        self._session.tell(_PLAYBACK, _SEEK, (), (_number(time, "the time [s]"),))

    @_usage("sim.play() or sim.play(2)")
    def play(self, speed: Optional[float] = None) -> None:
        """Plays the recording, at `speed` if given: -4 to 64; negative plays backwards."""
        self._session.tell(_PLAYBACK, _PLAY, (), () if speed is None else (_play_speed(speed),))

    @_usage("sim.set_play_speed(2)")
    def set_play_speed(self, s: float) -> None:
        """Sets the speed of the playback: -4 to 64; negative plays backwards."""
        self._session.tell(_PLAYBACK, _SET_PLAY_SPEED, (), (_play_speed(s),))

    @_usage("sim.skip() or sim.skip(-10)")
    def skip(self, n: int = 1) -> None:
        """Goes n recorded steps forward, or back if n is negative, and pauses there."""
        if _whole(n, "n") == 0:
            raise Error(4, "n is a number of steps, negative to go back, but not 0: write sim.skip(1)")
        self._session.tell(_PLAYBACK, _SKIP, (_whole(n, "n"),))

    @_usage("sim.set_loop(True)")
    def set_loop(self, on: bool) -> None:
        """Whether the playback restarts at the recording's end."""
        if on not in (0, 1) or isinstance(on, float):  # True and False are such numbers
            raise Error(3, f"on is True or False, not {on!r}")
        self._session.tell(_PLAYBACK, _SET_LOOP, (int(on),))

    @_usage("sim.branch() or sim.branch(12.5)")
    def branch(self, time: Optional[float] = None) -> None:
        """Ends the playback: the simulation continues live from the step shown, or from a simulated time [s]. With the same
        inputs it repeats the recorded run bit for bit."""
        data = () if time is None else (_number(time, "the time [s]"),)
        self._session.tell(_PLAYBACK, _BRANCH, (), data, timeout=_EXPORT_TIMEOUT_S)
        self._session.jumped()

    @_usage('sim.open_run("lesson1")')
    def open_run(self, name: str) -> None:
        """Plays a recording of the daemon (sim.recordings() lists them). Suspends the live run until sim.close_run()."""
        self._session.tell(_PLAYBACK, _OPEN, (), (), _run_name(name), timeout=_EXPORT_TIMEOUT_S)
        self._session.jumped()

    def close_run(self) -> None:
        """Ends the playback and resumes the live run that sim.open_run() suspended."""
        self._session.tell(_PLAYBACK, _CLOSE)
        self._session.jumped()

    # --- status ---
    def status(self) -> Dict[str, Any]:
        """The status of the simulation (docs/protocol.md lists the keys)."""
        return json.loads(self._session.control(_GET_STATUS).text)

    def hash(self) -> str:
        """The hash of the state, 16 hexadecimal digits: equal runs give equal hashes."""
        return str(self.status()["hash"])

    def scores(self) -> Dict[str, float]:
        """The present scores of the run, by the names of the scenario's [SCORE_n]; nan: undefined."""
        return {s["name"]: math.nan if s["value"] is None else float(s["value"]) for s in self.status()["scores"]}

    @_usage('sim.log("energy", 3.5)')
    def log(self, name: str, value: float) -> None:
        """Logs a number under a name: appears in sim.logged(), in --summary and in the recording (Run.logged(name))."""
        self._session.control(_LOG, data=[_number(value, 'a number, sim.log("energy", 3.5)')], text=str(name))

    def logged(self) -> Dict[str, float]:
        """The newest logged number of each name."""
        return {one["name"]: float(one["value"]) for one in self.status()["logged"]}

    def end_run(self, why: str = "") -> None:
        """Ends the run because its purpose is achieved; a daemon that was started for one run exits."""
        self._session.control(_END_RUN, text=str(why))

    def waiting(self) -> List[Awaited]:
        """The robots that the world waits for, and why."""
        return [Awaited(a["robot"], a["why"], float(a["seconds"] or 0)) for a in self.status()["awaiting"] or []]

    @_usage('sim.snapshot("a.png")')
    def snapshot(
        self, file: str, w: int = 640, h: int = 480, eye: Optional[Sequence[float]] = None,
        look: Optional[Sequence[float]] = None,
    ) -> str:
        """Writes a PNG picture of w by h pixels to `file`; `eye` and `look` are points x, y, z [m] in the world."""
        file = _path(file, "the name of a file")
        url = f"{_page(self._session.address, self.status())}/snapshot.png?w={_count(w, 'w')}&h={_count(h, 'h')}"
        for word, point in (("eye", eye), ("look", look)):
            if point is not None:
                if not hasattr(point, "__len__") or len(point) != 3:
                    raise Error(3, f"{word} is a point: write ({word}_x, {word}_y, {word}_z)")
                url += f"&{word}=" + ",".join(repr(_number(c, word)) for c in point)
        _download(url, file, "picture", 30, self._session.address.page_headers())
        return file

    @_usage('sim.describe("/robot1/motors")')
    def describe(self, name: str) -> Dict[str, Any]:
        """The description of a module's commands, e.g. of "/robot1/motors", with values and units."""
        return _describe(self._session, name)

    def modules(self) -> List[Module]:
        """All names registered at the daemon, with their addresses."""
        self._session.require_open()
        return self._session.address.modules()

    @_usage('sim.call("/robot1/motors", "set_velocity", data=[0.2, 0.5])')
    def call(
        self, name: str, command: Union[str, int], params: Sequence[int] = (), data: Sequence[float] = (),
        text: str = "", timeout: Optional[float] = None,
    ) -> Reply:
        """Sends a raw message, e.g. `sim.call("/robot1/motors", "set_velocity", data=[0.2, 0.5])`; in lockstep, the reply to an
        actuator command arrives after the step. Error 11 after `timeout` seconds (default: never)."""
        return _call(self._session, name, command, params, data, text, timeout)

    def close(self) -> None:
        """Stops the robots of this sim and releases them. Does not wait for the step."""
        if not self._session.closed:
            self._session.close()


def _page(address: _Address, status: Dict[str, Any]) -> str:
    """The page's URL, with the host by which this machine reaches the daemon."""
    url = str(status.get("http") or "off")
    if "://" not in url:
        raise Error(5, "the daemon was started with --no-http, so there are no pictures and no files")
    return _here(address, url).rstrip("/")


def _here(address: _Address, url: str) -> str:
    """`url` with the host by which this machine reaches the daemon."""
    if address.port == 0:  # a unix socket: the page is on this machine
        return url
    there, slash, path = url.split("://", 1)[1].partition("/")
    host = f"[{address.host}]" if ":" in address.host else address.host
    return f"http://{host}:{there.rsplit(':', 1)[-1]}{slash}{path}"


def _word(text: Any, what: str) -> str:
    """Returns the only word of `text`; raises Error 3 otherwise."""
    if not isinstance(text, str) or len(text.split()) != 1:
        raise Error(3, f"{what} is one word, not {text!r}")
    return text.strip()


def _run_name(text: Any) -> str:
    """The name of a recording, a file name that may contain blanks."""
    if not isinstance(text, str) or not text.strip():
        raise Error(3, f"the name of a recording is a text, not {text!r}")
    return text


def _download(
    url: str, file: str, what: str = "recording", timeout: float = _EXPORT_TIMEOUT_S, headers: Optional[Dict[str, str]] = None
) -> None:
    """Downloads `url` to `file`, completely or not at all."""
    import http.client
    import tempfile
    import urllib.error
    import urllib.request

    def pieces() -> Iterator[bytes]:
        got = 0
        request = urllib.request.Request(url, headers=headers or {})
        try:
            with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=timeout) as reply:
                length = reply.headers.get("Content-Length")
                for piece in iter(lambda: reply.read(1 << 20), b""):
                    got += len(piece)
                    yield piece
        except urllib.error.HTTPError as e:
            text = e.read().decode("utf-8", "replace").strip() or str(e)
            raise Error(10 if e.code == 404 else 5, f"no {what}: {text}") from None
        except (OSError, http.client.HTTPException, ValueError) as e:
            raise Error(-1, f"no {what} from {url}: {e}") from None
        if length is not None and got != int(length):
            raise Error(-1, f"the connection broke before the {what} was complete: {got} of {length} bytes arrived")

    source = pieces()
    first = next(source, b"")
    folder, name = os.path.split(os.path.abspath(file))
    part = ""
    try:
        try:
            handle, part = tempfile.mkstemp(".part", f".{name}.", folder)
            with os.fdopen(handle, "wb") as out:
                out.write(first)
                for piece in source:
                    out.write(piece)
            umask = os.umask(0)
            os.umask(umask)
            os.chmod(part, 0o666 & ~umask)  # the mode of a new file
            os.replace(part, file)
            part = ""
        except OSError as e:
            raise Error(5, f"cannot write {file}: {e.strerror or e}") from None
    finally:
        source.close()
        if part:
            os.remove(part)


def _module_name(name: Any) -> str:
    return "/" + _word(name, 'a module, as "/robot1/motors",').strip("/")


def _describe(session: _Session, name: str) -> Dict[str, Any]:
    session.require_open()
    connection = _Connection(session.address, _module_name(name))
    try:
        return json.loads(session.ask(connection, _DESCRIBE, (), (), "").text)
    finally:
        connection.close()


def _call(
    session: _Session, name: str, command: Union[str, int], params: Sequence[int], data: Sequence[float], text: str,
    timeout: Optional[float],
) -> Reply:
    session.require_open()
    name = _module_name(name)
    if isinstance(command, str):
        if name not in session.commands:
            described = _describe(session, name)
            session.commands[name] = {c["name"]: int(c["id"]) for c in described["commands"]}
        if command not in session.commands[name]:
            raise Error(1, f"{name} has no command {command!r}; it has: {_list_of(session.commands[name])}")
        command = session.commands[name][command]
    if not hasattr(params, "__iter__") or not isinstance(text, str):
        raise Error(2, f"params are a list of whole numbers and text is a text, not {params!r} and {text!r}")
    command, params = _whole(command, "a command"), [_whole(p, "a param") for p in params]
    try:
        numbers = [float(d) for d in data]
    except (TypeError, ValueError):
        raise Error(3, f"data are a list of numbers, not {data!r}") from None
    link = next((l for l in session.links if l.motors is not None and l.motors.module == name), None)
    if link is not None and link.motors is not None:
        session.settle(link)
        connection = link.motors
    else:
        connection = session.connection(name)
    session.forget_carried()
    waiting: Dict[_Connection, Optional[_Driven]] = {connection: link}
    try:
        connection.send(encode(command, params, numbers, text))
        reply = _await_one(session, connection, timeout)
    except BaseException as e:
        if isinstance(e, Error) and connection.sock is not None and not connection.busy:
            if isinstance(e, WorldReset):
                raise session.world_reset(e.text) from None
            raise  # an error reply: the connection is intact
        raise session.give_up(waiting, e) from None
    if name in (_SIMULATION, _PLAYBACK):
        session.reached = 0  # it may have been a reset
    return Reply(reply.text, reply.command, reply.params, reply.data[:-2], reply.data[-2], int(reply.data[-1]))


def _await_one(session: _Session, connection: _Connection, timeout: Optional[float]) -> Message:
    """The reply to a raw message, which may have to wait for a step."""
    wait = _Wait(session, timeout, f"no answer from {connection.module}")
    while True:
        reply = connection.try_read()
        if reply is not None:
            return session.note(_checked(reply))
        wait.check()
        wait.readable((connection,))


@_usage('coopdyn.connect(), coopdyn.connect("labserver") or coopdyn.connect("labserver:10100", watch=True)')
def connect(
    server: Union[str, int, None] = None, name: Optional[str] = None, token: Optional[str] = None, timeout: float = 3,
    watch: bool = False, seat: Optional[str] = None, pin: Optional[str] = None,
) -> Simulation:
    """Connects to a daemon: "labserver", "labserver:10100", 10100 (a port of this machine), or "unix:/PATH" (a unix socket);
    default: COOPDYN_SERVER, else this machine.

    `name`: the client's name, without spaces (default user@host:pid); a client of the same name takes over robots.
    `token`: printed by the daemon, needed from other machines to change the world. `timeout`: of connecting [s]. `watch`:
    read-only, never drives a robot. `seat` and `pin`: of a class (`coopdyn host`), as on your sheet; default:
    COOPDYN_SEAT=ana:7305; seat="": none.
    """
    session = _Session(_Address(server, name, token, _number(timeout, "timeout [s]"), seat, pin), watch)
    try:
        status = json.loads(session.control(_GET_STATUS, timeout=session.address.timeout).text)
        if status.get("protocol", PROTOCOL) != PROTOCOL:
            raise Error(5, f"the daemon at {session.address} (version {status.get('version')}) speaks protocol "
                           f"{status.get('protocol')}, this coopdyn.py ({__version__}) speaks {PROTOCOL}: take the coopdyn.py "
                           "that the daemon's page offers")
        session.scenario = status.get("scenario")
        session.control(_GET_TIME)
    except ValueError:
        session.close()
        raise Error(7, f"what listens at {session.address} sent a status that is not JSON") from None
    except BaseException:
        session.close()
        raise
    return Simulation(session)


# --- private daemons ---------------------------------------------------------------------------------------------------

class _Daemon:
    """A daemon started by this program, and its output."""

    def __init__(self, program: str, words: Sequence[str], text: Optional[str]) -> None:
        self.said: "collections.deque[str]" = collections.deque(maxlen=_SAID_LINES)
        self.lines: "queue.Queue[Optional[str]]" = queue.Queue()
        # In a separate session: Ctrl-C must reach only the program, which then ends the daemon.
        try:
            self.process = subprocess.Popen([program, "serve", *words], stdin=subprocess.DEVNULL if text is None else subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        except OSError as e:
            raise Error(-1, f"{program} cannot be started: {e.strerror}") from None
        self.readers = [threading.Thread(target=self._read, args=(stream, keep), daemon=True)
                        for stream, keep in ((self.process.stdout, self.lines.put), (self.process.stderr, self.said.append))]
        for reader in self.readers:
            reader.start()
        if text is not None:
            assert self.process.stdin is not None
            with contextlib.suppress(OSError):  # the daemon has exited; its output says why
                self.process.stdin.write(text.encode())
                self.process.stdin.close()

    def _read(self, stream: Any, keep: Callable[[str], Any]) -> None:
        with stream:
            for line in stream:
                keep(line.decode(errors="replace").rstrip())
        if keep == self.lines.put:
            keep(None)  # type: ignore[arg-type]

    def server(self, timeout: float) -> str:
        """Waits until the daemon is ready; returns its address."""
        limit = _clock.monotonic() + timeout
        while True:
            try:
                line = self.lines.get(timeout=max(0.0, limit - _clock.monotonic()))
            except queue.Empty:
                self.end()
                raise Error(11, f"the daemon was not ready within {timeout:g} s: give launch a longer timeout") from None
            if line is None:
                self.end()
                raise Error(7, "the daemon did not start:\n" + "\n".join(self.said))
            if line.startswith("ready names="):
                return line.split()[1][len("names="):]

    def end(self) -> None:
        """Shuts the daemon down; kills it if it does not exit in time."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(_END_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
        self.process.wait()
        for reader in self.readers:
            reader.join(_CLOSE_S)


def _program(program: Optional[str]) -> str:
    """The daemon's program: the given one, $COOPDYN or $COOPDYN_BINARY, one on the PATH, or one built beside this file."""
    built = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "release", "coopdyn")
    found = program or os.environ.get("COOPDYN") or os.environ.get("COOPDYN_BINARY") or shutil.which("coopdyn") or (built if os.path.exists(built) else "")
    if not found:
        raise Error(10, 'the program coopdyn is not on the PATH: write launch(..., program="/path/to/coopdyn"), or set COOPDYN')
    return found


def launch(
    scenario: str = "classroom", *, set: Optional[Dict[str, Any]] = None, seed: Optional[int] = None, mode: Optional[str] = None,
    record: Optional[str] = None, options: Sequence[str] = (), program: Optional[str] = None, timeout: float = _LOAD_TIMEOUT_S,
) -> Simulation:
    """Starts a private daemon on free ports of this machine and connects to it: launch("arena20", seed=7).

    `scenario`: a file, a name or the text of a scenario. `set`: overrides of its values, {"SWARM_1.count": 20}. `record`: a
    file. `options`: further arguments of `coopdyn serve`, e.g. ["--no-http"]. The daemon exits on sim.close(), at the end of
    a `with` block, and when this program exits or crashes.
    """
    if not isinstance(scenario, str):
        raise Error(3, f'a scenario is a file, a name or a text, not {scenario!r}; write e.g. coopdyn.launch("classroom")')
    if set is not None and not hasattr(set, "items"):
        raise Error(3, f'set takes keys with their values, set={{"SWARM_1.count": 20}}, not {set!r}')
    is_text = "\n" in scenario
    words = ["-" if is_text else scenario, "--port", "0", "--with-process", str(os.getpid())]
    for key, value in (set or {}).items():
        parts = value if isinstance(value, (list, tuple)) else [value]
        words += ["--set", f"{key}={' '.join(str(part) for part in parts)}"]
    for flag, value in (("--seed", seed), ("--mode", mode), ("--record", record)):
        if value is not None:
            words += [flag, str(value)]
    daemon = _Daemon(_program(program), [*words, *options], scenario if is_text else None)
    try:
        sim = connect(daemon.server(_number(timeout, "timeout [s]")), seat="")
    except BaseException:
        daemon.end()
        raise
    sim._session.on_closed = weakref.finalize(sim, daemon.end)
    return sim


# --- recorded runs ----------------------------------------------------------------------------------------------------

_RUN_ID, _RUN_FORMAT = 0x434F4F50, 2  # SQLite's application_id and user_version of a recording
_POSE_BYTES, _COMMAND_BYTES, _CHANNEL_BYTES, _SCORE_BYTES = 18, 13, 9, 9
_RUN_READINGS = ("distances", "targets", "channels")


class Event(NamedTuple):
    """An event of a recorded run, after a step, at a simulated time [s]. `level`: "info", "warning", "error" or "note"."""

    step: int
    time: float
    level: str
    text: str


class _Place(NamedTuple):
    """The indices of a thing's values in the rows of one scene of a recording. `robot`: its number, -1 for an object."""

    scene: int
    body: int
    robot: int
    p_BR: Tuple[float, float, float]
    q_BR: Tuple[float, float, float, float]
    first_sensor: int
    sensors: int
    first_channel: int = 0
    channels: int = 0


@_usages("run")
class Run:
    """A recorded run: `coopdyn.read_run("lesson1.run")`. Each call reads only the data it returns.

        run = coopdyn.read_run("lesson1.run")
        for x, y, heading in run.pose("robot1"): ...
        p = run.pose("robot1"); plot(p[:, 0], p[:, 1])           # a path; numpy.asarray(p) is the matrix

    k is the number of recorded moments; the first is the state at the recording's start. Values that did not exist or were
    not recorded at a moment are nan. A run that is still being recorded is read up to its end at the time of opening.
    """

    def __init__(self, file: Union[str, "os.PathLike[str]"]) -> None:
        self._file = _path(file, "the name of a recording")
        self._db = _open_run(self._file)
        with self._reading():
            self._last = self._db.execute("SELECT max(step) FROM step WHERE poses IS NOT NULL").fetchone()[0]
            if self._last is None:
                raise Error(7, f"{self.file} holds no step yet; if its daemon has ended, `coopdyn info` shows its contents")
            meta = dict(self._db.execute("SELECT key, value FROM meta"))
            for key in ("seed", "scenario_seed"):
                meta[key] = int(meta[key])
            self._names = [name for (name,) in self._db.execute("SELECT name FROM robot GROUP BY name ORDER BY min(scene), place")]
            for scene, bodies, robots, shown, moved in self._db.execute(
                "SELECT s.id, (SELECT count(DISTINCT robot) FROM body WHERE scene = s.id), (SELECT count(*) FROM robot WHERE "
                "scene = s.id), length(poses), length(channels) FROM scene AS s LEFT JOIN step ON step = s.first_step"):
                count, channels = (self._db.execute(f"SELECT count(*) FROM {table} WHERE scene = ?", (scene,)).fetchone()[0]
                                   for table in ("body", "channel"))
                if (bodies > robots or shown is not None and shown != 1 + _POSE_BYTES * count
                        or moved is not None and moved < _CHANNEL_BYTES * channels):
                    raise ValueError(f"robots, bodies or channels of scene {scene} are missing")
        self._info: Dict[str, Any] = meta
        self._whole = False  # its steps were counted

    def __repr__(self) -> str:
        return f"<coopdyn run {self.file}: {_list_of(self._names[:_NAMED_ROBOTS])}{' …' if len(self._names) > _NAMED_ROBOTS else ''}>"

    def __del__(self) -> None:
        db = getattr(self, "_db", None)
        if db is not None:
            db.close()

    @property
    def file(self) -> str:
        """The file's name."""
        return self._file

    @property
    def info(self) -> Dict[str, Any]:
        """Properties of the whole run: version, started, command, seed, mode, step_ns … (docs/formats.md)."""
        return dict(self._info)

    @property
    def scenario(self) -> str:
        """The text of the scenario."""
        with self._reading():
            row = self._db.execute("SELECT content FROM text WHERE kind = 'scenario'").fetchone()
        return str(row[0]) if row else ""

    @property
    def names(self) -> List[str]:
        """The names of all robots."""
        return list(self._names)

    @property
    def time(self) -> "array.array[float]":
        """Simulated times [s], k of them."""
        with self._reading():
            return array.array("d", [t / 1e9 for t in self._rows("time_ns")])

    @property
    def steps(self) -> "array.array[int]":
        """Numbers of the steps, k of them."""
        with self._reading():
            return array.array("q", self._rows("step"))

    @property
    def hash(self) -> List[str]:
        """The hash of the exact state at each moment, 16 hexadecimal digits: equal runs have equal hashes."""
        with self._reading():
            return [f"{h & 0xFFFFFFFFFFFFFFFF:016x}" for h in self._rows("hash")]

    @_usage('run.pose("robot1")')
    def pose(self, name: str) -> Rows:
        """x, y [m] and heading [rad] of a robot or a moving object, one row per moment."""
        flat = self._poses(name)
        k = len(flat) // 7
        out = array.array("d", bytes(24 * k))
        out[0::3], out[1::3] = flat[0::7], flat[1::7]
        out[2::3] = array.array("d", [math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
                                      for w, x, y, z in zip(flat[3::7], flat[4::7], flat[5::7], flat[6::7])])
        return Rows(out, 3, 0, (k, 3))

    @_usage('run.pose_3d("robot1")')
    def pose_3d(self, name: str) -> Rows:
        """x, y, z [m] and quaternion w, x, y, z in the world, one row per moment."""
        flat = self._poses(name)
        return Rows(flat, 7, 0, (len(flat) // 7, 7))

    @_usage('run.reading("robot1", "distances")')
    def reading(self, name: str, what: str) -> Rows:
        """A robot's readings, one row per moment: "distances" [m], right to left, inf = nothing there; "targets": distance [m]
        and bearing [rad] of each, nan = not seen; "channels": positions [rad], not wrapped, then velocities [rad/s] (sliding
        joints: [m], [m/s]) of the m channels in the order of `joints(name)`, 2m columns."""
        if what not in _RUN_READINGS:
            raise Error(4, f"there is no reading {what!r}; there are: {_list_of(_RUN_READINGS)}")
        places = self._robot_places(name)
        if what not in str(self._info.get("what", "")).split(","):
            raise Error(5, f"{what} were not recorded in {self.file}; record with --record-what all")
        if what == "distances":
            width = max(p.sensors for p in places)
            return self._readings(what, width, {p.scene: (4 * p.first_sensor, 4 * p.sensors) for p in places}, {})
        if what == "channels":
            slices = {p.scene: (_CHANNEL_BYTES * p.first_channel, _CHANNEL_BYTES * p.channels) for p in places}
            return self._readings(what, 2 * max(p.channels for p in places), slices, {})
        columns: Dict[int, List[int]] = {p.scene: [] for p in places}
        with self._reading():
            ids = sorted({i for (i,) in self._db.execute("SELECT DISTINCT id FROM target")})
            for scene, i in self._db.execute("SELECT scene, id FROM target ORDER BY scene, place"):
                if scene in columns:
                    columns[scene].append(ids.index(i))
        slices = {p.scene: (8 * len(columns[p.scene]) * p.robot, 8 * len(columns[p.scene])) for p in places}
        return self._readings(what, 2 * len(ids), slices, columns)

    @_usage('run.joints("robot1")')
    def joints(self, name: str) -> List[str]:
        """The names of the joints that a robot's m channels drive: the columns of its channels and commands."""
        most = max(self._robot_places(name), key=lambda p: p.channels)
        with self._reading():
            return [str(joint) for (joint,) in self._db.execute(
                "SELECT joint FROM channel WHERE scene = ? AND robot = ? ORDER BY place", (most.scene, most.robot))]

    @_usage('run.commands("robot1")')
    def commands(self, name: str) -> Rows:
        """The set-points of a robot, one row per change: the step of the change, time [s], the set-points of its m channels,
        and their control modes: 1 position [rad], 3 velocity [rad/s], 4 effort [N m] (0 idle, 2 direct), so 2 + 2m columns. The
        first row is in force at the recording's start. Error 5 if a loaded controller drove the robot and its commands were
        not recorded; commands of a client that took the robot over are recorded."""
        found = self._robot_places(name)
        places = {p.scene: range(p.first_channel, p.first_channel + p.channels) for p in found}
        m = max(p.channels for p in found)
        in_force = [math.nan] * (2 * m)
        out = array.array("d")
        with self._reading():
            self._count()
            controller = self._unrecorded_controller(name)
            unknown = bool(controller)
            for step, time_ns, scene, blob in self._db.execute(
                "SELECT step, time_ns, scene, commands FROM step WHERE step <= ? AND commands IS NOT NULL ORDER BY step",
                (self._last,),
            ):
                if len(blob) % _COMMAND_BYTES:
                    raise ValueError(f"the commands of step {step} do not add up")
                sent = [(i, at) for i, at in enumerate(_command_of(blob, c) for c in places.get(scene, ())) if at >= 0]
                for i, at in sent:
                    unknown = unknown and blob[at + 3] < 0x80  # until a client sends one
                    in_force[m + i], in_force[i] = struct.unpack_from("<Bd", blob, at + 4)
                if sent and not unknown:
                    out.extend((step, time_ns / 1e9, *in_force))
        if unknown:
            raise Error(5, f"the commands of {name}, driven by controller {controller}, were not recorded in {self.file}; "
                           f"record with --record-what {self._info.get('what', '')},controllers")
        width = 2 + len(in_force)
        return Rows(out, width, 0, (len(out) // width, width))

    @property
    def events(self) -> List[Event]:
        """All events in order, including notes."""
        with self._reading():
            count, ends = self._db.execute("SELECT count(*), (SELECT value FROM meta WHERE key = 'ends') FROM event").fetchone()
            if count < _end_of("event", ends):
                raise ValueError("events are missing")
            return [Event(int(step), time_ns / 1e9, str(level), str(text)) for step, time_ns, level, text in
                    self._db.execute("SELECT step, time_ns, level, text FROM event WHERE step <= ? ORDER BY id", (self._last,))]

    @_usage('run.score("distance")')
    def score(self, name: str) -> Rows:
        """Time [s] and value of a score, one row per moment, k x 2; nan: undefined."""
        known = self._score_names()
        if name not in known:
            raise Error(10, f"{self.file} has no score {name}" + (f"; there are {', '.join(known)}" if known else ""))
        at = _SCORE_BYTES * known.index(name)
        out = array.array("d")
        with self._reading():
            for time_ns, blob in zip(self._rows("time_ns"), self._rows("scores")):
                out.extend((time_ns / 1e9, struct.unpack_from("<d", blob, at)[0]))
        return Rows(out, 2, 0, (len(out) // 2, 2))

    def scores(self) -> Dict[str, float]:
        """The scores at the last moment, by the names of the scenario's [SCORE_n]; nan: undefined."""
        with self._reading():
            names = self._score_names()
            last = self._rows("scores")[-1] if names else b""
            return {name: struct.unpack_from("<d", last, _SCORE_BYTES * i)[0] for i, name in enumerate(names)}

    @_usage('run.logged("energy")')
    def logged(self, name: str) -> Rows:
        """Time [s] and value of each number logged under a name, n x 2."""
        numbers = [(e.time, e.text.partition(" ")) for e in self.events if e.level == "log"]
        out = array.array("d", [x for time, (one, _, value) in numbers if one == name for x in (time, float(value))])
        if not out:
            known = sorted({one for _, (one, _, _) in numbers})
            raise Error(10, f"{self.file} has no numbers logged under {name}" + (f"; there are {', '.join(known)}" if known else ""))
        return Rows(out, 2, 0, (len(out) // 2, 2))

    # --- inside ---
    @contextlib.contextmanager
    def _reading(self) -> Iterator[None]:
        """Turns exceptions caused by inconsistent data of the file into Error."""
        import sqlite3

        try:
            yield
        except (sqlite3.Error, ValueError, TypeError, KeyError, IndexError, OverflowError, struct.error) as e:
            raise Error(7, f"{self.file} is damaged ({e}); `coopdyn info {self.file}` says what can be read") from None

    def _count(self) -> None:
        """Raises Error 7 if steps or poses are missing that were not lost while recording, as a damaged page may hide them."""
        if self._whole:
            return
        every = int(self._info.get("pose_every_ns", 0))
        rows, first, last = 0, 0, -1
        shown: Optional[int] = None  # the time of the newest row with poses
        of_file: List[Any] = [None] * 4
        for step, time_ns, has_poses, *of_file in self._db.execute(
            "SELECT step, time_ns, poses IS NOT NULL, (SELECT min(first_step) FROM scene), "
            "(SELECT sum(CASE key WHEN 'lost' THEN value ELSE -value END) FROM meta WHERE key IN ('lost', 'lost_after')), "
            "(SELECT value FROM meta WHERE key = 'last_step'), (SELECT value FROM meta WHERE key = 'ends') FROM step ORDER BY step"
        ):
            if step <= last:
                raise ValueError(f"step {step} comes after step {last}")
            if not has_poses and (every <= 0 or shown is None or time_ns // every != shown // every):
                raise ValueError(f"the poses of step {step} are missing")
            first, last, rows = step if rows == 0 else first, step, rows + 1
            shown = time_ns if has_poses else shown
        begin, lost, last_step, ends = of_file
        if (rows < last - first + 1 - int(lost or 0) or last < _end_of("step", ends) or begin is not None and first > begin
                or last_step is not None and last != last_step):
            raise ValueError("steps are missing")
        self._whole = True

    def _rows(self, column: str) -> List[Any]:
        self._count()
        return [value for (value,) in self._db.execute(
            f"SELECT {column} FROM step WHERE step <= ? AND poses IS NOT NULL ORDER BY step", (self._last,))]

    def _score_names(self) -> List[str]:
        return [one.split(" ")[0] for one in str(self._info.get("scores", "")).split(", ") if one]

    def _places(self, name: str) -> List[_Place]:
        """The indices of `name` in each scene that has it."""
        with self._reading():
            channel = "FROM channel AS c WHERE c.scene = a.scene AND c.robot = a.place"
            found = [_Place(scene, body, place, (px, py, pz), (qw, qx, qy, qz), before or 0, sensors, first or 0, channels)
                     for scene, place, body, px, py, pz, qw, qx, qy, qz, sensors, before, first, channels in self._db.execute(
                         "SELECT scene, place, body, p_x, p_y, p_z, q_w, q_x, q_y, q_z, sensors, (SELECT sum(b.sensors) "
                         "FROM robot AS b WHERE b.scene = a.scene AND b.place < a.place), "
                         f"(SELECT min(c.place) {channel}), (SELECT count(*) {channel}) FROM robot AS a WHERE name = ? "
                         "ORDER BY scene", (name,))]
            if not found:
                found = [_Place(scene, place, -1, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), 0, 0) for scene, place in
                         self._db.execute("SELECT scene, place FROM body WHERE name = ? ORDER BY scene", (name,))]
            for p in found:
                for number in (p.scene, p.body, p.first_sensor, p.sensors, p.first_channel):
                    if not isinstance(number, int) or not 0 <= number < 2**31:
                        raise ValueError(f"the place of {name} is no number that can be")
                if not math.isfinite(sum(p.p_BR) + sum(p.q_BR)):
                    raise ValueError(f"the frame of {name} is no pose")
        if not found:
            with self._reading():
                known = self._names + [str(o) for (o,) in self._db.execute(
                    "SELECT name FROM body WHERE robot IS NULL GROUP BY name ORDER BY min(scene), place")]
            raise Error(10, f"there is no {name!r} in {self.file}; {_nearest(str(name), known)}there are: {_list_of(known)}")
        return found

    def _robot_places(self, name: str) -> List[_Place]:
        places = self._places(name)
        if places[0].robot < 0:
            raise Error(10, f"{name} is no robot; there are: {_list_of(self._names)}")
        return places

    def _unrecorded_controller(self, name: str) -> str:
        """The loaded controller of a robot, if controllers' commands were not recorded; else empty."""
        if "controllers" in str(self._info.get("what", "")).split(","):
            return ""
        for number, kind, scene in self._db.execute(
            "SELECT robot.id, type, description FROM robot JOIN scene ON scene.id = robot.scene WHERE name = ?", (name,)
        ):
            head = struct.pack("<II", number, number)
            for text in (name.encode(), kind.encode()):
                head += struct.pack("<I", len(text)) + text
            at = scene.find(head)
            if at < 0:
                continue
            at += len(head) + 81  # pose, colour, sync
            for _ in range(*struct.unpack_from("<I", scene, at)):  # modules waited for
                at += 4 + struct.unpack_from("<I", scene, at + 4)[0]
            at += 16  # their number, deadline, three words
            (size,) = struct.unpack_from("<I", scene, at)
            if size:
                return scene[at + 4 : at + 4 + size].decode()
        return ""

    def _slices(self, column: str, slices: Dict[int, Tuple[int, int]]) -> Iterator[Tuple[Any, ...]]:
        """For each moment: step, scene, length and first byte of a column, and its bytes selected by `slices` (first, count)
        of that scene."""
        self._count()
        values = ", ".join(f"({scene}, {first + 1}, {count})" for scene, (first, count) in slices.items())
        return self._db.execute(
            f"WITH part(scene, first, count) AS (VALUES {values}) SELECT step, scene, substr({column}, 1, 1), "
            f"substr({column}, first, count) FROM step LEFT JOIN part USING (scene) WHERE step <= ? AND poses IS NOT NULL "
            "ORDER BY step", (self._last,))

    def _poses(self, name: str) -> "array.array[float]":
        """Seven numbers per moment: x y z [m], quaternion w x y z."""
        places = {p.scene: p for p in self._places(name)}
        out = array.array("d")
        nowhere = (math.nan,) * 7
        with self._reading():
            for step, scene, first, raw in self._slices(
                    "poses", {p.scene: (1 + _POSE_BYTES * p.body, _POSE_BYTES) for p in places.values()}):
                if raw is None:
                    out.extend(nowhere)
                    continue
                if len(raw) != _POSE_BYTES or first[0] > 31:
                    raise ValueError(f"the poses of step {step} do not add up")
                place = places[scene]
                out.extend(_pose_from(raw, float(1 << first[0]), place.p_BR, place.q_BR))
        return out

    def _readings(self, what: str, width: int, slices: Dict[int, Tuple[int, int]], columns: Dict[int, List[int]]) -> Rows:
        """Rows of `width` numbers, padded with nan. `columns`: of pairs, by scene."""
        out, k = array.array("d"), 0
        nothing = (math.nan,) * width
        unpack = struct.Struct(f"<{width}f").unpack
        shifted = {scene: at for scene, at in columns.items() if at != list(range(width // 2))}
        with self._reading():
            for k, (step, scene, _, raw) in enumerate(self._slices(what, slices), 1):
                if raw is None:
                    out.extend(nothing)
                    continue
                if len(raw) != slices[scene][1]:
                    raise ValueError(f"the {what} of step {step} do not add up")
                if what == "channels":
                    starts = range(0, len(raw), _CHANNEL_BYTES)
                    fill = nothing[: width // 2 - len(starts)]  # in another scene it has more
                    out.extend(_POSITION_UNIT * int.from_bytes(raw[at : at + 5], "little", signed=True) for at in starts)
                    out.extend(fill)
                    out.extend(struct.unpack_from("<f", raw, at + 5)[0] for at in starts)
                    out.extend(fill)
                elif scene in shifted:  # another scene has other targets
                    row = list(nothing)
                    for at, pair in zip(shifted[scene], struct.iter_unpack("<2f", raw)):
                        row[2 * at : 2 * at + 2] = pair
                    out.extend(row)
                elif len(raw) == 4 * width:
                    out.extend(unpack(raw))
                else:  # in another scene it has more
                    out.extend(struct.unpack(f"<{len(raw) // 4}f", raw) + nothing[len(raw) // 4 :])
        return Rows(out, width, 0, (k, width))


def _end_of(table: str, ends: Any) -> int:
    """The number of a table's last row, from `ends` of table meta: "step 1200 34, event 3 78"."""
    return int(dict(part.split(" ")[:2] for part in str(ends or "").split(", ") if part).get(table, 0))


_TURN_SCALE = math.sqrt(2) * (2**19 - 1)  # of the components of a quaternion
_POSITION_UNIT = 1e-5  # rad or m


def _command_of(blob: bytes, channel: int) -> int:
    """The offset of a channel's command in the commands of a step; -1: none."""
    key = struct.pack("<I", channel)
    at = blob.find(key[:3])
    while at >= 0 and (at % _COMMAND_BYTES or blob[at + 3] & 0x7F != key[3]):
        at = blob.find(key[:3], at + 1)
    return at


def _pose_from(
    raw: bytes, unit: float, p_BR: Tuple[float, float, float], q_BR: Tuple[float, float, float, float]
) -> Tuple[float, ...]:
    """The pose of R, x y z [m], quaternion w x y z, from the 18 bytes of its body's pose, positions in units of `unit` µm
    (server/state/pose_codec.h)."""
    n = int.from_bytes(raw, "little")
    px = ((n & 0x7FFFFFF ^ 0x4000000) - 0x4000000) * unit / 1e6
    py = ((n >> 27 & 0x7FFFFFF ^ 0x4000000) - 0x4000000) * unit / 1e6
    pz = ((n >> 54 & 0x7FFFFFF ^ 0x4000000) - 0x4000000) * unit / 1e6
    a = ((n >> 81 & 0xFFFFF ^ 0x80000) - 0x80000) / _TURN_SCALE
    b = ((n >> 101 & 0xFFFFF ^ 0x80000) - 0x80000) / _TURN_SCALE
    c = ((n >> 121 & 0xFFFFF ^ 0x80000) - 0x80000) / _TURN_SCALE
    square = a * a + b * b + c * c
    largest = math.sqrt(max(0.0, 1 - square))
    norm = math.sqrt(square + largest * largest)
    a, b, c, largest = a / norm, b / norm, c / norm, largest / norm
    left_out = n >> 141 & 3
    if left_out == 0:
        w, x, y, z = largest, a, b, c
    elif left_out == 1:
        w, x, y, z = a, largest, b, c
    elif left_out == 2:
        w, x, y, z = a, b, largest, c
    else:
        w, x, y, z = a, b, c, largest
    ux, uy, uz = p_BR
    if ux or uy or uz:
        tx, ty, tz = 2 * (y * uz - z * uy), 2 * (z * ux - x * uz), 2 * (x * uy - y * ux)
        px += ux + w * tx + (y * tz - z * ty)
        py += uy + w * ty + (z * tx - x * tz)
        pz += uz + w * tz + (x * ty - y * tx)
    rw, rx, ry, rz = q_BR
    if rx or ry or rz:
        w, x, y, z = (w * rw - x * rx - y * ry - z * rz, w * rx + x * rw + y * rz - z * ry,
                      w * ry - x * rz + y * rw + z * rx, w * rz + x * ry - y * rx + z * rw)
    return px, py, pz, w, x, y, z


def _open_run(file: str) -> "sqlite3.Connection":
    """Opens the file as a read-only database, after checking that it is a recording."""
    import sqlite3

    if not os.path.isfile(file):
        raise Error(10, f"there is no file {file!r}; a recording is called NAME.run")
    if file.lower().endswith(".mat"):
        raise Error(7, f"{file} is a MAT file for MATLAB; read the recording itself, {file[:-4]}.run: "
                       'sim.fetch_run("NAME") downloads it')
    foreign = f"{file} is no recording of coopdyn (NAME.run)"
    cure = f"run `coopdyn info {file}`, which repairs the file after a crash if it can be written"
    waits = os.path.isfile(file + "-wal") and os.path.getsize(file + "-wal") > 0  # an unclosed recording
    url = "file:" + urllib.parse.quote(os.path.abspath(file)) + "?mode=ro"
    for how in ("", "&immutable=1"):  # the latter for read-only folders
        try:
            db = sqlite3.connect(url + how, uri=True)
        except sqlite3.Error as e:
            raise Error(5, f"cannot open {file}: {e}") from None
        try:
            tag = db.execute("PRAGMA application_id").fetchone()[0]
            if tag != _RUN_ID:
                raise Error(7, foreign)
            version = db.execute("PRAGMA user_version").fetchone()[0]
            if version < 1:
                raise Error(7, f"{file} is damaged: its format is {version}, not {_RUN_FORMAT}; {cure}")
            if version != _RUN_FORMAT:
                older = version < _RUN_FORMAT
                raise Error(5, f"{file} was recorded in format {version} by {'an older' if older else 'a newer'} coopdyn, this one "
                               f"reads {_RUN_FORMAT}: {'record it again' if older else 'get that version of coopdyn and its clients'}")
            db.execute("SELECT count(*) FROM meta")
            return db
        except BaseException as e:
            db.close()
            if isinstance(e, sqlite3.OperationalError) and not waits and not how:
                continue
            if isinstance(e, sqlite3.OperationalError):
                raise Error(5, f"cannot read {file} ({e}): {cure}") from None
            if isinstance(e, sqlite3.DatabaseError):
                raise Error(7, f"{foreign}, or it is damaged ({e}); {cure}") from None
            raise
    raise AssertionError("the second way returns or raises")


@_usage('coopdyn.read_run("lesson1.run")')
def read_run(file: Union[str, "os.PathLike[str]"]) -> Run:
    """Opens a recorded run, NAME.run, which may still be recorded or stem from a crashed daemon."""
    return Run(file)


# --- the command line -------------------------------------------------------------------------------------------------


@_usage('coopdyn.doctor() or coopdyn.doctor("labserver:10100")')
def doctor(
    server: Union[str, int, None] = None, token: Optional[str] = None, seat: Optional[str] = None, pin: Optional[str] = None
) -> bool:
    """Checks the connection from the server's name to a round trip; prints `ok`, or cause and cure, per line. True if all
    checks pass.
    `server`, `token`, `seat` and `pin` as in connect()."""

    def say(ok: bool, text: str) -> bool:
        print(f"{'ok   ' if ok else 'FAIL '} {text}", flush=True)
        return ok

    try:
        address = _Address(server, None, token, 3.0, seat, pin)
    except Error as e:
        return say(False, e.text)
    say(True, f"server: {address} (Python {sys.version.split()[0]}, coopdyn.py {__version__})")
    try:
        if address.port:
            found = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)
            say(True, f"name lookup: {address.host} is {_list_of(sorted({str(f[4][0]) for f in found}))}")
    except socket.gaierror:
        return say(False, f"name lookup: no machine is called {address.host!r}; write its address")
    way = str(address.port or address)
    try:
        address.dial_port(_clock.monotonic() + address.timeout).close()
        say(True, f"port: {way} is open")
        modules = address.modules()
        if address.seat:
            say(True, f"seat: {address.seat} is yours, by its PIN")
        ports = [m.port for m in modules if m.port]
        on = f" on ports {min(ports)} to {max(ports)}" if ports else ""
        say(True, f"names: {len(modules)} modules{on}; this client needs {way} only")
        sim = connect(server, token=token, seat=seat, pin=pin)
    except Error as e:
        return say(False, e.text)
    with sim:
        status = sim.status()
        say(True, f"versions: daemon {status.get('version')}, protocol {status.get('protocol')}")
        took = []
        for _ in range(50):
            start = _clock.perf_counter()
            sim._session.control(_GET_TIME)
            took.append(_clock.perf_counter() - start)
        say(True, f"round trip: {sorted(took)[25] * 1e6:.0f} us (median of 50), longest {max(took) * 1e6:.0f} us")
        say(True, f"time: {status['mode']}, {status['state']}, step {status['step']}, dt {status['step_s']} s")
        whose = [f"{r['name']} ({'driven by ' + str(r['owner']) if r.get('owner') else 'free'})" for r in status["robots"]]
        say(True, f"robots: {_list_of(whose)}")
        for awaited in sim.waiting():
            say(True, f"waiting for {awaited.robot} ({awaited.why}), {awaited.seconds:.1f} s")
    return True


def _hello(server: Optional[str]) -> None:
    with connect(server) as sim:
        r = sim.robot(1)
        for _ in range(100):
            r.set_velocity(0.1, 0.5)
            sim.step()
        p = r.get_pose()
        print(f"hello from {r.name}: at {p.x:.2f} {p.y:.2f} m, t = {sim.time:.2f} s")


def _main(arguments: Sequence[str]) -> int:
    usage = ("write: python3 coopdyn.py doctor [HOST[:PORT]]   or   python3 coopdyn.py hello [HOST[:PORT]]; in a class "
             "COOPDYN_SEAT=ana:7305 before it")
    if arguments and arguments[0] in ("-h", "--help", "help"):
        print(usage)
        return 0
    if not 1 <= len(arguments) <= 2 or arguments[0] not in ("doctor", "hello"):
        print(usage, file=sys.stderr)
        return 2
    server = arguments[1] if len(arguments) == 2 else None
    if arguments[0] == "doctor":
        return 0 if doctor(server) else 1
    try:
        _hello(server)
    except Error as e:
        print(f"coopdyn: {e.text}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
