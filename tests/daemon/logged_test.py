"""Numbers logged and runs ended by clients: in get_status, summaries and recordings."""
import json
import sys
import unittest
from pathlib import Path

from harness import LIMIT_S, Daemon
from recording import RecordingTestCase, equal_steps, tool

sys.path.insert(0, str(Path(__file__).parents[2] / "clients" / "python"))
import coopdyn  # noqa: E402

ROOM = "[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n"


class LoggedTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.scenario = self.folder / "room.scenario"
        self.scenario.write_text(ROOM)
        self.summary = self.folder / "summary.json"

    def daemon(self, *options):
        return Daemon(None, "--no-render", "--summary", self.summary, *options, name=str(self.scenario))

    def test_the_newest_number_of_a_name_stands_in_the_status(self):
        with self.daemon() as daemon, coopdyn.connect(daemon.names[1]) as sim:
            self.assertEqual(sim.logged(), {})
            sim.log("energy", 3.5)
            sim.log("gap", 0.1)
            sim.log("energy", 4)
            self.assertEqual(sim.logged(), {"energy": 4.0, "gap": 0.1})
            sim.reset()
            self.assertEqual(sim.logged(), {})

    def test_a_telnet_line_logs(self):
        with self.daemon() as daemon:
            simulation = daemon.text("/simulation")
            simulation.must("log energy 3.5")
            self.assertEqual([one["value"] for one in daemon.status()["logged"]], [3.5])
            self.assertEqual(simulation.ask("log 3energy 1").error, 7)
            self.assertIn("log energy 3.5", simulation.ask("log en-ergy 1").text)
            self.assertEqual(simulation.ask("log energy inf").error, 4)

    def test_more_names_than_there_is_room_for_are_refused(self):
        with self.daemon() as daemon:
            simulation = daemon.text("/simulation")
            for number in range(100):
                simulation.must(f"log n{number} 1")
            reply = simulation.ask("log n100 1")
            self.assertEqual((reply.error, reply.text), (8, "100 names are already logged: log one of those"))
            simulation.must("log n99 2")

    def test_a_recording_has_all_numbers_with_their_times_and_verifies(self):
        with self.daemon("--record", self.file) as daemon, coopdyn.connect(daemon.names[1]) as sim:
            eva = sim.robot("eva")
            for k in range(5):
                eva.set_velocity(0.2, 0)
                sim.step()
                sim.log("twice", 2 * k)
        run = coopdyn.read_run(self.file)
        self.assertEqual([(round(time, 6), value) for time, value in run.logged("twice")],
                         [(0.01 * (k + 1), 2.0 * k) for k in range(5)])
        with self.assertRaisesRegex(coopdyn.Error, "no numbers logged under energy; there are twice"):
            run.logged("energy")
        self.assertGreaterEqual(equal_steps(self.file), 5)  # closing stops the robot, one step more

    def test_end_run_ends_the_run_at_this_step_with_exit_code_0(self):
        with self.daemon("--duration", "100") as daemon:
            with coopdyn.connect(daemon.names[1]) as sim:
                eva = sim.robot("eva")
                for _ in range(7):
                    eva.set_velocity(0.2, 0)
                    sim.step()
                sim.log("goals", 1)
                sim.end_run("the ball is in the goal")
            self.assertEqual(daemon.process.wait(LIMIT_S), 0)
        told = json.loads(self.summary.read_text())
        self.assertEqual((told["ended"], told["steps"]), ("client", 7))
        self.assertEqual([(one["name"], one["value"], one["step"]) for one in told["logged"]], [("goals", 1, 7)])

    def test_exports_list_them(self):
        with self.daemon("--record", self.file) as daemon:
            daemon.text("/simulation").must("log energy 3.5")
        code, said = tool("export", self.file, "--to", "csv", "--out", self.folder / "energy.csv")
        self.assertEqual(code, 0, said)
        self.assertIn("log,energy 3.5", (self.folder / "energy-events.csv").read_text().replace('"', ""))


if __name__ == "__main__":
    unittest.main()
