# SPDX-License-Identifier: MIT
"""Exchanges of a YARS client with a channel, by UDP and by TCP: one datagram, or one send and one recv, for each.

    build/release/coopdyn serve experiment.xml --mode lockstep --no-render --no-http &
    python3 tests/bench/yars_exchanges.py 4500 [PID]

The first robot must be driven by clients. With the daemon's PID, also prints the daemon's processor time per exchange.
"""
import pathlib
import socket
import statistics
import struct
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "daemon"))
from yars_clients import Tcp, Udp, ints  # noqa: E402

COUNT = 20000
PORT = int(sys.argv[1])
PID = sys.argv[2] if len(sys.argv) > 2 else None


def daemon_s():
    if PID is None:
        return 0
    return sum(int(path.read_text().split()[0])
               for path in pathlib.Path(f"/proc/{PID}/task").glob("*/schedstat")) / 1e9


def text(words):
    return b"s" + struct.pack("<i", len(words)) + words


def measure(name, port, request, size):
    port.setblocking(True)
    times_s = []
    daemon, own = daemon_s(), time.process_time()
    for _ in range(COUNT):
        began = time.perf_counter()
        port.send(request)
        missing = size
        while missing > 0:
            missing -= len(port.recv(4096)) or sys.exit("the daemon closed the connection")
        times_s.append(time.perf_counter() - began)
    daemon, own = daemon_s() - daemon, time.process_time() - own
    times_s.sort()
    print(f"{name}: {COUNT / sum(times_s):.0f}/s, median {statistics.median(times_s) * 1e6:.1f} us, "
          f"90th percentile {times_s[COUNT * 9 // 10] * 1e6:.1f} us, 99th {times_s[COUNT * 99 // 100] * 1e6:.1f} us; "
          f"processor time of an exchange: client {own / COUNT * 1e6:.1f} us"
          + (f", daemon {daemon / COUNT * 1e6:.1f} us" if PID else ""))


udp = Udp(PORT)
motors = udp.handshake().count(300)
_, values = udp.step([0] * motors)
udp.socket.connect(udp.server)
measure("UDP", udp.socket, udp.step_request([0.1] * motors), 20 + 4 * len(values))
udp.ask(100, -1)

tcp = Tcp(PORT)
values = tcp.sensors()
measure("TCP", tcp.socket, text(b"ACTUATORS") + b"D" + struct.pack(f"<i{motors}d", motors, *[0.1] * motors)
        + text(b"SENSORS"), 5 + 8 * len(values))
tcp.close()
