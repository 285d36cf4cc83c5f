# SPDX-License-Identifier: MIT
"""Sensors of the scripted daemon's robots, with known readings. The cameras have a rate: they show every third step."""
import math
import struct

MODULES = {"gyro": "imu", "mast_imu": "imu", "wrench": "wrench", "lidar": "lidar", "rear_lidar": "lidar", "contact": "contact", "sonar": "sonar", "infrared": "infrared",
           "light": "light", "left_camera": "camera", "right_camera": "camera", "battery": "battery", "odometry": "odometry"}
FIRST = {"imu": 230, "wrench": 240, "lidar": 250, "contact": 260, "sonar": 320, "infrared": 330, "light": 310, "camera": 271,
         "battery": 290, "odometry": 340}
NAMES = {"imu": {"get_imu": 230}, "wrench": {"get_wrench": 240}, "lidar": {"get_scan": 250, "get_scan_geometry": 251},
         "contact": {"get_contacts": 260, "get_bumper": 261}, "sonar": {"get_sonar": 320}, "infrared": {"get_infrared": 330},
         "light": {"get_light": 310}, "camera": {"get_image": 270, "get_camera": 271}, "battery": {"get_battery": 290},
         "odometry": {"get_odometry": 340}}
ROWS, COLUMNS = 2, 5
WIDTH, HEIGHT = 33, 3  # the bytes do not fill an integer number of params
READINGS = {
    230: ("", (), [1, 0.25, -0.5, 0.125, 0.1, 0.2, -0.3, 0.5, -0.25, 9.81]),
    240: ("", (), [1, -2, 90.5, 0.5, 0.25, -0.125]),
    250: ("", (), [0, 0.5, 1, 1.5, math.inf, 2, 2.5, 3, 3.5, 4]),
    251: ("", (), [-1, 0.5, 0.125, 10, ROWS, COLUMNS, -0.25, 0.5]),
    260: ("floor box_2", (0, 7), [9.5, 0.1, 0.2, 0, 0, 0, 1, 2.5, 0.3, -0.1, 0.05, -1, 0, 0]),
    261: ("", (), [1, 0, 1]),
    271: ("", (), [WIDTH, HEIGHT, 30.5, 30.5, 16.5, 1.5, 0.05, 20, 33.25]),
    290: ("", (), [3600, 0.75, 12.5]),
    310: ("", (), [0.5, 0.25]),
    320: ("", (), [1.5, math.inf]),
    330: ("", (), [2.25, 0.375, 0.5]),
    340: ("", (), [1, 2, 0.5, 0.25, -0.125]),
}
# Of a robot's second sensors.
SECOND = {
    ("mast_imu", 230): ("", (), [0, 1, 0, 0, 0.5, 0.25, 0.125, 1, 2, -9.81]),
    ("rear_lidar", 250): ("", (), [0.5, math.inf, 3]),
    ("rear_lidar", 251): ("", (), [-0.25, 0.25, 0, 4, 1, 3, 0, 0]),
}


def shown(reading, step):
    """The step that a reading shows."""
    return step // 3 * 3 if reading == 270 else step


def pixels(kind, right):
    count = WIDTH * HEIGHT
    if kind == 0:
        return bytes((k + right) % 256 for k in range(3 * count))
    if kind == 1:
        return b"\xff\xd8picture\xff\xd9"
    if kind == 2:
        return struct.pack(f"<{count}f", *([math.inf, 0.0] + [k / 8 for k in range(2, count)]))
    return struct.pack(f"<{count}H", *([0, 1, 700] * (count // 3)))


def values(module, reading, params):
    """Text, params and data; None if this is not a reading of a sensor."""
    if reading != 270:
        return SECOND.get((module.split("/")[-1], reading)) or READINGS.get(reading)
    kind = params[0] if params else 0
    raw = pixels(kind, module.endswith("right_camera"))
    filled = raw + bytes(-len(raw) % 4)
    return "1=floor 700=ball_1" if kind == 3 else "", (WIDTH, HEIGHT, len(raw), *struct.unpack(f"<{len(filled) // 4}i", filled)), []
