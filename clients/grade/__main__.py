# SPDX-License-Identifier: MIT
"""coopdyn grade: grades submissions of students by a scenario's scores. Started by the program coopdyn."""
import concurrent.futures
import contextlib
import os
import shutil
import sys
import tempfile

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "sweep"))

import appeal  # noqa: E402
import assignment as assignments  # noqa: E402
import class_folder  # noqa: E402
import film  # noqa: E402
import formats  # noqa: E402
import grading  # noqa: E402
import kept  # noqa: E402
import page  # noqa: E402
import submissions  # noqa: E402
from common import Parser, catch_signals  # noqa: E402
from plan import Wrong  # noqa: E402
from results import Results, put  # noqa: E402

kHere = os.path.dirname(os.path.abspath(__file__))


def read_options(words):
    options = Parser(
        prog="coopdyn grade", allow_abbrev=False,
        description="Grade submissions: each drives the assignment's scenario in a sandbox, once for each seed. The scenario's scores earn points.",
        epilog="Example: coopdyn grade --example maze    then: coopdyn grade maze/maze.assignment maze/reference maze/weak --out results. "
               "Exit codes: 0 all is graded; 1 mistakes in files, runs that could not be graded, an appeal that differs; 2 wrong use")
    add = options.add_argument
    add("assignment", nargs="?", help="its file")
    add("submission", nargs="*", help="a folder, a .zip, a .tar or .tar.gz")
    add("--submissions", action="append", default=[], metavar="FOLDER", help="grade each entry of this folder, as exported by Moodle and Gradescope; may be repeated")
    add("--class", dest="class_", metavar="FOLDER", help="grade what each seat of a class (coopdyn host) handed in last, and write the result beside it, for the student's page")
    add("--out", default="results", help="folder of the results (default: results)")
    add("--key", metavar="FILE", help="of the hidden seeds (default: beside the assignment, with the ending .key)")
    add("--jobs", type=int, default=os.cpu_count(), help="runs at the same time (default: as many as cores)")
    add("--again", action="store_true", help="run again what has a result")
    add("--format", choices=("csv", "gradescope", "autolab", "moodle"), default="csv",
        help="for another system: gradescope (OUT/results.json), autolab (the last line that is printed), moodle (OUT/moodle.csv). OUT/grades.csv is written in each case")
    add("--worksheet", metavar="FILE.csv", help="with --format moodle: the worksheet from Moodle, to be filled in")
    add("--show-hidden", action="store_true", help="write hidden seeds into results.json")
    add("--no-film", action="store_true", help="pages without a film")
    add("--no-sandbox", action="store_true", help="run submissions with your rights. Only your own, or in a container that holds nothing else")
    add("--try", dest="try_out", metavar="FOLDER", help="run the visible seeds of your own program, and print what they earn")
    add("--new-key", metavar="FILE", help="make a key for hidden seeds")
    add("--example", metavar="FOLDER", help="write an assignment with a reference solution")
    add("--appeal", metavar="OUT/NAME", help="repeat the runs of a submission from their recordings, and its program")
    add("--forget", metavar="OUT/NAME", help="delete all that is stored of a submission")
    add("--assignment", dest="moved", metavar="FILE", help="with --appeal: where the assignment is now")
    given = options.parse_args(words)
    chosen = [name for name in ("try_out", "new_key", "example", "appeal", "forget") if getattr(given, name)]
    if len(chosen) > 1:
        options.error("--try, --new-key, --example, --appeal and --forget exclude each other: write one of them")
    if given.jobs < 1:
        options.error("--jobs takes a whole number from 1")
    if not chosen or chosen == ["try_out"]:
        if not given.assignment:
            options.error("name an assignment: coopdyn grade maze.assignment SUBMISSION… ; --example FOLDER writes one")
        if not chosen and not given.submission and not given.submissions and not given.class_:
            options.error("name submissions: folders, .zip or .tar files, --submissions FOLDER, or --class FOLDER")
    elif given.assignment:
        options.error(f"--{chosen[0].replace('_', '-')} takes no assignment before it")
    if given.worksheet and given.format != "moodle":
        options.error("--worksheet goes with --format moodle")
    return given


def write_example(folder):
    if os.path.lexists(folder):
        raise Wrong(f"{folder} is there already: name a new folder")
    try:
        shutil.copytree(os.path.join(kHere, "example"), folder, ignore=shutil.ignore_patterns("__pycache__"))
    except OSError as error:
        raise Wrong(f"{folder} cannot be written: {error}") from None
    assignments.new_key(os.path.join(folder, "maze.key"))
    print(f"{folder}: an assignment, a reference solution, a weak one. Next:\n  coopdyn grade {folder}/maze.assignment {folder}/reference {folder}/weak --out results")
    return 0


def key_for(assignment, given):
    """The teacher's key; None without hidden seeds."""
    beside = os.path.splitext(assignment.path)[0] + ".key"
    if given.key or os.path.isfile(beside):
        return assignments.read_key(given.key or beside)
    if assignment.values["hidden_seeds"]:
        raise Wrong(f"{assignment.path} has hidden seeds, which need a key: coopdyn grade --new-key {beside} makes one, --key FILE names another file")
    return None


@contextlib.contextmanager
def staged(given, root, every, needed):
    """A Stage with copies of the submissions that the sandbox can read."""
    stage = grading.Stage(root, not given.no_sandbox)
    try:
        grading.warn_of_no_sandbox(stage)
        stage.take(every, needed)
        yield stage
    finally:
        stage.close()


def grade(given, program, folders):
    assignment = assignments.read(given.assignment, folders, grading.scores_of(program))
    key = key_for(assignment, given)
    before = kept.results(given.out)
    entries = submissions.candidates(given.submission, given.submissions) + (class_folder.candidates(given.class_, assignment) if given.class_ else [])
    every = submissions.named(entries, kept.ids(before))
    if given.format == "autolab" and len(every) > 1:
        raise Wrong("--format autolab takes one submission: Autolab grades each alone")
    with staged(given, folders[-1], every, assignment.values["files"]) as stage:
        session = grading.Grading(assignment, every, key, program, given.out, stage)
        runs = session.run(given.jobs, given.again)
        grades = [grading.Grade(assignment, one, runs.get(one.name, []), stage.sandbox.who != "none") for one in every]
        texts, others = write(session, grades, given)
    for one in grades:
        print(f"{one.name}: {page.points_text(one.points)} of {page.points_text(assignment.most)} points" + (f". {one.sentence}" if one.sentence else ""))
    troubles = [trouble for one in grades for trouble in one.troubles]
    for one in troubles[:3]:
        print(f"{one['label']}: {one['trouble']}", file=sys.stderr)
    if troubles:
        print(f"{len(troubles)} runs could not be graded. The same command tries them again.", file=sys.stderr)
    if others:
        print(page.left_out(others), file=sys.stderr)
    print(f"{given.out}: index.html, grades.csv{texts}, and a folder for each submission")
    if given.class_:
        print(f"{given.class_}: result.txt beside {grading.counted(class_folder.write_results(grades), 'hand-in')}, which the students' pages show")
    if given.format == "autolab":
        print(formats.autolab(grades[0]))
    return 1 if troubles else 0


def write(session, grades, given):
    """Writes all files of the results. The tables have what was graded into OUT before, too. Returns the names of the optional files, and of the
    submissions that the tables do not have."""
    def one(grade_):
        text = formats.as_text(formats.gradescope(session, grade_, given.show_hidden))
        grading.store(session, grade_, text)
        worst = None if given.no_film else grade_.worst()
        pictures = worst and film.of_run(session.program, os.path.join(session.out, worst["recording"]), worst["time_s"])
        page.write_one(session, grade_, pictures)
        return text

    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        texts = list(pool.map(one, grades))
    grading.remember(session)
    results = kept.results(session.out)
    every, others = kept.grades(results, session.assignment)
    page.write_class(session, every, others)
    formats.grades_csv(session, every)
    one_alone = len(grades) == 1 and (len(every) == 1 or given.format == "gradescope")
    put(os.path.join(session.out, "results.json"), texts[0] if one_alone else formats.as_text({"submissions": [results[one.name] for one in every]}))
    also = ", results.json"
    if given.format == "moodle":
        also += ", " + os.path.basename(formats.moodle_csv(session, every, given.worksheet))
    return also, others


def try_out(given, program, folders):
    """Grades a student's own folder on the visible seeds, and prints what went wrong."""
    assignment = assignments.read(given.assignment, folders, grading.scores_of(program))
    every = submissions.find([given.try_out], [])
    with staged(given, folders[-1], every, assignment.values["files"]) as stage, tempfile.TemporaryDirectory(prefix="coopdyn-try-") as out:
        if every[0].refused:
            raise Wrong(every[0].refused)
        session = grading.Grading(assignment, every, None, program, out, stage)
        own = grading.Grade(assignment, every[0], session.run(given.jobs, quiet=True)[every[0].name], stage.sandbox.who != "none")
    head, rows = page.run_rows(own)
    shown = [head, *([str(cell) for cell in row] for row in rows)]
    kept = [k for k, name in enumerate(head) if name != "hash"]
    widths = [max(len(row[k]) for row in shown) for k in kept]
    for row in shown:
        print("  ".join(row[k].ljust(width) for k, width in zip(kept, widths)).rstrip())
    for one in own.improvements():
        print("- " + page.improvement(own, *one))
    failed = next((one for one in own.runs if one["void"] and one["output"]), None)
    if failed:
        print(f"\nWhat it printed, {failed['label']}:\n{failed['output'][-page.kOutput:].rstrip()}")
    hidden = assignment.values["hidden_seeds"]
    print(f"\n{page.points_text(own.points)} of {page.points_text(assignment.most)} points on the visible seeds" + (f"; {hidden} hidden ones count, too" if hidden else ""))
    return 1 if own.troubles else 0


def forget(path):
    """Deletes all stored data of a submission: its folders, its runs, its lines."""
    out, name = os.path.split(os.path.abspath(path))
    if not os.path.isfile(os.path.join(out, "grading.json")) or not os.path.isfile(os.path.join(path, "results.json")) or os.path.islink(path):
        raise Wrong(f"--forget {path}: this is no submission of a grading: name OUT/NAME")
    _, result = appeal.found(path)
    keys = {one["key"] for one in result["extra_data"]["runs"]}
    results = Results(out, "grading")
    try:
        results.forget(lambda one: one["key"] in keys)
    finally:
        results.close()
    for folder in (path, os.path.join(out, "hidden", name)):
        shutil.rmtree(folder, ignore_errors=True)
    for file in ("index.html", "grades.csv", "moodle.csv", "results.json"):
        with contextlib.suppress(FileNotFoundError):
            os.remove(os.path.join(out, file))
    print(f"All of {name} is deleted, and the tables of the class, which named it. The next coopdyn grade writes these anew, without running what is there.")
    return 0


def main():
    """Returns the exit code. That of a process whose output nobody reads (`| head`) is the one of SIGPIPE."""
    try:
        code = carry_out()
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else Python reports it again at its end
        return 141


def carry_out():
    program, root, *words = sys.argv[1:]
    folders = [os.path.dirname(program), root]
    given = read_options(words)
    try:
        if given.new_key:
            assignments.new_key(given.new_key)
            print(f"{given.new_key}: keep it from your students, and keep a copy: with another key the hidden seeds are others")
            return 0
        if given.example:
            return write_example(given.example)
        if given.appeal:
            return appeal.appeal(given, program, folders)
        if given.forget:
            return forget(given.forget)
        return try_out(given, program, folders) if given.try_out else grade(given, program, folders)
    except Wrong as wrong:
        print(wrong if ": error: " in str(wrong) else f"coopdyn grade: {wrong}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nThe grading stopped. The same command does what is missing.", file=sys.stderr)
        return 130


if __name__ == "__main__":
    catch_signals()
    sys.exit(main())
