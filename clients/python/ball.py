# SPDX-License-Identifier: MIT
"""Follows a red ball by a camera: python3 ball.py [robot1 [SECONDS]]

Scenario `ball`. The ball's pixels are those with much more red than green and blue. Their centre gives the bearing, their number n
the distance: a ball of radius R at distance d covers pi (f R / d)^2 pixels, so d = f R sqrt(pi / n). The robot turns towards the
ball and keeps its distance; without a ball in view it turns to the side where it saw the ball last. All three languages use the
same algorithm and numbers.
"""
import math
import sys

import coopdyn

BALL_RADIUS = 0.12  # R [m]
KEEP = 0.8  # [m] from the camera to the ball
APPROACH = 1.0  # [1/s] speed per metre of distance error
MAX_SPEED = 0.4  # [m/s]
STEER = 2.0  # [1/s] turn rate per radian of bearing
MAX_TURN = 1.5  # [rad/s]
SEARCH = 0.8  # [rad/s] without a ball in view
RED = 60  # minimal red of a red pixel
MORE = 2  # minimal ratio of red to green, and of red to blue
COLUMNS = 80  # sampled columns: every fourth pixel of a picture 320 wide
FEW = 6  # fewer red pixels are no ball


def look(image, camera):
    """Distance [m] and bearing [rad] of the ball; None if not in view."""
    every = max(1, image.width // COLUMNS)
    count, columns, stride = 0, 0, 3 * every
    for y in range(0, image.height, every):
        row = image.data[3 * y * image.width : 3 * (y + 1) * image.width]
        for x, (r, g, b) in enumerate(zip(row[0::stride], row[1::stride], row[2::stride])):
            if r >= RED and r >= MORE * g and r >= MORE * b:
                count += 1
                columns += x
    if count < FEW:
        return None
    middle = every * columns / count + 0.5
    return camera.fx * BALL_RADIUS * math.sqrt(math.pi / count) / every, math.atan2(camera.cx - middle, camera.fx)


def main(name="robot1", duration="30"):
    with coopdyn.connect() as sim:
        r = sim.robot(name)
        camera, start = r.get_camera(), sim.time
        side, seen, pictures, distance, bearing = 1, 0, 0, math.inf, 0.0
        while sim.time - start < float(duration):
            ball = look(r.get_image(), camera)
            pictures += 1
            if ball is None:
                r.set_velocity(0, SEARCH * side)
            else:
                seen += 1
                distance, bearing = ball
                side = -1 if bearing < 0 else 1
                r.set_velocity(max(-MAX_SPEED, min(MAX_SPEED, APPROACH * (distance - KEEP))),
                               max(-MAX_TURN, min(MAX_TURN, STEER * bearing)))
            sim.step()
        print(f"{name} saw the ball in {100 * seen / pictures:.0f} % of {pictures} pictures, at last {distance:.3f} m away and "
              f"{math.degrees(bearing):.2f} degrees to the left")
        return 0 if seen else 1


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:]))
    except coopdyn.Error as error:
        sys.exit(str(error))
