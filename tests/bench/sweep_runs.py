# SPDX-License-Identifier: MIT
"""Overhead of a sweep beyond its daemons: time per empty run, two cores against one, runs/s of each engine.

    COOPDYN_BINARY=build/release/coopdyn python3 tests/bench/sweep_runs.py [runs]
"""
import os
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../sweep"))
import engines  # noqa: E402

BINARY = os.path.abspath(os.environ.get("COOPDYN_BINARY", "build/release/coopdyn"))
EMPTY = "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nposition 0 0\n[SCORE_1]\nkind time\n"
LONG = "[FLOOR]\nsize 40 40\n[SWARM_1]\ntype minibot\nname r\ncount 50\nspacing 1\ncontroller diffuse\n[SCORE_1]\nkind distance\n"


def taken(words, **given):
    began = time.perf_counter()
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, **given)
    if done.returncode != 0:
        sys.exit(done.stdout.decode())
    return time.perf_counter() - began


def sweep(folder, scenario, runs, duration, *more, env=None):
    """Duration of a sweep [s]."""
    with tempfile.TemporaryDirectory(dir=folder) as out:
        return taken([BINARY, "sweep", scenario, "--seeds", f"1..{runs}", "--duration", duration, "--out", out, *more], env=env)


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    with tempfile.TemporaryDirectory() as folder:
        files = {}
        for name, text in (("empty", EMPTY), ("long", LONG)):
            files[name] = os.path.join(folder, name + ".scenario")
            with open(files[name], "w", encoding="utf-8") as stream:
                stream.write(text)
        alone = [BINARY, "serve", files["empty"], "--no-http", "--no-render", "--no-net", "--mode", "free", "--speed", "0", "--duration", "0.01",
                 "--seed", "1", "--summary", "/dev/stdout"]
        daemon_s = statistics.median(taken(alone) for _ in range(runs))
        start_s = min(sweep(folder, files["empty"], 1, "0.01", "--jobs", "1") for _ in range(3)) - daemon_s
        one_s = sweep(folder, files["empty"], runs, "0.01", "--jobs", "1") - start_s
        print(f"an empty run: daemon alone {1000 * daemon_s:.1f} ms, in a sweep {1000 * one_s / runs:.1f} ms; the sweep itself starts in {start_s:.2f} s")
        ratios = []
        for _ in range(3):
            slow, fast = (sweep(folder, files["long"], 16, "100", "--jobs", jobs) for jobs in "12")
            ratios.append((slow - start_s) / (fast - start_s))
        print(f"two cores against one, 16 runs of {(slow - start_s) / 16:.1f} s: {statistics.median(ratios):.2f} x")
        two_s = sweep(folder, files["empty"], runs, "0.01", "--jobs", "2") - start_s
        print(f"empty runs/s: two processes {runs / two_s:.0f}")
        with engines.processes() as every:
            dask = engines.Dask(folder, every)
            dask_s = sweep(folder, files["empty"], runs, "0.01", "--dask", dask.address) - start_s
            print(f"empty runs/s: Dask, a scheduler and two workers {runs / dask_s:.0f}")
        with engines.processes() as every:
            place = os.path.join(folder, "slurm")
            os.mkdir(place)
            environment = engines.start_slurm(place, every)
            slurm_s = sweep(folder, files["empty"], runs, "0.01", "--slurm", env=environment) - start_s
            print(f"empty runs/s: Slurm, one node with two tasks at a time {runs / slurm_s:.1f}")


if __name__ == "__main__":
    main()
