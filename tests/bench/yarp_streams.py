# SPDX-License-Identifier: MIT
"""Readers of many YARP ports by tcp, in real time: lost samples, and the daemon's processor time per sample.

    COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/yarp_streams.py [ROBOTS] [SECONDS]
    COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/yarp_streams.py --board [JOINTS] [SECONDS]

Reads two ports of each robot, /R/pose/state:o and /R/motors/state:o, at 100 Hz. With --board, one robot has a control board of JOINTS
joints (40), whose ports state:o and stateExt:o are read at 1 kHz. Subtracts the cost of the same run without readers.
"""
import os
import pathlib
import selectors
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "daemon"))
from harness import Connection, Daemon  # noqa: E402
from yarp_ports import ACK, Reader, registration  # noqa: E402

board = "--board" in sys.argv
numbers = [word for word in sys.argv[1:] if word != "--board"]
count = int(numbers[0]) if numbers else 40 if board else 50
seconds = float(numbers[1]) if len(numbers) > 1 else 10


def comb(joints):
    """A robot fixed to the world, with a pendulum per joint."""
    teeth = "".join(f"""<link name="l{i}"><pose>{0.1 * i} 0 0.8 0 0 0</pose><inertial><mass>0.1</mass></inertial></link>
        <joint name="j{i}" type="revolute"><parent>base</parent><child>l{i}</child><axis><xyz>0 1 0</xyz>
        <limit><lower>-1</lower><upper>1</upper><effort>10</effort><velocity>3</velocity></limit></axis></joint>""" for i in range(joints))
    return f"""<sdf version="1.9"><model name="comb"><link name="base"><pose>0 0 1 0 0 0</pose></link>
        <joint name="stand" type="fixed"><parent>world</parent><child>base</child></joint>{teeth}</model></sdf>"""


def board_scenario(folder):
    model = pathlib.Path(folder) / "comb.sdf"
    model.write_text(comb(count))
    return f"[SIMULATION]\nmode realtime\nstep 0.001\n[ROBOT_1]\ntype {model}\nname comb\nposition 0 0 0\n"


def scenario():
    robots = count
    placed = "".join(f"[ROBOT_{i}]\ntype coopbot\nname robot{i}\nposition {i % 10} {i // 10} 0\n\n" for i in range(1, robots + 1))
    return f"[SIMULATION]\nmode realtime\nstep 0.01\n[FLOOR]\nsize 40 40 0.1\n\n{placed}"


def connect(daemon, port, number):
    """Makes our port send to a reader; returns the reader's connection."""
    reader = Reader(daemon, f"/reader{number}")
    admin = daemon.keep(Connection(registration(daemon, port)))
    admin.write(f'CONNACK admin\r\na\r\n[add] "tcp:/{reader.name}"\r\n')
    reader.answer_probe()
    accepted = reader.accept()
    accepted.read_hello()
    return accepted


def cpu_s(daemon):
    fields = pathlib.Path(f"/proc/{daemon.process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(reads):
    with tempfile.TemporaryDirectory() as folder, Daemon(board_scenario(folder) if board else scenario()) as daemon:
        connections = []
        if reads:
            ports = [f"/robot{i}/{module}/state:o" for i in range(1, count + 1) for module in ("pose", "motors")]
            if board:
                ports = ["/comb/joints/state:o", "/comb/joints/stateExt:o"]
            connections = [connect(daemon, port, number) for number, port in enumerate(ports)]
        waiting = selectors.DefaultSelector()
        for connection in connections:
            waiting.register(connection.socket, selectors.EVENT_READ, connection)
        samples, last = 0, {}
        lost = 0
        before, end = cpu_s(daemon), time.monotonic() + seconds
        while time.monotonic() < end:
            for key, _ in waiting.select(0.1):
                connection = key.data
                number = int(connection.read_sample(ACK)[0].split()[1])
                lost += number - last.get(connection, number - 1) - 1
                last[connection] = number
                samples += 1
        return samples, lost, cpu_s(daemon) - before


idle = run(False)[2]
samples, lost, cpu = run(True)
print(f"{2 if board else 2 * count} ports: {samples / seconds:.0f} samples/s, {lost} lost; {1e6 * (cpu - idle) / max(samples, 1):.1f} us of the "
      f"daemon's processor time each ({cpu / seconds:.3f} and {idle / seconds:.3f} of a core with and without readers)")
