"""Checks that each library includes only what the table in docs/architecture.md lets it use.

The table's rows read | `server/base/` | uses | what is inside |. Also: <ode/ode.h> only in server/physics, GL only in
server/render, sockets (Asio, Beast) only in server/net, naming, yarp, robot, control, web, host and app. And that commands print through server/app/print.h.
"""
import re
import sys
import tempfile
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)
ROW = re.compile(r"^\|\s*`([a-z_/]+)/`\s*\|([^|]*)\|", re.M)

# Commands print through one place, which sanitises texts of files and peers.
PRINTS = re.compile(r"print\.h$")
WRITES = re.compile(r"std::(cout|cerr|clog)|\b(printf|fprintf|puts|fputs|fwrite|putchar)\(")

# External headers and the only folders that may include them.
ONLY_IN = {
    r"ode/": ["server/physics"],
    r"(GL|EGL|GLES\d?)/": ["server/render"],
    r"boost/(asio|beast)": ["server/net", "server/naming", "server/robot", "server/yarp", "server/yars", "server/control", "server/web", "server/host", "server/app", "clients/cpp"],
    r"sdf/": ["server/model"],
    r"sleef": ["server/base"],
    r"assimp/": ["server/files"],
    r"mujoco/": ["server/mjcf"],
    r"sqlite3": ["server/record", "clients/cpp"],
    r"matio": ["server/replay"],
}


def read_table(text):
    """Folder → set of folders it may use. Names in `uses` are the last part of a folder, or `all`."""
    rows = {folder: uses for folder, uses in ROW.findall(text)}
    short = {folder.split("/")[-1]: folder for folder in rows}
    table = {}
    for folder, uses in rows.items():
        words = re.findall(r"[a-z_]+", uses)
        table[folder] = set(rows) if "all" in words else {short[w] for w in words if w in short}
    return table


def folder_of(path, table):
    """The longest folder of the table that holds `path`."""
    best = ""
    for folder in table:
        if path.startswith(folder + "/") and len(folder) > len(best):
            best = folder
    return best


def check(root):
    table = read_table((root / "docs" / "architecture.md").read_text())
    if len(table) < 10:
        return ["docs/architecture.md: the table of libraries was not found"]
    mistakes = []
    for top in ("protocol", "server", "clients"):
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in (".h", ".cc") or not file.is_file():
                continue
            path = file.relative_to(root).as_posix()
            own = folder_of(path, table)
            if not own:
                mistakes.append(f"{path}: its folder is not in the table of docs/architecture.md")
                continue
            if own == "server/app" and not PRINTS.match(file.name) and WRITES.search(file.read_text()):
                mistakes.append(f"{path}: commands print through server/app/print.h only")
            for kind, included in INCLUDE.findall(file.read_text()):
                for pattern, allowed in ONLY_IN.items():
                    if kind == "<" and re.match(pattern, included) and own not in allowed:
                        mistakes.append(f"{path}: <{included}> belongs to {', '.join(allowed)} only")
                used = folder_of(included, table)
                if kind == '"' and used and used != own and used not in table[own]:
                    mistakes.append(f'{path}: "{included}": {own} may not use {used}')
    return mistakes


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name in "abcdefghijk":
            (root / "server" / name).mkdir(parents=True)
        (root / "docs").mkdir()
        rows = "".join(f"| `server/{name}/` | {'a' if name == 'b' else ''} | |\n" for name in "abcdefghijk")
        (root / "docs" / "architecture.md").write_text(rows)
        (root / "server/b/x.h").write_text('#include "server/a/y.h"\n')
        assert check(root) == [], check(root)
        (root / "server/a/y.h").write_text('#include "server/b/x.h"\n#include <ode/ode.h>\n')
        assert len(check(root)) == 2, check(root)
        (root / "server/app").mkdir()
        (root / "docs/architecture.md").write_text(rows + "| `server/app/` | all | |\n")
        (root / "server/app/x.cc").write_text('std::cerr << "mistake";\n')
        assert len(check(root)) == 3, check(root)


if sys.argv[1] == "--self-test":
    self_test()
else:
    found = check(Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)
