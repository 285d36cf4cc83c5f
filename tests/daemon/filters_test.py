# SPDX-License-Identifier: MIT
"""Filtered values of channels, and the energy of motors: in an experiment, over a socket, in recordings."""
import math
import unittest

from harness import Daemon
from recording import RecordingTestCase, equal_steps

TIME_S, STEP_S, STEPS, ACCELERATION_M_S2, NOISE_M = 0.2, 0.01, 100, 2, 0.05

# A ball pushed by forces; a bar on a motor of two values.
EXPERIMENT = f"""<rosiml version="0.8.41">
  <simulator frequency="100"/>
  <environment/>
  <robots>
    <robot name="arm">
      <body>
        <box name="base"><dimension width="0.1" depth="0.1" height="1"/><pose z="0.5"/><physics><mass kg="0"/></physics></box>
        <box name="bar"><dimension width="0.1" depth="0.1" height="0.1"/><pose x="0.3" z="0.8"/><physics><mass kg="1"/></physics></box>
      </body>
      <actuators>
        <slider name="rail" type="force and velocity" mode="active"><source name="base"/><destination name="bar"/>
          <force max="50"/><velocity max="10"/><pose z="0.3"/><mapping min="-1" max="1"/></slider>
      </actuators>
      <sensors>
        <ov name="v"><object name="bar"/><mapping min="-10" max="10"/><domain min="-10" max="10"/>
          <coordinates x="true" y="false" z="false"/></ov>
        <ov name="smooth"><object name="bar"/><mapping min="-10" max="10"/><domain min="-10" max="10"/>
          <filter module="low_pass"><parameter name="time" value="{TIME_S}"/></filter>
          <coordinates x="true" y="false" z="false"/></ov>
        <position name="mean"><object name="bar"/><mapping min="-5" max="5"/><domain min="-5" max="5"/>
          <noise module="white"><parameter name="sigma" value="{NOISE_M}"/></noise>
          <filter module="mean"><parameter name="steps" value="50"/></filter>
          <coordinates x="false" y="false" z="true"/></position>
      </sensors>
      <controller module="TCPIP" frequency="100"/>
    </robot>
  </robots>
</rosiml>
"""
FORCE = ACCELERATION_M_S2 / 50 * 2 - 1  # of the range -1 to 1


class FiltersTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.xml = self.folder / "arm.xml"
        self.xml.write_text(EXPERIMENT)

    def serve(self, *options):
        return Daemon(None, "--mode", "lockstep", "--no-render", *options, name=str(self.xml))

    def push(self, channel, steps=STEPS, velocity=1):
        return [channel.must(f"set_motors {FORCE} {velocity}").data[:3] for _ in range(steps)]

    def test_the_first_value_limits_the_force(self):
        with self.serve() as daemon:
            values = self.push(daemon.text("/arm/channel"))
        self.assertAlmostEqual(abs(values[-1][0]), ACCELERATION_M_S2, delta=0.01 * ACCELERATION_M_S2)

    def test_a_low_pass_lags_by_its_time_constant(self):
        with self.serve() as daemon:
            speed, smooth, _ = self.push(daemon.text("/arm/channel"))[-1]
        lag = TIME_S * (1 - math.exp(-STEPS * STEP_S / TIME_S))
        wanted = ACCELERATION_M_S2 * (STEPS * STEP_S - lag)
        self.assertAlmostEqual(smooth, math.copysign(wanted, speed), delta=0.02 * wanted)

    def test_a_mean_takes_the_noise_away(self):
        with self.serve() as daemon:
            heights = [values[2] for values in self.push(daemon.text("/arm/channel"))[60:]]
        self.assertLess(max(abs(height - 0.8) for height in heights), NOISE_M / 2)
        self.assertGreater(len(set(heights)), 30)

    def test_a_recording_verifies_and_a_saved_state_goes_on_alike(self):
        with self.serve("--record", str(self.file)) as daemon:
            channel, simulation = daemon.text("/arm/channel"), daemon.text("/simulation")
            self.push(channel, 30)
            simulation.must("save half")
            first = self.push(channel, 20)
            simulation.must("restore half")
            self.assertEqual(self.push(channel, 20), first)
        self.assertGreaterEqual(equal_steps(self.file), 50)

    def test_a_reset_begins_anew(self):
        with self.serve() as daemon:
            channel = daemon.text("/arm/channel")
            first = self.push(channel, 20)
            daemon.text("/simulation").must("reset")
            self.assertEqual(self.push(channel, 20), first)


if __name__ == "__main__":
    unittest.main()
