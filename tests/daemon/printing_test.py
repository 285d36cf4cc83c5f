"""Texts of files and peers printed by commands cannot control a terminal, stay in their line, and are cut if very long."""
import json
import socket
import struct
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

from harness import BINARY, Daemon, frame, scenario
from recording import change

NASTY = "a\x1b[2J\x1b]0;owned\x07\u202eb\u2066c\u200b\x9b31m"
FORBIDDEN = [chr(code) for code in (*range(0x0, 0xA), *range(0xB, 0x20), *range(0x7F, 0xA0), 0x202E, 0x2066, 0x200B)]


def run(*arguments, **more):
    return subprocess.run([BINARY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, **more)


def serve_once(answer):
    """A peer that is not a coopdyn daemon: runs `answer(connection)` for each connection. Returns HOST:PORT."""
    listener = socket.create_server(("127.0.0.1", 0))

    def accept():
        while True:
            connection = listener.accept()[0]
            threading.Thread(target=answer, args=(connection,), daemon=True).start()

    threading.Thread(target=accept, daemon=True).start()
    return f"127.0.0.1:{listener.getsockname()[1]}"


class PrintingTest(unittest.TestCase):
    def check(self, done, lines=None):
        for said in (done.stdout, done.stderr):
            text = said.decode()  # it is UTF-8
            for letter in FORBIDDEN:
                self.assertNotIn(letter, text, (done.args, said))
            for line in text.splitlines():
                self.assertLess(len(line), 5000)
        if lines is not None:
            self.assertEqual(len((done.stdout + done.stderr).decode().splitlines()), lines, done)
        return (done.stdout + done.stderr).decode()

    def test_check_and_serve_of_a_nasty_scenario(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{NASTY}\nb.scenario"
            path.write_text(f"[FLOOR]\nsize 4 4 0.1\n{NASTY} 1\ncolor {NASTY}\n[ROBOT_1]\ntype {NASTY}\nname {NASTY}\n"
                            f"position 0 0\ncontroller {NASTY}\n[SIMULATION]\nmode {'x' * 100000}\n[WORLD]\nfile {NASTY}\n")
            self.check(run("check", str(path)))
            self.check(run("serve", str(path), "--port", "0"))

    def test_check_of_a_nasty_model_and_of_a_good_file_with_a_nasty_name(self):
        with tempfile.TemporaryDirectory() as folder:
            model = Path(folder) / f"{NASTY}.sdf"
            model.write_text(f'<sdf version="1.9" xmlns:coopdyn="https://coopdyn.dev/sdf"><model name="m">'
                             f'<link name="\u202e" \u200bx="{"y" * 100000}"/></model></sdf>')
            self.check(run("check", str(model)))
            good = Path(folder) / f"{NASTY}\nb.scenario"
            good.write_text(scenario(1))
            self.check(run("check", str(good)), lines=1)

    def test_files_that_are_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            name = f"{folder}/{NASTY}\nb.run"
            for command in (["info", name], ["verify", name], ["export", name, "--to", "csv"], ["play", name, "--port", "0"],
                            ["check", name], ["serve", name, "--port", "0"], ["serve", "--mode", NASTY],
                            ["new-controller", NASTY]):
                self.check(run(*command))

    def test_a_recording_with_a_nasty_name_and_notes(self):
        with tempfile.TemporaryDirectory() as folder:
            name = f"{folder}/{NASTY}.run"  # under which nothing is recorded, but a file may come
            with Daemon(scenario(1, mode="free"), "--record", f"{folder}/a.run", "--paused") as daemon:
                daemon.binary("/recorder").ask(123, text=NASTY + "\n" + NASTY)
            Path(f"{folder}/a.run").rename(name)
            for command in (["info", name, "--events"], ["info", name, "--json"], ["verify", name]):
                self.check(run(*command))

    def test_a_recording_of_a_machine_with_a_nasty_name(self):
        with tempfile.TemporaryDirectory() as folder:
            name = f"{folder}/a.run"
            with Daemon(scenario(1, mode="free"), "--record", name, "--paused"):
                pass
            change(name, "UPDATE step SET hash = 0")
            for key in ("cpu", "version", "build", "libraries", "controllers"):
                change(name, "UPDATE meta SET value = ? WHERE key = ?", f"{NASTY}\nequal, 9 steps{'x' * 100000} 1", key)
            for command in (["info", name], ["verify", name]):
                said = self.check(run(*command))
                self.assertNotIn("\nequal", said)
            self.assertIn("made by another build", said)

    def test_a_peer_that_answers_nasty_names(self):
        def answer(connection):
            with connection, connection.makefile("rb") as lines:
                for line in lines:
                    if line.startswith(b"OPEN"):
                        connection.sendall(f"error 10 {NASTY}\n".encode())
                    else:
                        connection.sendall(f"registration name /{NASTY}/pose ip {NASTY} port {NASTY} type tcp\r\n"
                                           "*** end of message\r\n".encode())

        server = serve_once(answer)
        for command in (["list"], ["status"], ["doctor"], ["call", "/x", "ping"], ["load", "x"]):
            self.check(run(*command, "--server", server))

    def test_a_peer_that_answers_nasty_texts(self):
        status = json.dumps({"scenario": NASTY + "\n", "mode": NASTY, "state": NASTY, "time_s": 1, "step": 1, "rtf": 1, "speed": None,
                             "playback": {"file": NASTY + "x" * 100000, "speed": 1}, "recording": NASTY,
                             "awaiting": [{"robot": NASTY, "why": NASTY, "seconds": 1}],
                             "robots": [{"name": NASTY, "type": NASTY, "owner": NASTY}]})

        def answer(connection):
            with connection, connection.makefile("rb") as stream:
                stream.readline()
                connection.sendall(b"ok\n")
                first = stream.read(4)
                if first != b"CDS1":
                    connection.sendall(f'0 "{NASTY}" 0 0 0\n'.encode())
                    return
                while head := stream.read(4):
                    body = stream.read(struct.unpack("<I", head)[0])
                    command = struct.unpack("<i", body[4:8])[0]
                    connection.sendall(frame(command, (), (1.0, 2.0), status if command == 100 else NASTY))

        server = serve_once(answer)
        for command in (["status"], ["call", "/x", "ping"], ["load", "x"], ["stop-all"]):
            self.check(run(*command, "--server", server))

    def test_the_log_of_names_and_clients(self):
        with Daemon(scenario(1), "--log-level", "debug") as daemon:
            with socket.create_connection(daemon.names, timeout=60) as names:
                names.sendall(f"NAME_SERVER register /{NASTY} tcp {NASTY} 5\nOPEN {NASTY}\n{NASTY}\n".encode())
                names.shutdown(socket.SHUT_WR)
                while names.recv(4096):
                    pass
            client = daemon.text("/simulation")
            client.ask(f'hello "{NASTY}"')
            client.ask(f'load_scenario "{NASTY}"')
            client.close()
            daemon.end()
            said = daemon.stderr()
        for letter in FORBIDDEN:
            self.assertNotIn(letter, said, ascii(letter))


class HugeLoadTest(unittest.TestCase):
    def test_millions_of_mistakes_take_little_memory_and_few_words(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            loader = daemon.binary("/simulation")
            reply = loader.ask(108, text="[B]\n" * 2_000_000)
            self.assertEqual(reply.error, 7)
            self.assertLessEqual(len(reply.text.splitlines()), 102)
            self.assertIn("more errors", reply.text)
            self.assertIn("the rest was not read", reply.text)
            peak = next(line for line in Path(f"/proc/{daemon.process.pid}/status").read_text().splitlines() if line.startswith("VmHWM"))
            self.assertLess(int(peak.split()[1]), 600_000, peak)  # kB
            self.assertEqual(daemon.status()["state"], "running")


if __name__ == "__main__":
    unittest.main()
