# SPDX-License-Identifier: MIT
"""A page for each submission, and one for the class: self-contained HTML."""
import base64
import html
import os
import urllib.parse

from report import html_table
from results import put

kHead = ("<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'><title>{}</title><style>"
         "body{{font:15px/1.5 sans-serif;margin:2em auto;padding:0 1em;max-width:60em}}td,th{{padding:.2em .8em;text-align:right;vertical-align:top}}"
         "th{{border-bottom:1px solid}}td:first-child,th:first-child,td:last-child,th:last-child{{text-align:left}}pre{{background:#eee;padding:1em;"
         "overflow:auto;white-space:pre-wrap}}img{{max-width:100%}}.loud{{background:#c00;color:#fff;padding:.5em}}</style>")
kLoud = "<p class='loud'>Graded without a sandbox: the programs could read and change whatever the grader could.</p>"
kOutput = 4000  # characters of the program's output on the page


def points_text(value):
    return f"{value:.2f}".rstrip("0").rstrip(".")


def with_unit(value, unit):
    return "" if value is None else f"{value:.4g}" + (f" {unit}" if unit else "")


def unit_of(grade, score):
    if score.endswith(" met"):
        return "s"
    return next((one["units"][score] for one in grade.runs if score in one["units"]), "")


def improvement(grade, points, value, earned):
    unit = unit_of(grade, points.score)
    reached = "no run has a value" if value is None else f"{with_unit(value, unit)} on average"
    text = (f" Only with {points.needs}." if points.needs else "") + (f" {points.text}" if points.text else "")
    return (f"{points.score}: {points_text(earned)} of {points_text(points.most)} points. Reached: {reached}. All points from {with_unit(points.end, unit)} on." + text)


def run_rows(grade):
    scores = [one.score for one in grade.assignment.points]
    head = ["run", *dict.fromkeys(scores), "points", "hash", "how it ended"]
    rows = []
    for one in grade.runs:
        values = {**one["scores"], **{f"{name} met": when for name, when in one["met_s"].items()}}
        rows.append([one["label"], *(with_unit(values.get(name), unit_of(grade, name)) for name in dict.fromkeys(scores)), points_text(one["points"]),
                     one["hash"] or "", one["sentence"]])
    return head, rows


def write_one(grading, grade, film):
    """Writes OUT/NAME/index.html."""
    assignment, escape = grade.assignment, html.escape
    title = f"{assignment.title}: {grade.name}"
    page = [kHead.format(escape(title)), f"<h1>{escape(title)}</h1>", "" if grade.sandbox else kLoud,
            f"<p><b>{points_text(grade.points)} of {points_text(assignment.most)} points</b>: the mean of {len(grade.runs)} runs on "
            f"{sum(not one['hidden'] for one in grade.runs)} visible and {sum(one['hidden'] for one in grade.runs)} hidden seeds.</p>"]
    if grade.sentence:
        page.append(f"<p>{escape(grade.sentence)}</p>")
    if grade.troubles:
        page.append(f"<p class='loud'>Not graded to the end: {len(grade.troubles)} runs failed for reasons that are not the submission's.</p>")
    if not grade.submission.refused:
        page += ["<h2>Points</h2>", html_table(["score", "points", "of", "nothing at", "all from"], (
            [one.score, points_text(earned), points_text(one.most), *(with_unit(value, unit_of(grade, one.score)) for value in (one.start, one.end))]
            for one, earned in zip(assignment.points, grade.earned))), "<h2>Runs</h2>", html_table(*run_rows(grade))]
        better = grade.improvements()
        if better:
            page += ["<h2>What to improve</h2><ul>", *(f"<li>{escape(improvement(grade, *one))}</li>" for one in better), "</ul>"]
    worst = grade.worst()
    if film:
        data = base64.b64encode(film).decode()
        page.append(f"<h2>The film of {worst['label']}, the visible run with the fewest points</h2><img alt='film' src='data:image/png;base64,{data}'>")
    said = next((one for one in ([worst] if worst else []) + grade.runs if one["output"]), None)
    if said:
        page += [f"<h2>What the program printed, {said['label']}</h2><pre>{escape(said['output'][-kOutput:])}</pre>"]
    page.append(f"<p>{escape(grading.version)}, build {escape(grading.digests.get('build', ''))}, assignment {assignment.digest}, submission "
                f"{grade.submission.digest}. The same program gives the same hashes again, unless it looks at the clock or at chance.</p>")
    put(os.path.join(grading.out, grade.name, "index.html"), "".join(page))


def write_class(grading, grades, others):
    """Writes OUT/index.html. `others`: names of results that are not in the table."""
    assignment = grading.assignment
    rows = "".join(
        f"<tr><td><a href='{urllib.parse.quote(grade.name)}/index.html'>{html.escape(grade.name)}</a><td>{html.escape(grade.submission.id)}" +
        "".join(f"<td>{points_text(earned)}" for earned in grade.earned) + f"<td><b>{points_text(grade.points)}</b>"
        f"<td>{html.escape(grade.sentence)}" for grade in grades)
    head = "".join(f"<th>{html.escape(one.score)} ({points_text(one.most)})" for one in assignment.points)
    put(os.path.join(grading.out, "index.html"), "".join([
        kHead.format(html.escape(assignment.title)), f"<h1>{html.escape(assignment.title)}</h1>",
        "" if all(grade.sandbox for grade in grades) else kLoud,
        f"<p>{len(grades)} submission{'' if len(grades) == 1 else 's'}, {len(grading.seeds)} seeds each. Points are means over the seeds, of "
        f"{points_text(assignment.most)}.</p>",
        f"<p class='loud'>{html.escape(left_out(others))}</p>" if others else "",
        f"<table><tr><th>submission<th>id{head}<th>points<th>", rows, "</table>"]))


def left_out(others):
    return f"Not in the tables, as they were graded with another text of the assignment or are damaged: {', '.join(others)}. Grade these again."
