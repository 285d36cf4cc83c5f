# SPDX-License-Identifier: MIT
"""Executes a program in a new network namespace that has only the loopback device: python3 netns.py root|user WORDS….

As `root` it stays root; as `user` it also creates a user namespace, in which it keeps its user."""
import ctypes
import fcntl
import os
import socket
import struct
import sys

kNewUser, kNewNet = 0x10000000, 0x40000000
kGetFlags, kSetFlags, kUp = 0x8913, 0x8914, 1


def put(path, text):
    with open(path, "w", encoding="ascii") as stream:
        stream.write(text)


def main():
    who, words = sys.argv[1], sys.argv[2:]
    user, group = os.geteuid(), os.getegid()
    if ctypes.CDLL(None, use_errno=True).unshare(kNewNet | (kNewUser if who == "user" else 0)) != 0:
        sys.exit(f"a network of its own cannot be made: {os.strerror(ctypes.get_errno())}")
    if who == "user":
        put("/proc/self/setgroups", "deny")
        put("/proc/self/uid_map", f"{user} {user} 1")
        put("/proc/self/gid_map", f"{group} {group} 1")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        request = struct.pack("16sh14x", b"lo", 0)
        flags = struct.unpack("16sh14x", fcntl.ioctl(probe, kGetFlags, request))[1]
        fcntl.ioctl(probe, kSetFlags, struct.pack("16sh14x", b"lo", flags | kUp))
    os.execvp(words[0], words)


if __name__ == "__main__":
    main()
