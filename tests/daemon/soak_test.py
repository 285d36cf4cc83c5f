"""A day of use in ten minutes: a daemon's resources do not grow while clients connect, drive, load, edit, watch and disconnect."""
import os
import time
import unittest
import urllib.request

from harness import BOX, Daemon, scenario

SOAK_S = float(os.environ.get("COOPDYN_SOAK_S", 600))
TEXTS = [scenario(robots, extra=BOX).replace("\n", "\\n") for robots in (1, 8, 3)]


def memory_kib(daemon):
    """The daemon's private memory."""
    with open(f"/proc/{daemon.process.pid}/smaps_rollup", encoding="ascii") as rollup:
        return sum(int(line.split()[1]) for line in rollup if line.startswith(("Private_Clean", "Private_Dirty")))


class SoakTest(unittest.TestCase):
    def use(self, daemon, text):
        """One lesson, which closes everything that it opens."""
        opened = len(daemon.connections)
        simulation, world = daemon.text("/simulation"), daemon.text("/world")
        simulation.must(f'load_scenario "{text}"')
        robots = [robot["name"] for robot in daemon.status()["robots"]]
        watcher = daemon.binary(f"/{robots[0]}/pose")
        watcher.ask(40)
        motors = [daemon.text(f"/{robot}/motors") for robot in robots]
        for _ in range(100):
            for each in motors:
                each.send("set_velocity 0.2 0.1")
            for each in motors:
                self.assertEqual(each.receive().error, 0)
        for _ in range(10):
            world.must("insert [CRATE_*] | type box | size 0.2 0.2 0.2 | position 8 8 | mass 1")
            world.must("undo")
        simulation.must("reset")
        for path in ("api/status", "api/scene", "api/modules", "api/costs"):
            with urllib.request.urlopen(daemon.http + path, timeout=60) as answer:
                answer.read()
        for connection in daemon.connections[opened:]:
            connection.close()
        del daemon.connections[opened:]

    def test_memory_files_and_threads_stay_flat(self):
        with Daemon(scenario(1), "--http") as daemon:
            rounds = []
            end = time.monotonic() + SOAK_S
            while time.monotonic() < end or len(rounds) < 30:
                for text in TEXTS:
                    self.use(daemon, text)
                rounds.append((memory_kib(daemon), daemon.open_files(), daemon.threads()))
            early, late = rounds[len(rounds) // 5:2 * len(rounds) // 5], rounds[-(len(rounds) // 5):]
            memory, files, threads = (tuple(max(each[i] for each in part) for part in (early, late)) for i in range(3))
            print(f"{len(rounds)} rounds; early and late: {memory} KiB, {files} files, {threads} threads")
            self.assertLess(memory[1], memory[0] * 1.05 + 1024)
            self.assertLessEqual(files[1], files[0] + 8)  # connections whose end has not been read yet
            self.assertLessEqual(threads[1], threads[0])


if __name__ == "__main__":
    unittest.main()
