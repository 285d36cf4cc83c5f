# SPDX-License-Identifier: MIT
"""A robot with two muscles that pull a sledge, a thruster and a torque on its base, and a knee with a drive train, all mapped by its
channel; and a robot with only wheels.

`python3 limbs.py FOLDER` makes FOLDER/robots/limbs/model.sdf and FOLDER/limbs.scenario with robot1 of that type and a coopbot
robot2; the daemon finds the type with COOPDYN_PATH=FOLDER."""
import pathlib
import sys

SCENARIO = """[SIMULATION]
mode lockstep
[FLOOR]
size 20 20 0.1
[ROBOT_1]
type limbs
name robot1
position 0 0
[ROBOT_2]
type single
name robot2
position 4 0
sync no
"""
MAX_FORCE_N, MAX_THRUST_N, MAX_TORQUE_NM = 30, 5, 0.2
STEPS = 2  # of an exchange


def link(name, z, mass, size):
    return f"""<link name="{name}"><pose>0 0 {z} 0 0 0</pose>
<inertial><mass>{mass}</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
<collision name="c"><geometry><box><size>{size}</size></box></geometry></collision></link>"""


def muscle(name, x):
    return (f'<coopdyn:muscle name="{name}" from="base" from_point="{x} 0 0.6" to="sledge" max_force_n="{MAX_FORCE_N}" '
            'optimal_length_m="0.5" max_velocity_m_s="2"/>')


MODEL = f"""<sdf version="1.9" xmlns:coopdyn="https://coopdyn.dev/sdf"><model name="limbs">
{link("base", 0.05, 10, "0.4 0.4 0.1")}
{link("shin", 0.3, 0.5, "0.1 0.1 0.1")}
{link("sledge", 0.65, 1, "0.1 0.1 0.1")}
<joint name="knee" type="continuous"><parent>base</parent><child>shin</child><axis><xyz>0 0 1</xyz></axis>
<coopdyn:drivetrain ratio="10" torque_constant_nm_a="0.05">
<coopdyn:pwm duty="1" no_load_speed_rad_s="50" stall_torque_nm="0.2"/></coopdyn:drivetrain></joint>
<joint name="rail" type="prismatic"><parent>base</parent><child>sledge</child>
<axis><xyz>1 0 0</xyz><limit><lower>-0.3</lower><upper>0.3</upper></limit><dynamics><damping>20</damping></dynamics></axis></joint>
{muscle("biceps", 0.5)}
{muscle("triceps", -0.5)}
<coopdyn:thruster name="jet" link="base" direction="1 0 0" max_force_n="{MAX_THRUST_N}"/>
<coopdyn:thruster name="spin" link="base" direction="0 0 1" max_torque_nm="{MAX_TORQUE_NM}"/>
<coopdyn:channel steps="{STEPS}">
<coopdyn:motor name="knee_motor" joint="knee" mode="velocity" internal="-4 4" external="-1 1"/>
<coopdyn:motor name="pull" joint="biceps" mode="pwm"/>
<coopdyn:value name="knee_speed" joint="knee" of="velocity" internal="-4 4" external="-1 1"/>
<coopdyn:value name="place" of="x" auxiliary="true"/>
<coopdyn:value name="place" of="y" auxiliary="true"/>
</coopdyn:channel>
<coopdyn:module type="channel"/><coopdyn:module type="pose"/>
</model></sdf>
"""


def make(folder):
    """Returns the scenario's path."""
    made = pathlib.Path(folder) / "robots" / "limbs"
    made.mkdir(parents=True)
    (made / "model.sdf").write_text(MODEL, encoding="utf-8")
    scenario = pathlib.Path(folder) / "limbs.scenario"
    scenario.write_text(SCENARIO, encoding="utf-8")
    return str(scenario)


if __name__ == "__main__":
    print(make(sys.argv[1]))
