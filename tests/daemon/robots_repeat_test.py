"""All shipped robots with joints, driven by programs: bitwise the same when recorded, verified, branched in motion, reset, with threads
and for any order of arrival. robots_test.py tests them with loaded controllers."""
import random
import subprocess
import sys
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon
from recording import SANITIZED, RecordingTestCase, equal_steps

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients" / "python"))
import coopdyn  # noqa: E402

# Modules by type; for a control board the number of its joints and their range around 0.
TYPES = {
    "lwa": {"arm": (7, 0.8)},
    "irb120": {"arm": (6, 0.8)},
    "mh5": {"arm": (6, 0.8)},
    "mobile_arm": {"motors": None, "arm": (6, 0.8)},
    "quadruped": {"legs": (12, 0.2)},
    "hexapod": {"legs": (18, 0.2)},
    "humanoid": {"left_leg": (6, 0.1), "right_leg": (6, 0.1), "left_arm": (4, 0.5), "right_arm": (4, 0.5),
                 "waist": (3, 0.05), "neck": (2, 0.3)},
    "car": {"motors": None},
    "transporter": {"motors": None},
    "team2": {"motors": None},
}
ROUNDS, ROUND_STEPS, AFTER_STEPS = 12, 4, 60
STEPS = ROUNDS * ROUND_STEPS + AFTER_STEPS
THREADS = (1, 4) if SANITIZED else (1, 2, 4)
BRANCHES = (50,) if SANITIZED else (45, 75)  # the last commands come at step 44


def names(kind, number):
    return [f"r{number}_leader", f"r{number}_helper"] if kind == "team2" else [f"r{number}"]


def scenario(*kinds, mode="lockstep"):
    text = f"[SIMULATION]\nmode {mode}\n[FLOOR]\nsize 60 60\n"
    for number, kind in enumerate(kinds, 1):
        text += f"[ROBOT_{number}]\ntype {kind}\nname r{number}\nposition 0 {3 * (number - 1)}\n"
    return text


def command(chance, shape, number):
    """The commands of one round: all modes, profile, compliance and gains."""
    if shape is None:
        return [f"set_velocity {chance.uniform(0, 0.4):.3f} {chance.uniform(-0.3, 0.3):.3f}", f"ready {ROUND_STEPS - 1}"]
    count, most = shape
    values = [f"{chance.uniform(-most, most):.4f}" for _ in range(count)]
    tuning = {0: "set_profile " + " ".join(["0.5 2"] * count), 5: "set_compliance (1) 150 5 0.1", 9: "set_gains (2) 80 1 0"}
    if number in tuning:  # takes no step
        return [tuning[number], f"ready {ROUND_STEPS}"]
    moves = {2: "set_velocities (1) " + values[0], 3: "set_efforts (2) " + values[0], 6: "set_modes (1) 0", 7: "hold",
             8: "set_positions_direct (1 2) 0.01 -0.01"}
    return [moves.get(number, "set_positions " + " ".join(values)), f"ready {ROUND_STEPS - 1}"]


class RobotsRepeatTest(RecordingTestCase):
    def drive(self, daemon, kinds, backwards=False):
        """Sends commands to all modules round by round; the last ones move to far positions."""
        modules = [(f"/{name}/{module}", shape) for number, kind in enumerate(kinds, 1) for name in names(kind, number)
                   for module, shape in TYPES[kind].items()]
        connections = [daemon.text(module) for module, _ in modules]
        chance = random.Random(5)
        for number in range(ROUNDS):
            lines = [command(chance, shape, number) for _, shape in modules]
            order = range(len(modules))
            for i in reversed(order) if backwards else order:
                for line in lines[i]:
                    connections[i].send(line)
            for i in order:
                for line in lines[i]:
                    reply = connections[i].receive()
                    self.assertEqual(reply.error, 0, (modules[i], line, reply))
        for connection in connections:
            connection.send(f"ready {AFTER_STEPS}")
        for connection in connections:
            connection.receive()
        for connection in connections:
            connection.close()

    def driven(self, kinds, name, *options, **more):
        """The recording of a driven run."""
        file = self.folder / f"{name}.run"
        with Daemon(scenario(*kinds), "--record", file, *options) as daemon:
            self.drive(daemon, kinds, **more)
        return file

    def test_each_type_is_recorded_verified_branched_and_reset(self):
        for kind in TYPES:
            with self.subTest(robot=kind):
                file = self.folder / f"{kind}.run"
                with Daemon(scenario(kind), "--record", file) as daemon:
                    self.drive(daemon, [kind])
                    hashes = [daemon.status()["hash"]]
                    daemon.text("/simulation").must("reset")
                    self.drive(daemon, [kind])
                    hashes.append(daemon.status()["hash"])
                self.assertEqual(hashes[0], hashes[1], "after a reset the same run again")
                equal_steps(file)
                run = self.driven([kind], f"{kind}_once")
                whole = coopdyn.read_run(run).hash
                self.assertEqual(len(whole), STEPS + 1)
                self.assertEqual(equal_steps(run), STEPS)
                for step in BRANCHES:
                    branch = self.folder / f"{kind}_{step}.run"
                    done = subprocess.run([BINARY, "serve", "--from", f"{run}@#{step}", "--mode", "free", "--duration", str(STEPS / 100),
                                           "--no-net", "--record", branch], capture_output=True, text=True, timeout=LIMIT_S)
                    self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                    hashes = coopdyn.read_run(branch).hash
                    self.assertEqual(hashes, whole[-len(hashes):], f"branched at step {step}")
                    self.assertGreaterEqual(len(hashes), STEPS - step)

    def test_threads_and_the_order_of_arrival_change_nothing(self):
        kinds = list(TYPES)
        hashes = [coopdyn.read_run(self.driven(kinds, f"threads{threads}", "--threads", str(threads), backwards=threads > 1)).hash
                  for threads in THREADS]
        self.assertEqual(len(hashes[0]), STEPS + 1)
        for other in hashes[1:]:
            self.assertEqual(other, hashes[0])


if __name__ == "__main__":
    unittest.main()
