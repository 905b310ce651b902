"""Writes the meshes of the runs to a folder: python3 meshes.py FOLDER"""

import math
import sys
from pathlib import Path

FOLDER = Path(sys.argv[1])


def write(name, points, faces):
    lines = ["v %.17g %.17g %.17g" % tuple(p) for p in points]
    lines += ["f %d %d %d" % tuple(corner + 1 for corner in face) for face in faces]
    (FOLDER / name).write_text("\n".join(lines) + "\n")


def union_jack(columns, rows, width, height, bump=0.0):
    wave = lambda i, j: bump * math.sin(math.pi * i / columns) * math.sin(math.pi * j / rows)
    corners = [(i, j) for j in range(rows + 1) for i in range(columns + 1)]
    points = [(width * i / columns, height * j / rows, wave(i, j)) for i, j in corners]
    faces = []
    for j in range(rows):
        for i in range(columns):
            a = i + j * (columns + 1)
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            faces += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return points, faces


def ball(radius, centre):
    """An icosahedron divided three times, with a vertex on top: 1280 triangles."""
    level, out = 1 / math.sqrt(5), 2 / math.sqrt(5)
    ring = lambda turn, z: [(out * math.cos(math.radians(72 * k + turn)), out * math.sin(math.radians(72 * k + turn)), z)
                            for k in range(5)]
    points = [(0, 0, 1), *ring(0, level), *ring(36, -level), (0, 0, -1)]
    faces = []
    for k in range(5):
        a, b, c, d = 1 + k, 1 + (k + 1) % 5, 6 + k, 6 + (k + 1) % 5
        faces += [(0, a, b), (a, c, b), (b, c, d), (11, d, c)]
    for _ in range(3):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                sums = [x + y for x, y in zip(points[a], points[b])]
                points.append(tuple(x / math.hypot(*sums) for x in sums))
                middles[key] = len(points) - 1
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return [tuple(radius * x + o for x, o in zip(p, centre)) for p in points], faces


for level in (2, 3, 4):
    write(f"m{level}.obj", *union_jack(2 ** (level + 1), 2 ** (level + 1), 1.0, 1.0, 1e-3))
write("strip.obj", *union_jack(120, 4, 0.3, 0.03))
write("ball.obj", *ball(0.2, (0.5, 0.5, -0.2)))
write("ball-at-origin.obj", *ball(0.2, (0.0, 0.0, 0.0)))
corners = [(x, y, z) for z in (-0.201, -0.001) for y in (0.25, 0.75) for x in (0.25, 0.75)]
sides = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
         (1, 3, 5), (3, 7, 5)]
write("table.obj", corners, sides)
