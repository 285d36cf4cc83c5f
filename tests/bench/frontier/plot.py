#!/usr/bin/env python3
"""Draws FOLDER/frontier.svg, and writes the table of FOLDER/benchmarks.md, from the JSON lines of `frontier`.
Usage: plot.py FIGURES FOLDER"""
import json
import math
import pathlib
import re
import sys

COLUMNS, WIDTH, HEIGHT, TOP = 4, 230, 190, 62
NOISE = 0.95  # ratio of CPU times or errors above which they count as equal
STYLES = {"coopdyn": ("#d62728", "", 2.5), "Euler": ("#1f77b4", "", 1.3), "implicitfast": ("#17a2b8", "", 1.3),
          "implicit": ("#1f77b4", "5,2", 1.3), "RK4": ("#1f77b4", "1,2", 1.3), "Bullet": ("#2ca02c", "", 1.3),
          "DART": ("#e08a00", "", 1.3)}


def style(engine):
    return next(look for word, look in STYLES.items() if word in engine)


def error(figure):
    """The error of a figure; infinite for one that exploded, which has none in the file."""
    value = figure["error"]
    return math.inf if value is None else max(value, figure["floor"])


def beats(a, b):
    no_worse = error(a) <= error(b) and a["ms_per_s"] <= b["ms_per_s"]
    return no_worse and (error(a) < NOISE * error(b) or a["ms_per_s"] < NOISE * b["ms_per_s"])


def on_front(figures, same_step=False):
    """The number of coopdyn's steps that no other engine beats, with any step or with the same."""
    others = [f for f in figures if f["engine"] != "coopdyn"]
    ours = [f for f in figures if f["engine"] == "coopdyn" and f["error"] is not None]
    return sum(not any(beats(other, f) for other in others if not same_step or other["step_ms"] == f["step_ms"]) for f in ours)


def ticks(low, high):
    decades = range(math.ceil(low), math.floor(high) + 1)
    return decades if len(decades) <= 5 else range(decades[0], decades[-1] + 1, math.ceil(len(decades) / 5))


def tick_text(decade):
    return f"{10 ** decade:g}" if -3 <= decade <= 3 else f"1e{decade}"


def panel(figures, engines):
    """One case: error up, CPU to the right; a line per engine, a dot per step, large ones for 10 ms."""
    left, right, top, bottom = 38, WIDTH - 10, 34, HEIGHT - 26
    xs = [math.log10(f["ms_per_s"]) for f in figures]
    finite = [math.log10(min(error(f), 1e6)) for f in figures if f["error"] is not None]
    x0, x1 = min(xs) - 0.15, max(xs) + 0.15
    y0, y1 = min(finite) - 0.2, max(max(finite), min(finite) + 1) + 0.4

    def place(f):
        x = left + (math.log10(f["ms_per_s"]) - x0) / (x1 - x0) * (right - left)
        y = top + 2 if f["error"] is None else bottom - (math.log10(min(error(f), 1e6)) - y0) / (y1 - y0) * (bottom - top)
        return x, y

    out = [f'<text x="{left}" y="14" class="t">{figures[0]["title"]}</text>',
           f'<text x="{left}" y="27" class="u">{figures[0]["unit"]}</text>',
           f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" class="f"/>']
    for d in ticks(y0, y1):
        y = bottom - (d - y0) / (y1 - y0) * (bottom - top)
        out.append(f'<path d="M{left} {y:.1f}H{right}" class="g"/><text x="{left - 3}" y="{y + 3:.1f}" class="y">{tick_text(d)}</text>')
    for d in ticks(x0, x1):
        x = left + (d - x0) / (x1 - x0) * (right - left)
        out.append(f'<path d="M{x:.1f} {top}V{bottom}" class="g"/><text x="{x:.1f}" y="{bottom + 11}" class="x">{tick_text(d)}</text>')
    for engine in reversed(engines):  # coopdyn on top
        points = sorted((f for f in figures if f["engine"] == engine), key=lambda f: f["step_ms"])
        color, dash, width = style(engine)
        line = " ".join("{:.1f},{:.1f}".format(*place(f)) for f in points)
        out.append(f'<polyline points="{line}" stroke="{color}" stroke-width="{width}" stroke-dasharray="{dash}"/>')
        for f in points:
            x, y = place(f)
            fill = "#fff" if f["error"] is None else color
            out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{3.2 if f["step_ms"] == 10 else 1.8}" fill="{fill}" stroke="{color}"/>')
    return "".join(out)


def svg(cases, engines):
    rows = math.ceil(len(cases) / COLUMNS)
    width, height = COLUMNS * WIDTH, TOP + rows * HEIGHT
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" fill="none">',
           "<style>.t{font-size:10px;font-weight:bold;fill:#222}.u,.l{font-size:10px;fill:#444}.x,.y{font-size:8px;fill:#666}"
           ".x{text-anchor:middle}.y{text-anchor:end}.f{stroke:#999}.g{stroke:#eee}</style>",
           f'<rect width="{width}" height="{height}" fill="#fff"/>',
           '<text x="38" y="18" class="l">Up: error. Right: CPU time, ms per simulated second. Dots: steps of 1, 2, 5 and 10 (large) ms. '
           'Lower left is better. A hollow dot: exploded.</text>']
    for i, engine in enumerate(engines):
        color, dash, line = style(engine)
        x = 38 + i * (width - 60) / len(engines)
        out.append(f'<path d="M{x:.0f} 38h22" stroke="{color}" stroke-width="{line}" stroke-dasharray="{dash}"/>'
                   f'<text x="{x + 26:.0f}" y="42" class="l">{engine}</text>')
    for i, figures in enumerate(cases.values()):
        out.append(f'<g transform="translate({i % COLUMNS * WIDTH} {TOP + i // COLUMNS * HEIGHT})">{panel(figures, engines)}</g>')
    return "\n".join(out + ["</svg>", ""])


def short(figure):
    if figure is None or figure["error"] is None:
        return "✗"
    if figure["error"] < figure["floor"]:
        return "0"
    return f'{figure["error"]:.2g}' if 0.01 <= figure["error"] < 100 else f'{figure["error"]:.0f}' if figure["error"] < 1e4 else "✗"


def table(cases, engines):
    lines = ["| case, error | " + " | ".join(engines) + " | steps on the front |", "|---" * (len(engines) + 2) + "|"]
    for figures in cases.values():
        at = {(f["engine"], f["step_ms"]): f for f in figures}
        cells = [f'{figures[0]["title"]}: {figures[0]["unit"]}']
        for engine in engines:
            cell = f"{short(at.get((engine, 1)))} / {short(at.get((engine, 10)))}"
            if engine != "coopdyn" and (engine, 10) in at:
                cell += f' · {at[engine, 10]["ms_per_s"] / at["coopdyn", 10]["ms_per_s"]:.2g}×'
            cells.append(cell)
        lines.append("| " + " | ".join([*cells, f"{on_front(figures)} of 4"]) + " |")
    counts = [on_front(figures) for figures in cases.values()]
    equal = [on_front(figures, same_step=True) for figures in cases.values()]
    lines += ["", f"coopdyn is on the Pareto front in {sum(n > 0 for n in counts)} of {len(counts)} cases: there is a step of it that no "
              "other engine, whatever its step, beats both in error and in CPU time. In "
              f"{sum(n == 4 for n in counts)} of them this is so for each of its four steps. At equal steps no engine beats it in "
              f"{sum(n == 4 for n in equal)} cases."]
    return "\n".join(lines)


def main():
    cases = {}
    for line in pathlib.Path(sys.argv[1]).read_text().splitlines():
        if line.startswith("{"):  # DART prints other lines, too
            figure = json.loads(line)
            cases.setdefault(figure["case"], []).append(figure)
    engines = list(dict.fromkeys(f["engine"] for figures in cases.values() for f in figures))
    folder = pathlib.Path(sys.argv[2])
    (folder / "frontier.svg").write_text(svg(cases, engines))
    page = folder / "benchmarks.md"
    made = f"<!-- made by tests/bench/frontier/run -->\n{table(cases, engines)}\n<!-- end -->"
    page.write_text(re.sub(r"<!-- made by tests/bench/frontier/run -->.*?<!-- end -->", lambda _: made, page.read_text(), flags=re.S))


main()
