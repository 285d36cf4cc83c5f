# SPDX-License-Identifier: MIT
"""Draws the paths of the robots of a recorded run: python3 plot_run.py lesson1.run [path.png]

Needs matplotlib (`pip install matplotlib`, or Debian's python3-matplotlib); reading the run needs nothing.
"""
import sys

import coopdyn

if not 2 <= len(sys.argv) <= 3:
    print("write: python3 plot_run.py NAME.run [PATH.png]", file=sys.stderr)
    sys.exit(2)
try:
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit("to draw, install matplotlib: pip install matplotlib, or Debian's python3-matplotlib")
try:
    run = coopdyn.read_run(sys.argv[1])
except coopdyn.Error as e:
    sys.exit(e.text)
for name in run.names:
    pose = run.pose(name)                       # one row per moment: x, y [m], heading [rad]
    plt.plot(pose[:, 0], pose[:, 1], label=name)
plt.axis("equal"), plt.xlabel("x [m]"), plt.ylabel("y [m]"), plt.legend()
plt.savefig(sys.argv[2]) if len(sys.argv) > 2 else plt.show()
