# SPDX-License-Identifier: MIT
"""A movable of type 'moving': clients apply forces and torques to its body."""
import math
import unittest

from harness import Daemon
from recording import RecordingTestCase, equal_steps

MASS_KG, RADIUS_M, GRAVITY_M_S2, FORCE_N, TORQUE_NM = 2, 0.1, 9.81, 40, 0.1

EXPERIMENT = f"""<rosiml version="1.0">
  <simulator frequency="100" mode="lockstep"/>
  <movables>
    <movable name="craft" type="moving">
      <force max="{FORCE_N}"><mapping min="-1" max="1"/></force>
      <torque max="{TORQUE_NM}"><mapping min="-1" max="1"/></torque>
      <body>
        <object name="hull" mass="{MASS_KG}">
          <pose z="5"/>
          <sphere radius="{RADIUS_M}"/>
          <position name="place"/>
          <velocity name="v"/>
          <angularVelocity name="w"/>
        </object>
      </body>
    </movable>
  </movables>
</rosiml>
"""
HOLD = MASS_KG * GRAVITY_M_S2 / FORCE_N  # carries its weight
STEPS = 100  # in 1 s
X, Y, Z, VX, VY, VZ, WX, WY, WZ = range(9)


class MovingTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.xml = self.folder / "craft.xml"
        self.xml.write_text(EXPERIMENT)

    def push(self, channel, *motors):
        """The values after a second with these motors."""
        for _ in range(STEPS):
            values = channel.must("set_motors " + " ".join(map(str, motors))).data
        return values

    def serve(self, *options):
        return Daemon(None, "--no-render", *options, name=str(self.xml))

    def test_it_accelerates_by_force_over_mass(self):
        with self.serve() as daemon:
            values = self.push(daemon.text("/craft/channel"), 0.1, -0.05, HOLD, 0, 0, 0)
        self.assertAlmostEqual(values[VX], 0.1 * FORCE_N / MASS_KG, delta=0.01 * 2)
        self.assertAlmostEqual(values[VY], -0.05 * FORCE_N / MASS_KG, delta=0.01)
        self.assertAlmostEqual(values[VZ], 0, delta=1e-6)
        self.assertAlmostEqual(values[X], 0.1 * FORCE_N / MASS_KG / 2, delta=0.02)

    def test_it_turns_by_torque_over_moment(self):
        with self.serve() as daemon:
            values = self.push(daemon.text("/craft/channel"), 0, 0, HOLD, 0, 0, 0.5)
        wanted = 0.5 * TORQUE_NM / (0.4 * MASS_KG * RADIUS_M**2)
        self.assertAlmostEqual(values[WZ], wanted, delta=0.01 * wanted)
        self.assertAlmostEqual(math.hypot(values[WX], values[WY]), 0, delta=1e-9)

    def test_its_forces_turn_with_it(self):
        with self.serve() as daemon:
            turn = math.pi / 2 / 0.5**2 * (0.4 * MASS_KG * RADIUS_M**2)  # N m, for half a second each
            channel = daemon.text("/craft/channel")
            for sign in (1, -1):
                for _ in range(STEPS // 2):
                    channel.must(f"set_motors 0 0 {HOLD} 0 0 {sign * turn / TORQUE_NM}")
            values = self.push(channel, 0.1, 0, HOLD, 0, 0, 0)
        self.assertAlmostEqual(values[VY], 2, delta=0.02)
        self.assertAlmostEqual(values[VX], 0, delta=0.05)

    def test_its_module_takes_newtons(self):
        with self.serve() as daemon:
            thrusters = daemon.text("/craft/thrusters")
            self.assertEqual(thrusters.must("get_thruster_limits").data[:6], [FORCE_N] * 3 + [TORQUE_NM] * 3)
            answer = thrusters.must("set_thrusts (1) 100")
            self.assertEqual(answer.text, f"limited to {FORCE_N}")
            self.assertEqual(thrusters.must("get_thrusts (1)").data[0], FORCE_N)

    def test_its_recording_verifies(self):
        with self.serve("--record", str(self.file)) as daemon:
            self.push(daemon.text("/craft/channel"), 0.1, 0.02, HOLD, 0, 0.3, 0.2)
        self.assertGreaterEqual(equal_steps(self.file), STEPS)


if __name__ == "__main__":
    unittest.main()
