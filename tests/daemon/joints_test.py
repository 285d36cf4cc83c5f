"""Control boards over raw sockets: two arms of one model, by words and by numbers, recorded and repeated."""
import math
import tempfile
import unittest
from pathlib import Path

from harness import Daemon
from recording import RecordingTestCase, equal_steps

ENV = {"COOPDYN_PATH": str(Path(__file__).parent / "robots")}


def arms(count=1, extra=""):
    text = "[SIMULATION]\nmode lockstep\nstep 0.01\n"
    for index in range(1, count + 1):
        text += f"[ROBOT_{index}]\ntype elbow\nname arm{index}\nposition 0 {2 * index} 0\n{extra}\n"
    return text


def daemon_of(count=1, *options):
    return Daemon(arms(count), *options, env=ENV)


class JointsTest(unittest.TestCase):
    def test_two_copies_answer_on_their_own_names(self):
        with daemon_of(2) as daemon:
            one, two = daemon.text("/arm1/arm"), daemon.text("/arm2/arm")
            one.must("claim"), two.must("claim")
            one.send("set_positions 0.5 -0.4")
            two.must("set_positions -0.3 0.2")
            one.receive()
            for _ in range(20):
                one.send("ready 10")
                two.must("ready 10")
                one.receive()
            for arm, wanted in ((one, (0.5, -0.4)), (two, (-0.3, 0.2))):
                data = arm.must("get_joints").data
                self.assertAlmostEqual(data[0], wanted[0], delta=math.radians(0.1))
                self.assertAlmostEqual(data[3], wanted[1], delta=math.radians(0.1))

    def test_a_partial_command_leaves_the_other_joints_alone(self):
        with daemon_of() as daemon:
            arm = daemon.text("/arm1/arm")
            arm.must("set_positions (1) 0.4")
            arm.must("set_velocities (2) 0.3")
            self.assertEqual(arm.must("get_modes").params, [1, 3])
            arm.must("ready 100")
            self.assertAlmostEqual(arm.must("get_joints (2)").data[1], 0.3, delta=1e-3)
            self.assertEqual(arm.must("get_motion (1)").data[0], 0.4)

    def test_get_motion_tells_when_a_joint_arrives(self):
        with daemon_of() as daemon:
            arm = daemon.text("/arm1/arm")
            arm.must("set_positions 0.5 0.1")
            self.assertEqual(arm.must("get_motion").params, [0, 0])
            while arm.must("get_motion").params != [1, 1]:
                self.assertLess(arm.must("ready").step, 500)

    def test_hold_stays_where_the_joint_is(self):
        with daemon_of() as daemon:
            arm = daemon.text("/arm1/arm")
            arm.must("set_velocities 0.5 0")
            arm.must("ready 50")
            here = arm.must("get_joints (1)").data[0]
            arm.must("hold")
            arm.must("ready 200")
            self.assertAlmostEqual(arm.must("get_joints (1)").data[0], here, delta=1e-3)

    def test_a_load_deflects_a_compliant_joint(self):
        with daemon_of() as daemon:
            arm = daemon.text("/arm1/arm")
            arm.must("set_compliance (2) 40 4 0")
            self.assertEqual(arm.must("get_compliance (2)").data[:3], [40, 4, 0])
            self.assertEqual(arm.must("get_compliance (1)").data[0], math.inf)
            arm.must("hold (1)")
            arm.must("set_positions (2) 0")
            arm.must("ready 600")
            position = arm.must("get_joints (2)").data[0]
            # The forearm of 1 kg at 0.15 m, the hand of 0.1 kg at 0.3 m.
            load_nm = 9.81 * (1 * 0.15 + 0.1 * 0.3) * math.cos(position)
            self.assertAlmostEqual(-position * 40 / load_nm, 1, delta=0.02)

    def test_limits_and_names(self):
        with daemon_of() as daemon:
            arm = daemon.text("/arm1/arm")
            limits = arm.must("get_limits")
            self.assertEqual(limits.text, "shoulder elbow")
            self.assertEqual(limits.data[:8], [-7, 7, 3, 60, -2, 2, 3, 30])
            reply = arm.must("set_positions 1 9")
            self.assertEqual(reply.text, "limited to 1 2")

    def test_the_chain_ends_at_the_tool(self):
        with daemon_of() as daemon:
            chain = daemon.text("/arm1/arm").must("get_chain")
            self.assertEqual((chain.text, chain.params), ("hand", [1, 0, 2, 0]))
            self.assertEqual(chain.data[:12], [0, 0, 0.8, 0, -1, 0, 0.3, 0, 0.8, 0, -1, 0])
            for got, wanted in zip(chain.data[12:19], [0.6, 0, 0.8, 1, 0, 0, 0]):
                self.assertAlmostEqual(got, wanted)

    def test_mistakes_say_what_to_write(self):
        with daemon_of() as daemon:
            arm = daemon.text("/arm1/arm")
            for line, error, said in (
                    ("set_positions 1", 3, "one"), ("set_positions (3) 1", 2, "joints 1 to 2"),
                    ("set_positions (1 1) 1 1", 2, "twice"), ("set_profile (1) 9 1", 4, "at most its limit 3"),
                    ("set_compliance (1) -1 0 0", 4, "0 to 1e9"), ("set_gains (1) nan 0 0", 4, "p is nan"),
                    ("set_modes (1) 7", 4, "idle")):
                reply = arm.ask(line)
                self.assertEqual(reply.error, error, f"{line}: {reply}")

    def test_only_the_owner_tunes(self):
        with daemon_of() as daemon:
            owner, other = daemon.text("/arm1/arm"), daemon.text("/arm1/arm")
            owner.must("claim")
            self.assertEqual(other.ask("set_gains (1) 50 0 0").error, 6)
            owner.must("set_gains (1) 50 0 0")
            self.assertEqual(other.must("get_gains (1)").data[0], 50)

    def test_a_team_moves_the_joints_of_all(self):
        with daemon_of(3) as daemon:
            swarm = daemon.text("/swarm")
            swarm.must("claim")
            swarm.must("select_readings joints")
            swarm.must("step_all positions 0.1 0.2 0.3 0.4 -0.1 -0.2")
            for _ in range(200):
                reply = swarm.must("step_all")
            self.assertEqual(reply.params[1:3], [3, 6])
            for row, wanted in enumerate([(0.1, 0.2), (0.3, 0.4), (-0.1, -0.2)]):
                self.assertAlmostEqual(reply.data[6 * row], wanted[0], delta=1e-3)
                self.assertAlmostEqual(reply.data[6 * row + 3], wanted[1], delta=1e-3)
            self.assertEqual(swarm.ask("step_all positions 1 2").error, 3)

    def test_a_state_that_is_saved_in_motion_goes_on_alike(self):
        with daemon_of() as daemon:
            arm, simulation = daemon.text("/arm1/arm"), daemon.text("/simulation")
            arm.must("set_compliance (2) 40 4 0")
            arm.must("set_positions 1 -0.5")
            arm.must("ready 20")
            simulation.must("save middle")
            arm.must("ready 50")
            first = arm.must("get_joints").data[:6]
            simulation.must("restore middle")
            arm.must("ready 50")
            self.assertEqual(arm.must("get_joints").data[:6], first)


class EncoderTest(unittest.TestCase):
    def arm_with(self, attributes):
        """A daemon with one arm whose encoders have these attributes."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        text = (Path(__file__).parent / "robots/elbow/model.sdf").read_text()
        model = Path(folder.name) / "elbow/model.sdf"
        model.parent.mkdir()
        model.write_text(text.replace('name="arm"', f'name="arm" {attributes}'))
        return Daemon(arms(), env={"COOPDYN_PATH": folder.name})

    def test_positions_come_in_steps_of_the_resolution(self):
        with self.arm_with('encoder_resolution="0.01"') as daemon:
            arm = daemon.text("/arm1/arm")
            arm.must("set_velocities 0.5 0.3")
            for _ in range(20):
                arm.must("ready")
                for position in arm.must("get_joints").data[0:6:3]:
                    self.assertAlmostEqual(position / 0.01, round(position / 0.01), places=6)

    def test_noise_is_new_in_each_step_and_the_same_for_all_who_read(self):
        with self.arm_with('encoder_noise_stddev="0.02"') as daemon:
            arm, other = daemon.text("/arm1/arm"), daemon.text("/arm1/arm")
            readings = []
            for _ in range(100):
                arm.must("ready")
                readings.append(arm.must("get_joints").data[0])
                self.assertEqual(other.must("get_joints").data[0], readings[-1])
            mean = sum(readings) / len(readings)
            spread = math.sqrt(sum((r - mean) ** 2 for r in readings) / len(readings))
            self.assertAlmostEqual(spread, 0.02, delta=0.008)


class RecordedJointsTest(RecordingTestCase):
    def test_a_recorded_run_repeats_with_its_tuning(self):
        with Daemon(arms(), "--record", self.file, env=ENV) as daemon:
            arm = daemon.text("/arm1/arm")
            arm.must("set_profile 1 4 1 4")
            arm.must("set_positions 0.8 -0.5")
            arm.must("ready 30")
            arm.must("set_compliance (2) 40 4 0")
            arm.must("set_efforts (1) -3")
            arm.must("ready 100")
            arm.must("set_modes idle velocity")
            arm.must("ready 50")
        self.assertGreater(equal_steps(self.file), 180)


if __name__ == "__main__":
    unittest.main()
