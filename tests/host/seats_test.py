# SPDX-License-Identifier: MIT
"""Seats of a class: access, and that failures of one daemon or the host cost nobody a run."""
import io
import os
import signal
import socket
import subprocess
import tarfile
import unittest

from classes import BINARY, Host, until
import harness

REALTIME = harness.scenario(mode="realtime")


class Doors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.host = Host(REALTIME).__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.host.__exit__(None, None, None)

    def test_a_student_drives_the_robot_of_the_own_seat(self):
        motors = self.host.module("ana", "/robot1/motors")
        self.assertEqual(motors.ask("set_velocity 0.2 0").error, 0)
        self.assertEqual(self.host.tile("ana", lambda tile: tile.get("clients"))["daemon"], "running")
        motors.close()

    def test_line_and_open_may_come_in_one_piece(self):
        seat = harness.Connection(("127.0.0.1", self.host.port))
        seat.write(f"SEAT ana {self.host.pin('ana')} python\nOPEN /robot1/pose\nget_pose\n")
        self.assertEqual([seat.read_line(), seat.read_line()], ["ok", "ok"])
        self.assertTrue(seat.read_line().startswith('0 "" '))
        self.assertEqual(self.host.tile("ana", lambda tile: tile["language"])["language"], "python")
        seat.close()

    def test_another_students_pin_and_an_unknown_seat_get_the_same_words(self):
        wrong = self.host.seat("ana", self.host.pin("ben"), source="127.0.0.2")
        unknown = self.host.seat("nobody", "7305", source="127.0.0.3")
        self.assertIn("error 12 no seat 'ana' with this PIN", wrong.said)
        self.assertEqual(wrong.said.replace("ana", "x"), unknown.said.replace("nobody", "x"))
        self.assertEqual(wrong.read_to_end(), b"")

    def test_who_tries_pins_has_to_wait(self):
        said = [self.host.seat("ben", f"{pin:04}", source="127.0.0.4").said for pin in range(5)]
        self.assertIn("wait", said[-1])
        # Not even the right one is looked at, and others are not held up.
        self.assertIn("wait", self.host.seat("ben", source="127.0.0.4").said)
        self.assertEqual(self.host.seat("ben", source="127.0.0.5").said, "ok")

    def test_without_the_line_one_is_told_to_say_it(self):
        for words in ("OPEN /robot1/motors\n", "NAME_SERVER list\n", "CDS1", "x" * 300, "SEAT ana\n"):
            guest = harness.Connection(("127.0.0.1", self.host.port))
            guest.write(words)
            self.assertIn("begin with SEAT NAME PIN", guest.read_line(), words)
            self.assertEqual(guest.read_to_end(), b"")

    def test_pages_of_other_seats_are_refused(self):
        me = self.host.as_student("ana")
        self.assertEqual(self.host.fetch("GET", "/s/ana/api/status", headers=me)[0], 200)
        for path in ("/s/ben/api/status", "/s/ben/ws", "/s/ben/class/me", "/s/../s/ben/api/status", "/s/ana/../ben/api/status",
                     "/s/ana%2f..%2fben/api/status", "/wall/s/ben/api/status", "/wall/class/seats", "/wall/class/collect.tar"):
            self.assertIn(self.host.fetch("GET", path, headers=me)[0], (400, 403, 404), path)
        self.assertEqual(self.host.fetch("POST", "/wall/class/do", {"do": "freeze"}, me)[0], 403)
        self.assertEqual(self.host.fetch("POST", "/s/ben/api/call", {}, me)[0], 403)

    def test_the_page_of_another_seat_leads_to_the_login(self):
        status, _, headers = self.host.fetch("GET", "/s/ben/")
        self.assertEqual((status, headers["Location"]), (303, "/"))

    def test_name_and_pin_give_the_seats_cookie(self):
        status, text, headers = self.host.fetch("POST", "/login", {"name": "Ana", "pin": self.host.pin("ana")})
        self.assertEqual((status, text.strip()), (200, '{"go":"/s/ana/"}'))
        self.assertIn("Path=/s/ana/; HttpOnly; SameSite=Strict", headers["Set-Cookie"])
        self.assertEqual(self.host.fetch("POST", "/login", {"name": "ana", "pin": "0"})[0], 403)

    def test_a_personal_link_needs_no_pin(self):
        link = self.host.roll()["ben"]["link"]
        status, _, headers = self.host.fetch("GET", f"/l/{link}")
        self.assertEqual((status, headers["Location"]), (303, "/s/ben/"))
        self.assertEqual(self.host.fetch("GET", "/l/" + link[:-1] + "x")[0], 404)
        self.assertEqual(self.host.fetch("GET", "/l/")[0], 404)

    def test_requests_from_other_pages_and_hosts_are_refused(self):
        me = self.host.as_student("ana")
        self.assertEqual(self.host.fetch("GET", "/s/ana/api/status", headers={**me, "Host": "evil.example"})[0], 403)
        self.assertEqual(self.host.fetch("POST", "/s/ana/class/hand", {"up": True}, {**me, "Origin": "http://evil.example"})[0], 403)
        self.assertEqual(self.host.fetch("POST", "/s/ana/class/hand", {"up": True}, {**me, "Content-Type": "text/plain"})[0], 403)

    def test_a_program_downloads_with_its_pin(self):
        def ask(pin):
            return self.host.fetch("GET", "/s/ana/api/status", headers={"Authorization": f"Bearer ana:{pin}"})[0]
        self.assertEqual(ask(self.host.pin("ana")), 200)
        self.assertEqual(ask("0000"), 403)


class Lives(unittest.TestCase):
    def test_a_killed_daemon_comes_back_at_its_last_recorded_moment(self):
        with Host(REALTIME) as host:
            motors = host.module("ana", "/robot1/motors")
            motors.must("set_velocity 0.2 0")
            until(lambda: host.status("ana")["step"] > 120)
            first = host.daemon("ana")
            os.kill(first, signal.SIGKILL)
            motors.read_to_end()  # the client hears of it
            host.await_other_daemon("ana", first)
            after = host.status("ana")
            self.assertGreater(after["step"], 10)
            self.assertEqual(after["robots"][0]["name"], "robot1")
            self.assertNotEqual(host.daemon("ana"), first)
            self.assertIn("crashed", host.tiles()["ana"]["trouble"])

    def test_a_host_that_is_killed_and_started_again_finds_its_seats(self):
        with Host() as host:
            motors = host.module("ana", "/robot1/motors")
            for _ in range(5):
                motors.must("set_velocity 0.2 0")
            daemon = host.daemon("ana")
            host.kill()
            self.assertEqual(motors.must("set_velocity 0.2 0").step, 6)  # nobody's run stops
            host.start()
            self.assertEqual(motors.must("set_velocity 0.2 0").step, 7)
            self.assertEqual(host.status("ana")["step"], 7)
            self.assertEqual(host.daemon("ana"), daemon)

    def test_a_seat_that_is_put_aside_continues_where_it_was(self):
        with Host() as host:
            motors = host.module("ana", "/robot1/motors")
            for _ in range(50):
                motors.must("set_velocity 0.2 0.3")
            before = host.status("ana")
            host.order(do="aside", seats=["ana"])
            motors.read_to_end()
            host.tile("ana", lambda tile: tile["daemon"] == "asleep")
            until(lambda: not host.daemon("ana"))
            after = host.status("ana")
            self.assertEqual((after["step"], after["hash"]), (before["step"], before["hash"]))

    def test_a_recording_that_a_student_ends_is_followed_by_another(self):
        with Host() as host:
            recorder = host.module("ana", "/recorder")
            recorder.must("stop")
            until(lambda: host.status("ana")["recording"])
            self.assertIn("000002", str(host.status("ana")["recording"]))

    def test_an_idle_seat_is_put_aside_by_itself(self):
        with Host(REALTIME, "--idle", "0.02") as host:
            pose = host.module("ana", "/robot1/pose")
            host.tile("ana", lambda tile: tile["daemon"] == "running" and tile.get("clients") == 1)
            pose.close()
            host.tile("ana", lambda tile: tile["daemon"] == "asleep")

    def test_a_scenario_that_always_crashes_is_given_up_for_the_lesson(self):
        with Host(REALTIME) as host:
            host.status("ana")
            for _ in range(3):
                daemon = host.daemon("ana")
                os.kill(daemon, signal.SIGKILL)
                host.await_other_daemon("ana", daemon)
                host.status("ana")
            self.assertIn("begun anew", host.tiles()["ana"]["trouble"])

    def test_the_list_may_change_while_the_class_runs(self):
        with Host() as host:
            def seat(*words):
                return subprocess.run([BINARY, "seat", *words, "--folder", str(host.folder / "class")], capture_output=True,
                                      text=True, timeout=harness.LIMIT_S)
            self.assertEqual(host.seat("ben").said, "ok")
            added = seat("add", "Cleo Paz", "--pin", "4321")
            self.assertEqual(added.stdout, "cleo-paz 4321 Cleo Paz\n")
            until(lambda: host.seat("cleo-paz", source="127.0.0.9").said == "ok")
            self.assertEqual(seat("remove", "ben").returncode, 0)
            until(lambda: "ben" not in host.tiles())
            until(lambda: not host.daemon("ben"))
            self.assertIn("no seat", host.seat("ben", "1111").said)
            self.assertIn("did you mean ana?", seat("pin", "anna").stderr)
            old = host.as_student("ana")
            self.assertEqual(seat("pin", "ana", "8888").stdout, "ana 8888 ana\n")
            until(lambda: host.fetch("GET", "/s/ana/api/status", headers=old)[0] == 403)

    def test_seats_have_ports_of_their_own_for_machines_that_showed_the_pin(self):
        with Host(REALTIME, "--seat-ports", "21000") as host:
            ports = {name: host.me(name)["own_port"] for name in ("ana", "ben")}
            self.assertEqual(ports, {"ana": 21000, "ben": 21100})
            for words in (("remove", "ana"), ("add", "Cleo"), ("add", "Dan")):
                subprocess.run([BINARY, "seat", *words, "--folder", str(host.folder / "class")], check=True, capture_output=True)
            until(lambda: "dan" in host.tiles())
            self.assertEqual(sorted(host.me(name)["own_port"] for name in ("ben", "cleo", "dan")), [21000, 21100, 21200])

    @harness.with_own_ports
    def test_a_machine_that_did_not_show_the_pin_is_refused_at_these_ports(self):
        def ask(source):
            connection = socket.create_connection(("127.0.0.1", 21000), harness.LIMIT_S, (source, 0))
            try:
                connection.sendall(b"OPEN /robot1/pose\n")
                return connection.recv(100)
            except ConnectionResetError:
                return b""
        with Host(REALTIME, "--seat-ports", "21000") as host:
            seat = host.seat("ana", source="127.0.0.6")
            self.assertEqual(seat.said, "ok")
            until(lambda: host.tiles()["ana"]["daemon"] == "running")
            self.assertEqual(ask("127.0.0.7"), b"")
            self.assertEqual(until(lambda: ask("127.0.0.6")), b"ok\n")

    def test_one_folder_has_one_host(self):
        with Host() as host:
            second = subprocess.run([*host.words, "--port", "0"], capture_output=True, text=True, timeout=harness.LIMIT_S)
            self.assertEqual(second.returncode, 1)
            self.assertIn("another host uses the folder", second.stderr)

    def test_a_lesson_with_mistakes_is_refused_before_anybody_comes(self):
        done = subprocess.run([BINARY, "host", "nosuchlesson", "--students", "2", "--port", "0", "--folder", os.devnull + "x/y"],
                              capture_output=True, text=True, timeout=harness.LIMIT_S)
        self.assertNotEqual(done.returncode, 0)


class Teaching(unittest.TestCase):
    def test_while_the_teacher_drives_the_student_may_only_watch(self):
        with Host(REALTIME) as host:
            motors, pose = host.module("ana", "/robot1/motors"), host.module("ana", "/robot1/pose")
            motors.must("set_velocity 0.2 0")
            host.order(do="take", seats=["ana"])
            self.assertTrue(host.me("ana")["taken"])
            refused = until(lambda: next((r for r in [motors.ask("set_velocity 0.1 0")] if r.error), None))
            self.assertEqual((refused.error, "the teacher has taken over or frozen this seat" in refused.text), (12, True))
            pose.must("get_pose")
            call = {"module": "/simulation", "command": "pause"}
            self.assertEqual(host.fetch("POST", "/s/ana/api/call", call, host.as_student("ana"))[0], 403)
            self.assertEqual(host.fetch("POST", "/wall/s/ana/api/call", call, host.as_teacher())[0], 200)
            self.assertEqual(host.status("ana")["state"], "paused")
            host.order(do="give", seats=["ana"])
            until(lambda: motors.ask("set_velocity 0.1 0").error == 0)

    def test_a_frozen_class_stands_still_also_after_a_restart_of_the_host(self):
        with Host(REALTIME) as host:
            motors = host.module("ana", "/robot1/motors")
            host.order(do="freeze")
            until(lambda: host.status("ana")["state"] == "paused")
            host.kill()
            host.start()
            self.assertTrue(host.me("ana")["frozen"])
            until(lambda: motors.ask("set_velocity 0.1 0").error == 12)
            host.order(do="thaw")
            until(lambda: host.status("ana")["state"] == "running")
            until(lambda: motors.ask("set_velocity 0.1 0").error == 0)

    def test_a_raised_hand_comes_first(self):
        with Host(students=("ana", "ben", "cleo")) as host:
            host.fetch("POST", "/s/cleo/class/hand", {"up": True}, host.as_student("cleo"))
            tiles = host.tiles()
            self.assertEqual(list(tiles)[0], "cleo")
            self.assertIn("hand up", tiles["cleo"]["why"])
            host.order(do="lower_hand", seats=["cleo"])
            self.assertFalse(host.me("cleo")["hand"])

    def test_messages_and_scenarios_reach_the_seats(self):
        with Host(REALTIME) as host:
            host.status("ana")
            host.order(do="message", seats=["ana"], text="Well done <b>")
            self.assertEqual([note["text"] for note in host.me("ana")["notes"]], ["Well done <b>"])
            self.assertEqual(host.me("ben")["notes"], [])
            host.order(do="push", text=harness.scenario(robots=2))
            until(lambda: host.status("ana")["robot_count"] == 2)
            self.assertEqual(host.status("ben")["robot_count"], 2)  # it slept, and begins with it
            status, text, _ = host.fetch("POST", "/wall/class/do", {"do": "dance"}, host.as_teacher())
            self.assertEqual(status, 400)
            self.assertIn("freeze", text)

    def test_a_pushed_scenario_with_mistakes_is_reported(self):
        with Host(REALTIME) as host:
            host.status("ana")
            host.order(do="push", seats=["ana"], text="[WORLD]\nfile nosuch.world\n")
            tile = host.tile("ana", lambda tile: tile["error"])
            self.assertIn("there is no world 'nosuch.world'", tile["error"])
            self.assertIn("there is no world 'nosuch.world'", tile["why"])

    def test_pages_are_served_by_the_advertised_name(self):
        with Host(REALTIME, "--advertise", "labserver") as host:
            named = {"Host": f"labserver:{host.http_port}"}
            self.assertEqual(host.fetch("GET", "/s/ana/", headers={**named, **host.as_student("ana")})[0], 200)
            self.assertEqual(host.fetch("GET", "/wall/s/ana/api/status", headers={**named, **host.as_teacher()})[0], 200)

    def test_the_sheet_has_its_style_and_leads_strangers_to_the_wall(self):
        with Host() as host:
            self.assertIn('sheet.css"', host.fetch("GET", "/wall/class/sheet", headers=host.as_teacher())[1])
            self.assertIn("text/css", host.fetch("GET", "/sheet.css")[2]["Content-Type"])
            status, _, headers = host.fetch("GET", "/wall/class/sheet")
            self.assertEqual((status, headers["Location"]), (303, "/wall/#to=sheet"))

    def test_a_hand_in_keeps_the_recording_and_is_collected(self):
        with Host() as host:
            motors = host.module("ana", "/robot1/motors")
            for _ in range(5):
                motors.must("set_velocity 0.2 0")
            self.assertEqual(host.fetch("POST", "/s/ana/class/hand-in", {}, host.as_student("ana"))[0], 200)
            self.assertEqual(len(host.me("ana")["handed_in"]), 1)
            self.assertEqual(host.tiles()["ana"]["handed_in"], 1)
            kept = next((host.folder / "class" / "seats" / "ana" / "handed-in").glob("*/recording.run"))
            self.assertEqual(subprocess.run([BINARY, "verify", str(kept)], capture_output=True, timeout=harness.LIMIT_S).returncode, 0)
            status, archive, _ = host.fetch("GET", "/wall/class/collect.tar", headers=host.as_teacher(), raw=True)
            self.assertEqual(status, 200)
            with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
                self.assertIn(f"seats/ana/handed-in/{kept.parent.name}/recording.run", tar.getnames())
                self.assertEqual(tar.extractfile("students.csv").read(), b"seat,name,group\nana,ana,\nben,ben,\n")

    def test_a_wrong_token_does_not_open_the_wall(self):
        with Host() as host:
            self.assertEqual(host.fetch("GET", "/wall/class/seats")[0], 403)
            self.assertEqual(host.fetch("POST", "/wall/login", {"token": "x" * 24})[0], 403)
            status, _, headers = host.fetch("POST", "/wall/login", {"token": host.token})
            self.assertEqual(status, 200)
            self.assertIn("Path=/wall/; HttpOnly; SameSite=Strict", headers["Set-Cookie"])


if __name__ == "__main__":
    unittest.main()
