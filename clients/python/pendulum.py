# SPDX-License-Identifier: MIT
"""Balances a two-wheeled robot by its IMU and drives it one metre forward: python3 pendulum.py [robot1]

Scenario `pendulum`. A state feedback sets the torque of the wheels' motors,

    tau = kx (x - x_ref) + kv (v - v_ref) + kp pitch + kr rate,

with the pitch and its rate from the IMU, and the travelled distance x and its speed v from the wheels' joints, which turn relative
to the body. The gains are those of a linear-quadratic regulator for the robot's masses. At the start the robot leans on a skid, and
gets up. All three languages use the same algorithm and numbers.
"""
import math
import sys

import coopdyn

WHEEL_RADIUS = 0.05  # [m]
POSITION_GAIN = 0.27  # kx [N m/m]
SPEED_GAIN = 0.36  # kv [N m s/m]
PITCH_GAIN = 2.12  # kp [N m/rad]
RATE_GAIN = 0.24  # kr [N m s/rad]
MAX_TORQUE = 1.0  # [N m] both wheels together
SPEED = 0.25  # [m/s]
STAND_UNTIL = 4.0  # [s] simulated, from the start of the program
DRIVE_UNTIL = 8.0  # [s]
END = 14.0  # [s]


def main(name):
    with coopdyn.connect() as sim:
        r = sim.robot(name)
        wheels = r.joints("wheels")
        start = sim.time
        s = r.sense()
        before = sum(s.joints["wheels"].position) / 2
        last, reference, way, most = s.time, 0.0, 0.0, 0.0
        while s.time - start < END:
            t = s.time - start
            imu, joints = s.imu, s.joints["wheels"]
            pitch = math.asin(max(-1.0, min(1.0, 2 * (imu.qw * imu.qy - imu.qz * imu.qx))))
            way = WHEEL_RADIUS * (sum(joints.position) / 2 - before + pitch)
            speed = WHEEL_RADIUS * (sum(joints.velocity) / 2 + imu.wy)
            speed_reference = SPEED if STAND_UNTIL <= t < DRIVE_UNTIL else 0.0
            reference += speed_reference * (s.time - last)
            last = s.time
            torque = (POSITION_GAIN * (way - reference) + SPEED_GAIN * (speed - speed_reference) + PITCH_GAIN * pitch
                      + RATE_GAIN * imu.wy)
            torque = max(-MAX_TORQUE, min(MAX_TORQUE, torque))
            wheels.set_efforts(torque / 2)
            if t >= STAND_UNTIL:
                most = max(most, abs(pitch))
            sim.step()
            s = r.sense()
        print(f"{name} went {way:.3f} m and leaned at most {math.degrees(most):.2f} degrees after it had got up")
        return 0 if most < 0.2 else 1


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:2] or ["robot1"]))
    except coopdyn.Error as error:
        sys.exit(str(error))
