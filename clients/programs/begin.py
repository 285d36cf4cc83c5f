# SPDX-License-Identifier: MIT
"""The first program in the box: begin.py DESCRIPTOR SOCKET WORDS…. Listens at SOCKET, by which the student's program reaches its
simulation, sends that out of the box through DESCRIPTOR, waits until the simulation answers, and goes on as WORDS."""
import contextlib
import os
import resource
import socket
import sys

kWaiting = 64  # connections
kStart_s = 20  # for a simulation that has to start: at the beginning of a class all of them do at once
kLessOfTheProcessors = 10
kFiles = 256  # open at the same time


def main():
    with socket.socket(fileno=int(sys.argv[1])) as out, socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as door:
        door.bind(sys.argv[2])
        door.listen(kWaiting)
        socket.send_fds(out, [b"L"], [door.fileno()])
    with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(kStart_s)
        probe.connect(sys.argv[2])
        probe.sendall(b"NAME_SERVER list\n")
        probe.recv(1)
    os.nice(kLessOfTheProcessors)
    resource.setrlimit(resource.RLIMIT_NOFILE, (kFiles, kFiles))
    os.execvp(sys.argv[3], sys.argv[3:])


if __name__ == "__main__":
    main()
