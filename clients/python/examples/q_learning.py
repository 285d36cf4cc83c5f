# SPDX-License-Identifier: MIT
"""Learns to drive to a target: tabular Q-learning.

python3 q_learning.py [--generations 20] [--population 10] [--seed 1] [--state q_learning.json]

A generation is `population` episodes, each from another place. After each generation one episode runs the table without
exploration; the best table is kept. A restarted program resumes. Standard library only.
"""
import math
import random

import coopdyn_gym
import resumable

WORLD = """[SIMULATION]
mode lockstep
[FLOOR]
size 8 8 0.1
[TARGET]
red 0 0
[ROBOT_1]
type coopbot
name robot1
position -2 0
[SCORE_1]
name arrived
kind reach
target red
within 0.4
until all
"""
CHOICES = [(0.4, 0.0), (0.0, 1.5), (0.0, -1.5)]  # forward m/s, turn rad/s
SECTORS = 12  # of the bearing
RATE, DISCOUNT, CHANCE = 0.2, 0.95, 0.2


def seen(m):
    """The number of the sector that the target is in."""
    return [int((m.reading.targets[0].bearing + math.pi) / (2 * math.pi) * SECTORS + 0.5) % SECTORS]


def nearer(m):
    """The decrease of the target's distance [m], minus a small cost of time, plus one when it is reached."""
    return m.before.targets[0].distance - m.reading.targets[0].distance - 0.05 + m.scores["arrived"]


def world(place, **more):
    """The world; an episode begins at `place`, a list of x, y [m] and heading [rad] that may be changed."""
    return coopdyn_gym.Env(WORLD, observation=seen, action=CHOICES, reward=nearer, max_steps=60, repeat=20,
                           start=lambda sim, _: sim.move("robot1", (place[0], place[1], 0.0), place[2]), **more)


def episode(env, table, generator=None):
    """The return of one episode. With a generator, explores and learns; without, follows the table."""
    s, total, over = int(env.reset(seed=1)[0][0]), 0.0, False
    while not over:
        by_chance = generator is not None and generator.random() < CHANCE
        a = generator.randrange(len(CHOICES)) if by_chance else max(range(len(CHOICES)), key=table[s].__getitem__)
        obs, reward, terminated, truncated, _ = env.step(a)
        after = int(obs[0])
        if generator is not None:
            table[s][a] += RATE * (reward + (0.0 if terminated else DISCOUNT * max(table[after])) - table[s][a])
        s, total, over = after, total + reward, terminated or truncated
    return total


def main():
    chosen = resumable.options(__doc__, "q_learning", 20, 10)
    state = resumable.load(chosen, table=[[0.0] * len(CHOICES) for _ in range(SECTORS)])
    test = [-2.0, 1.0, 2.0]
    if state["generation"] < chosen.generations:
        place = list(test)
        with world(place) as env:
            while state["generation"] < chosen.generations:
                k = state["generation"]
                generator = random.Random(f"{chosen.seed} {k}")
                for _ in range(chosen.population):
                    angle, distance = generator.uniform(-math.pi, math.pi), generator.uniform(1.0, 3.0)
                    place[:] = distance * math.cos(angle), distance * math.sin(angle), generator.uniform(-math.pi, math.pi)
                    episode(env, state["table"], generator)
                place[:] = test
                total = episode(env, state["table"])
                if state["best"] is None or total > state["best"]["fitness"]:
                    state["best"] = {"fitness": total, "table": [list(row) for row in state["table"]]}
                state["history"].append(total)
                state["generation"] = k + 1
                resumable.save(chosen, state)
                print(f"generation {k + 1}: return {total:.3f}", flush=True)

    def record(file, best):
        with world(test, record=file, options=["--force"]) as env:
            episode(env, best["table"])

    resumable.finish(chosen, state, record)


if __name__ == "__main__":
    main()
