# SPDX-License-Identifier: MIT
"""Programs that students write in the page of their seat: they run on the server, in a sandbox, and harm nobody."""
import json
import os
import signal
import subprocess
import unittest
from pathlib import Path
from unittest import mock

from classes import BINARY, Host, until
import harness

REALTIME = harness.scenario(mode="realtime")
DRIVE = "import coopdyn\nsim = coopdyn.connect()\nr = sim.robot('robot1')\n"
# Others on this machine may run the same test.
SLEEPS = [f"{86421 + k}.{os.getpid()}" for k in range(4)]
TRIES = """import ctypes, mmap, os, socket
libc = ctypes.CDLL(None, use_errno=True)
def check(result):
    if result < 0:
        raise OSError(ctypes.get_errno(), "")
def attempt(deed):
    try:
        print(deed())
    except OSError as error:
        print(type(error).__name__)
"""
FOREVER = "import time\nprint('begun', flush=True)\nwhile True:\n    time.sleep(0.05)\n"


class ProgramCase(unittest.TestCase):
    """What a page asks of the program of a seat."""

    def ask(self, host, what="", body=None, seat="ana"):
        """(status, JSON or text)."""
        path = f"/s/{seat}/class/program" + (f"/{what}" if what else "")
        status, text, _ = host.fetch("GET" if body is None else "POST", path, body, host.as_student(seat))
        return status, json.loads(text) if status == 200 else text

    def get(self, host, what="", seat="ana"):
        status, said = self.ask(host, what, seat=seat)
        self.assertEqual(status, 200, said)
        return said

    def begin(self, host, text, seat="ana"):
        status, said = self.ask(host, "run", {"text": text, "base": self.get(host, seat=seat)["version"]}, seat)
        self.assertEqual(status, 200, said)

    def end(self, host, seat="ana"):
        """The state after the end of the run."""
        return until(lambda: next((one for one in [self.get(host, seat=seat)] if not one["runs"]), None))

    def printed(self, host, seat="ana"):
        return self.get(host, "output/0", seat)["text"]

    def run_to_end(self, host, text, seat="ana"):
        """(state, output)."""
        self.begin(host, text, seat)
        return self.end(host, seat), self.printed(host, seat)

    def await_output(self, host, text, seat="ana"):
        until(lambda: text in self.printed(host, seat))


def processes(words):
    """Processes of the machine with these words in their command line."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if words in Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace"):
                found.append(int(pid))
        except OSError:
            pass
    return found


class Runs(ProgramCase):
    @classmethod
    def setUpClass(cls):
        cls.host = Host(harness.scenario()).__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.host.__exit__(None, None, None)

    def test_a_program_drives_the_robot_of_its_seat_and_of_no_other(self):
        before = {seat: self.host.status(seat)["step"] for seat in ("ana", "ben")}
        state, output = self.run_to_end(self.host, DRIVE + "for k in range(50):\n    r.set_velocity(0.2, 0)\n    sim.step()\nprint(r.get_pose().x > 0.05)\n")
        self.assertEqual((state["sentence"], state["error"], output), ("The program has ended.", False, "True\n"))
        self.assertGreaterEqual(self.host.status("ana")["step"], before["ana"] + 50)
        self.assertEqual(self.host.status("ben")["step"], before["ben"])
        self.assertEqual(self.host.tiles()["ana"]["language"], "python")

    def test_what_it_prints_is_there_while_it_runs(self):
        self.begin(self.host, FOREVER)
        self.await_output(self.host, "begun")
        self.assertTrue(self.get(self.host)["runs"])
        self.assertEqual(self.ask(self.host, "run", {"text": FOREVER, "base": ""}), (409, "your program runs: stop it first\n"))
        self.assertTrue(self.host.tiles()["ana"]["program"]["runs"])
        self.ask(self.host, "stop", {})
        self.end(self.host)

    def test_stop_ends_all_its_processes(self):
        self.begin(self.host, f"import os\nfor k in range(3):\n    if os.fork() == 0:\n        os.setsid()\n        os.execlp('sleep', 'sleep', '{SLEEPS[0]}')\n" + FOREVER)
        until(lambda: len(processes("sleep " + SLEEPS[0])) == 3)
        self.ask(self.host, "stop", {})
        state = self.end(self.host)
        self.assertEqual((state["sentence"], state["error"]), ("The program was stopped.", False))
        until(lambda: not processes("sleep " + SLEEPS[0]))

    def test_it_runs_again_at_once_after_a_stop(self):
        self.begin(self.host, FOREVER)
        self.await_output(self.host, "begun")
        first = self.get(self.host)["run"]
        self.ask(self.host, "stop", {})
        self.begin(self.host, "print('again')\n")
        until(lambda: self.get(self.host)["run"] == first + 1 and not self.get(self.host)["runs"])
        self.assertEqual(self.printed(self.host), "again\n")

    def test_a_stop_after_stop_and_run_counts_too(self):
        self.begin(self.host, FOREVER)
        self.await_output(self.host, "begun")
        self.ask(self.host, "stop", {})
        self.begin(self.host, FOREVER)
        self.ask(self.host, "stop", {})
        self.assertEqual(self.end(self.host)["sentence"], "The program was stopped.")

    def test_it_cannot_free_itself_of_its_sandbox(self):
        """The first process of the box has the same user, and would be its way out."""
        _, output = self.run_to_end(self.host, TRIES + """
attempt(lambda: check(libc.ptrace(16, 1, None, None)))
attempt(lambda: open("/proc/1/mem", "r+b"))
attempt(lambda: open("/proc/self/autogroup", "w"))
""")
        self.assertEqual(output, "PermissionError\nOSError\nOSError\n")

    def test_memory_that_no_limit_counts_is_refused(self):
        _, output = self.run_to_end(self.host, TRIES + """
attempt(lambda: mmap.mmap(-1, 4096))
attempt(lambda: check(libc.semget(0, 32000, 0)))
attempt(lambda: check(libc.inotify_init1(0)))
attempt(lambda: os.stat("/dev/zero").st_rdev != os.stat("/dev/null").st_rdev)
for family in (socket.AF_INET, socket.AF_VSOCK, socket.AF_NETLINK):
    attempt(lambda: socket.socket(family, socket.SOCK_STREAM))
attempt(lambda: mmap.mmap(-1, 4096, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS).close())
""")
        self.assertEqual(output.split(), ["PermissionError"] * 3 + ["False"] + ["PermissionError"] * 3 + ["None"])

    def test_descriptors_under_way_keep_no_other_program_from_starting(self):
        self.begin(self.host, """
import os, socket, time
for _ in range(2):
    a, b = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        while True:
            socket.send_fds(a, [b"x"], [0] * 250)
    except OSError:
        pass
    if os.fork() == 0:
        break
""" + FOREVER)
        self.await_output(self.host, "begun")
        self.assertEqual(self.run_to_end(self.host, "print('here')\n", seat="ben")[1], "here\n")
        self.ask(self.host, "stop", {})
        self.end(self.host)

    def test_the_teacher_may_read_and_stop_it(self):
        self.begin(self.host, FOREVER)
        self.await_output(self.host, "begun")
        status, text, _ = self.host.fetch("GET", "/wall/class/programs/ana", headers=self.host.as_teacher())
        self.assertEqual((status, json.loads(text)["text"]), (200, FOREVER))
        run = {"text": "", "base": json.loads(text)["version"]}
        self.assertEqual(self.host.fetch("POST", "/wall/class/programs/ana/run", run, self.host.as_teacher())[0], 403)
        self.assertEqual(self.host.fetch("POST", "/wall/class/programs/ana/stop", {}, self.host.as_teacher())[0], 200)
        self.assertEqual(self.end(self.host)["sentence"], "The teacher stopped the program.")

    def test_an_error_has_its_line_and_the_teacher_sees_it(self):
        state, output = self.run_to_end(self.host, "def f():\n    return nothing\n\nf()\n")
        self.assertEqual((state["error"], state["line"]), (True, 2))
        self.assertEqual(state["sentence"], "The program ended with an error: NameError: name 'nothing' is not defined")
        self.assertIn('File "/program/program.py", line 4', output)
        tile = self.host.tiles()["ana"]
        self.assertEqual((tile["need"], tile["why"]), (2, state["sentence"]))
        state, _ = self.run_to_end(self.host, "while True\n    pass\n")
        self.assertEqual((state["line"], "SyntaxError" in state["sentence"]), (1, True))
        self.run_to_end(self.host, "pass\n")
        self.assertEqual(self.host.tiles()["ana"]["need"], 0)

    def test_how_it_ended_is_said_in_words(self):
        for text, sentence in (("raise SystemExit(3)\n", r"exit code 3\."), ("import os\nos.kill(os.getpid(), 11)\n", r"signal 11 \(SIGSEGV\)"),
                               ("input('how far?')\n", r"EOFError.*cannot ask with input\(\)"), ("import os\nos.kill(os.getpid(), 9)\n", "ended by the system")):
            self.assertRegex(self.run_to_end(self.host, text)[0]["sentence"], sentence)

    def test_bytes_that_are_no_text_are_shown_as_such(self):
        state, output = self.run_to_end(self.host, "import sys\nsys.stdout.buffer.write(b'\\0\\x1b[31m\\xff\\xc3\\xa9\\r\\n')\n")
        self.assertEqual((output, state["error"]), ("\\x00\\x1b[31m\\xffé\n", False))

    def test_numpy_and_matplotlib_of_the_server_are_there(self):
        text = "import numpy\nimport matplotlib.pyplot as plot\nplot.plot(numpy.arange(3))\nplot.savefig('a.png')\nprint(open('a.png', 'rb').read(4))\n"
        missing = subprocess.run(["/usr/bin/python3", "-c", "import matplotlib"], capture_output=True, check=False).returncode != 0
        state, output = self.run_to_end(self.host, text)
        self.assertIn("No module named" if missing else "b'\\x89PNG'", output, state["sentence"])

    def test_another_student_reaches_no_part_of_it(self):
        ben = self.host.as_student("ben")
        for method, path in (("GET", "program"), ("GET", "program/output/0"), ("POST", "program"), ("POST", "program/run"), ("POST", "program/stop")):
            body = {"text": "", "base": ""} if method == "POST" else None
            self.assertEqual(self.host.fetch(method, f"/s/ana/class/{path}", body, ben)[0], 403, path)
        self.assertEqual(self.host.fetch("GET", "/wall/class/programs/ana", headers=ben)[0], 403)
        self.assertEqual(self.host.fetch("POST", "/s/ana/class/program/stop", {}, {**self.host.as_student("ana"), "Origin": "http://evil.example"})[0], 403)

    def test_an_address_that_is_wrong_is_refused_with_words(self):
        for what, body in (("output/", None), ("output/x", None), ("output/-1", None), ("output/1x", None), ("other", None), ("other", {}), ("", {}), ("run", {"text": 3})):
            self.assertIn(self.ask(self.host, what, body)[0], (400, 404), what)

    def test_output_beyond_what_is_kept_is_left_out_at_its_beginning(self):
        state, output = self.run_to_end(self.host, "for k in range(60000):\n    print(f'line {k} é')\n")
        self.assertLessEqual(len(output.encode()), 64 << 10)
        self.assertTrue(output.endswith("line 59999 é\n"))
        page = self.get(self.host, f"output/{state['printed'] - 11}")
        self.assertEqual((page["text"], page["to"]), ("e 59999 é\n", state["printed"]))


# (program, sentence at its end)
SEEK = """
def refused(attempt):
    try:
        attempt()
    except OSError:
        return True
    return False
"""
HARM = {
    "forks": ("import os\nwhile True:\n    os.fork()\n", r"ended with an error: "),
    "takes memory": ("x = []\nwhile True:\n    x.append(bytearray(1 << 20))\n", r"MemoryError|512 MiB of memory"),
    "takes memory by many": ("import os\nfor k in range(4):\n    os.fork()\nx = [b'1' * (1 << 20) + bytes([k % 256]) for k in range(150)]\nwhile True:\n    pass\n",
                             r"512 MiB of memory"),
    "floods": ("import sys\nwhile True:\n    sys.stdout.write('x' * 65536)\n", r"printed more than 16 MiB"),
    "writes 10 GB": ("with open('/program/big', 'wb') as stream:\n    for k in range(10240):\n        stream.write(bytes(1 << 20))\n", r"No space left|File too large"),
    "kills": ("import os, signal\nfor who in (os.getppid(), 1, -1):\n    try:\n        os.kill(who, signal.SIGKILL)\n    except OSError as error:\n        print(error)\n"
              "raise SystemExit('nobody died')\n", r"nobody died"),
    "looks for a network": (SEEK + "import socket\nassert refused(lambda: socket.create_connection(('192.0.2.1', 80), 2))\n"
                            "assert refused(lambda: socket.create_connection(('127.0.0.1', %(port)d), 2))\n"
                            "assert refused(lambda: socket.create_connection(('127.0.0.1', %(http_port)d), 2))\nraise SystemExit('alone')\n", r"alone"),
    "reads files of the class": (SEEK + "for name in ('class.csv', 'token', 'seats/ben/door', 'seats/ben/program.py', 'seats/ana/program.py', 'lock'):\n"
                                 "    assert refused(lambda: open('%(folder)s/' + name))\nassert refused(lambda: __import__('os').listdir('/root'))\n"
                                 "assert refused(lambda: __import__('os').listdir('/home'))\nraise SystemExit('unseen')\n", r"unseen"),
    "looks at other processes": ("import os\npids = [pid for pid in os.listdir('/proc') if pid.isdigit()]\nnames = [open(f'/proc/{pid}/cmdline').read().split('\\0')[0] for pid in pids]\n"
                                 "assert sorted(names) == ['bwrap', 'python3'], names\nraise SystemExit('no other')\n", r"no other"),
    "looks for sockets": ("import os, socket\nlines = open('/proc/net/unix').read().splitlines()[1:]\nassert all(line.split()[7:] in ([], ['/run/coopdyn.sock']) for line in lines), lines\n"
                          "assert os.listdir('/run') == ['coopdyn.sock']\nfor fd in range(3, 256):\n    try:\n        os.fstat(fd)\n    except OSError:\n        continue\n"
                          "    raise SystemExit(f'descriptor {fd} is open')\nraise SystemExit('no socket')\n", r"no socket"),
    "reads its environment": ("import os\nassert not [k for k in os.environ if 'TOKEN' in k or 'SEAT' in k or 'SECRET' in k], os.environ\n"
                              "assert os.getuid() == 65534\nraise SystemExit('clean')\n", r"clean"),
    "leaves links": ("import os\nos.remove('/program/program.py')\nos.symlink('%(folder)s/token', '/program/program.py')\nos.symlink('/etc/passwd', '/program/output.txt')\n"
                     "raise SystemExit('links')\n", r"links"),
    "takes its socket away": ("import os\nos.remove('/run/coopdyn.sock')\nimport coopdyn\ncoopdyn.connect()\n", r"nothing can be reached"),
}


class Harm(ProgramCase):
    def test_each_ends_with_a_sentence_and_nobody_else_notices(self):
        with mock.patch.dict(os.environ, {"MY_SECRET": "x"}), Host(REALTIME) as host:
            known = {"port": host.port, "http_port": host.http_port, "folder": host.folder / "class"}
            motors, daemon, mine = host.module("ben", "/robot1/motors"), host.daemon("ben"), None
            self.addCleanup(motors.close)
            for name, (text, sentence) in HARM.items():
                with self.subTest(name):
                    text = text % known if "%(" in text else text
                    state, output = self.run_to_end(host, text)
                    self.assertRegex(state["sentence"], sentence, output[-2000:])
                    self.assertEqual(self.get(host)["text"], text)
                    self.assertEqual((motors.ask("set_velocity 0.1 0").error, host.daemon("ben")), (0, daemon))
                    mine = mine or host.daemon("ana")
                    self.assertEqual(host.daemon("ana"), mine)
            kept = host.folder / "class" / "seats" / "ana"
            self.assertFalse(any(path.is_symlink() for path in kept.rglob("*")))
            self.assertLess(sum(path.stat().st_size for path in kept.glob("*.*")), 2 << 20)

    def test_many_connections_disturb_no_other_seat(self):
        with Host(REALTIME) as host:
            motors = host.module("ben", "/robot1/motors")
            self.begin(host, "import socket\nprint('begun', flush=True)\nkept = []\nwhile True:\n    one = socket.socket(socket.AF_UNIX)\n    one.settimeout(5)\n"
                             "    try:\n        one.connect('/run/coopdyn.sock')\n    except OSError:\n        continue\n    kept = (kept + [one])[-100:]\n")
            self.await_output(host, "begun")
            for _ in range(100):
                motors.must("set_velocity 0.1 0")
            self.assertEqual(host.seat("ben").said, "ok")
            self.ask(host, "stop", {})
            self.end(host)
            until(lambda: host.module("ana", "/robot1/motors").ask("set_velocity 0.1 0").error == 0)


class Kept(ProgramCase):
    def test_there_is_a_first_program_that_drives(self):
        with Host(REALTIME) as host:
            first = self.get(host)["text"]
            self.assertFalse((host.folder / "class" / "seats" / "ana" / "program.py").exists())
            self.begin(host, first)
            self.await_output(host, "the nearest thing is")
            until(lambda: host.status("ana")["robots"][0]["owner"].startswith("ana@"))
            self.ask(host, "stop", {})
            self.end(host)

    def test_a_text_survives_a_restart_of_the_host_and_its_output_too(self):
        with Host() as host:
            self.run_to_end(host, "print('é')\n")
            host.end()
            host.start()
            self.assertEqual((self.get(host)["text"], self.printed(host)), ("print('é')\n", "é\n[The program has ended.]\n"))

    def test_two_windows_of_a_seat_do_not_overwrite_each_other(self):
        with Host() as host:
            base = self.get(host)["version"]
            first = self.ask(host, "", {"text": "a = 1\n", "base": base})[1]["version"]
            status, words = self.ask(host, "", {"text": "a = 2\n", "base": base})
            self.assertEqual((status, "changed meanwhile" in words), (409, True))
            self.assertEqual(self.ask(host, "", {"text": "a = 3\n", "base": first})[0], 200)
            self.assertEqual(self.get(host)["text"], "a = 3\n")

    def test_a_text_that_is_too_long_is_refused(self):
        with Host() as host:
            status, words = self.ask(host, "", {"text": "#" * (257 << 10), "base": self.get(host)["version"]})
            self.assertEqual((status, "256 KiB" in words), (409, True))

    def test_program_and_output_are_handed_in_and_collected(self):
        with Host() as host:
            self.run_to_end(host, "print('handed')\n")
            self.assertEqual(host.fetch("POST", "/s/ana/class/hand-in", {}, host.as_student("ana"))[0], 200)
            self.assertEqual(host.me("ana")["handed_in"][0]["files"][:2], ["program.py", "output.txt"])
            kept = next((host.folder / "class" / "seats" / "ana" / "handed-in").iterdir())
            self.assertEqual((kept / "program.py").read_text(), "print('handed')\n")
            self.assertEqual((kept / "output.txt").read_text(), "handed\n[The program has ended.]\n")
            archive = host.fetch("GET", "/wall/class/collect.tar", headers=host.as_teacher(), raw=True)[1]
            self.assertIn(b"seats/ana/program.py", archive)

    def test_nothing_is_left_when_the_host_is_killed(self):
        with Host() as host:
            self.begin(host, f"import os\nprint('begun', flush=True)\nos.execlp('sleep', 'sleep', '{SLEEPS[1]}')\n")
            until(lambda: processes("sleep " + SLEEPS[1]))
            output = host.folder / "class/seats/ana/output.txt"
            until(lambda: output.exists() and "begun" in output.read_text())
            host.kill()
            until(lambda: not processes("sleep " + SLEEPS[1]) and not processes(str(host.folder / "class/seats/ana/program.py")))
            host.start()
            self.assertEqual((self.get(host)["runs"], self.printed(host)), (False, "begun\n[It ran at this moment.]\n"))

    def test_nothing_is_left_when_the_process_that_watches_is_killed(self):
        with Host() as host:
            self.begin(host, f"import os\nos.execlp('sleep', 'sleep', '{SLEEPS[2]}')\n")
            until(lambda: processes("sleep " + SLEEPS[2]))
            os.kill(processes(str(host.folder / "class/seats/ana/program.py"))[0], signal.SIGKILL)
            self.assertEqual(self.end(host)["sentence"], "The program was ended from outside.")
            until(lambda: not processes("sleep " + SLEEPS[2]))


class Teaching(ProgramCase):
    def test_while_the_teacher_drives_its_set_points_are_refused_with_words(self):
        with Host(REALTIME) as host:
            self.begin(host, DRIVE + "print('drives', flush=True)\nwhile True:\n    r.set_velocity(0.1, 0)\n    sim.step()\n")
            self.await_output(host, "drives")
            host.order(do="take", seats=["ana"])
            self.assertIn("the teacher has taken over or frozen this seat", self.end(host)["sentence"])

    def test_it_ends_when_its_seat_is_put_aside_begun_anew_or_removed(self):
        with Host() as host:
            for order, words in (("aside", "put aside"), ("restart", "began the lesson anew")):
                self.begin(host, FOREVER)
                self.await_output(host, "begun")
                host.order(do=order, seats=["ana"])
                self.assertIn(words, self.end(host)["sentence"])
            self.begin(host, f"import os\nos.execlp('sleep', 'sleep', '{SLEEPS[3]}')\n")
            until(lambda: processes("sleep " + SLEEPS[3]))
            subprocess.run([BINARY, "seat", "remove", "ana", "--folder", str(host.folder / "class")], check=True, capture_output=True)
            until(lambda: not processes("sleep " + SLEEPS[3]))

    def test_a_seat_with_a_program_is_not_idle(self):
        with Host(REALTIME, "--idle", "0.02") as host:
            host.status("ana")
            self.begin(host, "import time\ntime.sleep(4)\nprint('slept')\n")
            first = host.daemon("ana")
            self.end(host)
            self.assertEqual((self.printed(host), host.daemon("ana")), ("slept\n", first))
            host.tile("ana", lambda tile: tile["daemon"] == "asleep")

    def test_a_server_without_the_sandbox_says_what_it_needs(self):
        with mock.patch.dict(os.environ, {"PATH": "/nowhere", "COOPDYN_PYTHON": "/usr/bin/python3"}), Host() as host:
            state, _ = self.run_to_end(host, "print('in the open')\n")
            self.assertRegex(state["sentence"], "the server needs apt-get install bubblewrap")
            self.assertEqual(state["printed"], 0)
            self.assertEqual(host.seat("ana").said, "ok")

    def test_a_server_that_cannot_start_python_says_so(self):
        with mock.patch.dict(os.environ, {"COOPDYN_PYTHON": "/nowhere/python3"}), Host() as host:
            status, words = self.ask(host, "run", {"text": "", "base": self.get(host)["version"]})
            self.assertEqual((status, words), (409, "/nowhere/python3 cannot be started: No such file or directory\n"))


if __name__ == "__main__":
    unittest.main()
