# SPDX-License-Identifier: MIT
"""The folder of a class (`coopdyn host`): takes what its seats handed in, and writes beside it what it got."""
import csv
import os
import re

import page
from plan import Wrong
from results import put
from submissions import Candidate

kProgram = "program.py"


def file_for(assignment):
    """The file as which an assignment wants the one program of a seat."""
    wanted = assignment.values["files"] or sorted(set(re.findall(r"\{submission\}/([^\s'\"]+)", " ".join(assignment.values["command"]))))
    if len(wanted) != 1 or not wanted[0].endswith(".py"):
        raise Wrong(f"{assignment.path} wants {' and '.join(wanted) or 'no file'}, and a seat hands in one Python program: --class needs an assignment whose "
                    "`files` names one .py, for example `files main.py`")
    return wanted[0]


def seats(folder):
    """[(seat, name), …] of class.csv, which teachers edit in a spreadsheet."""
    path = os.path.join(folder, "class.csv")
    try:
        with open(path, newline="", encoding="utf-8-sig") as stream:
            head = stream.readline()
            stream.seek(0)
            rows = list(csv.reader(stream, delimiter=max(",;\t", key=head.count)))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise Wrong(f"--class {folder}: {path} cannot be read: {error}. Name the folder that `coopdyn host` has made, for example class") from None
    columns = [name.strip().lower() for name in rows[0]] if rows else []
    if not {"seat", "name"} <= set(columns):
        raise Wrong(f"--class {folder}: the first line of {path} has no seat and name: start `coopdyn host` with it once, which adds them")
    every = [dict(zip(columns, (cell.strip() for cell in row))) for row in rows[1:]]
    return [(one["seat"], one.get("name") or one["seat"]) for one in every if one.get("seat")]


def newest(folder, seat):
    """The folder of a seat's newest hand-in; None without one."""
    path = os.path.join(folder, "seats", seat, "handed-in")
    times = [name for name in os.listdir(path) if re.fullmatch(r"\d{8}-\d{6}", name)] if os.path.isdir(path) else []
    return os.path.join(path, max(times)) if times else None


def candidates(folder, assignment):
    """The newest program that each seat handed in. Prints who handed in nothing, and seats that the class no longer has."""
    wanted, every, found, without = file_for(assignment), seats(folder), [], []
    for seat, name in every:
        if not re.fullmatch(r"[a-z0-9][a-z0-9_-]*", seat):
            raise Wrong(f"--class {folder}: class.csv has the seat {seat!r}: a seat's name has a-z, 0-9, - and _")
        handed_in = newest(folder, seat)
        if handed_in:
            found.append(Candidate(os.path.join(handed_in, kProgram), name, seat, wanted, os.path.join(handed_in, "result.txt")))
        else:
            without.append(f"{name} ({seat})")
    if without:
        print(f"{folder}: nothing handed in by {', '.join(without)}", flush=True)
    path = os.path.join(folder, "seats")
    gone = sorted(set(os.listdir(path) if os.path.isdir(path) else []) - {seat for seat, _ in every})
    gone = [seat for seat in gone if newest(folder, seat)]
    if gone:
        print(f"{folder}: passed over {', '.join(gone)}: class.csv has no such seat: add the line if it counts", flush=True)
    return found


def write_results(grades):
    """Writes the result.txt that a student's page shows. Returns how many."""
    texts = [(one.submission.result, text_of(one)) for one in grades if one.submission.result and not one.troubles]
    for path, text in texts:
        put(path, text)
    return len(texts)


def text_of(grade):
    lines = [f"{grade.assignment.title}: {page.points_text(grade.points)} of {page.points_text(grade.assignment.most)} points."]
    if grade.sentence:
        lines.append(grade.sentence)
    if grade.runs:
        lines += ["To improve: " + page.improvement(grade, *one) for one in grade.improvements()]
    return "\n".join(lines) + "\n"
