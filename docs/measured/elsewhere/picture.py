"""Draws docs/pictures/other-tools.png, made of results.csv, with matplotlib: python3 picture.py OUT.png"""

import statistics
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from tables import runs

CURVES = [
    ("isosheet", "elastic, limit 0.01", "isosheet, elastic, limit 0.01", "#0b5394", "o", "-"),
    ("isosheet", "elastic", "isosheet, elastic, limit 0.05", "#3d85c6", "^", "-"),
    ("isosheet", "rods", "isosheet, rods", "#6fa8dc", "s", "-"),
    ("STARK", None, "STARK, best setting", "#b45f06", "D", "-"),
    ("MuJoCo flex", "", "MuJoCo flex", "#38761d", "v", "--"),
    ("MuJoCo flex", "penalties", "MuJoCo flex", "#38761d", "v", "--"),
    ("MuJoCo flex", "flag ipc", "MuJoCo flex, flag ipc", "#741b47", "P", "--"),
    ("PositionBasedDynamics", "XPBD", "PositionBasedDynamics, XPBD", "#999999", "X", "--"),
]
PANELS = [
    ("hanging", "289", "Hanging sheet, 289 vertices", "0.3"),
    ("hanging", "1089", "Hanging sheet, 1089 vertices", "0.3"),
    ("tablecloth", "289", "Tablecloth, 289 vertices", "0.5"),
    ("tablecloth", "1089", "Tablecloth, 1089 vertices", "0.5"),
]


def points(kinds, scene, size, program, setting):
    """Step -> (CPU seconds, error, whether states intersect), at the fastest setting if none is named."""
    best = {}
    for (own_scene, own_program, own_setting, step, own_size), rows in kinds.items():
        if (own_scene, own_program, own_size) != (scene, program, size) or not rows[0]["error_mm"]:
            continue
        if setting is not None and own_setting != setting:
            continue
        if float(rows[0]["time_s"]) < float(rows[0]["end_s"]) - 1e-6:
            continue
        cpu = statistics.median(float(row["cpu_s"]) for row in rows)
        cut = bool(rows[0]["intersecting"]) and int(rows[0]["intersecting"]) > 0
        if step not in best or cpu < best[step][0]:
            best[step] = (cpu, float(rows[0]["error_mm"]), cut)
    return [best[step] for step in sorted(best, key=lambda step: int(step[2:]))]


def main():
    kinds = runs()
    plt.rcParams.update({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 2, figsize=(10.66, 8.58))
    named = {}
    for axis, (scene, size, title, end) in zip(axes.flat, PANELS):
        for program, setting, name, colour, marker, line in CURVES:
            curve = points(kinds, scene, size, program, setting)
            if not curve:
                continue
            (drawn,) = axis.plot([p[0] for p in curve], [p[1] for p in curve], line, color=colour, lw=1.5)
            for cpu, error, cut in curve:
                axis.plot(cpu, error, marker, color=colour, mfc="white" if cut else colour, ms=7, mew=1.4)
            named.setdefault(name, plt.Line2D([], [], color=colour, ls=line, marker=marker, ms=7))
        axis.set_xscale("log")
        axis.set_yscale("log")
        for numbers in (axis.xaxis, axis.yaxis):
            numbers.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
            numbers.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
            numbers.set_minor_formatter(matplotlib.ticker.NullFormatter())
        axis.grid(alpha=0.3, lw=0.6)
        axis.set_title(title, fontsize=11, loc="left")
        axis.set_xlabel(f"CPU seconds for {end} s of motion")
    axes[0, 0].set_ylabel("error of positions at 0.3 s, mm")
    axes[1, 0].set_ylabel("error of positions at 0.1 s, mm")
    figure.legend(named.values(), named.keys(), loc="lower center", ncol=4, frameon=False, fontsize=9)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(sys.argv[1], dpi=100)


main()
