# SPDX-License-Identifier: MIT
"""A seat of a class: the line that takes it, and a unix socket at a path."""
import contextlib
import io
import os
import pathlib
import socket
import tempfile
import unittest
from unittest import mock

from cases import LIMIT_S, FakeTestCase
import coopdyn


class SeatTestCase(FakeTestCase):
    def take(self, daemon, **options):
        return self.connect(daemon, seat="ana", pin="0912", timeout=LIMIT_S, **options)

    def enter(self, patch):
        patch.start()
        self.addCleanup(patch.stop)

    def variable(self, **values):
        self.enter(mock.patch.dict(os.environ, values))


class Seat(SeatTestCase):
    def test_every_connection_takes_the_seat_in_the_same_write_as_its_first_line(self):
        """The scripted class answers once both lines have arrived."""
        daemon = self.start(robots=2, seat="ana:0912")
        sim = self.take(daemon)
        r = sim.robot(1)
        r.set_velocity(0.1, 0)
        sim.step()
        r.sense(), r.subscribe("pose"), r.next("pose"), sim.modules(), sim.describe("/swarm"), sim.waiting()
        sim.team(["robot2"]).step((0.1, 0))
        self.assertEqual(len(daemon.entries), len(daemon.connections))
        self.assertEqual(set(daemon.entries), {"SEAT ana 0912 python"})

    def test_a_variable_takes_it(self):
        daemon = self.start(seat="ana:0912")
        self.variable(COOPDYN_SEAT="ana:0912")
        self.assertEqual(self.connect(daemon).robots(), ["robot1"])

    def test_arguments_win_over_the_variable(self):
        daemon = self.start(seat="ana:0912")
        self.variable(COOPDYN_SEAT="ben:7305")
        self.assertEqual(self.take(daemon).robots(), ["robot1"])
        ordinary = self.start()
        self.assertEqual(self.connect(ordinary, seat="").robots(), ["robot1"])

    def test_files_come_from_the_page_of_the_seat(self):
        sim = self.take(self.start(seat="ana:0912"))
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "a.run")
            sim.fetch_run("lesson", file)
            self.assertEqual(pathlib.Path(file).read_text(encoding="utf-8"), "/s/ana/runs/lesson.run")
            sim.snapshot(file)
            self.assertTrue(pathlib.Path(file).read_text(encoding="utf-8").startswith("/s/ana/snapshot.png?"))

    def test_a_page_gets_no_pin_without_a_seat(self):
        daemon = self.start()
        with tempfile.TemporaryDirectory() as folder:
            self.connect(daemon).snapshot(os.path.join(folder, "a.png"))
        self.assertFalse(any("Authorization" in header for header in daemon.runs.headers))

    @unittest.skipUnless(hasattr(socket, "AF_UNIX") and os.name == "posix" and os.uname().sysname == "Linux", "Linux only")
    def test_the_unix_socket_of_another_daemon_is_not_used(self):
        daemon = self.start(seat="ana:0912")
        with socket.socket(socket.AF_UNIX) as other:
            other.bind(f"\0coopdyn-{daemon.port}")
            other.listen(8)
            self.take(daemon).step()
            other.setblocking(False)
            self.assertRaises(BlockingIOError, other.accept)

    def test_a_daemon_that_has_just_ended_is_awaited(self):
        daemon = self.start(seat="ana:0912")
        daemon.seat_ends = 2
        self.assertEqual(self.take(daemon).robots(), ["robot1"])

    def test_a_seat_without_a_daemon_is_told_in_words(self):
        daemon = self.start(seat="ana:0912")
        daemon.seat_ends = 1
        self.enter(mock.patch.object(coopdyn, "_SEAT_AGAIN_S", LIMIT_S))  # so it does not try again
        self.assert_error(-1, lambda: self.take(daemon), "closed the connection of the seat ana without an answer",
                          "ask your teacher")

    def test_a_lost_daemon_starts_again_by_itself(self):
        daemon = self.start(mode=1, seat="ana:0912")
        sim = self.take(daemon)
        r = sim.robot(1)
        r.set_velocity(0.1, 0)
        daemon.break_replies = 1
        self.assert_error(-1, sim.step, "the class restarts the seat ana where it was: run your program again")
        r.set_velocity(0.1, 0)
        sim.step()

    def test_doctor_tells_of_the_seat(self):
        daemon = self.start(seat="ana:0912")
        for pin, ok, says in (("0912", True, "seat: ana is yours"), ("0913", False, "FAIL  no seat with this PIN")):
            with contextlib.redirect_stdout(io.StringIO()) as out:
                self.assertEqual(coopdyn.doctor(daemon.server, seat="ana", pin=pin), ok)
            self.assertIn(says, out.getvalue())


class Refused(SeatTestCase):
    def test_a_wrong_pin_is_told_in_the_words_of_the_class(self):
        daemon = self.start(seat="ana:0912")
        self.assert_error(12, lambda: coopdyn.connect(daemon.server, seat="ana", pin="0913"), "no seat with this PIN")

    def test_a_class_that_is_asked_without_a_seat_says_what_it_is(self):
        daemon = self.start(seat="ana:0912")
        self.assert_error(12, lambda: coopdyn.connect(daemon.server), "this is a class")
        address = coopdyn._Address(daemon.server, None, None, 3)
        self.assert_error(12, address.modules, "this is a class")

    def test_an_ordinary_daemon_is_no_class(self):
        daemon = self.start()
        self.assert_error(5, lambda: self.take(daemon), f"{daemon.server} is not a class: leave seat and pin out")
        self.variable(COOPDYN_SEAT="ana:0912")
        self.assert_error(5, lambda: self.connect(daemon), "leave seat and pin out, and COOPDYN_SEAT, too")

    def test_a_half_says_what_is_missing(self):
        for options, says in (({"seat": "ana"}, "the seat ana needs its PIN"), ({"pin": "0912"}, "a PIN needs its seat"),
                              ({"seat": "", "pin": "0912"}, "a PIN needs its seat")):
            self.assert_error(3, lambda: coopdyn.connect(**options), says, 'write connect(seat="ana", pin="7305")')
        for half in ("ana", "ana:", ":0912"):
            self.variable(COOPDYN_SEAT=half)
            self.assert_error(3, coopdyn.connect, "needs its", "COOPDYN_SEAT=ana:7305")

    def test_a_pin_is_a_text(self):
        self.assert_error(3, lambda: coopdyn.connect(seat="ana", pin=912), "loses the zeros", 'write pin="0912"')

    def test_what_no_sheet_has_is_told_before_anything_is_sent(self):
        for seat in ("Ana", "ana b", "-ana", "a" * 33, "ana\n", 5):
            self.assert_error(3, lambda: coopdyn.connect(seat=seat, pin="0912"), "the name of a seat has only a-z, 0-9, - and _")
        for pin in ("091", "09 12", "1" * 17, "0912\n", "٠٩١٢", b"0912"):
            self.assert_error(3, lambda: coopdyn.connect(seat="ana", pin=pin), "a PIN has 4 to 16 letters or digits")


class Path(SeatTestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "door")

    def test_a_daemon_is_reached_by_the_unix_socket_at_a_path(self):
        daemon = self.start(path=self.path)
        self.variable(COOPDYN_SERVER=f"unix:{self.path}")
        with coopdyn.connect() as sim:
            r = sim.robot(1)
            r.set_velocity(0.1, 0)
            sim.step()
            self.assertEqual(len(sim.modules()), len(daemon.modules()))

    def test_a_seat_may_be_behind_it(self):
        daemon = self.start(path=self.path, seat="ana:0912")
        self.assertEqual(self.take(daemon).robots(), ["robot1"])

    def test_doctor_walks_along_it(self):
        daemon = self.start(path=self.path)
        with contextlib.redirect_stdout(io.StringIO()) as out:
            self.assertTrue(coopdyn.doctor(daemon.server))
        self.assertIn(f"unix:{self.path} is open", out.getvalue())

    def test_nothing_there_says_so(self):
        self.assert_error(-1, lambda: coopdyn.connect(f"unix:{self.path}"), f"nothing can be reached at unix:{self.path}", "HOST:PORT")
        self.assert_error(-1, lambda: coopdyn.connect("unix:/" + "a" * 200), "nothing can be reached at")

    def test_a_path_begins_with_a_slash(self):
        self.assert_error(4, lambda: coopdyn.connect("unix:door"), "unix:/PATH")


if __name__ == "__main__":
    unittest.main()
