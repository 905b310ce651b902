"""OpenUSD reads the series and the mesh; numpy has the trajectory."""
import sys
import numpy as np
from pxr import Usd, UsdGeom

run, mesh, trajectory = sys.argv[1:]
data = np.load(trajectory)
stage = Usd.Stage.Open(run)
assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 1
sheet = UsdGeom.Mesh(stage.GetDefaultPrim())
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
stage = Usd.Stage.Open(mesh)
still = UsdGeom.Mesh(stage.GetDefaultPrim())
assert not still.GetPointsAttr().GetTimeSamples()
assert (np.array(still.GetPointsAttr().Get()) == data["x"][0].astype(np.float32)).all()
