# SPDX-License-Identifier: MIT
"""Round trips of `get_pose` by YARP's tcp carrier: with a pose module of the daemon, or with an echo server of YARP.

    COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/yarp_rpc.py HOST PORT
"""
import pathlib
import socket
import statistics
import struct
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "daemon"))
from yarp_test import ACK, HELLO, message  # noqa: E402

COUNT = 20000
port = socket.create_connection((sys.argv[1], int(sys.argv[2])))
port.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
port.sendall(HELLO)
port.recv(8)
request = message(b"d", struct.pack("<iii", 256 + 4, 1, 8) + b"get_pose")
times_s = []
for _ in range(COUNT):
    began = time.perf_counter()
    port.sendall(request)
    reply = b""
    while not reply.endswith(ACK):
        more = port.recv(4096)
        if not more:
            sys.exit("the port closed the connection: is it a YARP port?")
        reply += more
    times_s.append(time.perf_counter() - began)
print(f"{COUNT / sum(times_s):.0f}/s, median {statistics.median(times_s) * 1e6:.1f} us, "
      f"99th percentile {sorted(times_s)[COUNT * 99 // 100] * 1e6:.1f} us")
