# SPDX-License-Identifier: MIT
"""Results of earlier gradings in OUT, which stay in the tables when more submissions are graded."""
import json
import os

import grading
import submissions


def results(out):
    """{name: content of its results.json} of all submissions in OUT; None instead of a content that cannot be read."""
    found = {}
    for name in sorted(os.listdir(out)) if os.path.isdir(out) else []:
        path = os.path.join(out, name, "results.json")
        if name == "hidden" or not os.path.isfile(path):
            continue
        try:
            with open(path, encoding="utf-8") as stream:
                found[name] = json.load(stream)
            data = found[name]["extra_data"]
            data["id"], data["refused"], data["sandbox"], data["assignment_digest"], [one["units"] for one in data["runs"]]
        except (OSError, ValueError, KeyError, TypeError):
            found[name] = None
    return found


def ids(kept):
    """{name: id of the school's system} of results()."""
    return {name: one["extra_data"]["id"] if one else "" for name, one in kept.items()}


def grades(kept, assignment):
    """(Grades, names of results that cannot stand beside them: those of another text of the assignment, and damaged ones)."""
    found, others = [], []
    for name, one in kept.items():
        data = one and one["extra_data"]
        if not data or data["assignment_digest"] != assignment.digest:
            others.append(name)
            continue
        submission = submissions.Submission(name, data["id"], None)
        submission.refused = data["refused"]
        found.append(grading.Grade(assignment, submission, data["runs"], data["sandbox"]))
    return found, others
