# SPDX-License-Identifier: MIT
"""Submissions that do harm, or try to: each earns nothing, with a sentence, and other submissions are graded as usual."""
import os
import socket
import subprocess
import time
import unittest

from grade_case import ASSIGNMENT, BINARY, DRIVE, LIMIT_S, GradeCase

# Attacks that must fail end with DRIVE: on success they would earn points.
TRY = """
def refused(*attempts):
    for name, attempt in attempts:
        try:
            attempt()
        except Exception as error:
            print(name, "is refused:", error)
        else:
            return False
    return True
"""
HARM = {
    "never ends": ("while True:\n    pass\n", r"took more than 5 s of processor time"),
    "forks": ("import os\nwhile True:\n    os.fork()\n", r"exit code 1: "),  # of many last words
    "forks and goes on": ("import os\nwhile True:\n    try:\n        os.fork()\n    except OSError:\n        pass\n", r"took more than 5 s of processor time"),
    "takes memory": ("x = []\nwhile True:\n    x.append(bytearray(1 << 20))\n", r"exit code 1|more than 128 MiB of memory"),
    "takes memory by many": ("import os\nfor k in range(4):\n    os.fork()\n    if k > 1: break\nx = [b'1' * (1 << 20) + bytes([k % 256]) for k in range(90)]\n"
                             "while True:\n    pass\n", r"more than 128 MiB of memory"),
    "floods": ("import sys\nwhile True:\n    sys.stdout.write('x' * 65536)\n", r"printed more than 16 MiB"),
    "writes 10 GB": ("with open('/tmp/big', 'wb') as stream:\n    for k in range(10240):\n        stream.write(bytes(1 << 20))\n",
                     r"exit code 1: OSError.*(No space left|File too large)"),
    "writes many files": ("for k in range(1000):\n    with open(f'/tmp/{k}', 'wb') as stream:\n        stream.write(bytes(1 << 20))\n", r"exit code 1: OSError.*No space left"),
    "writes elsewhere": (TRY + "import os\nassert refused(*((p, lambda p=p: open(p + '/x', 'wb').write(bytes(1 << 26))) for p in "
                         "('/submission', '/coopdyn', '/usr', '/', '/dev', '/dev/shm', '/etc', '/var')))\nraise SystemExit('nowhere')\n", r"exit code 1: nowhere"),
    "takes memory that no limit counts": (TRY + "import ctypes, os\nlibc = ctypes.CDLL(None, use_errno=True)\ndef shared():\n"
                                          "    if libc.shmget(0, 1 << 30, 0o600) < 0:\n        raise OSError(ctypes.get_errno(), 'shmget')\n"
                                          "assert refused(('memfd', lambda: os.memfd_create('x')), ('shmget', shared))\nraise SystemExit('no memory')\n", r"no memory"),
    "prints binary": ("import sys\nsys.stdout.buffer.write(bytes(range(256)) * 100)\n", r"printed bytes that are not text"),
    "kills": ("import os, signal\nfor who in (os.getppid(), 1, -1):\n    try:\n        os.kill(who, signal.SIGKILL)\n    except OSError as error:\n        print(error)\n"
              "raise SystemExit('nobody died')\n", r"exit code 1: nobody died"),
    "resets": ("import coopdyn\nsim = coopdyn.connect()\nsim.reset()\n" + DRIVE, r"tried to change the world"),
    "edits": ("import coopdyn\nsim = coopdyn.connect()\nsim.move('eva', [3, 0])\n" + DRIVE, r"tried to change the world"),
    "ends the run": ("import coopdyn\nsim = coopdyn.connect()\nsim.end_run()\n", r"tried to change the world"),
    "never drives": ("print('done')\n", r"ended before the first step.*done"),
    "crashes": ("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n", r"signal 11 \(SIGSEGV\)"),
    "is no python": ("drive along x\n", r"exit code 1: SyntaxError"),
}


class HostileTest(GradeCase):
    def test_each_earns_nothing_with_a_sentence_and_the_others_are_graded_as_alone(self):
        good = [self.submit("aaa", DRIVE), self.submit("zzz", DRIVE)]
        self.grade_all(*good, out="alone")
        bad = [self.submit(name, text) for name, (text, _) in HARM.items()]
        os.mkdir(self.path("is empty"))
        self.grade_all(good[0], *bad, self.path("is empty"), good[1], "--jobs", "2")
        rows = {row["name"]: row for row in self.table()}
        self.assertEqual(len(rows), len(HARM) + 3)
        for name, (_, sentence) in HARM.items():
            self.assertEqual(float(rows[name]["points"]), 0, name)
            self.assertRegex(rows[name]["sentence"], sentence, name)
        self.assertEqual((rows["is empty"]["points"], rows["is empty"]["sentence"]), ("0.0", "main.py is missing."))
        for name in ("aaa", "zzz"):
            self.assertEqual(self.result(name), self.result(name, "alone"))
            self.assertEqual(self.result(name)["score"], 10)

    def test_a_program_that_sleeps_for_ever_ends_by_the_clock(self):
        self.write("lane.assignment", ASSIGNMENT.replace("clock 300s", "clock 2s"))
        self.grade_all(self.submit("sleeper", "import time\ntime.sleep(1e6)\n"))
        self.assertRegex(self.table()[0]["sentence"], "did not end: the run was at 0 s after 2 s by the clock")

    def test_nothing_is_left_of_a_fork_bomb_that_ignores_signals(self):
        self.submit("bomb", "import os, signal, time\nfor k in range(1, 32):\n    try:\n        signal.signal(k, signal.SIG_IGN)\n    except OSError:\n        pass\n"
                    "for k in range(5):\n    if os.fork() == 0:\n        os.setsid()\n        os.execlp('sleep', 'sleep', '8765')\n")
        self.grade_all(self.path("bomb"))
        end = time.monotonic() + LIMIT_S
        while subprocess.run(["pgrep", "-fx", "sleep 8765"], capture_output=True, check=False).returncode == 0:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)

    def test_it_reaches_no_other_daemon_and_nothing_outside(self):
        daemon = subprocess.Popen([BINARY, "serve", self.path("lane.scenario"), "--port", "0", "--no-http", "--no-render"], stdout=subprocess.PIPE,
                                  stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(daemon.stdout.close)
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.terminate)
        port = int(daemon.stdout.readline().split()[1].rpartition(":")[2])
        with socket.create_server(("127.0.0.1", 0)) as listener, socket.socket(socket.AF_UNIX) as local:
            local.bind(self.path("local"))
            local.listen()
            own = listener.getsockname()[1]
            self.submit("caller", TRY + f"""import socket
def unix(name):
    with socket.socket(socket.AF_UNIX) as one:
        one.connect(name)
def tcp(host, port):
    socket.create_connection((host, port), 5).close()
def datagram():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.connect(("192.0.2.1", 53))
        one.send(b"x")
ok = refused(("daemon", lambda: tcp("127.0.0.1", {port})), ("its socket", lambda: unix("\\0coopdyn-{port}")), ("host", lambda: tcp("127.0.0.1", {own})),
             ("file", lambda: unix({self.path('local')!r})), ("outside", lambda: tcp("192.0.2.1", 80)), ("names", lambda: socket.getaddrinfo("example.org", 80)),
             ("datagram", datagram), ("raw", lambda: socket.socket(socket.AF_INET, socket.SOCK_RAW, 1)))
if ok:
    raise SystemExit("no way out")
""" + DRIVE)
            self.grade_all(self.path("caller"))
            listener.settimeout(0)
            with self.assertRaises(BlockingIOError):
                listener.accept()
        self.assertRegex(self.table()[0]["sentence"], "exit code 1: no way out")

    def test_it_reads_neither_key_nor_others_nor_home(self):
        self.write("lane.assignment", ASSIGNMENT.replace("duration", "hidden_seeds 1\nduration"))
        key = self.path("lane.key")
        subprocess.run([BINARY, "grade", "--new-key", key], check=True, capture_output=True)
        self.submit("good", DRIVE)
        self.submit("reader", TRY + f"""import glob, os
paths = [{key!r}, {self.assignment!r}, {self.path('good')!r}, {self.folder!r}, {os.path.expanduser('~')!r}, "/root", "/home", "/var", "/srv", "/mnt", "/boot", "/sys",
         "/etc/shadow", "/etc/hostname", "/etc/ssh", "/proc/1/environ/../../../../../root"]
ok = refused(*((path, lambda path=path: os.listdir(path) if os.path.isdir(path) else open(path).close()) for path in paths))
seen = [p for p in os.listdir("/proc") if p.isdigit()]
words = [open(f"/proc/{{p}}/cmdline").read() for p in seen]
users = open("/etc/passwd").read().splitlines() + open("/etc/group").read().splitlines()
if ok and len(users) == 2 and not any("serve" in text or "lane" in text for text in words) and not [n for n in os.environ if n.startswith("COOPDYN_") and n != "COOPDYN_SERVER"]:
    raise SystemExit("nothing to see")
""" + DRIVE)
        self.grade_all(self.path("good"), self.path("reader"))
        runs = self.runs("reader")
        self.assertRegex(runs[0]["sentence"], "exit code 1: nothing to see")
        self.assertEqual([one["points"] for one in runs], [0, 0])

    def test_it_lists_no_recordings(self):
        self.submit("good", DRIVE)
        self.grade_all(self.path("good"))
        self.submit("lister", "import coopdyn\nsim = coopdyn.connect()\nraise SystemExit(f'recordings: {[r.name for r in sim.recordings()]}')\n")
        self.grade_all(self.path("good"), self.path("lister"), cwd=self.path("out/good"))
        self.assertRegex({row["name"]: row for row in self.table()}["lister"]["sentence"], r"recordings: \[\]$")

    def test_a_hidden_seed_does_not_come_out_by_what_a_program_prints(self):
        self.write("lane.assignment", ASSIGNMENT.replace("duration", "hidden_seeds 1\nduration"))
        subprocess.run([BINARY, "grade", "--new-key", self.path("lane.key")], check=True, capture_output=True)
        self.submit("teller", "import coopdyn\nsim = coopdyn.connect()\nraise SystemExit(f'the seed is {sim.status()[\"seed\"]}')\n")
        self.grade_all(self.path("teller"))
        with open(self.path("out/teller/index.html"), encoding="utf-8") as page:
            self.assertEqual(page.read().count("the seed is"), 3)  # of seed 1: in short, in its row, as output
        self.assertEqual([one["seed"] for one in self.runs("teller")], [1, None])
        self.assertRegex(self.runs("teller")[0]["sentence"], "the seed is 1$")
        self.assertEqual(self.runs("teller")[1]["sentence"], "The program ended with exit code 1.")

    @unittest.skipUnless(os.uname().machine == "x86_64", "of x86-64")
    def test_a_program_computes_as_on_a_processor_without_newer_instructions(self):
        code = ("import hashlib, math, struct\nprint(hashlib.sha256(b''.join(struct.pack('3d', math.sin(k / 7), math.exp(k % 600 / 9), math.tan(k / 3)) "
                "for k in range(99999))).hexdigest())\n")
        old = subprocess.run(["/usr/bin/python3", "-c", code], capture_output=True, text=True, check=True,
                             env={"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}).stdout.strip()
        self.submit("sine", code)
        self.grade_all(self.path("sine"))
        self.assertIn(old, self.table()[0]["sentence"])

    def test_without_bubblewrap_nothing_runs(self):
        os.mkdir(self.path("bin"))
        for name in ("prlimit", "nsenter", "python3"):
            os.symlink(f"/usr/bin/{name}", self.path("bin", name))
        done = self.grade_all(self.submit("good", DRIVE), code=1, env={**os.environ, "PATH": self.path("bin")})
        self.assertRegex(done.stderr, "the sandbox needs bwrap: apt-get install bubblewrap")
        self.assertFalse(os.path.exists(self.path("out", "good")))

    def test_no_sandbox_is_said_loudly(self):
        done = self.grade_all(self.submit("good", DRIVE), "--no-sandbox")
        self.assertIn("NO SANDBOX", done.stderr)
        self.assertEqual(self.result("good")["score"], 10)
        self.assertIn("GRADED WITHOUT A SANDBOX", self.result("good")["output"])
        self.assertEqual(self.table()[0]["sandbox"], "no")
        with open(self.path("out/good/index.html"), encoding="utf-8") as page:
            self.assertIn("without a sandbox", page.read())


if __name__ == "__main__":
    unittest.main()
