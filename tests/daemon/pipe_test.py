"""Scenarios read from a pipe: serve, check and load."""
import fcntl
import os
import signal
import subprocess
import tempfile
import termios
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon, scenario, until

RUN = ("--mode", "free", "--duration", "0.05", "--no-net", "--no-render")


def piped(text, *words, cwd=None):
    return subprocess.run([os.path.abspath(BINARY), *words], input=text.encode(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=LIMIT_S,
                          cwd=cwd)


class PipeTest(unittest.TestCase):
    def test_serve_reads_a_scenario_from_standard_input(self):
        done = piped(scenario(2), "serve", "-", *RUN)
        self.assertEqual((done.returncode, done.stdout), (0, b"ready names=off http=off robots=2\n"), done.stderr)

    def test_serve_reads_a_scenario_that_the_shell_pipes_in(self):
        command = f"{BINARY} serve <(printf '%s' \"$TEXT\") {' '.join(RUN)}"
        done = subprocess.run(["bash", "-c", command], env={**os.environ, "TEXT": scenario(3)}, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=LIMIT_S)
        self.assertEqual((done.returncode, done.stdout), (0, b"ready names=off http=off robots=3\n"), done.stderr)

    def test_what_it_names_lies_in_the_working_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "own.world").write_text("[FLOOR]\nsize 7 7 0.1\n")
            text = "[WORLD]\nfile own.world\n[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n"
            done = piped(text, "serve", "-", *RUN, cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_mistakes_are_told_by_their_line(self):
        for verb in (("serve", "-", *RUN), ("check", "-")):
            done = piped(scenario(1).replace("type coopbot", "type cooopbot"), *verb)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr.decode(), r"\A-:\d+: error: .*cooopbot[^\n]*\n\Z")

    def test_an_empty_pipe_is_a_mistake(self):
        for verb in (("serve", "-", *RUN), ("check", "-")):
            done = piped("\n", *verb)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr.decode(), r"\A-: error: nothing came through the pipe[^\n]*\n\Z")

    def test_a_signal_ends_the_wait_for_the_writer(self):
        process = subprocess.Popen([BINARY, "serve", "-", *RUN], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        process.stdin.write(b"[FLOOR]\n")
        process.stdin.flush()
        try:
            until(lambda: fcntl.ioctl(process.stdin, termios.FIONREAD, bytes(4)) == bytes(4))  # it has read that much
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(LIMIT_S), -signal.SIGTERM)
        finally:
            process.kill()
            process.communicate()

    def test_a_question_how_the_run_stands_does_not_end_the_wait_for_the_writer(self):
        process = subprocess.Popen([BINARY, "serve", "-", *RUN], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        process.stdin.write(b"# nothing yet\n")
        process.stdin.flush()
        try:
            until(lambda: fcntl.ioctl(process.stdin, termios.FIONREAD, bytes(4)) == bytes(4))  # it has read that much
            process.send_signal(signal.SIGUSR1)
            out, told = process.communicate(scenario(1).encode(), LIMIT_S)
            self.assertEqual((process.returncode, out), (0, b"ready names=off http=off robots=1\n"), told)
        finally:
            process.kill()
            process.communicate()

    def test_reload_says_that_it_cannot_be_read_again(self):
        reader, writer = os.pipe()
        os.write(writer, scenario(1).encode())
        os.close(writer)
        try:
            with Daemon(name="-", before_exec=lambda: os.dup2(reader, 0)) as daemon:
                self.assertEqual(daemon.status()["scenario"], "(text)")
                reply = daemon.text("/simulation").ask("reload")
                self.assertNotEqual(reply.error, 0)
                self.assertIn("coopdyn load FILE", reply.text)
                self.assertEqual(len(daemon.status()["robots"]), 1)
        finally:
            os.close(reader)

    def test_load_sends_what_comes_through_a_pipe(self):
        with Daemon(scenario(1)) as daemon:
            done = piped(scenario(3), "load", "-", "--server", f"127.0.0.1:{daemon.names[1]}")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(len(daemon.status()["robots"]), 3)


if __name__ == "__main__":
    unittest.main()
