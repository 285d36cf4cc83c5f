# SPDX-License-Identifier: MIT
"""Evolves a moth that flies to the light: CMA-ES on the weights of a Braitenberg vehicle.

python3 evolve_light.py [--generations 20] [--population 8] [--seed 1] [--state evolve_light.json]

The light in the two eyes sets the wheels' speeds: left = a + b * left eye + c * right eye, and right likewise with the eyes
exchanged. Individuals fly at the same time, each in its own world. A restarted program resumes. Needs numpy (`pip install numpy`,
or Debian's python3-numpy).
"""
import sys

import coopdyn_gym
import resumable

try:
    import numpy as np
except ImportError:
    sys.exit("CMA-ES needs numpy: pip install numpy, or Debian's python3-numpy")

SCALE = np.array([5.0, 20.0, 20.0])  # rad/s: the wheels' speed without light, and per unit of light
WORLD = dict(observation=("light",), action="wheels", reward=lambda m: m.reading.light[2], max_steps=150, repeat=10)
WHEEL_LIMIT = 10.0  # rad/s


def wheels(weights, light):
    """Wheel speeds [rad/s] of a moth that sees `light`: right eye, left eye, all round."""
    a, b, c = SCALE * np.asarray(weights)
    right, left, _ = light
    return np.clip([a + b * left + c * right, a + b * right + c * left], -WHEEL_LIMIT, WHEEL_LIMIT)


def fly(envs, individuals, seed):
    """The mean light of each individual over an episode."""
    light, _ = envs.reset(seed=[seed] * len(individuals))
    total = np.zeros(len(individuals))
    for _ in range(WORLD["max_steps"]):
        light, reward, _, _, _ = envs.step([wheels(w, eyes) for w, eyes in zip(individuals, light)])
        total += reward
    return total / WORLD["max_steps"]


class Cma:
    """CMA-ES (Hansen, "The CMA evolution strategy: a tutorial") with its state in lists, for JSON."""

    def __init__(self, state, population):
        self.s, self.n, self.population = state, len(state["mean"]), population
        weights = np.log(population / 2 + 0.5) - np.log(np.arange(1, population // 2 + 1)) if population > 1 else np.ones(1)
        self.w = weights / weights.sum()
        self.mu = 1 / (self.w**2).sum()
        n, mu = self.n, self.mu
        self.cs = (mu + 2) / (n + mu + 5)
        self.ds = 1 + 2 * max(0, np.sqrt((mu - 1) / (n + 1)) - 1) + self.cs
        self.cc = (4 + mu / n) / (n + 4 + 2 * mu / n)
        self.c1 = 2 / ((n + 1.3) ** 2 + mu)
        self.cmu = min(1 - self.c1, 2 * (mu - 2 + 1 / mu) / ((n + 2) ** 2 + mu))
        self.chi = np.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))

    def ask(self, generator):
        """The individuals of the next generation, population x n."""
        values, self.B = np.linalg.eigh(np.array(self.s["C"]))
        self.D = np.sqrt(np.maximum(values, 1e-20))
        return np.array(self.s["mean"]) + self.s["sigma"] * (generator.standard_normal((self.population, self.n)) * self.D) @ self.B.T

    def tell(self, individuals, fitness):
        """Learns from the fitness of all individuals; higher is better."""
        s, mean, sigma = self.s, np.array(self.s["mean"]), self.s["sigma"]
        chosen = individuals[np.argsort(-fitness)[: len(self.w)]]
        steps = (chosen - mean) / sigma
        step = self.w @ steps
        ps = (1 - self.cs) * np.array(s["ps"]) + np.sqrt(self.cs * (2 - self.cs) * self.mu) * (self.B @ ((self.B.T @ step) / self.D))
        short = np.linalg.norm(ps) < (1.4 + 2 / (self.n + 1)) * self.chi * np.sqrt(1 - (1 - self.cs) ** (2 * (s["generation"] + 1)))
        pc = (1 - self.cc) * np.array(s["pc"]) + short * np.sqrt(self.cc * (2 - self.cc) * self.mu) * step
        C = np.array(s["C"])
        C = ((1 - self.c1 - self.cmu) * C + self.c1 * (np.outer(pc, pc) + (1 - short) * self.cc * (2 - self.cc) * C)
             + self.cmu * (steps.T * self.w) @ steps)
        s.update(mean=(mean + sigma * step).tolist(), ps=ps.tolist(), pc=pc.tolist(), C=((C + C.T) / 2).tolist(),
                 sigma=float(sigma * np.exp((self.cs / self.ds) * (np.linalg.norm(ps) / self.chi - 1))))


def main():
    chosen = resumable.options(__doc__, "evolve_light", 20, 8)
    if chosen.population < 4:
        sys.exit("CMA-ES needs at least four individuals: write --population 4")
    state = resumable.load(chosen, mean=[0.5, 0.0, 0.0], sigma=0.5, C=np.eye(3).tolist(), ps=[0.0] * 3, pc=[0.0] * 3)
    if state["generation"] < chosen.generations:
        cma = Cma(state, chosen.population)
        with coopdyn_gym.VectorEnv("lamps", "moth1", num_envs=chosen.population, **WORLD) as envs:
            while state["generation"] < chosen.generations:
                k = state["generation"]
                individuals = cma.ask(np.random.default_rng([chosen.seed, k]))
                fitness = fly(envs, individuals, chosen.seed)
                cma.tell(individuals, fitness)
                top = int(np.argmax(fitness))
                if state["best"] is None or fitness[top] > state["best"]["fitness"]:
                    state["best"] = {"fitness": float(fitness[top]), "weights": individuals[top].tolist()}
                state["history"].append(float(fitness.mean()))
                state["generation"] = k + 1
                resumable.save(chosen, state)
                print(f"generation {k + 1}: mean light {fitness.mean():.3f}, best {fitness[top]:.3f}", flush=True)

    def record(file, best):
        with coopdyn_gym.Env("lamps", "moth1", record=file, options=["--force"], **WORLD) as env:
            light, _ = env.reset(seed=chosen.seed)
            for _ in range(WORLD["max_steps"]):
                light, *_ = env.step(wheels(best["weights"], light))

    resumable.finish(chosen, state, record)


if __name__ == "__main__":
    main()
