"""numpy reads the point cache and the table."""
import sys
import numpy as np

cache, table, trajectory = sys.argv[1:]
data = np.load(trajectory)
frames, vertices, _ = data["x"].shape
header = np.dtype([("name", "S12"), ("version", "<i4"), ("points", "<i4"), ("start", "<f4"),
                   ("rate", "<f4"), ("samples", "<i4")])
head = np.fromfile(cache, header, 1)[0]
assert head.tolist() == (b"POINTCACHE2", 1, vertices, 0.0, 1.0, frames)
points = np.fromfile(cache, "<f4", offset=32).reshape(frames, vertices, 3)
assert (points == data["x"].astype(np.float32)).all()
rows = np.genfromtxt(table, delimiter=",", names=True)
names = ("frame", "t", "vertex", "x", "y", "z", "contact_force_x", "contact_force_y", "contact_force_z", "gap")
assert rows.dtype.names == names
assert (np.stack([rows[c] for c in "xyz"], axis=1).reshape(data["x"].shape) == data["x"]).all()
assert (rows["t"].reshape(frames, vertices) == data["t"][:, None]).all()
assert data["contact_forces"].shape == data["x"].shape and data["gaps"].shape == (frames, vertices)
assert (data["contact_forces"] == data["x"] * data["x"] - 0.25 * data["t"][:, None, None]).all()
assert (data["gaps"] == 1e-3 * np.arange(vertices) + data["t"][:, None]).all()
forces = np.stack([rows["contact_force_" + c] for c in "xyz"], axis=1)
assert (forces.reshape(data["x"].shape) == data["contact_forces"]).all()
assert (rows["gap"].reshape(frames, vertices) == data["gaps"]).all()
