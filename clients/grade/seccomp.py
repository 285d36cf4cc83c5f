# SPDX-License-Identifier: MIT
"""The system calls that the sandbox refuses: those that allocate memory outside a process's limits, and some that only attacks need. A
kernel filter (seccomp(2), classic BPF), for bubblewrap's --seccomp."""
import errno
import os
import struct

kLoad, kIfEqual, kIfLeast, kReturn = 0x20, 0x15, 0x35, 0x06
kNumber_at, kArchitecture_at = 0, 4
kAllow, kRefuse = 0x7FFF0000, 0x00050000 | errno.EPERM
kX32 = 0x40000000  # numbers of a second set of calls on x86-64

# AUDIT_ARCH_…, and the numbers of the calls there.
kMachines = {
    "x86_64": (0xC000003E, {"shmget": 29, "add_key": 248, "request_key": 249, "keyctl": 250, "perf_event_open": 298, "memfd_create": 319, "bpf": 321,
                            "userfaultfd": 323, "io_uring_setup": 425, "memfd_secret": 447}),
    "aarch64": (0xC00000B7, {"shmget": 194, "add_key": 217, "request_key": 218, "keyctl": 219, "perf_event_open": 241, "memfd_create": 279, "bpf": 280,
                             "userfaultfd": 282, "io_uring_setup": 425, "memfd_secret": 447}),
}


def step(code, value, then=0, otherwise=0):
    return struct.pack("=HBBI", code, then, otherwise, value)


def program():
    """The filter for this machine; empty if its architecture is unknown here."""
    if os.uname().machine not in kMachines:
        return b""
    architecture, calls = kMachines[os.uname().machine]
    numbers = sorted(calls.values())
    checks = [step(kIfLeast, kX32, len(numbers) + 1)]
    checks += [step(kIfEqual, number, len(numbers) - index) for index, number in enumerate(numbers)]
    return b"".join([step(kLoad, kArchitecture_at), step(kIfEqual, architecture, 0, len(checks) + 2), step(kLoad, kNumber_at), *checks, step(kReturn, kAllow),
                     step(kReturn, kRefuse)])
