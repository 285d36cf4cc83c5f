# SPDX-License-Identifier: MIT
"""The report of a sweep: a table of all runs, medians and quartiles per cell, plots, and one page that shows them."""
import csv
import html
import io
import os
import statistics


def cell_of(result):
    """What makes a cell: all inputs but the seed."""
    inputs = dict(result["set"])
    if result["controller"]:
        inputs["controller"] = result["controller"]
    return tuple(sorted(inputs.items()))


def quartiles(values):
    """Lower quartile, median and upper quartile, by linear interpolation."""
    if len(values) == 1:
        return values[0], values[0], values[0]
    return tuple(statistics.quantiles(values, n=4, method="inclusive"))


def order(text):
    """Numbers by value, before words."""
    try:
        return (0, float(text), "")
    except ValueError:
        return (1, 0.0, str(text))


def numbers_of(result):
    """Scores, and what was logged, by name; a logged number with the name of a score is called "logged NAME"."""
    scores = dict(result["scores"])
    for name, value in result.get("logged", {}).items():
        scores[f"logged {name}" if name in scores else name] = value
    return scores


def summarise(results):
    """Rows of cell, score, count, failed, lower quartile, median, upper quartile; sorted."""
    cells = {}
    for result in results:
        cells.setdefault(cell_of(result), []).append(result)
    rows = []
    for cell in sorted(cells, key=lambda one: [(name, order(value)) for name, value in one]):
        runs = cells[cell]
        names = sorted({name for one in runs for name in numbers_of(one)} | {"time_s"})
        for name in names:
            values = [one["time_s"] if name == "time_s" else numbers_of(one).get(name) for one in runs if not one["error"]]
            values = [value for value in values if value is not None]
            low, middle, high = quartiles(values) if values else (None, None, None)
            rows.append({"cell": dict(cell), "score": name, "runs": len(values), "failed": sum(bool(one["error"]) for one in runs),
                         "lower_quartile": low, "median": middle, "upper_quartile": high})
    return rows


def write_csv(folder, results, rows):
    names = sorted({name for one in results for name in one["set"]})
    scores = sorted({name for one in results for name in numbers_of(one)})
    with open(os.path.join(folder, "runs.csv"), "w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream)
        table.writerow(["key", "scenario", *names, "controller", "seed", "ended", "steps", "time_s", "hash", *scores, "error"])
        for one in sorted(results, key=lambda one: (cell_of(one), one["seed"])):
            table.writerow([one["key"], one["scenario"], *(one["set"].get(name, "") for name in names), one["controller"] or "", one["seed"],
                            one["ended"], one["steps"], one["time_s"], one["hash"], *(numbers_of(one).get(name, "") for name in scores), one["error"] or ""])
    keys = sorted({name for row in rows for name in row["cell"]})
    with open(os.path.join(folder, "cells.csv"), "w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream)
        table.writerow([*keys, "score", "runs", "failed", "lower_quartile", "median", "upper_quartile"])
        for row in rows:
            table.writerow([*(row["cell"].get(key, "") for key in keys), row["score"], row["runs"], row["failed"],
                            row["lower_quartile"], row["median"], row["upper_quartile"]])


def label_of(cell):
    return ", ".join(f"{name}={value}" for name, value in sorted(cell.items())) or "all"


def plot(rows, score, file):
    """Median and quartiles of a score in each cell."""
    import matplotlib
    matplotlib.use("svg")
    from matplotlib import pyplot
    pyplot.rcParams["svg.hashsalt"] = "coopdyn"  # equal results give equal files
    shown = [row for row in rows if row["score"] == score and row["runs"]]
    figure, axes = pyplot.subplots(figsize=(7, 0.9 + 0.35 * len(shown)))
    places = range(len(shown))
    middles = [row["median"] for row in shown]
    errors = [[row["median"] - row["lower_quartile"] for row in shown], [row["upper_quartile"] - row["median"] for row in shown]]
    axes.errorbar(middles, places, xerr=errors, fmt="o", capsize=4)
    axes.set_yticks(list(places), [label_of(row["cell"]) for row in shown])
    axes.invert_yaxis()
    axes.set_xlabel(f"{score}: median and quartiles")
    figure.savefig(file, format="svg", bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)


def write(folder, results):
    """Writes runs.csv, cells.csv, an SVG a score and report.html; returns what to tell the user."""
    rows = summarise(results)
    write_csv(folder, results, rows)
    try:
        import matplotlib  # noqa: F401
        plots = True
    except ImportError:
        plots = False
    page = io.StringIO()
    page.write("<!doctype html><meta charset='utf-8'><title>Sweep</title><style>body{font:15px sans-serif;margin:2em;max-width:60em}"
               "td,th{padding:.2em .8em;text-align:right}th{border-bottom:1px solid}td:first-child,th:first-child{text-align:left}</style>")
    page.write(f"<h1>Sweep of {html.escape(', '.join(sorted({one['scenario'] for one in results})))}</h1><p>{len(results)} runs, "
               f"{sum(bool(one['error']) for one in results)} with errors. Tables: runs.csv, cells.csv.</p>")
    for score in sorted({row["score"] for row in rows}):
        page.write(f"<h2>{html.escape(score)}</h2>")
        if plots and any(row["runs"] for row in rows if row["score"] == score):
            file = os.path.join(folder, "".join(c if c.isalnum() or c in "-_" else "_" for c in score) + ".svg")
            plot(rows, score, file)
            with open(file, encoding="utf-8") as stream:
                svg = stream.read()
            page.write(svg[svg.index("<svg"):])
        page.write("<table><tr><th>cell<th>runs<th>failed<th>lower quartile<th>median<th>upper quartile</tr>")
        for row in rows:
            if row["score"] == score:
                numbers = ["" if row[name] is None else f"{row[name]:.6g}" for name in ("lower_quartile", "median", "upper_quartile")]
                page.write(f"<tr><td>{html.escape(label_of(row['cell']))}<td>{row['runs']}<td>{row['failed']}" + "".join(f"<td>{n}" for n in numbers) + "</tr>")
        page.write("</table>")
    failed = [one for one in results if one["error"]]
    if failed:
        page.write("<h2>Errors</h2><table><tr><th>run<th>seed<th>error</tr>")
        for one in failed:
            page.write(f"<tr><td>{html.escape(label_of(dict(cell_of(one))))}<td>{one['seed']}<td>{html.escape(one['error'])}</tr>")
        page.write("</table>")
    with open(os.path.join(folder, "report.html"), "w", encoding="utf-8") as stream:
        stream.write(page.getvalue())
    said = f"{folder}: runs.csv, cells.csv, report.html"
    return said if plots else said + " (without plots: apt-get install python3-matplotlib brings them)"
