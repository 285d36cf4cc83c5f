# SPDX-License-Identifier: MIT
"""Writes recordings by hand, from docs/formats.md, for tests of their readers: python3 run_file.py FILE (a sample)."""
import math
import sqlite3
import struct
import sys

SCHEMA = """
CREATE TABLE meta(key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE text(kind TEXT, name TEXT, file TEXT, content TEXT, PRIMARY KEY(kind, name)) WITHOUT ROWID;
CREATE TABLE scene(id INTEGER PRIMARY KEY, first_step INTEGER, description BLOB);
CREATE TABLE body(scene, place, id, name, robot, PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE robot(scene, place, id, name, type, body, p_x, p_y, p_z, q_w, q_x, q_y, q_z, sensors,
                   PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE channel(scene, place, robot, module, joint, PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE target(scene, place, id, color, x, y, z, PRIMARY KEY(scene, place)) WITHOUT ROWID;
CREATE TABLE step(step INTEGER PRIMARY KEY, time_ns INTEGER, hash INTEGER, scene INTEGER, commands BLOB, messages BLOB,
                  channels BLOB, distances BLOB, targets BLOB, poses BLOB);
CREATE TABLE keyframe(step INTEGER PRIMARY KEY, state BLOB);
CREATE TABLE input(id INTEGER PRIMARY KEY, step, action TEXT, detail TEXT);
CREATE TABLE event(id INTEGER PRIMARY KEY, step, time_ns, level TEXT, text TEXT);
"""
META = {"version": "0.9", "build": "0" * 16, "cpu": "a processor", "started": "2026-01-02T03:04:05Z",
        "command": "coopdyn serve two", "scenario_name": "two", "scenario_file": "two.scenario", "scenario_seed": "3",
        "seed": "18446744073709551615", "mode": "lockstep", "step_ns": 10_000_000, "substeps": 1,
        "what": "poses,channels,distances,targets,controllers", "pose_every_ns": 0, "closed": 1, "lost": 0}
IDENTITY = (1.0, 0.0, 0.0, 0.0)
COMPONENT = math.sqrt(2) * (2**19 - 1)


def pose_bytes(x, y, z, q, e=0, frozen=False):
    """18 bytes: position in units of 2^e µm, the quaternion without its largest component."""
    number = 0
    for k, metres in enumerate((x, y, z)):
        number |= (round(metres / (1e-6 * 2**e)) & (2**27 - 1)) << 27 * k
    left_out = max(range(4), key=lambda i: abs(q[i]))
    sign = 1 if q[left_out] >= 0 else -1
    for k, i in enumerate(i for i in range(4) if i != left_out):
        number |= (round(sign * q[i] * COMPONENT) & (2**20 - 1)) << 81 + 20 * k
    return (number | left_out << 141 | frozen << 143).to_bytes(18, "little")


def poses_blob(poses, e=0):
    return bytes([e]) + b"".join(pose_bytes(*p, q, e) for p, q in poses)


def commands_blob(*commands):
    """Commands (robot, by client, left, right): velocities, or in the modes that follow."""
    return b"".join(struct.pack("<IBd", 2 * robot + side | by_client << 31, ([*rest, 3, 3])[2 + side], rest[side])
                    for robot, by_client, *rest in commands for side in range(2))


def channels_blob(*robots):
    """Robots (position left, right, velocity left, right)."""
    return b"".join(round(r[side] / 1e-5).to_bytes(5, "little", signed=True) + struct.pack("<f", r[2 + side])
                    for r in robots for side in range(2))


def floats_blob(*values):
    return struct.pack(f"<{len(values)}f", *values)


def create(path, application_id=0x434F4F50, user_version=2, **meta):
    """An empty recording, open; WAL as while recording."""
    db = sqlite3.connect(path, isolation_level=None)
    db.execute("PRAGMA page_size = 32768")
    db.execute("PRAGMA journal_mode = WAL")
    db.execute("PRAGMA synchronous = OFF")
    db.execute(f"PRAGMA application_id = {application_id}")
    db.execute(f"PRAGMA user_version = {user_version}")
    db.executescript(SCHEMA)
    db.executemany("INSERT INTO meta VALUES (?, ?)", {**META, **meta}.items())
    return db


def close(db):
    db.execute("PRAGMA journal_mode = DELETE")
    db.close()


def add_scene(db, scene, first_step, bodies, robots, targets=()):
    """bodies: names; robots, of two wheels each: (name, first body, p_BR, q_BR, sensors); targets: colours."""
    db.execute("INSERT INTO scene VALUES (?, ?, x'')", (scene, first_step))
    for place, name in enumerate(bodies):
        owner = next((k for k, robot in enumerate(robots) if name.startswith(robot[0] + ".")), None)
        db.execute("INSERT INTO body VALUES (?, ?, ?, ?, ?)", (scene, place, place + 1, name, owner))
    for place, (name, body, p, q, sensors) in enumerate(robots):
        db.execute("INSERT INTO robot VALUES (?, ?, ?, ?, 'single', ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                   (scene, place, place + 1, name, body, *p, *q, sensors))
        for side, wheel in enumerate(("left", "right")):
            db.execute("INSERT INTO channel VALUES (?, ?, ?, 'motors', ?)",
                       (scene, 2 * place + side, place, wheel + "_wheel_joint"))
    for place, colour in enumerate(targets):
        db.execute("INSERT INTO target VALUES (?, ?, ?, ?, 1, 2, 0)", (scene, place, place + 1, colour))


def add_step(db, step, poses, scene=1, hash=0, commands=None, channels=None, distances=None, targets=None, dt_ns=10_000_000):
    db.execute("INSERT INTO step VALUES (?, ?, ?, ?, ?, NULL, ?, ?, ?, ?)",
               (step, step * dt_ns, hash, scene, commands, channels, distances, targets, poses))


def describe_robot(db, scene, place, name, controller, waits_for=("motors", "pose")):
    """The entry of one robot in the scene's description, after bytes of others."""
    def text(words):
        return struct.pack("<I", len(words)) + words.encode()

    raw = b"others" + struct.pack("<II", place + 1, place + 1) + text(name) + text("single") + struct.pack("<10dB", *range(10), 1)
    raw += struct.pack("<I", len(waits_for)) + b"".join(map(text, waits_for)) + struct.pack("<Bd3B", 1, 0.5, 2, 255, 1)
    db.execute("UPDATE scene SET description = ? WHERE id = ?", (raw + text(controller) + b"and so on", scene))


def write_controlled(path, what, *sent):
    """Robots a, and m with a loaded controller; m's commands by step: (from a client, left)."""
    db = create(path, what=what)
    add_scene(db, 1, 0, ["a.b", "m.b"], [(name, k, (0, 0, 0), IDENTITY, 0) for k, name in enumerate("am")])
    describe_robot(db, 1, 1, "m", "diffuse")
    for k, (by_client, left) in enumerate(sent):
        add_step(db, k, poses_blob([((0, 0, 0), IDENTITY)] * 2), commands=commands_blob((1, by_client, left, 0)))
    close(db)


def write_taken(path):
    """A recording without the controller's commands, in which a client takes m over."""
    write_controlled(path, "poses", (0, 0), (1, 2), (0, 3))


def write_sample(path):
    """Two robots over four steps; one moves, and has another body, sensors and targets in the second scene."""
    db = create(path)
    add_scene(db, 1, 0, ["a.chassis", "b.chassis"],
              [("a", 0, (0, 0, 0), IDENTITY, 2), ("b", 1, (0, 0, 0), IDENTITY, 1)], ["red"])
    add_scene(db, 2, 2, ["b.chassis"], [("b", 0, (1, 0, 0), IDENTITY, 3)], ["blue", "red"])
    db.execute("UPDATE target SET id = 3 - id WHERE scene = 2")  # columns are ordered by id
    for k in range(2):
        add_step(db, k, poses_blob([((5, k, 0), IDENTITY), ((6, k, 0), IDENTITY)]), distances=floats_blob(1, 2, 3),
                 targets=floats_blob(1, 2, 3, 4), commands=commands_blob((0, 1, 1, k), (1, 1, 2, k)))
    for k in range(2, 4):
        add_step(db, k, poses_blob([((7, k, 0), IDENTITY)]), scene=2, distances=floats_blob(7, 8, 9),
                 targets=floats_blob(5, 6, 7, 8), commands=commands_blob((0, 1, 3, k)), hash=-k)
    db.execute("INSERT INTO text VALUES ('scenario', 's', 's.scenario', '[FLOOR]')")
    db.execute("INSERT INTO event VALUES (1, 2, 20000000, 'note', 'b alone')")
    close(db)


if __name__ == "__main__":
    write_sample(sys.argv[1])
