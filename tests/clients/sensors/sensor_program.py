# SPDX-License-Identifier: MIT
"""Prints the readings of all sensors of robot1; sensor_program.m and sensor_program.cc are the same program."""
import math

import coopdyn


def show(what, values):
    print(what, *("%.17g" % value for value in values))


def show_contacts(contacts):
    for c in contacts:
        show(f"contact {c.name}", [c.id, c.force, c.x, c.y, c.z, c.nx, c.ny, c.nz])


def show_scan(scan):
    for row in scan.ranges:
        show("ranges", row)
    show("azimuth", scan.azimuth)
    show("elevation", scan.elevation)
    show("limits", [scan.min_range, scan.max_range])


def show_image(image):
    show("image", [image.width, image.height, sum(image.data), *image.rgb(2, 1), *image.rgb(image.width - 1, 0)])


with coopdyn.connect() as sim:
    r = sim.robot("robot1")
    sim.step(7)
    show("imu", r.get_imu())
    show("imu", r.get_imu("mast_imu"))
    show("wrench", r.get_wrench())
    show_scan(r.get_scan())
    show_scan(r.get_scan("rear_lidar"))
    show_contacts(r.get_contacts())
    show("bumper", r.get_bumper())
    show("sonar", r.get_sonar())
    show("infrared", r.get_infrared())
    show("light", r.get_light())
    show("battery", r.get_battery())
    show("odometry", r.get_odometry())
    show("camera", r.get_camera())
    image = r.get_image()
    show_image(image)
    show("when", [image.time, image.step, sim.steps])
    show_image(r.get_image("right_camera"))
    jpeg = r.get_jpeg()
    show("jpeg", [len(jpeg), jpeg[0], jpeg[1], sum(jpeg)])
    depth = r.get_depth()
    seen = [d for d in depth.data if math.isfinite(d)]
    show("depth", [depth.width, depth.height, depth.at(2, 1), depth.at(0, 2), min(seen), max(seen), len(depth.data) - len(seen)])
    labels = r.get_segmentation()
    show("segmentation", [labels.width, labels.height, labels.at(2, 1), sum(labels.data)])
    for number, name in sorted(labels.names.items()):
        print("name", number, name)
    for k in range(3):
        sim.step()
        s = r.sense()
        show("sense", [s.time, s.step, sim.steps])
        show("imu", s.imu)
        show("wrench", s.wrench)
        show_scan(s.scan)
        show_contacts(s.contacts)
        show("sonar", s.sonar)
        show("infrared", s.infrared)
        show("light", s.light)
        show("battery", s.battery)
        show("odometry", s.odometry)
        show("when", [r.get_image().step, sim.steps])
    r.subscribe("light")
    r.subscribe("rear_lidar")
    sim.step()
    show("pushed", r.next("light", timeout=60).value)
    show("pushed", r.next("rear_lidar", timeout=60).value)
