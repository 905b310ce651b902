"""Prints the tables of docs/other-tools.md and docs/measured-elsewhere.md, made of results.csv.

python3 tables.py [TABLE ...], with the tables `same-error`, `whole`, `quality` and the scenes, all by default.
"""

import csv
import math
import statistics
import sys
from pathlib import Path

SCENES = {
    "hanging": "The hanging sheet, 0.3 s",
    "hanging-1s": "The hanging sheet, 1 s",
    "tablecloth": "The tablecloth, 0.5 s",
    "ball": "The sheet on a ball, 1 s",
    "strip": "The crushed strip, 1.8 s",
}
TRIANGLES = ", ball of triangles"
# Programs, the settings that belong to them (None: all of them, the fastest counts) and their step in whole scenes.
PROGRAMS = [
    ("isosheet, elastic, limit 0.01", "isosheet", ["elastic, limit 0.01"], "1/60"),
    ("isosheet, elastic, limit 0.05", "isosheet", ["elastic"], "1/60"),
    ("isosheet, rods", "isosheet", ["rods"], "1/60"),
    ("STARK, fastest setting", "STARK", None, None),
    ("MuJoCo flex", "MuJoCo flex", ["", "penalties"], "1/480"),
    ("MuJoCo flex, flag ipc", "MuJoCo flex", ["flag ipc"], "1/480"),
    ("PositionBasedDynamics, XPBD", "PositionBasedDynamics", ["XPBD"], "1/4000"),
]
SAME_ERROR = [("hanging", 3.0), ("tablecloth", 7.5)]
SIZES = ["289", "1089"]
WHOLE = [(scene, size) for scene in ("hanging-1s", "ball") for size in ("81", *SIZES)]
WHOLE += [("tablecloth", size) for size in SIZES] + [("strip", "605")]
# With longer steps MuJoCo throws the ends of the strip about.
STRIP_STEPS = {"MuJoCo flex": "1/960"}


def runs():
    """All runs, those of one kind together: (scene, program, setting, step, vertices) -> rows."""
    found = {}
    with open(Path(__file__).with_name("results.csv"), newline="") as file:
        for row in csv.DictReader(file):
            kind = tuple(row[key] for key in ("scene", "program", "setting", "step", "vertices"))
            found.setdefault(kind, []).append(row)
    return found


def cpu(rows):
    return statistics.median(float(row["cpu_s"]) for row in rows)


def complete(rows):
    return float(rows[0]["time_s"]) > float(rows[0]["end_s"]) - 1e-3


def short(number, digits=3):
    """A number with some digits, without zeros at its end."""
    text = f"{float(number):.{digits}g}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        text = f"{mantissa}e{int(exponent)}"
    return text


def inverse(step):
    return int(step.removeprefix("1/"))


def curve(kinds, scene, size, program, settings):
    """(CPU seconds, error) of complete runs at the fastest setting, from the longest step to the shortest."""
    best = {}
    for (own_scene, own_program, setting, step, own_size), rows in kinds.items():
        if (own_scene, own_program, own_size) != (scene, program, size) or not complete(rows):
            continue
        if (settings is None or setting in settings) and rows[0]["error_mm"]:
            point = (cpu(rows), float(rows[0]["error_mm"]))
            best[step] = min(best.get(step, point), point)
    return [best[step] for step in sorted(best, key=inverse)]


def for_error(points, asked):
    """CPU seconds for an error: the least of what measured runs took, and of what lies between two of them."""
    if not points:
        return ""
    if points[0][1] <= asked:
        return f"{short(points[0][0], 2)} ({short(points[0][1], 2)} mm)"
    found = [time for time, error in points if error <= asked]
    for (time, error), (next_time, next_error) in zip(points, points[1:]):
        if error > asked >= next_error:
            part = math.log(error / asked) / math.log(error / next_error)
            found.append(time * (next_time / time) ** part)
    if found:
        return short(min(found), 2)
    time, error = min(points, key=lambda point: point[1])
    return f"{short(time, 2)} for {short(error, 2)} mm"


def same_error(kinds):
    heads = [f"{scene}, {size}" for scene, _ in SAME_ERROR for size in SIZES]
    print("| program | " + " | ".join(heads) + " |")
    print("|" + "---|" * (1 + len(heads)))
    for name, program, settings, _ in PROGRAMS:
        cells = []
        for scene, asked in SAME_ERROR:
            cells += [for_error(curve(kinds, scene, size, program, settings), asked) for size in SIZES]
        if any(cells):
            print(f"| {name} | " + " | ".join(cells) + " |")
    print()


def fastest(kinds, scene, size, program, settings, step):
    """The fastest complete run of a program; without one, that which got furthest."""
    own = [
        rows
        for (own_scene, own_program, setting, own_step, own_size), rows in kinds.items()
        if (own_scene, own_program, own_size) == (scene, program, size)
        and (settings is None or setting in settings)
        and (step is None or own_step == step)
    ]
    done = [rows for rows in own if complete(rows)]
    if done:
        return min(done, key=cpu)
    return max(own, key=lambda rows: float(rows[0]["time_s"]), default=None)


def quality(kinds):
    """Of the runs of whole scenes: how lengths change, and in how many states something intersects."""
    print("| program | largest relative change of a length | states in which something intersects | depth |")
    print("|---|---|---|---|")
    for name, program, settings, step in PROGRAMS:
        own = []
        for scene, size in WHOLE:
            own_step = STRIP_STEPS.get(program, step) if scene == "strip" else step
            rows = fastest(kinds, scene, size, program, settings, own_step)
            own += rows[:1] if rows and complete(rows) else []
        lengths = [float(row["edge_error"]) for row in own]
        looked = [row for row in own if row["states"]]
        cut = sum(int(row["intersecting"]) for row in looked)
        states = sum(int(row["states"]) for row in looked)
        depth = max([float(row["depth_mm"]) for row in looked if row["depth_mm"]], default=0.0)
        said = f"{short(depth, 2)} mm in the ball" if depth > 0 else ""
        print(f"| {name} | {short(min(lengths), 1)} to {short(max(lengths), 2)} | {cut} of {states} | {said} |")
    print()


def whole(kinds):
    print("| program | " + " | ".join(f"{scene.removesuffix('-1s')}, {size}" for scene, size in WHOLE) + " |")
    print("|" + "---|" * (1 + len(WHOLE)))
    lines = []
    for name, program, settings, step in PROGRAMS:
        lines.append((name, program, settings, step))
        if program == "isosheet":
            lines.append((name + TRIANGLES, program, [setting + TRIANGLES for setting in settings], step))
    for name, program, settings, step in lines:
        cells = []
        for scene, size in WHOLE:
            own_step = STRIP_STEPS.get(program, step) if scene == "strip" else step
            rows = fastest(kinds, scene, size, program, settings, own_step)
            if rows is None:
                cells.append("")
            elif complete(rows):
                cells.append(short(cpu(rows)))
            else:
                cells.append(f"{short(cpu(rows))} for {short(rows[0]['time_s'])} s")
        print(f"| {name} | " + " | ".join(cells) + " |")
    print()


def cell(rows):
    """CPU seconds; error; error of lengths; intersecting states."""
    parts = [short(cpu(rows)) + ("" if complete(rows) else f" for {short(rows[0]['time_s'])} s")]
    if rows[0]["error_mm"]:
        parts.append(short(rows[0]["error_mm"], 2))
    parts.append(short(rows[0]["edge_error"], 2))
    if rows[0]["states"]:
        cut = f"{rows[0]['intersecting']} of {rows[0]['states']}"
        depth = rows[0]["depth_mm"]
        parts.append(cut + (f", {short(depth, 2)} mm" if depth and float(depth) > 0 else ""))
    return "; ".join(parts)


def of_scene(kinds, scene):
    here = {kind: rows for kind, rows in kinds.items() if kind[0] == scene}
    sizes = sorted({kind[4] for kind in here}, key=int)
    print(f"**{SCENES[scene]}.**\n")
    print("| program | step, s | " + " | ".join(f"{size} vertices" for size in sizes) + " |")
    print("|" + "---|" * (2 + len(sizes)))
    for program, setting, step in dict.fromkeys(kind[1:4] for kind in here):
        rows = [here.get((scene, program, setting, step, size)) for size in sizes]
        cells = [cell(own) if own else "" for own in rows]
        title = f"{program}, {setting}" if setting else program
        print(f"| {title} | {step} | " + " | ".join(cells) + " |")
    print()


def main():
    kinds = runs()
    asked = sys.argv[1:] or ["same-error", "whole", "quality", *SCENES]
    for table in asked:
        if table == "same-error":
            same_error(kinds)
        elif table == "whole":
            whole(kinds)
        elif table == "quality":
            quality(kinds)
        else:
            of_scene(kinds, table)


if __name__ == "__main__":
    main()
