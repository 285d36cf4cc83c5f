# SPDX-License-Identifier: MIT
"""The scripted daemon's /recorder and page: recordings of any name exist, and each contains its own path."""
import urllib.parse

from fake_swarm import encode

NAMES = {"start": 121, "stop": 122}


class Runs:
    def __init__(self, daemon):
        self.daemon, self.name = daemon, ""
        self.headers = []  # of the last request

    @property
    def url(self):
        seat = f"s/{self.daemon.seat.split(':')[0]}/" if self.daemon.seat else ""
        return f"http://127.0.0.1:{self.daemon.port}/{seat}" if self.daemon.page else "off"

    def answer(self, command, text):
        if command == NAMES["start"]:
            self.name = text + ".run"
        has_url = command == NAMES["stop"] and self.daemon.page
        said = f"{self.name} {self.url}runs/{urllib.parse.quote(self.name)}" if has_url else self.name
        return encode(0, said, command, (), self.daemon.clock())

    def page(self, line, file):
        """The answer to `GET path HTTP/1.1`, whose first line has been read."""
        self.headers = []
        while header := file.readline().decode().strip():
            self.headers.append(header)
        if self.daemon.seat and f"Authorization: Bearer {self.daemon.seat}" not in self.headers:
            return b"HTTP/1.1 403 Forbidden\r\nContent-Length: 17\r\nConnection: close\r\n\r\nnot your own seat"
        body = urllib.parse.unquote(line.split()[1]).encode()
        return b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\nConnection: close\r\n\r\n" % len(body) + body
