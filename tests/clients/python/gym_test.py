# SPDX-License-Identifier: MIT
"""coopdyn_gym against the rules of Gymnasium's and PettingZoo's interfaces, with and without their packages, and what is wrong."""
import array
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import harness
from launch_test import of_process

sys.path.insert(0, str(harness.ROOT / "clients" / "python"))
import coopdyn  # noqa: E402
import coopdyn_gym as gym  # noqa: E402

TEXT = ("[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 8 8 0.1\n[TARGET]\nred 1 0\n[ROBOT_1]\ntype coopbot\nname ana\nposition 0 0\n"
        "[ROBOT_2]\ntype moth\nname ben\nposition -2 2\n[SCORE_1]\nkind reach\nof ana\ntarget red\nwithin 0.5\n")
SWARM = harness.swarm_of(4, "[SCORE_1]\nkind distance\n")
EXAMPLES = harness.ROOT / "clients" / "python" / "examples"

# The rules, each a sentence of the interfaces' documents, and the test that holds us to it.
RULES = {
    "Env.reset(*, seed=None, options=None) returns (observation, info)": "test_reset_returns_an_observation_and_an_info",
    "Env.step(action) returns (observation, reward, terminated, truncated, info)": "test_step_returns_five_values",
    "observations are in observation_space, samples in action_space": "test_observations_are_in_their_space",
    "reset(seed=s) begins the generator anew, reset() goes on with it": "test_the_same_seed_is_the_same_episode",
    "terminated: the aim is reached; truncated: the time is over": "test_until_terminates_and_max_steps_truncates",
    "metadata has render_modes; render() with rgb_array is height x width x 3": "test_render_gives_a_picture",
    "unwrapped is the environment itself; np_random is its generator": "test_unwrapped_and_np_random",
    "close() may be called twice": "test_close_twice_does_no_harm",
    "VectorEnv has num_envs, single and batched spaces, and autoreset_mode": "test_vector_attributes",
    "VectorEnv.reset(seed=s) gives world k the seed s + k": "test_vector_seeds",
    "the step after an end begins anew: reward 0, the action is ignored": "test_vector_autoreset_in_the_next_step",
    "VectorEnv's infos are rows by key, with a mask _key": "test_vector_infos",
    "ParallelEnv has possible_agents, agents, num_agents, max_num_agents": "test_agents",
    "observation_space(agent) and action_space(agent) return the same object each time": "test_spaces_of_agents",
    "ParallelEnv.step takes and returns dicts by agents": "test_parallel_step_returns_five_dicts",
    "agents that ended leave `agents`, and do not come back before reset": "test_who_ends_leaves",
}


def env(text=TEXT, robot="ana", **how):
    return gym.Env(text, robot, **{"repeat": 10, **how})


def same(a, b):
    return array.array("f", a).tobytes() == array.array("f", b).tobytes()


class RulesTest(unittest.TestCase):
    def test_each_rule_has_its_test(self):
        tests = {name for case in (EnvTest, VectorTest, ParallelTest) for name in dir(case)}
        self.assertEqual([test for test in RULES.values() if test not in tests], [])


class EnvTest(unittest.TestCase):
    def make(self, *args, **how):
        made = env(*args, **how)
        self.addCleanup(made.close)
        return made

    def wrong(self, text, call, *args, **how):
        with self.assertRaises(coopdyn.Error) as caught:
            call(*args, **how)
        self.assertIn(text, str(caught.exception))

    def test_reset_returns_an_observation_and_an_info(self):
        e = self.make()
        obs, info = e.reset(seed=1, options={})
        self.assertEqual(len(obs), 11)
        self.assertEqual((info["time"], info["scores"]), (0.0, {"reach": 0.0}))
        self.assertRaises(TypeError, e.reset, 1)

    def test_step_returns_five_values(self):
        e = self.make()
        e.reset()
        obs, reward, terminated, truncated, info = e.step([0.1, 0.0])
        self.assertEqual((type(reward), type(terminated), type(truncated), type(info)), (float, bool, bool, dict))
        self.assertAlmostEqual(info["time"], 0.1)

    def test_observations_are_in_their_space(self):
        e = self.make(observation=("distances", "pose", "wheels", "targets"))
        obs, _ = e.reset()
        self.assertEqual(e.observation_space.shape, (len(obs),))
        e.action_space.seed(3)
        for _ in range(20):
            action = e.action_space.sample()
            self.assertTrue(e.action_space.contains(action))
            self.assertIn(e.step(action)[0], e.observation_space)
        e.action_space.seed(3)
        first = e.action_space.sample()
        e.action_space.seed(3)
        self.assertTrue(same(first, e.action_space.sample()))

    def test_the_same_seed_is_the_same_episode(self):
        def run(e, **how):
            rows = [e.reset(**how)[0]] + [e.step([0.2, 0.3])[0] for _ in range(10)]
            return b"".join(array.array("f", row).tobytes() for row in rows)

        a, b = (self.make(robot="ben", observation=("light", "pose"), text=TEXT + "[LIGHT_1]\nposition 0 0 1\npower 1\n") for _ in range(2))
        first, second = run(a, seed=5), run(a)
        self.assertNotEqual(first, second, "another episode has other noise")
        self.assertEqual((run(b, seed=5), run(b)), (first, second), "in another daemon")
        self.assertEqual((run(a, seed=5), run(a)), (first, second), "after other episodes")
        self.assertNotEqual(run(a, seed=6), first)

    def test_until_terminates_and_max_steps_truncates(self):
        e = self.make(TEXT + "until all\n", max_steps=30)
        for _ in range(2):  # the daemon is still there after the aim
            e.reset()
            ends, total = [], 0.0
            while not any(ends):
                _, reward, *ends, _ = e.step([0.4, 0.0])
                total += reward
            self.assertEqual((ends, total), ([True, False], 1.0))
        e.reset()
        ends = [e.step([0.0, 0.0])[2:4] for _ in range(30)]
        self.assertEqual(ends, [(False, False)] * 29 + [(False, True)])

    def test_ends_of_a_shipped_scenario_end_episodes_not_the_daemon(self):
        more = {"SCORE_1.kind": "travelled", "SCORE_1.of": "moth1", "SCORE_1.until": ">= 0.1", "SCORE_2.kind": "time", "SCORE_2.limit": "0.3"}
        e = gym.Env("lamps", "moth1", set=more, observation="light", repeat=10)
        self.addCleanup(e.close)
        e.reset()
        self.assertEqual([e.step([0, 0])[2:4] for _ in range(3)], [(False, False)] * 2 + [(False, True)])
        e.reset()
        self.assertEqual([e.step([0.5, 0])[2:4] for _ in range(3)][-1], (True, True))

    def test_done_reward_and_start_are_functions(self):
        e = self.make(reward=lambda m: m.reading.pose.x - m.before.pose.x, done=lambda m: m.reading.pose.x > 1.1,
                      start=lambda sim, rng: sim.move("ana", (1.0, 0.0, 0.0), 0.0), observation=lambda m: [m.reading.pose.x, m.step])
        obs, _ = e.reset(seed=2)
        self.assertAlmostEqual(obs[0], 1.0, 5)
        total, over = 0.0, False
        while not over:
            obs, reward, over, _, _ = e.step([0.3, 0.0])
            total += reward
        self.assertAlmostEqual(1.0 + total, obs[0], 5)

    def test_choices_wheels_and_a_function_act(self):
        e = self.make(action=[(0.4, 0.0), (0.0, 1.0)], observation=("pose",))
        self.assertEqual((e.action_space, e.action_space.n), (gym.Discrete(2), 2))
        e.reset()
        self.assertGreater(e.step(0)[0][0], 0.005)
        self.wrong("write a whole number from 0 to 1", e.step, 2)
        self.wrong("write a whole number from 0 to 1", e.step, 0.5)
        e = self.make(action="wheels", observation=("pose",))
        e.reset()
        self.assertGreater(e.step([4, 4])[0][0], 0.005)
        e = self.make(action=lambda robot, a: robot.set_velocity(a[0], 0), action_space=gym.Box(-1, 1, (1,)), observation=("pose",))
        e.reset()
        self.assertLess(e.step([-0.5])[0][0], -0.005)

    def test_joints_of_all_groups_and_of_one(self):
        free = {"ROBOT_1.controller": ""}
        e = gym.Env("trot", "straight", set=free, action="positions", reward=lambda m: 0, observation="joints")
        self.addCleanup(e.close)
        self.assertEqual((e.action_space.shape, e.observation_space.shape), ((12,), (24,)))
        e.reset()
        before = e.reset()[0]
        self.assertFalse(same(before, [e.step([0.2] * 12)[0] for _ in range(5)][-1]))
        e = gym.Env("walk", "ahead", set=free, action="efforts/neck", reward=lambda m: 0, observation="pose")
        self.addCleanup(e.close)
        self.assertLess(e.action_space.shape[0], 5)
        self.wrong("has no wheels: write action=\"positions\"", gym.Env, "trot", "straight", set=free, reward=lambda m: 0)

    def test_repeat_is_as_many_steps(self):
        ends = []
        for repeat in (1, 10):
            with env(repeat=repeat) as e:
                e.reset(seed=1)
                for _ in range(40 // repeat):
                    e.step([0.3, 0.4])
                ends.append((e.sim.steps, e.sim.hash()))
        self.assertEqual(ends[0], ends[1])

    def test_wrong_actions_are_told(self):
        e = self.make()
        self.wrong("write obs, info = env.reset()", e.step, [0, 0])
        e.reset()
        self.wrong("the action has 3 numbers, not 2: write 2 numbers within [-1.05, -7.5] and [1.05, 7.5]", e.step, [1, 2, 3])
        self.wrong("holds nan, [1, nan]", e.step, [1, math.nan])
        self.wrong("the action is 'ahead': write 2 numbers", e.step, "ahead")
        self.wrong("the action is None: write 2 numbers", e.step, None)
        e.step([math.inf, 0])  # limited

    def test_a_step_after_the_end_is_told(self):
        e = self.make(max_steps=1)
        e.reset()
        e.step([0, 0])
        self.wrong("the episode has ended, or has not begun: write obs, info = env.reset()", e.step, [0, 0])

    def test_wrong_choices_are_told_and_leave_no_daemon(self):
        self.wrong("there is no observation 'distance'; there are: distances", env, observation=("distance",))
        self.wrong("ana has no light", env, observation=("light",))
        self.wrong("there is no action 'velocities'; write action=\"velocity\"", env, action="velocities")
        self.wrong("write action_space=", env, action=lambda robot, a: None)
        self.wrong("the scenario has no score 'reached'; there are: reach", env, reward="reached")
        self.wrong("no [SCORE_n], so there is no reward: write reward=", gym.Env, harness.scenario_of(1))
        self.wrong("there is no render_mode 'human'", env, render_mode="human")
        self.wrong("done is a function, not 3", env, done=3)
        self.assertEqual(of_process(os.getpid()), [])
        self.wrong("a seed is a whole number of at least 0, not -1", self.make().reset, seed=-1)
        self.wrong("there is no such scenario", gym.Env, "lampz")
        self.wrong("make the environment with render_mode", self.make().render)

    def test_render_gives_a_picture(self):
        e = self.make(render_mode="rgb_array", size=(64, 48))
        e.reset()
        picture = e.render()
        shape = picture.shape if gym.numpy is not None else (picture.height, picture.width, len(picture.rgb(0, 0)))
        self.assertEqual(tuple(shape), (48, 64, 3))
        self.assertEqual((e.render_mode, e.metadata["render_modes"]), ("rgb_array", ["rgb_array"]))

    def test_unwrapped_and_np_random(self):
        e = self.make()
        self.assertIs(e.unwrapped, e)
        e.reset(seed=4)
        first = e.np_random.random()
        e.reset(seed=4)
        self.assertEqual(e.np_random.random(), first)

    def test_close_twice_does_no_harm(self):
        e = env()
        e.close()
        e.close()

    def test_an_episode_is_a_run_that_replays(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "best.run")
            with env(record=file) as e:
                e.reset(seed=1)
                for _ in range(5):
                    e.step([0.2, 0.1])
            self.assertEqual(verify(file)[0], 0)
            self.assertEqual(list(coopdyn.read_run(file).steps)[:51], list(range(51)))

    @unittest.skipIf(gym.gymnasium is None, "gymnasium is not installed")
    def test_make_of_gymnasium(self):
        gym.gymnasium.register("coopdyn/Lamps-v0", "coopdyn_gym:Env", max_episode_steps=5, kwargs={
            "scenario": "lamps", "robot": "moth1", "observation": "light", "reward": lambda m: sum(m.reading.light)})
        e = gym.gymnasium.make("coopdyn/Lamps-v0")
        self.addCleanup(e.close)
        e.reset(seed=1)
        self.assertEqual([e.step(e.action_space.sample())[3] for _ in range(5)], [False] * 4 + [True])

    @unittest.skipIf(gym.gymnasium is None, "gymnasium is not installed")
    def test_the_checker_of_gymnasium(self):
        from gymnasium.utils.env_checker import check_env

        check_env(self.make(render_mode="rgb_array"), skip_render_check=False)


class VectorTest(unittest.TestCase):
    def setUp(self):
        self.envs = gym.VectorEnv(TEXT, "ana", num_envs=3, repeat=10, max_steps=3, observation=("pose",))
        self.addCleanup(self.envs.close)

    def test_vector_attributes(self):
        e = self.envs
        self.assertEqual((e.num_envs, e.single_observation_space.shape, e.observation_space.shape, e.action_space.shape), (3, (3,), (3, 3), (3, 2)))
        self.assertIn("NextStep", str(getattr(e.metadata["autoreset_mode"], "value", e.metadata["autoreset_mode"])))
        self.assertTrue(e.action_space.contains(e.action_space.sample()))
        self.assertTrue(e.observation_space.contains(e.reset()[0]))

    def test_vector_seeds(self):
        seeds = list(self.envs.reset(seed=5)[1]["seed"])
        self.assertEqual(len(set(seeds)), 3)
        self.assertEqual(list(self.envs.reset(seed=[7, 6, 5])[1]["seed"])[::-1][:2], seeds[:2])
        with self.assertRaisesRegex(coopdyn.Error, "there are 2 seeds for 3 worlds"):
            self.envs.reset(seed=[1, 2])

    def test_vector_autoreset_in_the_next_step(self):
        self.envs.reset(seed=1)
        drive = [[0.3, 0.0]] * 3
        results = [self.envs.step(drive) for _ in range(5)]
        self.assertEqual([list(r[3]) for r in results], [[False] * 3, [False] * 3, [True] * 3, [False] * 3, [False] * 3])
        self.assertGreater(results[2][0][0][0], 0.05)
        self.assertEqual((results[3][0][0][0], list(results[3][1]), results[3][4]["time"][0]), (0.0, [0.0] * 3, 0.0))
        self.assertGreater(results[4][0][0][0], 0.0)

    def test_vector_infos(self):
        infos = self.envs.reset()[1]
        self.assertEqual((list(infos["time"]), list(infos["_time"]), list(infos["scores"]["reach"])), ([0.0] * 3, [True] * 3, [0.0] * 3))

    def test_each_world_is_as_alone(self):
        rows = [self.envs.reset(seed=3)[0]] + [self.envs.step([[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]])[0] for _ in range(3)]
        with env(observation=("pose",), max_steps=3) as alone:
            own = [alone.reset(seed=5)[0]] + [alone.step([0.3, 0.3])[0] for _ in range(3)]
        self.assertTrue(all(same(row[2], mine) for row, mine in zip(rows, own)))

    def test_its_generators_are_those_of_the_worlds(self):
        self.assertIs(self.envs.np_random[2], self.envs.envs[2].np_random)
        self.assertIs(self.envs.unwrapped, self.envs)

    def test_wrong_use_is_told(self):
        with self.assertRaisesRegex(coopdyn.Error, "no episode has begun"):
            self.envs.step([[0, 0]] * 3)
        self.envs.reset()
        with self.assertRaisesRegex(coopdyn.Error, "an action for each of 3 worlds"):
            self.envs.step([[0, 0]] * 2)
        with self.assertRaisesRegex(coopdyn.Error, "the action of world 1 holds nan"):
            self.envs.step([[0, 0], [0, math.nan], [0, 0]])
        with self.assertRaisesRegex(coopdyn.Error, "cannot share a recording"):
            gym.VectorEnv(TEXT, "ana", record="x.run")
        with self.assertRaisesRegex(coopdyn.Error, "no such name|there is no robot|bob"):
            gym.VectorEnv(TEXT, "bob")
        self.envs.close()
        with self.assertRaisesRegex(coopdyn.Error, "is closed"):
            self.envs.reset()


class ParallelTest(unittest.TestCase):
    def make(self, text=SWARM, robots="mini", **how):
        e = gym.ParallelEnv(text, robots, **{"repeat": 5, "max_steps": 4, **how})
        self.addCleanup(e.close)
        return e

    def test_agents(self):
        e = self.make()
        self.assertEqual((e.possible_agents, e.agents, e.max_num_agents), ([f"mini_{k}" for k in range(1, 5)], [], 4))
        e.reset()
        self.assertEqual((e.agents, e.num_agents, e.unwrapped), (e.possible_agents, 4, e))

    def test_spaces_of_agents(self):
        e = self.make(observation=("distances", "pose", "neighbours"), neighbours=2)
        obs, infos = e.reset(seed=1, options={})
        self.assertEqual(set(obs) & set(infos), set(e.agents))
        for name in e.agents:
            self.assertIs(e.observation_space(name), e.observation_space(name))
            self.assertIs(e.action_space(name), e.action_space(name))
            self.assertIn(obs[name], e.observation_space(name))
        self.assertIsNot(e.action_space("mini_1"), e.action_space("mini_2"))
        self.assertEqual(len(e.state()), 12)

    def test_parallel_step_returns_five_dicts(self):
        e = self.make()
        e.reset(seed=1)
        while e.agents:
            acting = list(e.agents)
            for part in e.step({name: [0.1, 0.2] for name in acting}):
                self.assertEqual(list(part), acting)
        self.assertRaisesRegex(coopdyn.Error, "write obs, info = env.reset", e.step, {})

    def test_the_same_seed_is_the_same_episode(self):
        def run(e):
            rows = [e.reset(seed=3)[0]] + [e.step({name: [0.2, 0.1] for name in e.agents})[0] for _ in range(4)]
            return [array.array("f", row[name]).tobytes() for row in rows for name in e.possible_agents]

        a, b = self.make(observation=("distances", "pose")), self.make(observation=("distances", "pose"))
        self.assertEqual(run(a), run(b))
        self.assertEqual(run(a), run(a))

    def test_who_ends_leaves(self):
        e = self.make(done=lambda m: [k < m.step for k in range(4)], max_steps=None, reward=lambda m: [10 * k for k in range(4)],
                      observation=("pose",), action="wheels")
        e.reset()
        _, rewards, ended, _, _ = e.step({name: [5, 5] for name in e.agents})
        self.assertEqual((rewards["mini_3"], ended["mini_1"], e.agents), (20.0, True, ["mini_2", "mini_3", "mini_4"]))
        place = e.state()[:3]
        e.step({name: [5, 5] for name in e.agents})
        e.step({name: [5, 5] for name in e.agents})
        self.assertTrue(all(abs(a - b) < 0.05 for a, b in zip(place, e.state()[:3])), "it stands")
        with self.assertRaisesRegex(coopdyn.Error, "mini_1 takes no part"):
            e.step({"mini_1": [0, 0], "mini_4": [0, 0]})
        e.step({"mini_4": [0, 0]})
        self.assertEqual(e.agents, [])

    def test_steps_in_rows_are_the_same_steps(self):
        def values(e, step):
            e.reset(seed=3)
            return [[[list(map(float, row)) for row in part[0]], list(map(float, part[1])), list(map(bool, part[2])), part[3]] for part in
                    (step(e, [[0.1 * k, 0.2], [0.3, 9.0], [-0.1, 0.0], [0.0, -9.0]]) for k in range(3))]

        def by_name(e, actions):
            obs, rewards, ended, over, _ = e.step(dict(zip(e.possible_agents, actions)))
            return list(obs.values()), list(rewards.values()), list(ended.values()), any(over.values())

        how = {"reward": lambda m: [row[0] for row in m.reading.pose], "observation": ("distances", "pose"), "max_steps": 3}
        a, b = self.make(**how), self.make(**how)
        rows = values(a, lambda e, actions: e.step_rows(actions))
        self.assertEqual(rows, values(b, by_name))
        self.assertTrue(rows[-1][3])
        self.assertEqual(a.agents, [])

    def test_who_has_ended_stands_in_rows_too(self):
        e = self.make(done=lambda m: [k == 0 for k in range(4)], max_steps=None, reward=lambda m: 1.0, observation=("pose",))
        e.reset()
        first = e.step_rows([[0.3, 0.0]] * 4)
        self.assertEqual(([bool(one) for one in first[2]], list(first[1]), e.agents), ([True, False, False, False], [1.0] * 4, e.possible_agents[1:]))
        for _ in range(4):
            then = e.step_rows([[0.3, 0.0]] * 4)
        moved = [math.hypot(a[0] - b[0], a[1] - b[1]) for a, b in zip(first[0], then[0])]
        self.assertLess(moved[0], 0.02)
        self.assertGreater(min(moved[1:]), 0.04)

    def test_wrong_rows_are_told(self):
        e = self.make()
        e.reset()
        for actions, text in (([[0, 0]], "a row for each of 4 robots"), ([[0, 0]] * 3 + [[0, math.nan]], "the action of mini_4 holds nan"),
                              ([[0, 0]] * 3 + [[0]], "the action of mini_4 has 1 numbers, not 2")):
            with self.assertRaises(coopdyn.Error) as caught:
                e.step_rows(actions)
            self.assertIn(text, str(caught.exception))

    def test_until_ends_all(self):
        e = self.make(SWARM + "until >= 0.1\n", max_steps=None)
        e.reset()
        ends = {}
        while e.agents:
            _, _, ends, _, _ = e.step({name: [0.3, 0.0] for name in e.agents})
        self.assertEqual(list(ends.values()), [True] * 4)

    def test_wrong_actions_are_told(self):
        e = self.make()
        e.reset()
        for actions, text in (([0, 0], "actions are a dict by robots' names"), ({"mini_1": [0, 0]}, "no action for mini_2, mini_3, mini_4"),
                              ({**{n: [0, 0] for n in e.agents}, "max": 0}, "max takes no part"),
                              ({n: [0, math.nan] for n in e.agents}, "the action of mini_1 holds nan"),
                              ({n: [0] for n in e.agents}, "the action of mini_1 has 1 numbers, not 2")):
            with self.assertRaises(coopdyn.Error) as caught:
                e.step(actions)
            self.assertIn(text, str(caught.exception))

    @unittest.skipIf(gym.pettingzoo is None, "pettingzoo is not installed")
    def test_the_checker_of_pettingzoo(self):
        from pettingzoo.test import parallel_api_test

        parallel_api_test(self.make(max_steps=20), num_cycles=30)


class PngTest(unittest.TestCase):
    def test_all_filters(self):
        pixels = [[(17 * x * y + 40 * k) % 256 for x in range(5) for k in range(3)] for y in range(5)]
        raw = bytearray()
        for kind, row in enumerate(pixels):
            above = pixels[kind - 1] if kind else [0] * 15
            raw.append(kind)
            for i, value in enumerate(row):
                left, up, corner = (row[i - 3], above[i], above[i - 3]) if i >= 3 else (0, above[i], 0)
                paeth = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))[2]
                raw.append((value - (0, left, up, (left + up) // 2, paeth)[kind]) % 256)
        data = b"\x89PNG\r\n\x1a\n"
        for name, content in ((b"IHDR", struct.pack(">2I5B", 5, 5, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(bytes(raw))), (b"IEND", b"")):
            data += struct.pack(">I", len(content)) + name + content + b"\0\0\0\0"
        self.assertEqual(gym.read_png(data), (5, 5, bytes(sum(pixels, []))))
        with self.assertRaisesRegex(coopdyn.Error, "no PNG picture"):
            gym.read_png(b"GIF89a")


def verify(file):
    done = subprocess.run([os.environ["COOPDYN_BINARY"], "verify", file], capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout


class DocumentTest(unittest.TestCase):
    def test_the_program_of_the_document_runs(self):
        text = (harness.ROOT / "docs" / "learning.md").read_text(encoding="utf-8")
        exec(text.split("```python\n")[1].split("```")[0], {})


class ExamplesTest(unittest.TestCase):
    def run_example(self, name, folder, *options):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(harness.ROOT / "clients" / "python"), os.environ.get("PYTHONPATH", "")])}
        done = subprocess.run([sys.executable, str(EXAMPLES / f"{name}.py"), *options], cwd=folder, env=environment, capture_output=True,
                              text=True, timeout=300)
        return done.returncode, done.stdout + done.stderr

    def learns(self, name, population):
        with tempfile.TemporaryDirectory() as folder:
            small = ("--population", str(population), "--seed", "3")
            code, out = self.run_example(name, folder, "--generations", "1", *small)
            self.assertEqual(code, 0, out)
            self.assertIn("generation 1:", out)
            code, out = self.run_example(name, folder, "--generations", "2", *small)
            self.assertEqual(code, 0, out)
            self.assertNotIn("generation 1:", out)
            self.assertIn("generation 2:", out)
            file = pathlib.Path(folder, f"{name}.json")
            state, before = json.loads(file.read_text()), file.read_bytes()
            self.assertEqual((state["generation"], len(state["history"])), (2, 2))
            code, out = verify(os.path.join(folder, f"{name}.run"))
            self.assertEqual(code, 0, out)
            code, out = self.run_example(name, folder, "--generations", "2", *small)
            self.assertEqual((code, "generation" in out, file.read_bytes()), (0, False, before), "nothing is missing")
            code, out = self.run_example(name, folder, "--population", str(population + 1), "--seed", "3")
            self.assertEqual(code, 1)
            self.assertIn(f"was begun with --population {population}", out)
            straight = os.path.join(folder, "straight.json")
            self.run_example(name, folder, "--generations", "2", *small, "--state", straight)
            self.assertEqual(json.loads(pathlib.Path(straight).read_text()), state, "in one go or in two it is the same")

    def test_evolve_swarm(self):
        self.learns("evolve_swarm", 3)

    def test_q_learning(self):
        self.learns("q_learning", 2)

    @unittest.skipIf(gym.numpy is None, "numpy is not installed")
    def test_evolve_light(self):
        self.learns("evolve_light", 4)

    @unittest.skipIf(gym.numpy is not None, "numpy is installed")
    def test_evolve_light_without_numpy_says_how_to_install_it(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.run_example("evolve_light", folder),
                             (1, "CMA-ES needs numpy: pip install numpy, or Debian's python3-numpy\n"))


if __name__ == "__main__":
    unittest.main()
