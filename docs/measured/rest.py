"""The table of docs/rest.md: searches for equilibria beside damped runs to rest.

python3 docs/measured/rest.py ISOSHEET [CASE ...]   (ISOSHEET is the command, of an optimised build)

A case is the text of a scene, the name of a file of xtask/scenes with the keys to change, or a kind of `isosheet new`.
The damped run is by implicit Euler with air that damps by 5 a second, until all vertices have been slower than 1e-5 m/s
for a tenth of a second.
"""

import csv
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).resolve().parents[2] / "xtask/scenes"

STRIP = """version = 1
[sheet]
mesh = {{ rectangle = {{ width = {width}, height = {height}, columns = {columns}, rows = {rows} }} }}
material = "{material}"
start = {{ perturbation = 1e-3, seed = 1 }}
[forces]
gravity = [0.0, 0.0, -9.81]
[method]
step = 0.0166
[stop]
time = 1.0
"""
CLAMP = """[[support]]
at = { half_space = { point = [0.011, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] } }
"""
CORNERS = """[[support]]
at = {{ nearest = {corners} }}
"""
BODY = """[[obstacle]]
shape = {shape}
pose = {{ position = {position} }}
friction = {friction}
"""


def strip(material, width, height, columns, rows, *held):
    return STRIP.format(**locals()) + "".join(held)


def corners(*points):
    return CORNERS.format(corners=[list(point) for point in points])


def body(shape, position, friction):
    return BODY.format(shape=shape, position=list(position), friction=friction)


def square(n):
    return f"sheet.mesh.square.level={n}"


CASES = {
    "strip of paper out of a clamp": strip("office paper", 0.15, 0.02, 30, 4, CLAMP),
    "the same, twice as long": strip("office paper", 0.3, 0.02, 60, 4, CLAMP),
    "strip of cotton out of a clamp": strip("cotton", 0.1, 0.03, 30, 9, CLAMP),
    "strip of film out of a clamp": strip("polycarbonate film", 0.3, 0.03, 40, 4, CLAMP),
    "strip of foil out of a clamp": strip("aluminium foil", 0.06, 0.02, 24, 8, CLAMP),
    "paper that hangs by a corner": strip("office paper", 0.2, 0.2, 12, 12, corners((0, 0, 0))),
    "paper that hangs by two corners": strip("office paper", 0.2, 0.2, 12, 12, corners((0, 0, 0), (0.2, 0, 0))),
    "paper that is held at four corners": strip(
        "office paper", 0.2, 0.2, 12, 12, corners((0, 0, 0), (0.2, 0, 0), (0.2, 0.2, 0), (0, 0.2, 0))
    ),
    "cotton that hangs by two corners": strip("cotton", 0.2, 0.2, 16, 16, corners((0, 0, 0), (0.2, 0, 0))),
    "cloth that hangs by a corner, 81 vertices": ("cost-hanging-elastic", square(2)),
    "cloth that hangs by a corner, 289 vertices": ("cost-hanging-elastic", square(3)),
    "film on a round table": "drape",
    "paper on a ball": strip(
        "office paper", 0.1, 0.1, 10, 10, body("{ sphere = { radius = 0.03 } }", (0.05, 0.05, -0.031), 0.3)
    ),
    "film on a ball, without friction, held at a corner": strip(
        "polycarbonate film",
        0.4,
        0.4,
        12,
        12,
        corners((0, 0, 0)),
        body("{ sphere = { radius = 0.1 } }", (0.2, 0.2, -0.101), 0.0),
    ),
    "disk of film on a ball, 631 vertices": ("cost-ball", "sheet.mesh.disk.rings=14"),
    "cloth on a ball and on itself, 289 vertices": ("cloth-on-ball",),
    "cloth on a table and on itself, 81 vertices": ("cost-table-elastic", square(2)),
    "cloth on a table and on itself, 289 vertices": ("cost-table-elastic", square(3)),
    "paper on a table, over its edge": strip(
        "office paper", 0.2, 0.04, 40, 8, body("{ box = { size = [0.12, 0.2, 0.02] } }", (0.06, 0.02, -0.0105), 0.4)
    ),
    "film between two blocks": strip(
        "polycarbonate film",
        0.2,
        0.05,
        20,
        5,
        body("{ box = { size = [0.06, 0.2, 0.02] } }", (0.03, 0.025, -0.0105), 0.6),
        body("{ box = { size = [0.06, 0.2, 0.02] } }", (0.17, 0.025, -0.0105), 0.6),
    ),
}


# The keys of a damped run.
DAMPED = (
    "sheet.damping=5.0",
    'method.integrator="implicit_euler"',
    "stop={ time = 120.0, rest = { speed = 1e-5, duration = 0.1 } }",
)


def scene_of(case, folder, command):
    """The file of a case, and the keys that it changes."""
    if isinstance(case, tuple):
        name, *keys = case
        return SCENES / f"{name}.toml", keys
    made = folder / "scene.toml"
    if "\n" in case:
        made.write_text(case)
    else:
        subprocess.run([command, "new", "-q", "--kind", case, "--out", str(made)], check=True)
    return made, []


def measure(command, verb, scene, keys, out):
    """CPU seconds, factorisations, energy at the end."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    changes = [word for key in keys for word in ("--set", key)]
    arguments = [command, verb, str(scene), *changes, "--out", str(out), "--threads", "1"]
    done = subprocess.run(arguments, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        return None, done.stderr.strip().splitlines()[0]
    rows = list(csv.DictReader(open(out / "history.csv")))
    seconds = after.ru_utime - before.ru_utime
    return (seconds, sum(int(row["factorisations"]) for row in rows), float(rows[-1]["potential"])), done.stderr


def main():
    command, *names = sys.argv[1:]
    print("| scene | factorisations | damped run | ratio | CPU s | damped run | ratio | energies |")
    print("|---|---|---|---|---|---|---|---|")
    for name in names or CASES:
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            scene, keys = scene_of(CASES[name], folder, command)
            found, told = measure(command, "rest", scene, keys, folder / "rest")
            run, told_run = measure(command, "simulate", scene, [*keys, *DAMPED], folder / "damped")
        if found is None or run is None:
            print(f"| {name} | {told if found is None else told_run} |", flush=True)
            continue
        (s, n, e), (s_run, n_run, e_run) = found, run
        print(
            f"| {name} | {n} | {n_run} | {n_run / n:.1f} | {s:.2f} | {s_run:.2f} | {s_run / s:.1f} "
            f"| {(e - e_run) / abs(e_run):.1e} |",
            flush=True,
        )


main()
