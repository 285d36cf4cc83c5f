# SPDX-License-Identifier: MIT
"""A class among hostile students, strangers in its network, and bad luck: what one does costs nobody else a seat."""
import concurrent.futures
import os
import resource
import signal
import socket
import subprocess
import unittest
from pathlib import Path

from classes import BINARY, Host, until
import harness

REALTIME = harness.scenario(mode="realtime")
HARD = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (min(HARD, 4096), HARD))  # for many connections


def run(*words):
    return subprocess.run([BINARY, *map(str, words)], capture_output=True, text=True, timeout=harness.LIMIT_S)


def seat(host, *words):
    return run("seat", *words, "--folder", host.folder / "class")


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] != "Z"
    except OSError:
        return False


def children(parent):
    """Also those that have ended, and for whose end nobody has asked."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = stat.read_text().rpartition(") ")[2].split()
        except OSError:
            continue
        if int(words[1]) == parent:
            found.append(stat.parent.name)
    return found


class Doors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.host = Host(REALTIME).__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.host.__exit__(None, None, None)

    def crowd(self, port, words, count=1000):
        """Connections from one address that say half of something."""
        crowd = []
        for _ in range(count):
            crowd.append(socket.create_connection(("127.0.0.1", port), harness.LIMIT_S, ("127.0.0.20", 0)))
            self.addCleanup(crowd[-1].close)
            try:
                crowd[-1].sendall(words)
            except OSError:
                pass  # it had to leave already
        return crowd

    def test_many_who_say_half_a_line_keep_nobody_out(self):
        self.crowd(self.host.port, b"SEAT an")
        self.assertEqual(self.host.seat("ana").said, "ok")

    def test_many_who_send_half_a_request_keep_nobody_out(self):
        self.crowd(self.host.http_port, b"GET / HT")
        self.assertEqual(self.host.fetch("GET", "/")[0], 200)

    def test_a_seat_holds_a_few_streams_of_events_and_the_others_get_theirs(self):
        def stream(name):
            one = socket.create_connection(("127.0.0.1", self.host.http_port), harness.LIMIT_S)
            self.addCleanup(one.close)
            cookie = self.host.as_student(name)["Cookie"]
            one.sendall(f"GET /s/{name}/class/events HTTP/1.1\r\nHost: localhost\r\nCookie: {cookie}\r\n\r\n".encode())
            self.assertIn(b"200", one.recv(100))
            return one
        streams = [stream("ana") for _ in range(40)]
        stream("ben")
        while streams[0].recv(65536):
            pass  # its end comes
        until(lambda: b"data: " in streams[-1].recv(65536))

    def test_ones_own_pin_between_guesses_does_not_make_them_free(self):
        def guess(pin):
            said = self.host.seat("ben", pin, source="127.0.0.21").said
            self.host.seat("ana", source="127.0.0.21")
            return said
        self.assertIn("wait", [guess(f"{pin:04}") for pin in range(6)][-1])

    def test_an_order_with_something_else_for_seats_is_not_for_all(self):
        status, text, _ = self.host.fetch("POST", "/wall/class/do", {"do": "freeze", "seats": "ana"}, self.host.as_teacher())
        self.assertEqual((status, "seats is a list" in text), (400, True))
        self.assertFalse(self.host.me("ben")["frozen"])

    def test_an_order_that_names_a_seat_many_times_is_given_once(self):
        self.host.order(do="message", seats=["ben"] * 1000, text="Hello")
        self.assertEqual(len(self.host.me("ben")["notes"]), 1)

    def test_a_hand_is_up_or_down_and_nothing_else(self):
        me = self.host.as_student("ben")
        self.host.fetch("POST", "/s/ben/class/hand", {"up": True}, me)
        status, text, _ = self.host.fetch("POST", "/s/ben/class/hand", {"up": "yes"}, me)
        self.assertEqual((status, '{"up": true}' in text, self.host.me("ben")["hand"]), (400, True, True))

    def test_hand_ins_at_once_are_one(self):
        self.host.status("ana")
        me = self.host.as_student("ana")
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(lambda _: self.host.fetch("POST", "/s/ana/class/hand-in", {}, me), range(8)))
        good = [text for status, text, _ in answers if status == 200]
        self.assertGreaterEqual(len(good), 1)
        self.assertEqual(len(self.host.me("ana")["handed_in"]), len(good))
        for status, text, _ in answers:
            self.assertTrue(status == 200 or "wait a moment" in text, text)


class Daemons(unittest.TestCase):
    def test_a_daemon_that_hangs_is_ended_by_restart_and_holds_nobody_up(self):
        with Host(REALTIME) as host:
            host.status("ana")
            hung = host.daemon("ana")
            os.kill(hung, signal.SIGSTOP)
            host.status("ben")
            host.order(do="restart", seats=["ana"])
            host.await_other_daemon("ana", hung)
            self.assertFalse(is_alive(hung))
            host.status("ana")

    def test_a_daemon_that_does_not_answer_is_shown_on_the_wall(self):
        with Host(REALTIME) as host:
            host.status("ana")
            os.kill(host.daemon("ana"), signal.SIGSTOP)
            self.assertIn("has not answered", host.tile("ana", lambda tile: tile["need"])["why"])
            os.kill(host.daemon("ana"), signal.SIGCONT)
            host.tile("ana", lambda tile: not tile["need"])

    def test_a_student_who_comes_back_waits_for_the_daemon_that_ends(self):
        with Host(REALTIME) as host:
            host.status("ana")
            hung = host.daemon("ana")
            os.kill(hung, signal.SIGSTOP)
            pin = host.pin("ana")
            self.assertEqual(seat(host, "remove", "ana").returncode, 0)
            until(lambda: "ana" not in host.tiles())
            self.assertEqual(seat(host, "add", "ana", "--pin", pin).returncode, 0)
            until(lambda: "ana" in host.tiles())
            self.assertFalse(is_alive(hung))
            host.status("ana")

    def test_a_daemon_that_a_killed_host_has_just_started_becomes_the_seats(self):
        with Host(REALTIME) as host:
            folder = host.folder / "class" / "seats" / "ana"
            with subprocess.Popen([BINARY, "serve", host.folder / "test.scenario", "--no-render", "--seat", folder / "door", "--seat-url",
                                   "http://localhost/s/ana/"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as other:
                until((folder / "door").exists)
                self.assertEqual(host.seat("ana").said, "ok")
                host.tile("ana", lambda tile: tile["daemon"] == "running")
                host.order(do="aside", seats=["ana"])
                self.assertEqual(other.wait(harness.LIMIT_S), 0)
            host.tile("ana", lambda tile: tile["daemon"] == "asleep")

    def test_a_recording_with_the_largest_number_is_no_run_of_the_seat(self):
        with Host(REALTIME) as host:
            (host.folder / "class" / "seats" / "ana" / "runs" / "2147483647.run").touch()
            self.assertIn("000001", str(host.status("ana")["recording"]))

    def test_daemons_that_have_ended_leave_no_processes_behind(self):
        with Host(REALTIME) as host:
            for _ in range(20):
                host.status("ana")
                host.order(do="restart", seats=["ana"])
            host.order(do="aside")
            host.tile("ana", lambda tile: tile["daemon"] == "asleep")
            until(lambda: not children(host.process.pid))

    def test_what_runs_of_students_who_have_left_ends_with_the_next_host(self):
        with Host(REALTIME) as host:
            host.status("ana")
            left = host.daemon("ana")
            host.kill()
            self.assertEqual(seat(host, "remove", "ana").returncode, 0)
            host.start()
            until(lambda: not is_alive(left))


class Files(unittest.TestCase):
    def test_changes_of_the_list_outlive_a_start_with_the_same_words(self):
        with Host(REALTIME) as host:
            seat(host, "add", "Cleo", "--pin", "4321")
            seat(host, "remove", "ben")
            host.kill()
            host.start("0", "--class", str(host.folder / "list.csv"))
            self.assertEqual((list(host.tiles()), host.pin("cleo")), (["ana", "cleo"], "4321"))

    def test_another_list_replaces_the_one_before(self):
        with Host(REALTIME) as host:
            seat(host, "add", "Cleo")
            host.kill()
            (host.folder / "list.csv").write_text("seat\nana\ndan\n")
            host.start("0", "--class", str(host.folder / "list.csv"))
            self.assertEqual(list(host.tiles()), ["ana", "dan"])

    def test_a_pin_that_an_editor_left_out_stays_or_is_made_and_written(self):
        with Host(REALTIME) as host:
            before = host.roll()["ana"]
            kept = host.folder / "class" / "class.csv"
            kept.write_text("name\nana\nEva Novak\n")
            until(lambda: kept.read_text().startswith("seat,"))
            self.assertEqual(host.roll()["ana"], before)
            until(lambda: "eva-novak" in host.tiles())
            self.assertEqual(host.seat("eva-novak").said, "ok")

    def test_many_seats_added_at_once_are_all_there(self):
        with Host(REALTIME) as host:
            folder = host.folder / "class"
            adding = [subprocess.Popen([BINARY, "seat", "add", f"s{n}", "--folder", folder], stdout=subprocess.DEVNULL) for n in range(20)]
            self.assertEqual({each.wait(harness.LIMIT_S) for each in adding}, {0})
            self.assertEqual(len(host.roll()), 22)

    def test_a_full_disk_does_not_cost_what_was_kept(self):
        with Host(REALTIME) as host:
            host.order(do="message", seats=["ana"], text="Well done")
            kept = host.folder / "class" / "seats" / "ana" / "desk.json"
            before = kept.read_text()
            Path(f"{kept}.new").symlink_to("/dev/full")
            host.order(do="message", seats=["ana"], text="Go on")
            self.assertFalse(kept.is_symlink())
            self.assertEqual(kept.read_text(), before)
            until(lambda: "desk.json cannot be written" in (host.folder / "host.log").read_text())

    def test_a_list_that_has_not_changed_is_not_written_at_a_start(self):
        with Host(REALTIME) as host:
            host.kill()
            Path(f"{host.folder / 'class' / 'class.csv'}.new").symlink_to("/dev/full")
            host.start()
            self.assertEqual(host.seat("ana").said, "ok")

    def test_a_seat_command_in_a_folder_without_a_class_says_what_to_write(self):
        for words in (("list",), ("add", "Ana"), ("remove", "ana"), ("pin", "ana")):
            done = run("seat", *words, "--folder", os.devnull + "/x")
            self.assertEqual((done.returncode, "write the --folder of its coopdyn host" in done.stderr), (1, True), words)

    def test_a_token_that_cannot_be_kept_is_an_error(self):
        with Host(REALTIME) as host:
            host.kill()
            token = host.folder / "class" / "token"
            token.unlink()
            token.mkdir()
            done = run(*host.words[1:], "--port", "0")
            self.assertEqual((done.returncode, "token cannot be written" in done.stderr), (1, True))
            token.rmdir()
            host.start()

    def test_a_folder_whose_path_is_too_long_for_a_socket_is_an_error(self):
        with Host(REALTIME) as host:
            done = run("host", "--students", "2", "--port", "0", "--folder", host.folder / ("x" * 100))
            self.assertEqual((done.returncode, "write a --folder that is" in done.stderr), (1, True))

    def test_only_its_owner_reads_a_folder_that_the_host_makes(self):
        with Host(REALTIME) as host:
            folder = host.folder / "other"
            run("host", "nosuchlesson", "--students", "2", "--port", "0", "--folder", folder)
            self.assertEqual(folder.stat().st_mode & 0o777, 0o700)


if __name__ == "__main__":
    unittest.main()
