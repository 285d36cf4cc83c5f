"""Files of recordings: their names, replacement by --force, and their URLs on the page."""
import http.client
import json
import shutil
import unittest
import urllib.parse
from pathlib import Path

from harness import LIMIT_S, Daemon, scenario, until
from recording import RecordingTestCase, equal_steps, tool

REFUSED = ".hidden.run", ".hidden", "-x.run", "two\nlines.run", "\x7f.run", 201 * "a" + ".run"


def serve(*words):
    return tool("serve", "empty", *words, "--no-net", "--no-http", "--no-render", "--duration", "0.1", "--mode", "free")


class ForceTest(RecordingTestCase):
    def test_only_recordings_are_replaced(self):
        for name, text in (("two.scenario", scenario(2)), ("robot.py", "print('mine')\n"), ("lesson.run", "mine")):
            file = self.folder / name
            file.write_text(text)
            for force in ((), ("--force",)):
                code, said = serve("--record", file, *force)
                self.assertEqual(code, 1, said)
                self.assertIn(f"{name} is not a recording of coopdyn: choose another name", said)
                self.assertEqual(file.read_text(), text)

    def test_recordings_are_replaced_even_if_they_are_empty_or_damaged(self):
        self.assertEqual(serve("--record", self.file)[0], 0)
        for change in (lambda: None, lambda: self.file.write_bytes(self.file.read_bytes()[:5000]),
                       lambda: self.file.write_bytes(b"")):
            change()
            code, said = serve("--record", self.file, "--force")
            self.assertEqual(code, 0, said)
            self.assertGreater(equal_steps(self.file), 0)

    def test_it_is_for_the_file_that_is_named_only(self):
        shutil.copy(__file__, self.folder / "lesson-2.run")
        (self.folder / "lesson-3.run").mkdir()
        self.assertEqual(serve("--record", self.file)[0], 0)
        self.assertEqual(serve("--record", self.folder / "lesson-4.run")[0], 0)
        with Daemon(scenario(1), "--record", self.file, "--force") as daemon, \
                Daemon(scenario(1), "--record", self.folder / "lesson-5.run") as other:
            until((self.folder / "lesson-5.run").exists)
            other.text("/robot1/motors").must("set_wheel_speeds 2 3")
            motors = daemon.text("/robot1/motors")
            for _ in range(2):
                motors.must("set_wheel_speeds 2 3")
                daemon.text("/simulation").must("reset")
            motors.must("set_wheel_speeds 2 3")
        self.assertEqual([equal_steps(self.folder / f"lesson{end}.run") for end in ("", "-5", "-6", "-7")], 4 * [1])
        self.assertEqual((self.folder / "lesson-2.run").read_text(), Path(__file__).read_text())
        self.assertGreater(equal_steps(self.folder / "lesson-4.run"), 1)


class PresentTest(RecordingTestCase):
    def test_after_a_reset_get_recording_names_the_new_file_at_once(self):
        with Daemon(scenario(1), "--record", self.file) as daemon:
            motors, simulation, recorder = (daemon.text(name) for name in ("/robot1/motors", "/simulation", "/recorder"))
            for part in range(1, 11):
                told = recorder.must("get_recording")
                self.assertEqual((told.text, told.data[2]), (f"lesson-{part}.run" if part > 1 else "lesson.run", 0))
                self.assertEqual(daemon.status()["recording"], told.text)
                motors.must("set_wheel_speeds 2 3")
                simulation.must("reset")


class ServedTest(RecordingTestCase):
    def get(self, daemon, path):
        address = urllib.parse.urlsplit(daemon.http)
        connection = http.client.HTTPConnection(address.hostname, address.port, timeout=LIMIT_S)
        connection.request("GET", path)  # as it is
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, content, answer.getheader("Content-Disposition")

    def test_whatever_name_is_accepted_is_served(self):
        with Daemon(scenario(1), "--record", self.folder / "my lesson ü.run", "--recordings", self.folder, "--http") as daemon:
            motors, recorder = daemon.text("/robot1/motors"), daemon.text("/recorder")
            for stem in ("my lesson ü", "a+b%20c", "1 'two' #?&;=@~", 196 * "x"):
                if stem != "my lesson ü":
                    self.assertEqual(recorder.must(f'start "{stem}"').text, f"{stem}.run")
                motors.must("set_wheel_speeds 2 3")
                name, url = recorder.must("stop").text.rsplit(" ", 1)
                self.assertEqual(name, f"{stem}.run")
                self.assertEqual(url, f"{daemon.http}runs/{urllib.parse.quote(name, safe='')}")
                self.assertIn((name, url), [(run["name"], run["url"]) for run in json.loads(recorder.must("list").text)])
                path = urllib.parse.urlsplit(url).path
                status, content, disposition = self.get(daemon, path)
                self.assertEqual((status, content), (200, (self.folder / name).read_bytes()))
                self.assertTrue(disposition.isascii(), disposition)
                self.assertEqual(self.get(daemon, path[:-4] + ".mat")[1][:6], b"MATLAB")
            self.assertEqual(self.get(daemon, "/runs/a+b%2520c.run")[0], 200)

    def test_nothing_else_is_reached(self):
        inner = self.folder / "inner"
        inner.mkdir()
        self.assertEqual(serve("--record", self.file)[0], 0)
        shutil.copy(self.file, inner / ".hidden.run")
        shutil.copy(self.file, inner / "-x.run")
        with Daemon(scenario(1), "--recordings", inner, "--http") as daemon:
            outside = (f"..{slash}lesson{end}" for slash in ("/", "%2f", "%2F", "%5c") for end in (".run", ".mat", ".run%00"))
            full = urllib.parse.quote(str(self.file), safe="")
            for path in (*outside, "%2e%2e%2flesson.run", full, "inner/../../lesson.run", "%2ehidden.run", "-x.run", "a%00.run",
                         "lesson%0d%0aX: y.run", "%ff.run", "%.run", "%4", ".run", ""):
                self.assertEqual(self.get(daemon, "/runs/" + path.replace(" ", "%20"))[0], 404, path)
            self.assertEqual(json.loads(daemon.text("/recorder").must("list").text), [])

    def test_a_name_that_cannot_be_served_is_refused_at_the_start(self):
        for name in REFUSED:
            code, said = serve("--record", self.folder / name)
            self.assertEqual(code, 1, said)
            self.assertIn("for example lesson1", said)
        with Daemon(scenario(1), "--recordings", self.folder) as daemon:
            recorder = daemon.text("/recorder")
            for name in ("-x", ".hidden", "a/b", "../lesson", "a\\nb", 201 * "a"):
                refused = recorder.ask(f'start "{name}"')
                self.assertEqual(refused.error, 4, name)
                self.assertIn("for example lesson1", refused.text)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
