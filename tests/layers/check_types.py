# SPDX-License-Identifier: MIT
"""Checks that no two headers define types of one name in one namespace: the linker keeps one of their functions for both.

check_types.py ROOT | --self-test
"""
import collections
import pathlib
import re
import sys

kNamespace = re.compile(r"^namespace ([\w:]+) \{", re.MULTILINE)
kType = re.compile(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: : [^;]*)?\s*\{", re.MULTILINE)


def clashes(texts):
    """A line for each name that several of the headers, {path: text}, define."""
    places = collections.defaultdict(list)
    for path, text in texts.items():
        space = kNamespace.search(text)
        for name in kType.findall(text):
            places[f"{space.group(1) if space else ''}::{name}"].append(path)
    return [f"{name} is defined in {' and in '.join(paths)}: rename one" for name, paths in sorted(places.items()) if len(paths) > 1]


def main():
    if sys.argv[1] == "--self-test":
        header = "namespace coopdyn {\nstruct End : Base {\n};\nclass Other;\n}\n"
        assert len(clashes({"a.h": header, "b.h": header})) == 1
        assert not clashes({"a.h": header, "b.h": header.replace("coopdyn", "coopdyn::yarp")})
        return 0
    root = pathlib.Path(sys.argv[1])
    found = clashes({str(path.relative_to(root)): path.read_text(encoding="utf-8")
                     for folder in ("protocol", "server") for path in sorted((root / folder).rglob("*.h"))})
    print("\n".join(found))
    return 1 if found else 0


sys.exit(main())
