"""Ports and connections that YARP programs make the daemon open, and their limits."""
import re
import resource
import socket
import struct
import unittest

from harness import Connection, Daemon, run_in_new_network, scenario, set_address, until
from yarp_ports import CODES, HEADER, Reader, YarpPorts, registration

OUTER = "10.9.9.9"  # exists only inside the namespace of a scene


def hello(daemon, port, name, carrier="tcp", address=None):
    """A connection to one of our ports, after the handshake."""
    host, number = registration(daemon, port)
    connection = daemon.keep(Connection((address or host, number)))
    said = name.encode() + b"\0"
    connection.write(HEADER.pack(b"YA", 7777 + CODES[carrier], b"RP") + struct.pack("<i", len(said)) + said)
    return connection


class YarpAccessTest(YarpPorts, unittest.TestCase):
    def ask_for_many(self, daemon, count, module="/robot1/pose"):
        names = daemon.keep(Connection(daemon.names))
        for number in range(1, count + 1):
            names.write(f"NAME_SERVER query {module}/{number}/state:o\n")
            while not names.read_line().startswith("*** end"):
                pass

    def test_ports_that_nobody_connects_to_are_bounded_and_close(self):
        with Daemon(scenario(1)) as daemon:
            connection = hello(daemon, "/robot1/pose/3/state:o", "anon")  # this one is in use
            connection.read_exactly(8)
            address = registration(daemon, "/robot1/pose/3/state:o")
            before = daemon.open_files()
            self.ask_for_many(daemon, 400)
            self.ask_for_many(daemon, 100, "/simulation")
            self.assertLess(daemon.open_files(), before + 150)
            until(lambda: daemon.open_files() <= before + 4)
            names = daemon.keep(Connection(daemon.names))
            names.write("NAME_SERVER list\n")
            listed = []
            while not (line := names.read_line()).startswith("***"):
                listed.append(line.split()[2])
            self.assertEqual([name for name in listed if name.endswith(":o")], ["/robot1/pose/3/state:o"])
            self.assertEqual(registration(daemon, "/robot1/pose/3/state:o"), address)
            self.assertIsNotNone(registration(daemon, "/robot1/pose/7/state:o"))  # it opens anew

    def test_running_out_of_files_is_told_once(self):
        with Daemon(scenario(1)) as daemon:
            _, hard = resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE)
            resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE, (daemon.open_files() + 5, hard))
            self.ask_for_many(daemon, 60)
            until(lambda: "Too many open files" in daemon.stderr())
            resource.prlimit(daemon.process.pid, resource.RLIMIT_NOFILE, (hard, hard))
            self.ask_for_many(daemon, 5)
            self.assertEqual(daemon.stderr().count("Too many open files"), 1)

    def test_nobody_takes_the_name_of_a_port_that_is_not_open_yet(self):
        with Daemon(scenario(1)) as daemon:
            names = daemon.keep(Connection(daemon.names))
            names.write("NAME_SERVER register /robot1/pose/state:o tcp 127.0.0.1 17001\n")
            self.assertIn("is a name of the daemon", names.read_line())

    def test_the_daemon_does_not_connect_to_itself(self):
        with Daemon(scenario(1)) as daemon:
            for target in ("/simulation", "/robot1/motors", "/robot1/motors/command:i"):
                admin = self.admin(daemon, "/robot1/pose/state:o")
                self.assertIsNotNone(registration(daemon, target))
                self.assertIn("Do not know how to connect", self.ask(admin, f'[add] "tcp:/{target}"'))

    def test_plug_ins_of_the_daemon_are_refused_in_words(self):
        with Daemon(scenario(1)) as daemon:
            Reader(daemon)
            admin = self.admin(daemon, "/robot1/pose/state:o")
            for carrier in ("tcp+send.portmonitor+type.lua", "fast_tcp+log.in", "tcp+recv.portmonitor+send.portmonitor"):
                self.assertRegex(self.ask(admin, f'[add] "{carrier}://reader"'), "^-1 .*no plug-in runs in the daemon", carrier)
            for carrier in ("mcast", "http", "mjpeg", "shmem"):
                self.assertRegex(self.ask(admin, f'[add] "{carrier}://reader"'), "^-1 .*use tcp, fast_tcp", carrier)
            for carrier in ("tcp", "fast_tcp", "udp"):
                connection = hello(daemon, "/robot1/motors/command:i", "/w (recv portmonitor) (type dll)", carrier)
                self.assertNotEqual(connection.read_to_end()[:2], b"YA", carrier)
            until(lambda: "no plug-in runs in the daemon" in daemon.stderr())
            self.assertEqual(hello(daemon, "/robot1/motors/command:i", "/w (send portmonitor)").read_exactly(2), b"YA")

    def test_mjpeg_is_refused_at_once(self):
        with Daemon(scenario(1)) as daemon:
            for module in ("/robot1/pose", None):
                reader = daemon.raw(module)
                reader.write("GET /?action=stream\n\n HTTP/1.1\r\n")
                self.assertIn(b"not HTTP", reader.read_to_end())

    def test_datagrams_of_a_program_without_a_port_end_when_it_is_silent(self):
        with Daemon(scenario(1)) as daemon:
            registration(daemon, "/robot1/motors/command:i")
            before = daemon.open_files()
            for number in range(20):
                handshake = hello(daemon, "/robot1/motors/command:i", f"/nobody{number}" if number % 2 else "anon", "udp")
                self.assertEqual(handshake.read_exactly(2), b"YA")
                handshake.close()
            self.assertGreater(daemon.open_files(), before + 20)
            until(lambda: daemon.open_files() <= before + 4)

    def test_a_program_is_asked_for_its_version_before_it_is_welcome(self):
        with Daemon(scenario(1)) as daemon:
            peer = Reader(daemon, "/ctl/rpc:o", 4)
            connection = hello(daemon, "/robot1/pose", "/ctl/rpc:o")
            probe = peer.accept()
            probe.begins()
            self.assertFalse(connection.has_bytes())
            peer.answer_probe(probe)
            self.assertEqual(connection.read_exactly(2), b"YA")

    def scene(self, name):
        run_in_new_network(__file__, name)

    def test_a_stranger_registers_its_own_address_alone(self):
        self.scene("registers")

    def test_what_another_name_server_says_leads_no_stranger_inside(self):
        self.scene("another_name_server")


class Scenes(YarpPorts, unittest.TestCase):
    """Run by main below, inside a new network namespace."""

    def names(self, host, port, line):
        connection = Connection((host, port))
        connection.write(f"NAME_SERVER {line}\n")
        said = connection.read_line()
        connection.close()
        return said

    def add(self, daemon, host, target):
        connection = daemon.keep(Connection((host, registration(daemon, "/robot1/pose/state:o")[1])))
        connection.write("CONNACK admin\r\n")
        connection.read_line()
        return self.ask(connection, f"[add] {target}")

    def inside(self, daemon):
        """A port that only this machine can reach."""
        listener = daemon.keep(socket.create_server(("127.0.0.1", 0)))
        return listener, listener.getsockname()[1]

    def assert_untouched(self, listener):
        listener.setblocking(False)
        with self.assertRaises(BlockingIOError):
            listener.accept()

    def scene_registers(self):
        with Daemon(scenario(1), "--host", "0.0.0.0") as daemon:
            port = daemon.names[1]
            listener, inner = self.inside(daemon)
            for address in ("127.0.0.1", "localhost", "0.0.0.0", "::1", "::ffff:127.0.0.1", "10.9.9.8", "169.254.169.254"):
                said = self.names(OUTER, port, f"register /evil tcp {address} {inner}")
                self.assertRegex(said, rf"refused: .*own address alone: write {OUTER}", address)
            said = self.names(OUTER, port, f"register /127.0.0.1:{inner} tcp 127.0.0.1 {inner}")
            self.assertIn("refused", said)
            for target in ("/evil", '"tcp://evil"', '"/evil" "udp"', f'"tcp://127.0.0.1:{inner}"', f'"tcp:/127.0.0.1:{inner}/"',
                           f'"tcp://127.0.0.1:{inner}/evil"', f'"/127.0.0.1:{inner}"', '"tcp://simulation"'):
                self.assertIn("Do not know how to connect", self.add(daemon, OUTER, target), target)
            self.assertRegex(self.names(OUTER, port, "subscribe /robot1/pose/state:o /evil"), "ok")
            # As YARP's own ports register, and what a program on this machine says of itself.
            self.assertRegex(self.names(OUTER, port, "register /a"), f"name /a ip {re.escape(OUTER)} port")
            self.assertRegex(self.names(OUTER, port, "register /b tcp ... 17001"), f"ip {re.escape(OUTER)} port 17001")
            self.assertRegex(self.names(OUTER, port, f"register /c tcp {OUTER} 17002"), "port 17002")
            self.assertRegex(self.names("127.0.0.1", port, f"register /local tcp {OUTER} 17003"), "port 17003")
            self.assert_untouched(listener)

    def scene_another_name_server(self):
        with Daemon(scenario(0)) as server:  # anybody may register anything there
            listener, inner = self.inside(server)
            for name, address in (("/evil", "127.0.0.1"), ("/null", "0.0.0.0"), ("/mapped", "::ffff:127.0.0.1"),
                                  ("/named", "localhost"), ("/six", "::1")):
                self.names("127.0.0.1", server.names[1], f"register {name} tcp {address} {inner}")
            with Daemon(scenario(1), "--host", "0.0.0.0", "--yarp-server", f"127.0.0.1:{server.names[1]}") as daemon:
                for name in ("evil", "null", "mapped", "named", "six"):
                    self.assertIn("Do not know how to connect", self.add(daemon, OUTER, f'"tcp://{name}"'), name)
                injected = r'"tcp://x\nregister /injected tcp 127.0.0.1 5"'
                self.assertIn("Do not know how to connect", self.add(daemon, "127.0.0.1", injected))
                self.assertNotIn("injected", self.names("127.0.0.1", server.names[1], "query /injected"))
                self.assert_untouched(listener)
                # A program of this machine goes where it likes.
                admin = daemon.keep(Connection(registration(daemon, "/robot1/pose/state:o")))
                admin.write('CONNACK admin\r\na\r\n[add] "tcp://evil"\r\n')
                listener.settimeout(60)
                listener.accept()[0].close()


if __name__ == "__main__":
    import sys

    set_address("lo", "127.0.0.1")
    set_address("lo:1", OUTER)
    getattr(Scenes(), "scene_" + sys.argv[1])()
