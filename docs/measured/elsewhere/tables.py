"""Prints the tables of docs/measured-elsewhere.md, made of results.csv: python3 tables.py [SCENE]"""

import csv
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


def runs():
    """All runs, those of one kind together: kind -> rows."""
    found = {}
    with open(Path(__file__).with_name("results.csv"), newline="") as file:
        for row in csv.DictReader(file):
            kind = tuple(row[key] for key in ("scene", "program", "setting", "step", "vertices"))
            found.setdefault(kind, []).append(row)
    return found


def short(number, digits=3):
    """A number with some digits, without zeros at its end."""
    text = f"{float(number):.{digits}g}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        text = f"{mantissa}e{int(exponent)}"
    return text


def cell(rows, end):
    """CPU seconds; error; error of lengths; intersecting states."""
    cpu = statistics.median(float(row["cpu_s"]) for row in rows)
    parts = [short(cpu) + (f" for {short(rows[0]['time_s'])} s" if float(rows[0]["time_s"]) < end - 1e-6 else "")]
    if rows[0]["error_mm"]:
        parts.append(short(rows[0]["error_mm"], 2))
    parts.append(short(rows[0]["edge_error"], 2))
    if rows[0]["states"]:
        cut = f"{rows[0]['intersecting']} of {rows[0]['states']}"
        depth = rows[0]["depth_mm"]
        parts.append(cut + (f", {short(depth, 2)} mm" if depth and float(depth) > 0 else ""))
    return "; ".join(parts)


def main():
    kinds = runs()
    for scene, title in SCENES.items():
        if sys.argv[1:] and scene not in sys.argv[1:]:
            continue
        here = {kind: rows for kind, rows in kinds.items() if kind[0] == scene}
        if not here:
            continue
        sizes = sorted({kind[4] for kind in here}, key=int)
        end = max(float(rows[0]["end_s"]) for rows in here.values())
        print(f"**{title}.**\n")
        print("| program | step, s | " + " | ".join(f"{size} vertices" for size in sizes) + " |")
        print("|" + "---|" * (2 + len(sizes)))
        for name in dict.fromkeys(kind[1:4] for kind in here):
            program, setting, step = name
            rows = [here.get((scene, *name, size)) for size in sizes]
            cells = [cell(own, end) if own else "" for own in rows]
            title = f"{program}, {setting}" if setting else program
            print(f"| {title} | {step} | " + " | ".join(cells) + " |")
        print()


main()
