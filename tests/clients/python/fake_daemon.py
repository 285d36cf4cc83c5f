# SPDX-License-Identifier: MIT
"""A small scripted daemon for behaviour that the real one never shows: silence, wrong versions, broken and dribbling replies, a
robot that refuses. It implements the name port, OPEN, the binary form, and enough of motors, distance, target, pose and
/simulation, with the rules of lockstep, to run whole client programs.

In a test: `with FakeDaemon(robots=2, mode=1) as d: coopdyn.connect(d.server)`. As a program it prints the same `ready`
line as the daemon: `python3 fake_daemon.py --robots 2 --mode lockstep`.
"""
from __future__ import annotations

import argparse
import difflib
import json
import math
import socket
import struct
import sys
import threading

import fake_sensors
from fake_runs import NAMES as RUNS, Runs
from fake_swarm import NAMES as SWARM, Robot, Swarm, encode

MODES = ("realtime", "lockstep", "free")
NAMES = {
    "common": {"ping": 0, "describe": 1, "ready": 2, "get_time": 3, "subscribe": 4, "unsubscribe": 5, "hello": 6,
               "claim": 7, "release": 8, "attach": 9},
    "motors": {"set_wheel_speeds": 10, "set_velocity": 11, "get_wheels": 12, "get_limits": 13, "stop": 14},
    "distance": {"get_distances": 20, "get_geometry": 21},
    "target": {"get_targets": 30, "get_target": 31, "get_robots": 32},
    "pose": {"get_pose": 40, "get_pose_3d": 41},
    "swarm": SWARM,
    "recorder": RUNS,
    "simulation": {"get_status": 100, "run": 101, "pause": 102, "step": 103, "reset": 104, "set_mode": 105,
                   "set_step": 106, "set_speed": 107, "load_scenario": 108, "quit": 109, "stop_all": 190,
                   "set_participants": 191, "reload": 192, "release_robot": 193},
}
FIRST = {"motors": 12, "distance": 20, "target": 30, "pose": 40}
TARGETS = ((1, "red", 2.0, 0.0), (2, "green", 0.0, 3.0))


class Connection:
    def __init__(self, daemon, sock):
        self.daemon, self.sock, self.client, self.attached, self.module, self.every = daemon, sock, "", [], "", {}
        self.write_lock = threading.Lock()

    def write(self, data):
        try:
            with self.write_lock:
                if self.daemon.dribble:
                    for i in range(len(data)):
                        self.sock.sendall(data[i : i + 1])
                else:
                    self.sock.sendall(data)
        except OSError:
            pass

    def close(self, notice=""):
        if notice:
            self.write(encode(0, notice, -1, (), self.daemon.clock()))
        try:
            self.sock.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


class FakeDaemon:
    """`refuse`: the robot whose commands are refused by error 4. `silent`: accepts connections and sends nothing. `says`: the
    answer to every line. `break_replies`: number of replies that are cut off in the middle, with their connections. `delay_s`:
    delay of replies to actuator commands in real time. `hold`: while true, requests for a pose are not answered. `page`: the
    daemon has a page. `seat`: it is a class with this seat, "ana:7305"; `entries` has the first line of each connection to it,
    and the next `seat_ends` connections end once the seat is taken. `path`: of a unix socket, instead of the port. `sensors`:
    robots also have those of fake_sensors. A client may set these, too: `load_scenario` with the text `!refuse=robot3`,
    `!delay_s=0.3` …"""

    def __init__(self, robots=1, mode=0, protocol=1, silent=False, says="", dribble=False, refuse="", delay_s=0.0, targets=TARGETS,
                 sensors=False, seat="", path=""):
        self.targets = targets
        self.kinds = {**{m: m for m in FIRST}, **(fake_sensors.MODULES if sensors else {})}  # types of modules, by name
        self.robots = [Robot(i + 1) for i in range(robots)]
        self.mode, self.protocol, self.silent, self.says = mode, protocol, silent, says
        self.dribble, self.refuse, self.delay_s, self.break_replies, self.hold = dribble, refuse, delay_s, 0, False
        self.dt, self.step, self.resets, self.state, self.stopping = 0.01, 0, 0, "running", False
        self.swarm, self.runs, self.page = Swarm(self), Runs(self), True
        self.seat, self.entries, self.seat_ends = seat, [], 0
        self.received = []  # (module, command, params, data) of every request
        self.lock = threading.Condition()
        self.connections = []
        if path:
            self.listener = socket.socket(socket.AF_UNIX)
            self.listener.bind(path)
            self.listener.listen(64)
            self.port, self.server = 0, f"unix:{path}"
        else:
            self.listener = socket.create_server(("127.0.0.1", 0), backlog=64)
            self.port = self.listener.getsockname()[1]
            self.server = f"127.0.0.1:{self.port}"
        self.threads = [threading.Thread(target=run, daemon=True) for run in (self._accept, self._pace)]
        for t in self.threads:
            t.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def stop(self):
        with self.lock:
            self.stopping = True
            self.lock.notify_all()
        try:
            self.listener.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.listener.close()
        for c in list(self.connections):
            c.close()
        for t in self.threads:
            t.join()

    # --- time ---
    def clock(self):
        return (self.step * self.dt, float(self.step))

    def _all_ready(self):
        return all(r.command is not None for r in self.robots)

    def _pace(self):
        with self.lock:
            while not self.stopping:
                if self.mode == 1:
                    self.lock.wait_for(lambda: self.stopping or self.mode != 1 or
                                       (self._all_ready() and self.state == "running"))
                    if self.stopping or self.mode != 1:
                        continue
                else:
                    self.lock.wait(self.dt)
                    if self.stopping or self.state != "running":
                        continue
                self._advance()

    def _advance(self):
        for r in self.robots:
            if r.command is not None:
                v, w, _ = r.command
                if v is not None:
                    r.v, r.w = v, w
                r.steps_left -= 1
                if r.steps_left <= 0:
                    r.command = None
            r.heading = math.remainder(r.heading + r.w * self.dt, 2 * math.pi)
            r.x += r.v * self.dt * math.cos(r.heading)
            r.y += r.v * self.dt * math.sin(r.heading)
        self.step += 1
        for c in self.connections:
            for reading, every in list(c.every.items()):
                if self.step % every == 0:
                    c.write(self._reading(c, reading, 0, -reading))
        self.lock.notify_all()

    def _wait_steps(self, n):
        """Waits for n steps; False after a reset."""
        last, resets = self.step + n, self.resets
        self.lock.wait_for(lambda: self.stopping or self.step >= last or self.resets != resets)
        return self.resets == resets

    # --- connections ---
    def _accept(self):
        while True:
            try:
                sock, _ = self.listener.accept()
            except OSError:
                return
            if self.port:
                sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection = Connection(self, sock)
            self.connections.append(connection)
            self.threads.append(threading.Thread(target=self._serve, args=(connection,), daemon=True))
            self.threads[-1].start()

    def _serve(self, c):
        file = c.sock.makefile("rb")
        try:
            self._talk(c, file)
        except (OSError, ValueError, struct.error):
            pass
        finally:
            with self.lock:
                for r in self.robots:
                    if r.owner is c:
                        r.owner = None
                c.every = {}
                self.lock.notify_all()
            file.close()
            c.sock.close()

    def _talk(self, c, file):
        line = file.readline().decode().strip()
        if self.silent:
            file.read()
            return
        if self.says:
            c.write(self.says.encode() + b"\r\n")
            return
        if line.startswith("GET "):
            return c.write(self.runs.page(line, file))
        if self.seat:
            self.entries.append(line)
            if not line.startswith("SEAT "):
                return c.write(b"error 12 this is a class: begin with SEAT NAME PIN\n")
            if line.split()[1:3] != self.seat.split(":"):
                return c.write(b"error 12 no seat with this PIN\n")
            line = file.readline().decode().strip()  # received together with the previous line
            c.write(b"ok\n")
            if self.seat_ends:
                self.seat_ends -= 1
                return
        elif line.startswith("SEAT "):
            c.write(b'*** refused: "SEAT" is not a request: help lists all\r\n*** end of message\r\n')
            line = file.readline().decode().strip()
        name = ""
        while name not in self.modules():
            if line.startswith("NAME_SERVER list"):
                for known in self.modules():
                    c.write(f"registration name {known} ip 127.0.0.1 port {self.port} type tcp\r\n".encode())
                c.write(b"*** end of message\r\n")
            name = line[5:] if line.startswith("OPEN ") else ""
            if name and name not in self.modules():
                near = difflib.get_close_matches(name, self.modules(), 1)
                hint = f"did you mean {near[0]}" if near else "list shows all"
                c.write(f"error 10 no such name {name}; {hint}\n".encode())
            if name not in self.modules():
                line = file.readline().decode()
                if not line:
                    return
                line = line.strip()
        c.write(b"ok\n")
        if file.read(4) != b"CDS1":
            return
        c.module = name
        while True:
            head = file.read(24)
            if len(head) < 24:
                return
            size, _, command, t, m, n = struct.unpack("<IiiIII", head)
            rest = file.read(size - 20)
            text = rest[:t].decode()
            params = struct.unpack_from(f"<{m}i", rest, t)
            data = struct.unpack_from(f"<{n}d", rest, t + 4 * m)
            with self.lock:
                self.received.append((name, command, params, data))
                reply = self._answer(c, name, command, text, params, data)
                if self.break_replies:
                    self.break_replies -= 1
                    c.write(reply[: len(reply) // 2])
                    return
                c.write(reply)

    def modules(self):
        return [f"/{r.name}/{m}" for r in self.robots for m in self.kinds] + ["/simulation", "/swarm", "/recorder"]

    # --- commands ---
    def _answer(self, c, name, command, text, params, data):
        if command == 40:
            self.lock.wait_for(lambda: self.stopping or not self.hold)
        robot = next((r for r in self.robots if name.startswith(f"/{r.name}/")), None)
        kind = name.rsplit("/", 1)[1]
        kind = self.kinds.get(kind, kind)
        if command == 0:
            return encode(0, "", 0, params, (*data, *self.clock()))
        if command == 1:
            commands = [{"name": k, "id": v} for k, v in {**NAMES["common"], **{**NAMES, **fake_sensors.NAMES}[kind]}.items()]
            return encode(0, json.dumps({"protocol": 1, "module": kind, "commands": commands}), 1, (), self.clock())
        if command == 6:
            c.client = text.split()[0]
            if kind == "motors" and robot.owner not in (None, c) and robot.owner.client == c.client:
                robot.owner.close(f"taken over by a new connection of {c.client}")
                robot.owner = c
            elif kind == "swarm":
                self.swarm.hello(c)
            return encode(0, "", 6, (), self.clock())
        if command == 9:
            c.attached = text.split()
            return encode(0, "", 9, (), self.clock())
        if command == 3:
            return self._step_reply(c, robot, 3)
        if command == 4:
            c.every[self._first(kind)] = params[0] if params else 1
            return encode(0, "", 4, (), self.clock())
        if kind == "motors" and command in (2, 7, 10, 11, 14):
            return self._drive(c, robot, command, params, data)
        if kind == "swarm":
            return self.swarm.answer(c, command, text, params, data)
        if kind == "recorder":
            return self.runs.answer(command, text)
        if command == 2:
            return self._step_reply(c, robot, 2) if self._wait_steps(params[0] if params else 1) else encode(5, "reset", 2)
        if kind == "simulation":
            return self._simulation(command, text, params, data)
        return self._reading(c, command, 0, command, text, params)

    def _drive(self, c, robot, command, params, data):
        if robot.owner not in (None, c):
            return encode(6, f"owned by {robot.owner.client or 'another client'}", command)
        robot.owner = c
        if command == 7:
            return encode(0, "", 7, (), self.clock())
        if self.refuse == robot.name and command != 2:
            return encode(4, "refused for the test", command)
        v, w = {11: data, 10: ((data[0] + data[1]) * 0.0375, (data[1] - data[0]) * 0.27) if len(data) == 2 else (), 14: (0.0, 0.0)}.get(
            command, (None, None))
        steps = params[0] if params else 1
        if self.mode != 1 and not params and command != 2:
            if self.delay_s:
                self.lock.wait(self.delay_s)
            robot.v, robot.w = v, w
            return self._step_reply(c, robot, command)
        robot.command, robot.steps_left = (v, w, c), steps
        self.lock.notify_all()
        if not self._wait_steps(steps):
            return encode(5, "reset", command)
        return self._step_reply(c, robot, command)

    def _simulation(self, command, text, params, data):
        if command == 100:
            awaiting = [{"robot": r.name, "why": "no client" if r.owner is None else f"no command from {r.owner.client}",
                         "seconds": 2.0} for r in self.robots if r.command is None] if self.mode == 1 else []
            status = {"version": "fake", "protocol": self.protocol, "mode": MODES[self.mode],
                      "state": "waiting" if awaiting and self.state == "running" else self.state, "step": self.step,
                      "time_s": self.step * self.dt, "step_s": self.dt, "hash": f"{self.step:016x}", "http": self.runs.url,
                      "robots": [{"name": r.name, "type": "fake", "owner": r.owner.client if r.owner else None,
                                  "modules": [{"name": f"/{r.name}/{m}", "type": kind, "port": 0} for m, kind in self.kinds.items()]}
                                 for r in self.robots], "awaiting": awaiting}
            return encode(0, json.dumps(status), 100, (), self.clock())
        if command == 101:
            self.state = "running"
        elif command == 102:
            self.state = "paused"
        elif command == 108 and text.startswith("!"):
            key, value = text[1:].split("=", 1)
            setattr(self, key, type(getattr(self, key))(float(value) if key != "refuse" else value))
        elif command in (104, 108, 192):
            self.step, self.resets = 0, self.resets + 1
            for i, r in enumerate(self.robots):
                r.place(i + 1)
        elif command == 105:
            self.mode = params[0]
        elif command == 106:
            self.dt = data[0]
        elif command == 193:
            for r in self.robots:
                if r.name == text and r.owner is not None:
                    r.owner.close("freed by the teacher")
                    r.owner = None
        self.lock.notify_all()
        return encode(0, "", command, (), self.clock())

    @staticmethod
    def _first(kind):
        return {**FIRST, **fake_sensors.FIRST}[kind]

    def _values(self, robot, reading, text="", params=(), module=""):
        def seen(x, y):
            dx, dy = x - robot.x, y - robot.y
            return [math.hypot(dx, dy), math.remainder(math.atan2(dy, dx) - robot.heading, 2 * math.pi)]

        if reading == 12:
            return "", (), [0.0, 0.0, robot.v, robot.v]
        if reading == 13:
            return "", (), [10.0, 0.075, 0.28]
        if reading == 20:
            return "", (), [math.inf] * 5 + [4.0 - robot.x] + [math.inf] * 5
        if reading == 21:
            return "", (), [x for i in range(11) for x in ((i - 5) * math.pi / 9, math.pi / 9, 4.0)]
        if reading == 30:
            return " ".join(t[1] for t in self.targets), [t[0] for t in self.targets], [v for t in self.targets for v in seen(t[2], t[3])]
        if reading == 31:
            fits = [seen(t[2], t[3]) for t in self.targets if t[1] == text or t[0] in params]
            return "", (), min(fits) if fits else None
        if reading == 32:
            others = [(i + 1, r) for i, r in enumerate(self.robots) if r is not robot]
            return " ".join(r.name for _, r in others), [i for i, _ in others], [v for _, r in others for v in seen(r.x, r.y)]
        if reading == 40:
            return "", (), [robot.x, robot.y, robot.heading, robot.v, robot.w]
        if reading == 41:
            h = robot.heading / 2
            return "", (), [robot.x, robot.y, 0.0, math.cos(h), 0.0, 0.0, math.sin(h), robot.v, 0.0, 0.0, 0.0, 0.0, robot.w]
        return fake_sensors.values(module, reading, params) or ("", (), None)

    def _reading(self, c, reading, error, command, text="", params=()):
        robot = next(r for r in self.robots if c.module.startswith(f"/{r.name}/"))
        words, ids, values = self._values(robot, reading, text, params, c.module)
        if values is None:
            return encode(10, f"there is no target {text or params}", command)
        step = fake_sensors.shown(reading, self.step)
        return encode(error, words, command, ids, (*values, step * self.dt, float(step)))

    def _step_reply(self, c, robot, command):
        params, data = [self.mode], []
        for module in c.attached:
            values = self._values(robot, self._first(self.kinds[module]))[2]
            params.append(len(values))
            data += values
        return encode(0, "", command, params, (*data, *self.clock()))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--robots", type=int, default=1)
    parser.add_argument("--mode", choices=MODES, default="realtime")
    parser.add_argument("--protocol", type=int, default=1)
    parser.add_argument("--silent", action="store_true")
    parser.add_argument("--says", default="")
    parser.add_argument("--dribble", action="store_true")
    parser.add_argument("--refuse", default="")
    parser.add_argument("--delay", type=float, default=0.0)
    parser.add_argument("--no-targets", action="store_true")
    parser.add_argument("--sensors", action="store_true")
    parser.add_argument("--seat", default="")
    parser.add_argument("--path", default="")
    a = parser.parse_args()
    targets = () if a.no_targets else TARGETS
    daemon = FakeDaemon(a.robots, MODES.index(a.mode), a.protocol, a.silent, a.says, a.dribble, a.refuse, a.delay, targets,
                         a.sensors, a.seat, a.path)
    print(f"ready names={daemon.server} http=off robots={a.robots}", flush=True)
    sys.stdin.read()  # until the parent process ends
    daemon.stop()


if __name__ == "__main__":
    main()
