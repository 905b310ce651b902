"""OpenUSD reads the series and the mesh; numpy has the trajectory."""
import sys
import numpy as np
from pxr import Gf, Usd, UsdGeom

run, mesh, trajectory = sys.argv[1:]
data = np.load(trajectory)
stage = Usd.Stage.Open(run)
assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 1
root = stage.GetDefaultPrim()
sheet = UsdGeom.Mesh(root.GetChild("sheet"))
points = sheet.GetPointsAttr()
samples = points.GetTimeSamples()
assert np.allclose(np.array(samples) / stage.GetTimeCodesPerSecond(), data["t"], rtol=1e-15, atol=0)
assert stage.GetStartTimeCode() == samples[0] and stage.GetEndTimeCode() == samples[-1]
for code, x in zip(samples, data["x"]):
    found = np.array(points.Get(code))
    assert (found == x.astype(np.float32)).all()
    low, high = sheet.GetExtentAttr().Get(code)
    assert (found.min(axis=0) == low).all() and (found.max(axis=0) == high).all()
middle = np.array(points.Get((samples[3] + samples[4]) / 2))
assert np.allclose(middle, (data["x"][3] + data["x"][4]) / 2, atol=1e-6)
assert (np.array(sheet.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3) == data["faces"]).all()
assert (np.array(sheet.GetFaceVertexCountsAttr().Get()) == 3).all()
assert sheet.GetSubdivisionSchemeAttr().Get() == "none" and sheet.GetDoubleSidedAttr().Get()
# The strip has the size 1 x 0.4, and a printed picture keeps its shape.
uv = UsdGeom.PrimvarsAPI(sheet).GetPrimvar("st")
assert uv.GetInterpolation() == "vertex"
assert np.allclose(np.array(uv.Get()), data["x"][0][:, :2], atol=1e-6)
assert {p.GetName() for p in root.GetChildren()} == {"sheet", "obstacle_0", "obstacle_1"}


def placed(name, code):
    prim = root.GetChild(name)
    to_world = UsdGeom.XformCache(code).GetLocalToWorldTransform(prim)
    points = UsdGeom.Mesh(prim).GetPointsAttr()
    assert not points.GetTimeSamples()
    return np.array([to_world.Transform(Gf.Vec3d(*map(float, p))) for p in points.Get()])


corners = np.array([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
# Also between two samples, between which the body turns evenly.
for code in samples + [(samples[3] + samples[4]) / 2]:
    t = code / stage.GetTimeCodesPerSecond()
    turn = np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])
    assert np.allclose(placed("obstacle_0", code), corners @ turn.T + [t, 0.5, 1], atol=1e-6), code
    assert np.allclose(placed("obstacle_1", code), corners + [0, 0, -1], atol=1e-7)
stage = Usd.Stage.Open(mesh)
still = UsdGeom.Mesh(stage.GetDefaultPrim().GetChild("sheet"))
assert not still.GetPointsAttr().GetTimeSamples()
assert (np.array(still.GetPointsAttr().Get()) == data["x"][0].astype(np.float32)).all()
