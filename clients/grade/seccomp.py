# SPDX-License-Identifier: MIT
"""The system calls that the sandbox refuses: those that allocate memory outside a process's limits, those that reach into other
processes of the box, and some that only attacks need. A kernel filter (seccomp(2), classic BPF), for bubblewrap's --seccomp."""
import errno
import os
import socket
import struct

kLoad, kAnd, kIfEqual, kIfLeast, kReturn = 0x20, 0x54, 0x15, 0x35, 0x06
kNumber_at, kArchitecture_at, kArguments_at = 0, 4, 16
kAllow, kRefuse = 0x7FFF0000, 0x00050000 | errno.EPERM
kX32 = 0x40000000  # numbers of a second set of calls on x86-64
kSharedAnonymous = 0x21  # of mmap's flags: memory that stays counted nowhere once it is unmapped in part
kLocal = (socket.AF_UNIX,)
kNetwork = (socket.AF_UNIX, socket.AF_INET, socket.AF_INET6, socket.AF_NETLINK)  # not AF_VSOCK, which leads out of every network

# AUDIT_ARCH_…, and the numbers of the calls there.
kMachines = {
    "x86_64": (0xC000003E, {"mmap": 9, "socket": 41, "shmget": 29, "semget": 64, "msgget": 68, "ptrace": 101, "add_key": 248, "request_key": 249,
                            "keyctl": 250, "inotify_init": 253, "vmsplice": 278, "inotify_init1": 294, "perf_event_open": 298, "process_vm_readv": 310,
                            "process_vm_writev": 311, "memfd_create": 319, "bpf": 321, "userfaultfd": 323, "io_uring_setup": 425, "pidfd_getfd": 438,
                            "memfd_secret": 447}),
    "aarch64": (0xC00000B7, {"mmap": 222, "socket": 198, "shmget": 194, "semget": 190, "msgget": 186, "ptrace": 117, "add_key": 217, "request_key": 218,
                             "keyctl": 219, "inotify_init1": 26, "vmsplice": 75, "perf_event_open": 241, "process_vm_readv": 270,
                             "process_vm_writev": 271, "memfd_create": 279, "bpf": 280, "userfaultfd": 282, "io_uring_setup": 425, "pidfd_getfd": 438,
                             "memfd_secret": 447}),
}


def program(families):
    """The filter for this machine, with sockets of these families alone; empty if its architecture is unknown here."""
    if os.uname().machine not in kMachines:
        return b""
    architecture, calls = kMachines[os.uname().machine]
    calls = dict(calls)
    mmap, socket_ = calls.pop("mmap"), calls.pop("socket")
    # (code, value, where to if so, where to if not): "allow", "refuse", or the number of steps to skip.
    steps = [(kLoad, kArchitecture_at, 0, 0), (kIfEqual, architecture, 0, "refuse"), (kLoad, kNumber_at, 0, 0), (kIfLeast, kX32, "refuse", 0)]
    steps += [(kIfEqual, number, "refuse", 0) for number in sorted(calls.values())]
    steps += [(kIfEqual, mmap, 0, 3), (kLoad, kArguments_at + 3 * 8, 0, 0), (kAnd, kSharedAnonymous, 0, 0), (kIfEqual, kSharedAnonymous, "refuse", "allow")]
    steps += [(kIfEqual, socket_, 0, "allow"), (kLoad, kArguments_at, 0, 0)]
    steps += [(kIfEqual, int(family), "allow", 0) for family in families[:-1]] + [(kIfEqual, int(families[-1]), "allow", "refuse")]
    ends = {"allow": len(steps), "refuse": len(steps) + 1}
    steps += [(kReturn, kAllow, 0, 0), (kReturn, kRefuse, 0, 0)]

    def skipped(target, index):
        return ends[target] - index - 1 if target in ends else target
    return b"".join(struct.pack("=HBBI", code, skipped(then, index), skipped(otherwise, index), value)
                    for index, (code, value, then, otherwise) in enumerate(steps))
