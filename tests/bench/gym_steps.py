# SPDX-License-Identifier: MIT
"""Steps per second of coopdyn_gym beside a bare Python client, which does the same without it; medians of ratios.

    COOPDYN_BINARY=build/release/coopdyn PYTHONPATH=clients/python python3 tests/bench/gym_steps.py [rounds]
"""
import statistics
import sys
import threading
import time

import coopdyn
import coopdyn_gym

read = list if coopdyn_gym.numpy is None else coopdyn_gym.numpy.asarray
ROOM = "[FLOOR]\nsize 60 60\n[SWARM_1]\ntype minibot\nname r\ncount {}\nspacing 1\nfidelity rolling\n[SIMULATION]\nstep 0.01\n"
ONE = "[FLOOR]\nsize 8 8\n[ROBOT_1]\ntype coopbot\nname eva\nposition 0 0\n"


def rate(step, count):
    began = time.perf_counter()
    for _ in range(count):
        step()
    return count / (time.perf_counter() - began)


def one_bare():
    sim = coopdyn.launch(ONE, mode="lockstep", options=["--no-http"])
    robot = sim.robot("eva")
    sim.set_participants(["eva"])

    def step():
        robot.set_velocity(0.1, 0.2)
        sim.step()
        reading = robot.sense()
        return reading.distances, reading.pose.x

    return step, sim.close


def one_gym():
    env = coopdyn_gym.Env(ONE, "eva", reward=lambda m: m.reading.pose.x, max_steps=None)
    env.reset(seed=7)
    return lambda: env.step([0.1, 0.2]), env.close


def team_bare(n):
    sim = coopdyn.launch(ROOM.format(n), mode="lockstep", options=["--no-http"])
    team = sim.team("r")
    team.select("pose", "distances")
    speeds = read([[0.1, 0.2]] * n)

    def step():
        reading = team.step(speeds)
        return read(reading.distances), read(reading.pose)

    return step, sim.close


def team_rows(n):
    env = coopdyn_gym.ParallelEnv(ROOM.format(n), "r", reward=lambda m: 0.0, max_steps=None)
    env.reset(seed=7)
    actions = read([[0.1, 0.2]] * n)
    return lambda: env.step_rows(actions), env.close


def team_gym(n):
    env = coopdyn_gym.ParallelEnv(ROOM.format(n), "r", reward=lambda m: 0.0, max_steps=None)
    env.reset(seed=7)
    actions = {name: [0.1, 0.2] for name in env.agents}
    return lambda: env.step(actions), env.close


def vector_bare(n):
    worlds = [one_bare() for _ in range(n)]

    def step():
        threads = [threading.Thread(target=world[0]) for world in worlds]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    return step, lambda: [world[1]() for world in worlds]


def vector_gym(n):
    envs = coopdyn_gym.VectorEnv(ONE, "eva", num_envs=n, reward=lambda m: m.reading.pose.x, max_steps=None)
    envs.reset(seed=7)
    return lambda: envs.step([[0.1, 0.2]] * n), envs.close


def compare(title, bare, gym, count, worlds, rounds):
    """Alternates rounds, so that other load slows both."""
    (bare_step, close_bare), (gym_step, close_gym) = bare, gym
    rate(bare_step, count // 4 + 1), rate(gym_step, count // 4 + 1)
    pairs = [(rate(bare_step, count), rate(gym_step, count)) for _ in range(rounds)]
    close_bare(), close_gym()
    bares, gyms = (worlds * statistics.median(column) for column in zip(*pairs))
    print(f"{title:34} bare {bares:8.0f}/s  gym {gyms:8.0f}/s  ratio {statistics.median(g / b for b, g in pairs):.2f}", flush=True)


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 9
    compare("1 robot, Env", one_bare(), one_gym(), 1000, 1, rounds)
    compare("1 robot in each of 2 worlds", vector_bare(2), vector_gym(2), 1000, 2, rounds)
    for n, count in ((16, 400), (1000, 40)):
        compare(f"{n} robots, ParallelEnv.step", team_bare(n), team_gym(n), count, 1, rounds)
        compare(f"{n} robots, ParallelEnv.step_rows", team_bare(n), team_rows(n), count, 1, rounds)


if __name__ == "__main__":
    main()
