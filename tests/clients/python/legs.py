# SPDX-License-Identifier: MIT
"""A robot whose modules have other names: its motors are called legs, its compass is called north.

`python3 legs.py FOLDER` makes FOLDER/robots/legs/model.sdf and FOLDER/legs.scenario with robot1 of that type; the daemon finds
the type with COOPDYN_PATH=FOLDER."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
SCENARIO = """[SIMULATION]
mode lockstep
[ROBOT_1]
type legs
name robot1
position 0 0
"""


def make(folder):
    """Returns the scenario's path."""
    model = (ROOT / "robots" / "minibot" / "model.sdf").read_text(encoding="utf-8")
    for kind, name in (("motors", "legs"), ("compass", "north")):
        plain = f'<coopdyn:module type="{kind}"/>'
        assert plain in model
        model = model.replace(plain, f'<coopdyn:module type="{kind}" name="{name}"/>')
    made = pathlib.Path(folder) / "robots" / "legs"
    made.mkdir(parents=True)
    (made / "model.sdf").write_text(model.replace('<model name="minibot">', '<model name="legs">'), encoding="utf-8")
    scenario = pathlib.Path(folder) / "legs.scenario"
    scenario.write_text(SCENARIO, encoding="utf-8")
    return str(scenario)


if __name__ == "__main__":
    print(make(sys.argv[1]))
