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
assert rows.dtype.names == ("frame", "t", "vertex", "x", "y", "z")
assert (np.stack([rows[c] for c in "xyz"], axis=1).reshape(data["x"].shape) == data["x"]).all()
assert (rows["t"].reshape(frames, vertices) == data["t"][:, None]).all()
