"""Shared by tests of cameras: a connection that reads pictures quickly."""
import struct

from harness import Binary

GET_TIME, GET_IMAGE, RGB, JPEG, DEPTH, SEGMENTATION = 3, 270, 0, 1, 2, 3


class Picture:
    """The reply to get_image: width, height, pixels, legend, time_s, step; or an error with its text."""

    def __init__(self, body):
        self.error, _, t, m, n = struct.unpack("<iiIII", body[:20])
        self.legend = body[20:20 + t].decode()
        if self.error == 0:
            self.width, self.height, count = struct.unpack("<iii", body[20 + t:32 + t])
            self.pixels = body[32 + t:32 + t + count]
            self.time_s, step = struct.unpack("<dd", body[-16:])
            self.step = int(step)

    def __eq__(self, other):
        return vars(self) == vars(other)

    def __repr__(self):
        return f"Picture({self.legend!r})" if self.error else f"Picture({self.width}x{self.height} of step {self.step})"


class Camera(Binary):
    """A connection to the camera of a robot."""

    def __init__(self, daemon, robot, module="camera"):
        super().__init__(daemon, f"/{robot}/{module}")
        daemon.connections.append(self)

    def ask_for_picture(self, kind=RGB):
        self.send(GET_IMAGE, (kind,))

    def receive_picture(self):
        body = self.read_exactly(struct.unpack("<I", self.read_exactly(4))[0])
        return Picture(body)

    def picture(self, kind=RGB):
        self.ask_for_picture(kind)
        picture = self.receive_picture()
        assert picture.error == 0, picture
        return picture
