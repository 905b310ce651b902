"""VTK reads the frames; strains and fold angles are computed anew by numpy."""
import json
import os
import sys
import xml.etree.ElementTree as tree
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

collection, fold, trajectory = sys.argv[1:]
data = np.load(trajectory)
fold = json.load(open(fold))
frames = [fold] + fold["file_frames"]
listed = tree.parse(collection).getroot().find("Collection").findall("DataSet")
assert [float(d.get("timestep")) for d in listed] == list(data["t"][::2])
rest = {tuple(sorted(e)): l for e, l in zip(data["edges"].tolist(), data["rest_lengths"])}


def fold_angle(x, faces, a, b):
    """Degrees between the normals of the two faces of an edge; positive where the faces form a valley."""
    normals, opposite = [], []
    for f in faces:
        if a in f and b in f:
            n = np.cross(x[f[1]] - x[f[0]], x[f[2]] - x[f[0]])
            normals.append(n / np.linalg.norm(n))
            opposite.append(x[next(v for v in f if v not in (a, b))])
    if len(normals) == 1:
        return 0.0
    size = np.degrees(np.arccos(np.clip(normals[0] @ normals[1], -1, 1)))
    return size if normals[0] @ (opposite[1] - x[a]) > 0 else -size


for number, entry in enumerate(listed):
    k = 2 * number
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(os.path.join(os.path.dirname(collection), entry.get("file")))
    reader.Update()
    assert reader.GetErrorCode() == 0
    poly = reader.GetOutput()
    x, faces = data["x"][k], data["faces"].tolist()
    assert (vtk_to_numpy(poly.GetPoints().GetData()) == x).all()
    assert vtk_to_numpy(poly.GetFieldData().GetArray("TimeValue")).tolist() == [data["t"][k]]
    lines = vtk_to_numpy(poly.GetLines().GetConnectivityArray()).reshape(-1, 2)
    assert vtk_to_numpy(poly.GetPolys().GetConnectivityArray()).reshape(-1, 3).tolist() == faces
    assert sorted(map(sorted, lines.tolist())) == sorted(map(list, rest))
    edges, n = len(lines), len(faces)
    cell = lambda name: vtk_to_numpy(poly.GetCellData().GetArray(name))
    lengths = np.linalg.norm(x[lines[:, 0]] - x[lines[:, 1]], axis=1)
    strains = lengths / np.array([rest[tuple(sorted(e))] for e in lines.tolist()]) - 1
    assert np.allclose(cell("strain")[:edges], strains, atol=1e-14)
    angles = [fold_angle(x, faces, a, b) for a, b in lines.tolist()]
    assert np.allclose(cell("fold_angle")[:edges], angles, atol=1e-5), k
    assert np.allclose(frames[number]["edges_foldAngle"], cell("fold_angle")[:edges], atol=1e-12)
    assert fold["edges_vertices"] == lines.tolist()
    where = {tuple(sorted(e)): i for i, e in enumerate(lines.tolist())}
    for i, f in enumerate(faces):
        own = [cell("fold_angle")[where[tuple(sorted((f[j], f[j - 1])))]] for j in range(3)]
        assert abs(cell("fold_angle")[edges + i]) == max(map(abs, own))
    points = vtk_to_numpy(poly.GetPointData().GetArray("height <m>"))
    assert (points == 0.5 * np.arange(len(x) * k, len(x) * (k + 1))).all()
    assert (vtk_to_numpy(poly.GetPointData().GetArray("contact_force")) == data["contact_forces"][k]).all()
    assert (vtk_to_numpy(poly.GetPointData().GetArray("gap")) == data["gaps"][k]).all()
    assert (cell("energy")[edges:] == 0.5 * np.arange(n * k, n * (k + 1))).all()
    assert (cell("force & load")[:edges] == 0.5 * np.arange(edges * k, edges * (k + 1))).all()
    assert poly.GetNumberOfCells() == edges + n == len(cell("energy"))
    assert (vtk_to_numpy(poly.GetPointData().GetTCoords())[:, 0] <= 1).all()

bodies = os.path.join(os.path.dirname(collection), "the run-bodies.pvd")
listed = tree.parse(bodies).getroot().find("Collection").findall("DataSet")
assert [float(d.get("timestep")) for d in listed] == list(data["t"][::2])
corners = np.array([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
for entry, t in zip(listed, data["t"][::2]):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(os.path.join(os.path.dirname(bodies), entry.get("file")))
    reader.Update()
    assert reader.GetErrorCode() == 0
    poly = reader.GetOutput()
    turn = np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])
    expected = np.vstack([corners @ turn.T + [t, 0.5, 1], corners + [0, 0, -1]])
    assert np.allclose(vtk_to_numpy(poly.GetPoints().GetData()), expected, atol=1e-12)
    assert vtk_to_numpy(poly.GetCellData().GetArray("body")).tolist() == [0.0] * 4 + [1.0] * 4
