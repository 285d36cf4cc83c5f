"""Costs of clients for other clients, one line each: subscribers and queues that are not read, pages, edits.

COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/burden.py [subscribers queues viewers edits]
For the first two, daemon and client are pinned to one core, so that one's work delays the other. Medians and ratios count.
"""
import base64
import contextlib
import fcntl
import os
import socket
import statistics
import struct
import sys
import termios
import threading
import time
import urllib.parse
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "daemon"), str(ROOT / "tests" / "bench")]
from harness import Daemon, frame, scenario, until  # noqa: E402
from measure import cpu_s  # noqa: E402

SUBSCRIBERS = 50
STEPS = 20_000
REPEATS = 5
PEERS = 10
REQUESTS = 100_000
EDITS = 200
SUBSCRIBE, SET_VELOCITY = 4, 11


def on_one_core():
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def cpu_per_step(daemon, client, steps=STEPS):
    """The daemon's CPU time per lockstep step of one client over a bare socket, in microseconds."""
    request = frame(SET_VELOCITY, (), (0.1, 0.2))
    sock = client.socket
    before = cpu_s(daemon.process.pid)
    for _ in range(steps):
        sock.send(request)
        size = struct.unpack("<I", sock.recv(4, socket.MSG_WAITALL))[0]
        sock.recv(size, socket.MSG_WAITALL)
    return 1e6 * (cpu_s(daemon.process.pid) - before) / steps


def subscribers():
    """CPU per step without subscribers, in the steps that fill the sockets of subscribers that never read, and with full ones."""
    on_one_core()
    for module in ("/robot1/pose", "/robot1/distance", "/robot2/distance", "/simulation"):
        with Daemon(scenario(2)) as daemon:
            daemon.text("/simulation").must("set_participants robot1")
            client = daemon.binary("/robot1/motors")
            cpu_per_step(daemon, client)
            alone = statistics.median(cpu_per_step(daemon, client) for _ in range(REPEATS))
            for _ in range(SUBSCRIBERS):
                deaf = daemon.binary(module)
                deaf.send(SUBSCRIBE)  # nothing is read from now on
            first = cpu_per_step(daemon, client)
            full = statistics.median(cpu_per_step(daemon, client) for _ in range(REPEATS))
        print(f"{SUBSCRIBERS} subscribers of {module} that never read: {alone:.1f} us of CPU per step without, {first:.1f} in "
              f"the first {STEPS} steps with, then {full:.1f} ({100 * (full / alone - 1):+.1f} %)", flush=True)


def cpu_and_worst_answer(daemon, busy):
    """CPU seconds of the daemon, seconds, and the longest wait of a client for a reply [ms], during busy()."""
    begin, used, worst = time.monotonic(), cpu_s(daemon.process.pid), 0.0
    bystander = daemon.text("/simulation")
    while True:
        asked = time.monotonic()
        bystander.must("get_time")
        worst = max(worst, time.monotonic() - asked)
        if not busy():
            return cpu_s(daemon.process.pid) - used, time.monotonic() - begin, 1000 * worst
        time.sleep(0.002)


def queue(sock, lines):
    """Sends until the socket is full."""
    sock.settimeout(0.3)
    left = memoryview(lines)
    try:
        while left:
            left = left[sock.send(left):]
    except TimeoutError:
        pass
    before = -1
    while (now := struct.unpack("i", fcntl.ioctl(sock, termios.TIOCOUTQ, b"\0" * 4))[0]) != before:
        before = now
        time.sleep(0.1)


def read_answers(sock, count):
    sock.settimeout(None)
    while count > 0:
        count -= sock.recv(1 << 20).count(b"\n")


def queues():
    """Ten peers queue get_status: first peers that then disconnect, then peers that read all replies."""
    on_one_core()
    with Daemon(scenario(1)) as daemon:
        port = daemon.module_port("/simulation")
        files = daemon.open_files()
        used = cpu_s(daemon.process.pid)
        peers = [socket.create_connection(("127.0.0.1", port)) for _ in range(PEERS)]
        for peer in peers:
            queue(peer, b"get_status\n" * REQUESTS)
        queued = cpu_s(daemon.process.pid) - used
        for peer in peers:
            peer.close()
        used, seconds, worst = cpu_and_worst_answer(daemon, lambda: daemon.open_files() > files + 1)
        print(f"{PEERS} peers queue {REQUESTS} get_status each and are gone: {queued:.1f} CPU-s before their end and "
              f"{used:.1f} in {seconds:.1f} s after it; another's get_time took at most {worst:.0f} ms", flush=True)
        peers = [socket.create_connection(("127.0.0.1", port)) for _ in range(PEERS)]
        readers = [threading.Thread(target=read_answers, args=(peer, REQUESTS // 10)) for peer in peers]
        for peer, reader in zip(peers, readers):
            queue(peer, b"get_status\n" * (REQUESTS // 10))
            reader.start()
        used, seconds, worst = cpu_and_worst_answer(daemon, lambda: any(reader.is_alive() for reader in readers))
        print(f"{PEERS} peers queue {REQUESTS // 10} get_status each and read: {used:.1f} CPU-s in {seconds:.1f} s; "
              f"another's get_time took at most {worst:.0f} ms", flush=True)
        for peer in peers:
            peer.close()


def viewer(url):
    """A WebSocket that requests poses, as a page does; counts the received bytes in its list."""
    place = urllib.parse.urlsplit(url)
    sock = socket.create_connection((place.hostname, place.port))
    key = base64.b64encode(os.urandom(16)).decode()
    sock.sendall(f"GET /ws HTTP/1.1\r\nHost: {place.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                 f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                 "Sec-WebSocket-Extensions: permessage-deflate\r\n\r\n".encode())
    ask = b'{"type":"poses","rate":30}'
    sock.sendall(bytes([0x81, 0x80 | len(ask)]) + bytes(4) + ask)  # masked with zeros
    came = [0]

    def read():
        with contextlib.suppress(OSError):
            while data := sock.recv(1 << 16):
                came[0] += len(data)
    threading.Thread(target=read, daemon=True).start()
    return sock, came


def viewers():
    """Steps per second of 100 robots without and with ten pages, and the bytes sent to a page."""
    with Daemon(None, "--mode", "lockstep", "--paused", "--http", name="diffuse100") as daemon:
        simulation = daemon.text("/simulation")

        def seconds(steps=STEPS):
            begin = time.monotonic()
            simulation.must(f"step {steps}")
            return time.monotonic() - begin
        seconds(1000)
        ratios, rates = [], []
        for _ in range(REPEATS):
            alone = seconds()
            pages = [viewer(daemon.http) for _ in range(PEERS)]
            until(lambda: all(came[0] for _, came in pages), "the pages get their first poses")
            before = sum(came[0] for _, came in pages)
            busy = seconds()
            ratios.append(alone / busy)
            rates.append((sum(came[0] for _, came in pages) - before) / busy / PEERS)
            for sock, _ in pages:
                sock.shutdown(socket.SHUT_RDWR)
                sock.close()
        print(f"{PEERS} pages with poses at 30 Hz: steps/s with them / without {min(ratios):.3f} to {max(ratios):.3f}, "
              f"median {statistics.median(ratios):.3f}; {statistics.median(rates) / 1000:.1f} kB/s each", flush=True)


def edits():
    """Milliseconds from request to reply of edits in a world of 1,000 boxes."""
    boxes = "".join(f"[B_{i}]\ntype box\nsize 0.4 0.4 0.4\nposition {2 * (i % 32) - 32} {2 * (i // 32) - 32}\nmass 1\n"
                    for i in range(1000))
    with Daemon("[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 200 200\n" + boxes, "--no-render", "--paused") as daemon:
        world = daemon.text("/world")
        for what, line in (("set_pose", "set_pose B_5 {0} 60 0.2"),
                           ("insert", "insert [N_{1}] type box | size 0.4 0.4 0.4 | position {0} 70 | mass 1")):
            times = []
            for k in range(EDITS):
                begin = time.perf_counter()
                world.must(line.format(k / 2 - 50, k))
                times.append(1000 * (time.perf_counter() - begin))
            times.sort()
            print(f"{what} in 1,000 boxes: median {statistics.median(times):.2f} ms, nine of ten within "
                  f"{times[9 * EDITS // 10]:.2f} ms of {EDITS}", flush=True)


if __name__ == "__main__":
    parts = {"subscribers": subscribers, "queues": queues, "viewers": viewers, "edits": edits}
    for name in sys.argv[1:] or parts:
        parts[name]()
