"""Supervisors in whole runs: their logs, moves and ends in summaries, recordings, branches and exports."""
import json
import shutil
import sys
import unittest
from pathlib import Path

from harness import BINARY, Daemon
from recording import RecordingTestCase, equal_steps, rows, tool

sys.path.insert(0, str(Path(__file__).parents[2] / "clients" / "python"))
import coopdyn  # noqa: E402

RACE = Path(__file__).parents[2] / "scenarios" / "race.scenario"


class SupervisorTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.summary = self.folder / "summary.json"

    def race(self, *options, scenario="race", code=0):
        """The summary of a run without sockets."""
        done, said = tool("serve", *([scenario] if scenario else []), "--mode", "free", "--no-net", "--no-render", "--duration", 60, "--summary",
                          self.summary, *options)
        self.assertEqual(done, code, said)
        return json.loads(self.summary.read_text())

    def test_ends_the_run_with_exit_code_0_and_what_it_has_logged(self):
        told = self.race()
        self.assertEqual(told["ended"], "supervisor")
        self.assertLess(told["time_s"], 60)
        self.assertEqual({one["name"]: one["value"] for one in told["logged"]}["round"], 5)

    def test_is_the_same_run_on_any_number_of_threads_and_in_process(self):
        hashes = {self.race(*options)["hash"] for options in ((), ("--threads", 2), ("--controllers", "in-process"))}
        self.assertEqual(len(hashes), 1)
        self.assertNotIn(self.race("--seed", 2)["hash"], hashes)

    def test_its_recording_verifies_and_goes_on_from_any_step_to_the_same_end(self):
        told = self.race("--record", self.file)
        self.assertEqual(equal_steps(self.file), told["steps"])
        moves = [step for step, in rows(self.file, "SELECT step FROM input ORDER BY id")]
        self.assertEqual(len(moves), 4)
        for step in (0, moves[0] - 1, moves[0], moves[0] + 1, moves[2], told["steps"] - 1):
            branch = self.race("--from", f"{self.file}@#{step}", scenario=None)
            self.assertEqual((branch["hash"], branch["steps"]), (told["hash"], told["steps"]), f"from step {step}")

    def test_what_it_logs_is_exported_and_read(self):
        self.race("--record", self.file)
        run = coopdyn.read_run(self.file)
        self.assertEqual([value for _, value in run.logged("round")], [1, 2, 3, 4, 5])
        code, said = tool("export", self.file, "--to", "csv", "--logged", "round_time", "--out", self.folder / "race.csv")
        self.assertEqual(code, 0, said)
        self.assertIn("logged.round_time", (self.folder / "race.csv").read_text().splitlines()[0])

    def test_a_client_sees_its_moves_and_logs_and_a_saved_state_goes_on_alike(self):
        with Daemon(None, "--no-render", "--mode", "lockstep", "--paused", name="race") as daemon:
            simulation = daemon.text("/simulation")
            with coopdyn.connect(daemon.names[1]) as sim:
                start = sim.world()["targets"][0]["position"]
                while "round" not in sim.logged():
                    simulation.must("step 50")
                self.assertNotEqual(sim.world()["targets"][0]["position"], start)
                simulation.must("save first")
                simulation.must("step 300")
                hash_ = sim.hash()
                simulation.must("restore first")
                simulation.must("step 300")
                self.assertEqual(sim.hash(), hash_)
                simulation.must("reset")
                self.assertEqual(sim.logged(), {})

    def test_one_that_is_gone_is_taken_from_the_recording(self):
        shutil.copy(Path(BINARY).parent / "controllers" / "referee.so", self.folder / "mine.so")
        own = self.folder / "own.scenario"
        own.write_text(RACE.read_text().replace("supervisor referee", "supervisor ./mine.so"))
        told = self.race("--record", self.file, scenario=own)
        (self.folder / "mine.so").unlink()
        code, said = tool("verify", self.file)
        self.assertEqual(code, 0, said)
        self.assertIn(f"equal, {told['steps']} steps", said)
        self.assertIn("controller mine is not found", said)
        code, said = tool("serve", "--from", f"{self.file}@3", "--no-net")
        self.assertNotEqual(code, 0)
        self.assertIn("supervisor mine of this run was not found: put it on the search path", said)

    def test_a_saved_world_keeps_it(self):
        with Daemon(None, "--no-render", "--paused", name="race") as daemon:
            text = daemon.text("/world").must("save").text
            self.assertIn("supervisor referee rounds=5 field=2", " ".join(text.split()))

    def test_a_robots_controller_is_refused_with_what_to_write(self):
        code, said = tool("check", "race", "--set", "SIMULATION.supervisor=diffuse")
        self.assertNotEqual(code, 0)
        self.assertIn("--set SIMULATION.supervisor=diffuse: error: controller diffuse drives a robot and is no supervisor", said)
        code, said = tool("check", "race", "--set", "SIMULATION.supervisor=refere")
        self.assertIn("did you mean 'referee'?", said)


if __name__ == "__main__":
    unittest.main()
