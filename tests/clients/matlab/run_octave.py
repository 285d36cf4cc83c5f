# SPDX-License-Identifier: MIT
"""Runs one test script in Octave: python3 run_octave.py NAME_test.m

The first line after the licence names the script's needs: `% needs: nothing`, `% needs: fake --robots 2 --mode lockstep` (the
scripted daemon), `% needs: daemon classroom --mode lockstep` (the real one), `% needs: recording classroom --duration 1` (a
daemon that plays a run recorded with these options; the scenario is a shipped one or one of tests/clients/python), or
`% needs: legs` or `limbs` (the robots of legs.py and limbs.py). COOPDYN_SERVER gives the script the daemon's address. A script
passes if it prints `passed` at the end, and the text of each line `% prints once: TEXT` exactly once.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python"))
import harness  # noqa: E402
import legs  # noqa: E402
import limbs  # noqa: E402


def octave(script, server):
    paths = "".join(f"addpath('{p}'); " for p in (harness.ROOT / "clients" / "matlab", HERE))
    env = dict(os.environ, COOPDYN_SERVER=server, COOPDYN_ROOT=str(harness.ROOT))
    env.pop("DISPLAY", None)
    run = subprocess.run(["octave", "--no-gui", "--norc", "--eval", f"{paths}{script.stem}"], env=env, text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600)
    print(run.stdout)
    once = [l.split(": ", 1)[1] for l in script.read_text(encoding="utf-8").splitlines() if l.startswith("% prints once: ")]
    passed = run.returncode == 0 and "passed" in run.stdout.splitlines()
    return 0 if passed and all(run.stdout.count(text) == 1 for text in once) else 1


def main():
    script = HERE / sys.argv[1]
    needs = next(l for l in script.read_text(encoding="utf-8").splitlines() if l.startswith("% needs: ")).split()[2:]
    if needs[0] == "nothing":
        return octave(script, "")
    if needs[0] == "daemon":
        own = HERE.parent / "python" / f"{needs[1]}.scenario"
        with harness.Daemon(own.read_text(encoding="utf-8") if own.exists() else needs[1], *needs[2:]) as daemon:
            return octave(script, daemon.server)
    if needs[0] in ("legs", "limbs"):
        with tempfile.TemporaryDirectory() as folder:
            make = legs.make if needs[0] == "legs" else limbs.make
            scenario = pathlib.Path(make(folder)).read_text(encoding="utf-8")
            os.environ["COOPDYN_PATH"] = folder
            with harness.Daemon(scenario) as daemon:
                return octave(script, daemon.server)
    if needs[0] == "recording":
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "a.run")
            folders = (HERE.parent / "python", harness.ROOT / "scenarios")
            scenario = next(str(f / f"{needs[1]}.scenario") for f in folders if (f / f"{needs[1]}.scenario").exists())
            subprocess.run([os.environ["COOPDYN_BINARY"], "serve", scenario, "--mode", "free", "--no-net", "--record", file,
                            *needs[2:]], check=True, stdout=subprocess.DEVNULL, timeout=60)
            with harness.Daemon(file) as daemon:
                return octave(script, daemon.server)
    command = [sys.executable, str(HERE.parent / "python" / "fake_daemon.py"), *needs[1:]]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as fake:
        server = fake.stdout.readline().split("names=")[1].split()[0]
        try:
            return octave(script, server)
        finally:
            fake.stdin.close()


if __name__ == "__main__":
    sys.exit(main())
