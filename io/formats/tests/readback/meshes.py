"""The readers of VTK find the triangles in space, as 32-bit floats."""
import sys
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
from vtkmodules.vtkIOPLY import vtkPLYReader

data = np.load(sys.argv[-1])
expected = data["x"][0].astype(np.float32)[data["faces"]]
for kind, path in zip((vtkOBJReader, vtkPLYReader, vtkSTLReader), sys.argv[1:]):
    reader = kind()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData())
    corners = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    assert np.array_equal(points[corners].astype(np.float32), expected), path
