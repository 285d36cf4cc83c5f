# SPDX-License-Identifier: MIT
"""A student's program in a class, for clients_test.py: clients_program.py SERVER SEAT PIN ACTION...
"-" for SEAT and PIN: none. Each action prints its result, or `error NAME TEXT`, and the next one follows."""
import sys

import coopdyn


class Program:
    def __init__(self, server, seat, pin):
        self.server = server
        self.seat = {"seat": None if seat == "-" else seat, "pin": None if pin == "-" else pin}

    def connect(self):
        self.sim = coopdyn.connect(self.server, **self.seat)
        self.robot = self.sim.robot("robot1")
        return f"page {self.sim.status()['http']}"

    def drive(self):
        self.robot.set_velocity(0.2, 0)
        self.sim.step()
        return "driven"

    def modules(self):
        return f"modules {len(self.sim.modules())}"

    def picture(self):
        return f"picture {self.sim.snapshot('picture.png')}"

    def run(self):
        return f"run {self.sim.fetch_run(self.sim.stop_recording().name, 'fetched.run')}"

    def launch(self):
        coopdyn.launch("classroom", options=["--no-http"]).close()
        return "launched"

    def doctor(self):
        return "healthy" if coopdyn.doctor(self.server, **self.seat) else "ill"

    def wait(self):
        """Waits for a line on stdin."""
        print("waits", flush=True)
        sys.stdin.readline()
        return "goes on"


program = Program(*sys.argv[1:4])
for action in sys.argv[4:]:
    try:
        print(getattr(program, action)(), flush=True)
    except coopdyn.Error as e:
        print(f"error {e.name} {e.text}", flush=True)
