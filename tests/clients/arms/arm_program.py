# SPDX-License-Identifier: MIT
"""Moves an arm in every way and prints its readings; arm_program.m and arm_program.cc are the same program."""
import coopdyn


def show(what, values):
    print(what, *("%.17g" % value for value in values))


with coopdyn.connect() as sim:
    arm = sim.robot("arm1").joints("arm")
    arm.set_positions([0, 0.4, 0, 0.4, 0, 0.4, 0])
    sim.step()
    steps = 1
    while not arm.arrived():
        sim.step()
        steps += 1
    show("arrived", [steps, *arm.get().position])
    show("target", arm.get_motion().target)
    arm.set_velocities([0.2, -0.1], [1, 3])
    sim.step(50)
    show("velocities", arm.get().velocity)
    arm.set_efforts(1.5, "joint_7")
    sim.step(5)
    show("efforts", arm.get([6, 7]).effort)
    print("modes", *arm.get_modes())
    arm.hold()
    sim.step(30)
    show("held", arm.get().position)
    arm.set_compliance(200, 20, 1, joints=[2])
    sim.step(100)
    show("compliance", [*arm.get_compliance(2).k, *arm.get_compliance(2).d, *arm.get_compliance(2).offset])
    show("sagged", arm.get(2).position)
    for k in range(20):
        arm.set_positions_direct(0.4 + 0.001 * k, 4)
        sim.step()
    show("direct", [*arm.get_references(4), *arm.get(4).position])
    show("tool", [row[3] for row in arm.forward([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])[:3]])
    print("hash", sim.hash(), sim.steps)
