# SPDX-License-Identifier: MIT
"""Checks that computing code calls no transcendental function of libm: their bits differ between machines, and affect the hash of
a run. server/base/portable_math.h has the permitted functions. Also checks that our programs export their own functions in place
of libm's, that foreign libraries and controllers call no others, and that nothing is compiled to a fused multiply-add.

Usage: check_math.py ROOT PROGRAM LIBRARY…
"""
import json
import pathlib
import re
import subprocess
import sys

NAMES = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sincos", "exp", "log", "pow", "cbrt", "hypot", "sinh", "cosh", "tanh", "exp2", "exp10", "expm1",
         "log2", "log10", "log1p"]  # shown by programs
OTHERS = ["asinh", "acosh", "atanh", "erf", "erfc", "tgamma", "lgamma", "fma"]
LIBM = {name + end for name in NAMES + OTHERS for end in ("", "f", "l")}
CALL = re.compile(r"std::(" + "|".join(NAMES + OTHERS) + r")\(|AngleAxisd|Rotation2D")
ROUND_TWICE = "-ffp-contract=off"
FOREIGN = ("libode.", "libccd.", "libsdformat", "libignition-math", "libassimp.")  # compute between a file and the hash
DRAW_AND_ANSWER = ("render", "web")  # folders of server/ that no hash depends on


def symbols(program, *options):
    """(file or None, symbol) for each symbol that nm lists."""
    listed = subprocess.run(["nm", *options, program], capture_output=True, text=True, check=True).stdout
    return {line.split()[-1].split("@")[0] for line in listed.splitlines() if re.search(r" [A-Za-z] ", line)}


def foreign_libraries(program):
    listed = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    return [path for path in re.findall(r"=> (\S+)", listed) if pathlib.Path(path).name.startswith(FOREIGN)]


def mistakes_in(root, program, libraries):
    found = []
    for path in sorted(path for path in (root / "server").rglob("*") if path.suffix in (".h", ".cc")):
        if path.relative_to(root).parts[1] not in DRAW_AND_ANSWER:
            found += [f"{path.relative_to(root)} calls {call[0]}: call portable:: of server/base/portable_math.h" for call in CALL.finditer(path.read_text())]
    for library in libraries:
        found += [f"{library} calls {name} of libm: call portable:: of server/base/portable_math.h" for name in sorted(symbols(library, "-u") & LIBM)]
    files = pathlib.Path(program).with_name("coopdyn-files")  # reads meshes
    for each in (program, files):
        shown = symbols(each, "-D", "--defined-only")
        found += [f"{each} does not show {name}: what it loads calls libm's" for name in NAMES if not {name, name + "f"} <= shown]
        for loaded in [*foreign_libraries(each), *sorted((files.parent / "controllers").glob("*.so"))]:
            found += [f"{loaded} calls {name}, which {each} does not show" for name in sorted((symbols(loaded, "-D", "-u") & LIBM) - shown)]
    commands = [entry["command"] for entry in json.loads((pathlib.Path(program).parent / "compile_commands.json").read_text())]
    outputs = {re.search(r" -o (\S+)", command)[1]: command for command in commands}
    fused = [output for output, command in outputs.items() if not output.startswith("tests/") and ROUND_TWICE not in command]
    skeleton = root / "clients" / "plugin" / "skeleton" / "CMakeLists.txt"  # what `coopdyn new-controller` writes
    fused += [] if ROUND_TWICE in skeleton.read_text() else [skeleton]
    found += [f"{output} may get fused multiply-adds: compile it with {ROUND_TWICE}" for output in fused]
    return found


def main():
    mistakes = mistakes_in(pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:])
    for mistake in mistakes:
        print(mistake)
    return bool(mistakes)


sys.exit(main())
