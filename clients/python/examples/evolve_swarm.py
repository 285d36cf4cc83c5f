# SPDX-License-Identifier: MIT
"""Evolves a swarm that gathers: a genetic algorithm on four numbers.

python3 evolve_swarm.py [--generations 15] [--population 10] [--seed 1] [--state evolve_swarm.json]

Each robot senses only whether another robot is ahead. The genes are the speeds of its two wheels without and with a robot ahead, as
in Gauci, Chen, Li, Dodd and Gross (2014). A restarted program resumes. Standard library only.
"""
import math
import random

import coopdyn_gym
import resumable

WORLD = """[SIMULATION]
mode lockstep
[FLOOR]
size 3 3 0.1
[SWARM_1]
type minibot
name bee
count 12
fidelity rolling
"""
GENES, SPEED = 4, 10.0  # rad/s of a wheel for a gene of 1
AHEAD = math.radians(15)
STEPS = 150  # of 0.2 s


def ahead(m, i):
    """1 if another robot is ahead of this one, else 0."""
    row = m.reading.neighbours[i]                       # id, distance, bearing of each; nan: none
    return [1.0 if any(abs(bearing) < AHEAD for bearing in row[2::3]) else 0.0]


def spread(m):
    """The mean distance of the robots from their centre [m]."""
    x, y = (sum(m.reading.pose[:, j]) / len(m.reading.pose) for j in (0, 1))
    return sum(math.dist(p[:2], (x, y)) for p in m.reading.pose) / len(m.reading.pose)


def world(**more):
    return coopdyn_gym.ParallelEnv(WORLD, "bee", observation=ahead, readings=("pose", "neighbours"), action="wheels",
                                   reward=lambda m: -spread(m), max_steps=STEPS, repeat=20, **more)


def live(env, genes, seed):
    """The fitness of these genes: minus the spread at the end [m]."""
    seen, _ = env.reset(seed=seed)
    rewards = {}
    while env.agents:
        seen, rewards, _, _, _ = env.step({name: [SPEED * gene for gene in (genes[2:] if see[0] else genes[:2])]
                                           for name, see in seen.items()})
    return next(iter(rewards.values()))


def children(parents, count, generator):
    """The next generation: the two best unchanged, the others crossed from two winners of tournaments and mutated."""
    ranked = sorted(parents, key=lambda p: -p["fitness"])
    out = [p["genes"] for p in ranked[:2]]
    while len(out) < count:
        mother, father = (min(generator.choices(range(len(ranked)), k=3)) for _ in range(2))
        out.append([min(1.0, max(-1.0, generator.choice(pair) + generator.gauss(0, 0.15)))
                    for pair in zip(ranked[mother]["genes"], ranked[father]["genes"])])
    return out[:count]


def main():
    chosen = resumable.options(__doc__, "evolve_swarm", 15, 10)
    state = resumable.load(chosen, parents=[])
    if state["generation"] < chosen.generations:
        with world(seed=chosen.seed) as env:
            while state["generation"] < chosen.generations:
                k = state["generation"]
                generator = random.Random(f"{chosen.seed} {k}")
                genes = (children(state["parents"], chosen.population, generator) if k else
                         [[generator.uniform(-1, 1) for _ in range(GENES)] for _ in range(chosen.population)])
                state["parents"] = [{"genes": g, "fitness": live(env, g, chosen.seed)} for g in genes]
                top = max(state["parents"], key=lambda p: p["fitness"])
                if state["best"] is None or top["fitness"] > state["best"]["fitness"]:
                    state["best"] = top
                state["history"].append(sum(p["fitness"] for p in state["parents"]) / chosen.population)
                state["generation"] = k + 1
                resumable.save(chosen, state)
                print(f"generation {k + 1}: best spread {-top['fitness']:.3f} m, mean {-state['history'][-1]:.3f} m", flush=True)

    def record(file, best):
        with world(seed=chosen.seed, record=file, options=["--force"]) as env:
            live(env, best["genes"], chosen.seed)

    resumable.finish(chosen, state, record)


if __name__ == "__main__":
    main()
