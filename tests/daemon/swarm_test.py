"""/swarm and /R/neighbours over raw sockets: one connection drives many robots."""
import math
import random
import re
import unittest

from document import block
from harness import Daemon, frame, until

CLAIM, RELEASE, STEP_ALL, SELECT, READ_ALL, GET_TEAM, STOP_TEAM = 7, 8, 110, 111, 112, 113, 114
ANTS = 6


def swarm_scenario(count=ANTS, mode="lockstep", more=""):
    return (f"[SIMULATION]\nmode {mode}\nstep 0.01\n[FLOOR]\nsize 20 20 0.1\n[TARGET]\nred 3 0 0.3\n"
            f"[SWARM_1]\ntype minibot\nname ant\ncount {count}\narea 0 0 4 4\nsockets yes\n{more}\n")


def commands(count, steps, seed=7):
    """Wheel speeds, steps x count x 2, some beyond the limits."""
    chance = random.Random(seed)
    return [[(chance.uniform(-30, 30), chance.uniform(-30, 30)) for _ in range(count)] for _ in range(steps)]


class EqualityTest(unittest.TestCase):
    def test_a_batch_gives_the_hash_of_one_connection_per_robot(self):
        steps = commands(ANTS, 50)
        hashes = []
        with Daemon(swarm_scenario()) as daemon:
            robots = [daemon.binary(f"/ant_{i + 1}/motors") for i in range(ANTS)]
            for step in steps:
                for robot, wheels in zip(robots, step):
                    robot.send(10, data=wheels)
                for robot in robots:
                    self.assertEqual(robot.receive().error, 0)
            hashes.append(daemon.status()["hash"])
        for threads in ("1", "2"):
            with Daemon(swarm_scenario(), "--threads", threads) as daemon:
                swarm = daemon.binary("/swarm")
                swarm.ask(CLAIM)
                for step in steps:
                    reply = swarm.ask(STEP_ALL, data=[x for pair in step for x in pair], text="wheels")
                    self.assertEqual(reply.error, 0, reply)
                self.assertEqual(reply.step, 50)
                status = daemon.status()
                hashes.append(status["hash"])
        self.assertEqual(len(set(hashes)), 1, hashes)

    def test_velocities_are_those_of_the_motors(self):
        hashes = []
        with Daemon(swarm_scenario(1)) as daemon:
            motors = daemon.text("/ant_1/motors")
            for _ in range(20):
                motors.must("set_velocity 0.1 2.5")
            hashes.append(daemon.status()["hash"])
        with Daemon(swarm_scenario(1)) as daemon:
            swarm = daemon.text("/swarm")
            for _ in range(20):
                swarm.must("step_all (1) 0.1 2.5")
            hashes.append(daemon.status()["hash"])
        self.assertEqual(hashes[0], hashes[1])


class SwarmTest(unittest.TestCase):
    def test_a_thousand_rounds_on_one_connection(self):
        with Daemon(swarm_scenario()) as daemon:
            swarm = daemon.binary("/swarm")
            self.assertEqual(swarm.ask(CLAIM, text="ant").params, list(range(1, ANTS + 1)))
            files = daemon.open_files()
            for k in range(1, 1001):
                reply = swarm.ask(STEP_ALL, data=[0.05, 0.1] * ANTS)
                self.assertEqual((reply.error, reply.params[:2], reply.step), (0, [1, ANTS], k))
                self.assertEqual(len(reply.data), ANTS * reply.params[2] + 2)
            self.assertEqual(daemon.open_files(), files)

    def test_rows_are_what_the_robots_own_modules_tell(self):
        with Daemon(swarm_scenario()) as daemon:
            swarm = daemon.binary("/swarm")
            swarm.ask(CLAIM)
            columns = swarm.ask(SELECT, [2], text="pose distances targets neighbours wheels").params
            reply = swarm.ask(STEP_ALL, data=[0.1, 1] * ANTS)
            self.assertEqual(reply.params, [1, ANTS, sum(columns)])
            for robot in range(ANTS):
                row = reply.data[robot * sum(columns):(robot + 1) * sum(columns)]
                name = f"/ant_{robot + 1}"
                self.assertEqual(row[:3], daemon.text(f"{name}/pose").must("get_pose").data[:3])
                distances = daemon.text(f"{name}/distance").must("get_distances").data[:-2]
                self.assertEqual(row[3:3 + len(distances)], distances)
                self.assertEqual(columns[1], len(distances))
                rest = row[3 + columns[1]:]
                self.assertEqual(rest[:2], daemon.text(f"{name}/target").must("get_targets").data[:2])
                near = daemon.text(f"{name}/neighbours").must("get_neighbours")
                seen = sorted(zip(near.data[0:-2:2], near.params, near.data[1:-2:2]))[:2]
                for k in range(2):
                    id_, distance, bearing = rest[2 + 3 * k:5 + 3 * k]
                    if k < len(seen):
                        self.assertEqual((distance, id_, bearing), seen[k])
                    else:
                        self.assertTrue(id_ == 0 and math.isinf(distance) and math.isnan(bearing))
                self.assertEqual(rest[8:], daemon.text(f"{name}/motors").must("get_wheels").data[:-2])

    def test_a_team_and_a_single_client_share_the_steps(self):
        with Daemon(swarm_scenario(3)) as daemon:
            motors = daemon.text("/ant_3/motors")
            motors.must("claim")
            swarm = daemon.text("/swarm")
            self.assertEqual(swarm.ask("claim ant").error, 6)
            self.assertEqual(swarm.must("claim").params, [1, 2])
            swarm.send("step_all wheels 1 1 2 2")
            until(lambda: daemon.awaited() == ["ant_3"])
            self.assertFalse(swarm.has_bytes())
            motors.must("set_wheel_speeds 3 3")
            self.assertEqual(swarm.receive().step, 1)
            self.assertEqual(motors.ask("claim").error, 0)
            self.assertEqual(daemon.text("/ant_1/motors").ask("stop").error, 6)

    def test_hello_takes_the_team_over_and_no_robot_module_does(self):
        with Daemon(swarm_scenario(2)) as daemon:
            old = daemon.text("/swarm")
            old.must("hello flock")
            old.must("claim")
            motors = daemon.text("/ant_1/motors")
            motors.must("hello flock")
            self.assertEqual(motors.ask("claim").error, 6)
            new = daemon.text("/swarm")
            new.must("hello flock")
            self.assertEqual(new.must("get_team").params, [1, 2])
            notice = old.receive()
            self.assertEqual((notice.command, notice.text), (-1, "taken over by flock"))
            self.assertEqual(new.must("step_all").step, 1)

    def test_a_reset_ends_the_wait_and_keeps_the_team(self):
        with Daemon(swarm_scenario(2)) as daemon:
            swarm = daemon.text("/swarm")
            swarm.must("claim ant_1")
            swarm.send("step_all 0.1 0")
            until(lambda: daemon.awaited() == ["ant_2"])
            daemon.text("/simulation").must("reset")
            reply = swarm.receive()
            self.assertEqual((reply.error, reply.text), (5, "reset"))
            self.assertEqual(swarm.must("claim").params, [1, 2])
            self.assertEqual(swarm.must("step_all").step, 1)

    def test_a_robot_released_by_somebody_else_leaves_the_team(self):
        with Daemon(swarm_scenario(2, mode="free")) as daemon:
            swarm = daemon.text("/swarm")
            swarm.must("claim")
            daemon.text("/simulation").must("release_robot ant_2")
            reply = swarm.must("step_all")
            self.assertEqual(reply.params[1], 1)
            self.assertEqual(reply.text, "no longer in the team: ant_2")
            self.assertEqual(daemon.text("/ant_2/motors").ask("claim").error, 0)

    def test_a_dead_client_frees_its_team_after_what_it_had_sent(self):
        with Daemon(swarm_scenario(2)) as daemon:
            swarm = daemon.binary("/swarm")
            swarm.write(frame(CLAIM) + frame(STEP_ALL, data=[1, 1, 2, 2], text="wheels") + frame(STEP_ALL))
            swarm.socket.shutdown(1)
            until(lambda: daemon.status()["step"] == 2)
            until(lambda: all(robot["owner"] is None for robot in daemon.status()["robots"]))
            self.assertEqual([swarm.receive().command for _ in range(3)], [CLAIM, STEP_ALL, STEP_ALL])
            wheels = daemon.text("/ant_2/motors").must("get_wheels")
            self.assertGreater(wheels.data[2], 0)

    def test_status_names_the_owner_of_a_driven_robot(self):
        with Daemon(swarm_scenario(2, more="controller diffuse")) as daemon:
            self.assertEqual([robot["owner"] for robot in daemon.status()["robots"]], ["controller diffuse"] * 2)
            swarm = daemon.text("/swarm")
            refusal = swarm.ask("claim ant")
            self.assertEqual(refusal.error, 6)
            self.assertIn("owned by controller diffuse", refusal.text)
            self.assertEqual(daemon.text("/ant_1/motors").ask("stop").error, 6)
            self.assertEqual(daemon.text("/ant_1/neighbours").ask("send_message 1").error, 6)
            daemon.text("/simulation").must("release_robot ant_1")
            self.assertEqual(swarm.must("claim").params, [1])
            self.assertEqual(swarm.must("step_all 0 0").error, 0)


class DocumentTest(unittest.TestCase):
    """Executes the examples of docs/protocol.md."""

    def play(self, daemon, marker):
        connection = daemon.raw()
        for line in block(marker).splitlines():
            if line.startswith("> "):
                connection.write(line[2:] + "\n")
                continue
            said = connection.read_line()
            pattern = " ".join(r"\S+" if word == "*" else re.escape(word) for word in line[2:].split(" "))
            self.assertRegex(said, f"^{pattern}$")

    def test_the_exchange_of_a_team(self):
        with Daemon(block("scenario: swarm")) as daemon:
            self.play(daemon, "exchange: swarm")

    def test_the_exchange_with_a_robot(self):
        with Daemon(name="classroom") as daemon:
            self.play(daemon, "exchange: text")


class HostileTest(unittest.TestCase):
    def test_hostile_requests_are_refused_and_disturb_nobody(self):
        with Daemon(swarm_scenario(2)) as daemon:
            good = daemon.binary("/swarm")
            good.ask(CLAIM)
            bad = daemon.binary("/swarm")
            chance = random.Random(3)
            for command, params, data, text, error in (
                    (STEP_ALL, [1], [math.nan, 0], "", 4), (STEP_ALL, [1], [math.inf, 0], "wheels", 4),
                    (STEP_ALL, [0], [], "", 4), (STEP_ALL, [-5], [], "", 4), (STEP_ALL, [2 ** 31 - 1], [], "", 10),
                    (STEP_ALL, [1] * 200000, [], "", 2), (STEP_ALL, [], [0.0] * 100000, "", 5),
                    (STEP_ALL, [1], [1.0], "", 3), (STEP_ALL, [], [], "x" * 900000, 2),
                    (CLAIM, [], [], "a " * 400000, 10), (CLAIM, [1], [], "", 2), (RELEASE, [], [], "ant", 6),
                    (SELECT, [0], [], "pose", 4), (SELECT, [2 ** 31 - 1], [], "neighbours", 4),
                    (SELECT, [], [], "pose " * 100000, 2), (READ_ALL, [3], [], "", 10), (READ_ALL, [], [], "", 5),
                    (STEP_ALL, [1, 2], [0, 0, 0, 0], "", 6), (115, [], [], "", 1)):
                reply = bad.ask(command, params, data, text)
                self.assertEqual(reply.error, error, (command, params[:3], text[:20], reply))
                self.assertLess(len(reply.text), 2000)
            for _ in range(300):
                bad.send(chance.choice([2, 3, 7, 8, STEP_ALL, SELECT, READ_ALL, GET_TEAM, STOP_TEAM, 0, 9]),
                         [chance.randint(-2, 3) for _ in range(chance.randint(0, 3))],
                         [chance.choice([0.0, 1.0, math.nan]) for _ in range(chance.randint(0, 4))],
                         chance.choice(["", "pose", "wheels", "ant_9", "ä"]))
            for k in range(1, 4):
                self.assertEqual(good.ask(STEP_ALL, data=[0.1, 0] * 2).step, k)


class NeighboursTest(unittest.TestCase):
    def test_a_broadcast_is_heard_after_the_step_by_those_within_range(self):
        with Daemon(swarm_scenario(3)) as daemon:
            swarm = daemon.text("/swarm")
            swarm.must("hello ana")
            swarm.must("claim")
            near = {i: daemon.text(f"/ant_{i}/neighbours") for i in (1, 2, 3)}
            link = near[1].must("get_link").data
            self.assertEqual(len(link), 6)
            self.assertEqual(near[1].ask("send_message 1").error, 6)  # another name than that of the owner
            near[1].must("hello ana")
            near[1].must("send_message 9 9 9")
            near[1].must("send_message 0.5 -2")
            swarm.must("step_all")
            poses = swarm.must("read_all").data
            width = (len(poses) - 2) // 3
            for i in (2, 3):
                away = math.dist(poses[:2], poses[(i - 1) * width:(i - 1) * width + 2])
                heard = near[i].must("get_messages")
                if away > link[1]:
                    self.assertEqual(heard.params, [])
                    continue
                self.assertEqual(heard.params, [1, 2])
                self.assertAlmostEqual(heard.data[0], away, delta=1e-6)
                self.assertEqual(heard.data[2:4], [0.5, -2])
            self.assertEqual(near[1].must("get_messages").params, [])
            swarm.must("step_all")
            self.assertEqual(near[2].must("get_messages").params, [])

    def test_numbers_of_a_message_are_checked(self):
        with Daemon(swarm_scenario(1)) as daemon:
            near = daemon.text("/ant_1/neighbours")
            self.assertEqual(near.ask("send_message").error, 3)
            self.assertEqual(near.ask("send_message 1 2 3 4 5 6 7 8 9").error, 3)
            self.assertEqual(near.ask("send_message nan").error, 4)
            self.assertEqual(near.must("send_message 1 2 3 4 5 6 7 8").error, 0)
            self.assertEqual(near.ask("claim").error, 5)


if __name__ == "__main__":
    unittest.main()
