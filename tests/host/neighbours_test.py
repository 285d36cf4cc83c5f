# SPDX-License-Identifier: MIT
"""A seat whose student does everything wrong, beside 29 seats that end with the hashes that they have without it."""
import contextlib
import os
import signal
import socket
import threading
import unittest

from classes import Host, until
import harness

NEIGHBOURS = [f"s{i:02}" for i in range(29)]
STEPS = 60
BOMB = ('<?xml version="1.0"?><!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">' +
        "".join(f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(12)) + ']><sdf version="1.9"><model name="&m;"/></sdf>')
DEEP = "<sdf version='1.9'>" + "<model name='a'>" * 100_000
CROWD = "[SIMULATION]\\nmode free\\n[FLOOR]\\nsize 400 400 0.1\\n[SWARM_1]\\ntype minibot\\nname mini\\ncount 100000\\nfidelity rolling\\n"


class HostileSeat:
    """What a student can do with the own name and PIN, one thing after the other in threads of their own, until `stop()`."""

    def __init__(self, host, name):
        self.host, self.name, self.ended, self.tried, self.crashes = host, name, threading.Event(), set(), 0
        acts = (self.flood, self.loop, self.load_a_crowd, self.fill_the_disk, self.send_bombs, self.crash)
        self.threads = [threading.Thread(target=self.repeat, args=[act]) for act in acts]
        for thread in self.threads:
            thread.start()

    def repeat(self, act):
        while not self.ended.is_set():
            self.tried.add(act)
            try:
                act()
            except (OSError, EOFError, AssertionError):
                pass  # refused, or the daemon has just died
            self.ended.wait(0.05)

    def stop(self):
        self.ended.set()
        for thread in self.threads:
            while thread.is_alive():
                self.kill(signal.SIGKILL)  # it may wait for an answer
                thread.join(0.2)

    def kill(self, number):
        daemon = self.host.daemon(self.name)
        if daemon:
            with contextlib.suppress(ProcessLookupError):
                os.kill(daemon, number)

    def flood(self):
        """Connections that ask much and read nothing."""
        opened = [self.host.module(self.name, "/robot1/pose") for _ in range(20)]
        for connection in opened:
            connection.socket.settimeout(0.01)
            try:
                while not self.ended.is_set():
                    connection.socket.sendall(b"get_pose\n" * 1000)
            except socket.timeout:
                pass
        for connection in opened:
            connection.close()

    def loop(self):
        """The simulation as fast as it can, and a program that asks without end."""
        module = self.host.module(self.name, "/simulation")
        module.ask("set_mode free")
        for _ in range(1000):
            if not self.ended.is_set():
                module.ask("get_status")
        module.close()

    def load_a_crowd(self):
        module = self.host.module(self.name, "/simulation")
        module.send(f'load_scenario "{CROWD}"')
        self.ended.wait(2)  # it takes longer, or the memory of the seat
        module.close()

    def crash(self):
        """Only once all the rest has been tried, as it ends that."""
        while len(self.tried) < len(self.threads) and not self.ended.is_set():
            self.ended.wait(0.05)
        self.ended.wait(1)
        self.kill(signal.SIGSEGV)
        self.crashes += 1

    def fill_the_disk(self):
        """Recordings, and files for scenarios."""
        recorder = self.host.module(self.name, "/recorder")
        recorder.ask("stop")
        recorder.close()
        self.upload("big.world", "# " + "x" * 4_000_000)

    def send_bombs(self):
        self.upload("bomb.sdf", BOMB)
        self.upload("deep.sdf", DEEP)

    def upload(self, name, text):
        self.host.fetch("POST", f"/s/{self.name}/api/upload", {"name": name, "text": text}, self.host.as_student(self.name))


class NeighboursTest(unittest.TestCase):
    def test_a_hostile_seat_does_not_change_the_others(self):
        alone = self.run_class(hostile=False)
        self.assertEqual(len(set(alone)), len(NEIGHBOURS))  # they drive different ways
        self.assertEqual(self.run_class(hostile=True), alone)

    def run_class(self, hostile):
        """The hashes with which the neighbours end."""
        with Host(students=["mallory", *NEIGHBOURS]) as host:
            enemy = HostileSeat(host, "mallory") if hostile else None
            try:
                motors = [host.module(name, "/robot1/motors") for name in NEIGHBOURS]
                for step in range(STEPS):
                    for index, module in enumerate(motors):
                        module.must(f"set_velocity {0.1 + 0.01 * index} {step % 3}")
                if enemy:
                    until(lambda: enemy.crashes > 1)
                return [host.status(name)["hash"] for name in NEIGHBOURS]
            finally:
                if enemy:
                    enemy.stop()


if __name__ == "__main__":
    unittest.main()
