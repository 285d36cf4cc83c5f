# SPDX-License-Identifier: MIT
"""The report of a sweep: a table of all runs, medians and quartiles per cell, plots, and a page with all of these."""
import html
import io
import os
import statistics
import textwrap

from results import put, table

kDigest = "digest "  # prefix of the names of inputs that are digests
kHead = ("<!doctype html><meta charset='utf-8'><title>Sweep</title><style>body{font:15px sans-serif;margin:2em;max-width:60em}"
         "td,th{padding:.2em .8em;text-align:right}th{border-bottom:1px solid}td:first-child,th:first-child{text-align:left}</style>")


def cell_of(result):
    """The identity of a run's cell: all given inputs but the seed, by name."""
    inputs = {name: result[name] for name in ("scenario", "controller", "client", "duration_s", "time_limit_s", "memory_limit_mib", "version")}
    inputs.update(result["set"])
    inputs.update((kDigest + name, value) for name, value in result["digests"].items())
    return tuple(sorted((name, value) for name, value in inputs.items() if value is not None))


def labels_of(cells):
    """A label for each cell: the inputs that differ between cells; digests only where all other inputs are equal."""
    def differing(some):
        names = sorted({name for cell in some for name, _ in cell})
        return [name for name in names if len({dict(cell).get(name) for cell in some}) > 1]

    def words(cell, names):
        inputs = dict(cell)
        return [f"{name}={str(inputs[name])[:8 if name.startswith(kDigest) else None]}" if name in inputs else f"no {name}" for name in names]

    plain = [name for name in differing(cells) if not name.startswith(kDigest)]
    alike = {}
    for cell in cells:
        alike.setdefault(tuple(words(cell, plain)), []).append(cell)
    return {cell: ", ".join([*told, *words(cell, differing(some))]) or "all" for told, some in alike.items() for cell in some}


def quartiles(values):
    """Lower quartile, median and upper quartile, by linear interpolation."""
    if len(values) == 1:
        return values[0], values[0], values[0]
    return tuple(statistics.quantiles(values, n=4, method="inclusive"))


def order(text):
    """A sort key: numbers by value, before words."""
    try:
        return (0, float(text), "")
    except ValueError:
        return (1, 0.0, str(text))


def numbers_of(result):
    """Scores and logged numbers by name; a logged number with the name of a score becomes "logged NAME"."""
    scores = dict(result["scores"])
    for name, value in result.get("logged", {}).items():
        scores[f"logged {name}" if name in scores else name] = value
    return scores


def ended_at_limit(result):
    """Whether the run might have continued, so that its time does not measure anything."""
    return result["ended"] in ("duration", "limit", "score") and not any(result["met"].values())  # older versions wrote score for a limit


def measures_of(result):
    """{name: (unit, value)} of a run: its scores, the times when those with an `until` were met, logged numbers, and its time;
    a missing value is None."""
    measures = {}
    for name, value in numbers_of(result).items():
        unit = result["units"].get(name, "")
        measures[name] = (unit, None if unit == "s" and ended_at_limit(result) else value)
    for name, when_s in result["met_s"].items():
        measures[f"{name} met"] = ("s", when_s)
    measures["time_s"] = ("s", None if ended_at_limit(result) else result["time_s"])
    return measures


def summarise(results):
    """A row for each cell and measure; sorted. `runs` counts all runs of the cell, `failed` those with errors, `n` those with a value."""
    cells = {}
    for result in results:
        cells.setdefault(cell_of(result), []).append(result)
    labels = labels_of(list(cells))
    rows = []
    for cell in sorted(cells, key=lambda one: [(name, order(value)) for name, value in one]):
        good = [one for one in cells[cell] if not one["error"]]
        every = [measures_of(one) for one in good]
        for name in sorted({name for measures in every for name in measures} or {"time_s"}):
            found = [measures[name] for measures in every if name in measures]
            values = [value for _, value in found if value is not None]
            met = [one["met"][name] for one in good if one["met"].get(name) is not None]
            low, middle, high = quartiles(values) if values else (None, None, None)
            rows.append({"cell": dict(cell), "label": labels[cell], "score": name, "unit": max((unit for unit, _ in found), default=""),
                         "runs": len(cells[cell]), "failed": len(cells[cell]) - len(good), "n": len(values), "met": sum(met) if met else None,
                         "success_rate": sum(met) / len(met) if met else None, "lower_quartile": low, "median": middle, "upper_quartile": high,
                         "values": values})
    timed = any(row["n"] for row in rows if row["score"] == "time_s")
    return [row for row in rows if timed or row["score"] != "time_s" or row["runs"] == row["failed"]]


kColumns = ("score", "unit", "runs", "failed", "n", "met", "success_rate", "lower_quartile", "median", "upper_quartile")


def input_names(cells):
    """The names of all inputs; digests last."""
    return sorted({name for cell in cells for name, _ in cell}, key=lambda name: (name.startswith(kDigest), name != "scenario", name))


def write_csv(folder, results, rows):
    cells = {id(one): cell_of(one) for one in results}
    names = input_names(cells.values())
    scores = sorted({name for one in results for name in numbers_of(one)})
    goals = sorted({name for one in results for name in one["met"]})
    table_of_runs = [["key", *names, "seed", "ended", "steps", "time_s", "hash", *scores,
                      *(f"{name} {what}" for name in goals for what in ("met", "met_s")), "error", "command"]]
    for one in sorted(results, key=lambda one: ([(name, order(value)) for name, value in cells[id(one)]], one["seed"])):
        inputs, numbers = dict(cells[id(one)]), numbers_of(one)
        table_of_runs.append([one["key"], *(inputs.get(name, "") for name in names), one["seed"], one["ended"], one["steps"], one["time_s"], one["hash"],
                              *(numbers.get(name, "") for name in scores), *(one[what].get(name, "") for name in goals for what in ("met", "met_s")),
                              one["error"] or "", one["command"]])
    put(os.path.join(folder, "runs.csv"), table(table_of_runs))
    table_of_cells = [[*(row["cell"].get(name, "") for name in names), *(row[name] for name in kColumns)] for row in rows]
    put(os.path.join(folder, "cells.csv"), table([[*names, *kColumns], *table_of_cells]))


def with_unit(row):
    return row["score"] + (f" [{row['unit']}]" if row["unit"] else "")


def count_text(row):
    """"n = 15, 1 failed, met 14 of 15"."""
    text = f"n = {row['n']}" + (f", {row['failed']} failed" if row["failed"] else "")
    return text if row["met"] is None else text + f", met {row['met']} of {row['runs'] - row['failed']}"


def plot(rows, score):
    """An SVG of a score in each cell: each run, median and quartiles."""
    import matplotlib
    matplotlib.use("svg")
    from matplotlib import pyplot
    pyplot.rcParams["svg.hashsalt"] = "coopdyn"  # equal results give equal files
    shown = [row for row in rows if row["score"] == score and row["n"]]
    figure, axes = pyplot.subplots(figsize=(7, 0.9 + 0.5 * len(shown)))
    places = range(len(shown))
    for place, row in zip(places, shown):
        axes.plot(row["values"], [place + 0.25] * row["n"], ".", color="0.6", markersize=4)
    middles = [row["median"] for row in shown]
    errors = [[row["median"] - row["lower_quartile"] for row in shown], [row["upper_quartile"] - row["median"] for row in shown]]
    axes.errorbar(middles, places, xerr=errors, fmt="o", capsize=4)
    axes.set_yticks(list(places), [f"{textwrap.fill(row['label'], 60)}\n{count_text(row)}" for row in shown])
    axes.invert_yaxis()
    axes.set_xlabel(f"{with_unit(shown[0])}: each run, median and quartiles")
    picture = io.StringIO()
    figure.savefig(picture, format="svg", bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)
    return picture.getvalue()


def html_table(head, rows):
    cells = lambda tag, row: "".join(f"<{tag}>{html.escape(str(one))}" for one in row)
    return f"<table><tr>{cells('th', head)}</tr>" + "".join(f"<tr>{cells('td', row)}</tr>" for row in rows) + "</table>"


def number(value):
    return "" if value is None else f"{value:.6g}"


def write(folder, results, older):
    """Writes the report and returns a message about it. `older`: lines without all inputs of their runs; named, not counted."""
    rows = summarise(results)
    write_csv(folder, results, rows)
    try:
        import matplotlib
        plots = bool(matplotlib)
    except ImportError:
        plots = False
    cells = {cell_of(one) for one in results}
    common = [(name, value) for name, value in dict.fromkeys(pair for cell in cells for pair in cell) if all((name, value) in cell for cell in cells)]
    page = [kHead, f"<h1>Sweep of {html.escape(', '.join(sorted({one['scenario'] for one in results})))}</h1><p>{len(results)} runs in {len(cells)} "
            f"cells, {sum(bool(one['error']) for one in results)} failed. Tables: runs.csv, cells.csv.</p>"]
    if older:
        keys = ", ".join(one["key"] for one in older[:20]) + (f" and {len(older) - 20} more" if len(older) > 20 else "")
        page.append(f"<p>Not in these figures, because an older coopdyn wrote them without all inputs of their runs: {html.escape(keys)}.</p>")
    for score in sorted({row["score"] for row in rows}):
        own = [row for row in rows if row["score"] == score]
        page.append(f"<h2>{html.escape(with_unit(max(own, key=lambda row: row['unit'])))}</h2>")
        if plots and any(row["n"] for row in own):
            picture = plot(rows, score)
            put(os.path.join(folder, "".join(c if c.isalnum() or c in "-_" else "_" for c in score) + ".svg"), picture)
            page.append(picture[picture.index("<svg"):])
        goals = any(row["met"] is not None for row in own)
        head = ["cell", "runs", "failed", "n", *(["met", "success rate"] if goals else []), "lower quartile", "median", "upper quartile"]
        page.append(html_table(head, ([row["label"], row["runs"], row["failed"], row["n"],
                                       *([row["met"], "" if row["met"] is None else f"{100 * row['success_rate']:.0f} %"] if goals else []),
                                       *(number(row[name]) for name in ("lower_quartile", "median", "upper_quartile"))] for row in own)))
    failed = [one for one in results if one["error"]]
    if failed:
        labels = labels_of(sorted(cells))
        page += ["<h2>Errors</h2>", html_table(["run", "seed", "key", "error"],
                                                ([labels[cell_of(one)], one["seed"], one["key"], one["error"]] for one in failed))]
    page += ["<h2>The same in all runs</h2>", html_table(["input", ""], sorted(common)), "<p>n: runs with a value. A success is a run whose score was "
             "met; failed runs are in no other figure than <i>failed</i>. A time counts only if the run did not end at its limit.</p>"]
    put(os.path.join(folder, "report.html"), "".join(page))
    said = f"{folder}: runs.csv, cells.csv, report.html"
    return said if plots else said + " (without plots: apt-get install python3-matplotlib brings them)"
