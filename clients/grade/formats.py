# SPDX-License-Identifier: MIT
"""Grades in the formats of Gradescope, Autolab and Moodle, and as a table."""
import csv
import json
import os
import sys

import page
from plan import Wrong
from results import put, table

kKept = ("key", "label", "hidden", "seed", "steps", "time_s", "hash", "scores", "units", "met_s", "points", "earned", "void", "ended", "sentence", "trouble", "recording")


def rounded(value):
    return round(value, 4)


def gradescope(grading, grade, show_hidden):
    """results.json: `score` is the grade; one test per [POINTS_n]; the runs in `extra_data`, for appeals."""
    assignment = grade.assignment
    better = {id(points): (value, earned) for points, value, earned in grade.improvements()}
    tests = []
    for number, (points, earned) in enumerate(zip(assignment.points, grade.earned), 1):
        test = {"number": str(number), "name": points.score, "score": rounded(earned), "max_score": points.most, "visibility": "visible"}
        test["output"] = page.improvement(grade, points, *better[id(points)]) if id(points) in better else "All points."
        tests.append(test)
    lines = [] if grade.sandbox else ["GRADED WITHOUT A SANDBOX."]
    lines += [grade.sentence] if grade.submission.refused else [f"{one['label']}: {page.points_text(one['points'])} points. {one['sentence']}" for one in grade.runs]
    lines.append(f"The grade is the mean of {len(grade.runs)} runs: {page.points_text(grade.points)} of {page.points_text(assignment.most)} points.")
    seeds = {label: seed for label, seed, _ in grading.seeds}
    runs = []
    for one in grade.runs:
        kept = {name: one[name] for name in kKept}
        if one["hidden"] and show_hidden:
            kept["seed"] = seeds[one["label"]]
        runs.append({**kept, "points": rounded(kept["points"]), "earned": [rounded(earned) for earned in kept["earned"]]})
    return {
        "score": rounded(grade.points), "output": "\n".join(lines), "visibility": "visible", "stdout_visibility": "hidden", "tests": tests,
        "extra_data": {"name": grade.name, "id": grade.submission.id, "max_score": assignment.most, "assignment": assignment.title,
                       "assignment_digest": assignment.digest, "submission_digest": grade.submission.digest, "version": grading.version,
                       "digests": grading.digests, "sandbox": grade.sandbox, "refused": grade.submission.refused, "graded": not grade.troubles, "runs": runs}}


def as_text(result):
    return json.dumps(result, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def autolab(grade):
    """The last output line of an Autolab autograder."""
    scores = {}
    for points, earned in zip(grade.assignment.points, grade.earned):
        scores[points.score] = rounded(scores.get(points.score, 0) + earned)
    return json.dumps({"scores": scores})


def grades_csv(grading, grades):
    names = [one.score for one in grading.assignment.points]
    rows = [["name", "id", "points", "of", *names, "runs", "runs that earn nothing", "sentence", "sandbox"]]
    for grade in grades:
        rows.append([grade.name, grade.submission.id, rounded(grade.points), grading.assignment.most, *map(rounded, grade.earned), len(grade.runs),
                     sum(one["void"] for one in grade.runs), grade.sentence, "yes" if grade.sandbox else "no"])
    put(os.path.join(grading.out, "grades.csv"), table(rows))


def moodle_csv(grading, grades, worksheet):
    """The worksheet for Moodle's "Upload grading worksheet", which finds its students by the numbers in Identifier. With a worksheet from Moodle, adds
    grades and comments to its rows, by number, or else by name; without, makes one with the required columns. Prints who stays without a number."""
    def comment(grade):
        return "; ".join([*([grade.sentence] if grade.sentence else []), *(page.improvement(grade, *one) for one in grade.improvements())]) or "All points."

    without = [grade.name for grade in grades if not grade.submission.id.isdigit()]
    if not worksheet:
        if without:
            print(f"moodle.csv: Moodle's numbers are not known of {', '.join(without)}, and Moodle takes no row without: add --worksheet FILE.csv, the worksheet "
                  "from Moodle, which has numbers and full names; or name submissions as Moodle does, for example Name_12345_assignsubmission_file", file=sys.stderr)
        rows = [["Identifier", "Full name", "Grade", "Maximum Grade", "Last modified (grade)", "Feedback comments"]]
        rows += [["" if grade.name in without else f"Participant {grade.submission.id}", grade.name, rounded(grade.points), grading.assignment.most, "-", comment(grade)] for grade in grades]
    else:
        try:
            with open(worksheet, newline="", encoding="utf-8-sig") as stream:
                rows = list(csv.reader(stream))
        except (OSError, UnicodeDecodeError) as error:
            raise Wrong(f"--worksheet {worksheet} cannot be read: {error}") from None
        if not rows or not {"Identifier", "Grade"} <= set(rows[0]):
            raise Wrong(f"--worksheet {worksheet}: its first line has no Identifier and Grade: download it from the assignment in Moodle")
        missing = fill_in(rows, grades, comment)
        if missing:
            print(f"--worksheet {worksheet}: it has no row, or several, for {', '.join(missing)}: write these grades into Moodle by hand, or download the worksheet "
                  "anew", file=sys.stderr)
    path = os.path.join(grading.out, "moodle.csv")
    put(path, table(rows))
    return path


def fill_in(rows, grades, comment):
    """Writes grades into the rows of a worksheet. Returns the names for which there is not one row."""
    own = {name: column for column, name in enumerate(rows[0])}

    def rows_where(column, is_theirs):
        return [row for row in rows[1:] if len(row) == len(rows[0]) and is_theirs(row[own[column]])] if column in own else []

    missing = []
    for grade in grades:
        found = rows_where("Identifier", lambda cell: grade.submission.id and cell.rpartition(" ")[2] == grade.submission.id)
        found = found or rows_where("Full name", lambda cell: cell.strip().casefold() == grade.name.casefold())
        if len(found) != 1:
            missing.append(grade.name)
            continue
        found[0][own["Grade"]] = rounded(grade.points)
        if "Feedback comments" in own:
            found[0][own["Feedback comments"]] = comment(grade)
    return missing
