# SPDX-License-Identifier: MIT
"""/swarm of the scripted daemon: robots that one connection drives together."""
import struct

NAMES = {"step_all": 110, "select_readings": 111, "read_all": 112, "get_team": 113, "stop_team": 114}
COLUMNS = {"pose": 3, "distances": 11, "targets": 4, "neighbours": 3, "wheels": 4}
READS = {"pose": 40, "distances": 20, "targets": 30, "wheels": 12}


def encode(error, text, command, params=(), data=()):
    raw = text.encode()
    return struct.pack(f"<IiiIII{len(raw)}s{len(params)}i{len(data)}d", 20 + len(raw) + 4 * len(params) + 8 * len(data),
                       error, command, len(raw), len(params), len(data), raw, *params, *data)


class Robot:
    def __init__(self, number):
        self.name = f"robot{number}"
        self.owner = None
        self.command = None  # (v, w, connection): for the next step; v None = ready
        self.steps_left = 0
        self.place(number)

    def place(self, number):
        self.x, self.y, self.heading, self.v, self.w = 0.0, 1.0 * (number - 1), 0.0, 0.0, 0.0
        self.command = None


class Swarm:
    """FakeDaemon's module /swarm; called with FakeDaemon's lock held."""

    def __init__(self, daemon):
        self.daemon = daemon
        self.selected = {}  # by connection

    def hello(self, c):
        """Closes an older connection of the same name; the new one takes over its robots."""
        for old in list(self.daemon.connections):
            if old is not c and old.module == c.module and old.client == c.client:
                for robot in self.daemon.robots:
                    if robot.owner is old:
                        robot.owner = c
                old.close(f"taken over by a new connection of {c.client}")

    def answer(self, c, command, text, params, data):
        team = [r for r in self.daemon.robots if r.owner is c]
        if command == 2:
            return self._ready(c, team, params[0] if params else 1)
        if command == 7:
            names = text.split()
            chosen = [r for r in self.daemon.robots if (r.name in names if names else r.owner in (None, c))]
            for r in chosen:
                if r.owner not in (None, c):
                    return encode(6, f"{r.name} is owned by {r.owner.client}", 7)
            for r in chosen:
                r.owner = c
            return self._team(c, 7)
        if command == 8:
            for r in team:
                r.owner = None
            return self._team(c, 8)
        if command == 111:
            for word in text.split():
                if word not in COLUMNS:
                    return encode(2, f"there is no reading {word}", 111)
            self.selected[c] = text.split() or ["pose", "distances"]
            return encode(0, " ".join(self.selected[c]), 111, [COLUMNS[w] for w in self.selected[c]], self.daemon.clock())
        if command == 113:
            return self._team(c, 113)
        if command == 114:
            for r in team:
                r.v = r.w = 0.0
            return encode(0, "", 114, (), self.daemon.clock())
        if command == 110:
            return self._step(c, team, data)
        return self._table(c, command) if command == 112 else encode(1, "unknown", command)

    def _team(self, c, command):
        team = [(i + 1, r.name) for i, r in enumerate(self.daemon.robots) if r.owner is c]
        return encode(0, " ".join(n for _, n in team), command, [i for i, _ in team], self.daemon.clock())

    def _ready(self, c, team, steps):
        for r in team:
            r.command, r.steps_left = (None, None, c), steps
        self.daemon.lock.notify_all()
        if not self.daemon._wait_steps(steps):
            return encode(5, "reset", 2)
        return encode(0, "", 2, (self.daemon.mode,), self.daemon.clock())

    def _step(self, c, team, data):
        if len(data) not in (0, 2 * len(team)):
            return encode(3, f"{len(data)} numbers for {len(team)} robots", 110)
        if self.daemon.refuse in [r.name for r in team]:
            return encode(4, f"{self.daemon.refuse} is refused for the test", 110)
        for k, r in enumerate(team):
            v, w = data[2 * k : 2 * k + 2] if data else (None, None)
            r.command, r.steps_left = (v, w, c), 1
        self.daemon.lock.notify_all()
        if not self.daemon._wait_steps(1):
            return encode(5, "reset", 110)
        return self._table(c, 110)

    def _table(self, c, command):
        team = [r for r in self.daemon.robots if r.owner is c]
        words, rows = self.selected.get(c, ["pose", "distances"]), []
        for r in team:
            for word in words:
                rows += self.daemon._values(r, READS[word])[2][: COLUMNS[word]]
        m = sum(COLUMNS[w] for w in words)
        return encode(0, "", command, (self.daemon.mode, len(team), m), (*rows, *self.daemon.clock()))
