"""YARP programs beside the daemon: read, administer and write to its ports."""
import socket
import struct

from harness import LIMIT_S, Connection

HEADER = struct.Struct("<2si2s")
ACK = HEADER.pack(b"YA", 0, b"RP")
CODES = {"udp": 0, "fast_tcp": 3, "tcp": 3 + 128}


def registration(daemon, name):
    """(host, port) of a name; None if unregistered."""
    connection = daemon.keep(Connection(daemon.names))
    connection.write(f"NAME_SERVER query {name}\n")
    words = connection.read_line().split()
    connection.close()
    return (words[4], int(words[6])) if words[0] == "registration" else None


class Accepted(Connection):
    """A connection opened by a peer."""

    def __init__(self, accepted):
        accepted.settimeout(LIMIT_S)
        self.socket, self.buffer = accepted, b""

    def begins(self):
        while len(self.buffer) < 8:
            self._more()
        return self.buffer[:8]

    def read_hello(self, port=11064):
        head = self.read_exactly(8)
        if head[:2] == b"YA":
            size, = struct.unpack("<i", self.read_exactly(4))
            self.hello = head[2:6], self.read_exactly(size)[:-1].decode()
            self.write(HEADER.pack(b"YA", port, b"RP"))
        else:
            self.hello = head.decode().strip(), self.read_line()
            self.write(f"Welcome {self.hello[1]}\r\n")

    def read_sample(self, ack=b""):
        """Reads the command with its envelope, and the payload, of a binary carrier."""
        begin = self.read_exactly(18)
        assert (begin[:8], begin[9:]) == (HEADER.pack(b"YA", 10, b"RP"), b"\1" + b"\xff" * 8), begin
        sizes = struct.unpack(f"<{begin[8] + 1}i", self.read_exactly(4 * (begin[8] + 1)))
        content = self.read_exactly(sum(sizes))
        size, mark, code = struct.unpack_from("<i2s2s", content, 0)
        assert (mark, code) == (b"~\0", b"\0\1"), content
        self.write(ack)
        return content[8:8 + size].rstrip(b"\0").decode(), content[8 + size:]


class Reader:
    """A port of another program, registered as `name`; `version` of its YARP."""

    def __init__(self, daemon, name="/reader", version=3):
        self.daemon, self.name, self.version = daemon, name, version
        self.listener = socket.create_server(("127.0.0.1", 0))
        daemon.keep(self.listener)
        self.listener.settimeout(LIMIT_S)
        connection = daemon.keep(Connection(daemon.names))
        connection.write(f"NAME_SERVER register {name} tcp 127.0.0.1 {self.listener.getsockname()[1]}\n")
        assert connection.read_line().startswith("registration"), name
        connection.close()

    def accept(self):
        return self.daemon.keep(Accepted(self.listener.accept()[0]))

    def first_sample(self):
        """The first sample of a connection; earlier connections may have been replaced."""
        while True:
            connection = self.accept()
            try:
                if connection.begins() == b"CONNACK ":
                    self.answer_probe(connection)
                else:
                    connection.read_hello()
                    return connection.read_sample(ACK)
            except (EOFError, OSError):
                pass

    def answer_probe(self, probe=None):
        """Answers the query of this program's version."""
        probe = probe or self.accept()
        assert probe.read_line() == "CONNACK admin"
        assert (probe.read_line(), probe.read_line()) == ("a", "[pid]")
        answer = '1 "" 4711' if self.version == 3 else '[fail] "send [help] for list of valid commands"'
        probe.write(f"Welcome admin\r\n{answer}\r\n<ACK>\r\n")
        probe.close()


class YarpPorts:
    """Helpers of tests of ports; a mix-in of TestCase."""

    def admin(self, daemon, port):
        """An administrative connection to one of our ports."""
        connection = daemon.keep(Connection(registration(daemon, port)))
        connection.write("CONNACK admin\r\n")
        self.assertEqual(connection.read_line(), "Welcome admin")
        return connection

    def ask(self, connection, request):
        connection.write(f"a\r\n{request}\r\n")
        lines = [connection.read_line()]
        self.assertEqual(connection.read_line(), "<ACK>")
        return lines[0]

    def connect(self, daemon, port, reader, carrier="tcp"):
        """Makes our port send to the reader; returns the reader's end of the connection."""
        admin = self.admin(daemon, port)
        admin.write(f'a\r\n[add] "{carrier}:/{reader.name}"\r\n')
        if carrier in CODES:
            reader.answer_probe()
        accepted = reader.accept()
        accepted.read_hello()
        self.assertEqual(accepted.hello[1], port)
        self.assertEqual(admin.read_line(), f'0 "Added connection from {port} to {carrier}:/{reader.name}\\r\\n"')
        admin.close()
        return accepted

    def links(self, daemon, port):
        return self.ask(self.admin(daemon, port), "[list] [out]")
