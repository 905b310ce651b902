"""Meshes of other libraries, which are known by their attributes."""

from types import SimpleNamespace

import numpy as np
import pytest

import isosheet

VERTICES = np.array([[0, 0, 0], [0.2, 0, 0], [0.2, 0.1, 0], [0, 0.1, 0]], dtype=float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])
LIKE = {
    "trimesh": SimpleNamespace(vertices=VERTICES, faces=FACES),
    "meshio": SimpleNamespace(points=VERTICES, cells_dict={"line": [[0, 1]], "triangle": FACES}),
    "pyvista": SimpleNamespace(
        points=VERTICES, faces=np.insert(FACES, 0, 3, axis=1).ravel(), is_all_triangles=True
    ),
}


@pytest.mark.parametrize("library", LIKE)
def test_meshes_of_other_libraries_are_taken(library):
    mesh = isosheet.Mesh(LIKE[library])
    assert np.array_equal(mesh.vertices, VERTICES) and np.array_equal(mesh.faces, FACES)
    scene = isosheet.Scene(sheet={"mesh": LIKE[library], "density": 0.08})
    assert scene == isosheet.Scene.from_dict({"sheet": {"mesh": mesh, "density": 0.08}})
    assert np.array_equal(isosheet.Simulation(scene).x, VERTICES)


@pytest.mark.parametrize("library", ["trimesh", "meshio"])
def test_the_libraries_themselves(library):
    module = pytest.importorskip(library)
    ours = isosheet.Mesh(VERTICES, FACES)
    theirs = {
        "trimesh": lambda: module.Trimesh(ours.vertices, ours.faces, process=False),
        "meshio": lambda: module.Mesh(ours.vertices, [("triangle", ours.faces)]),
    }[library]()
    back = isosheet.Mesh(theirs)
    assert np.array_equal(back.vertices, VERTICES) and np.array_equal(back.faces, FACES)


def test_what_is_no_mesh_of_triangles_is_refused():
    quads = [[0, 1, 2, 3]]
    for cells in ({"quad": quads}, {"triangle": FACES, "quad": quads}):
        with pytest.raises(ValueError, match='"quad"'):
            isosheet.Mesh(SimpleNamespace(points=VERTICES, cells_dict=cells))
    with pytest.raises(ValueError, match='"triangle"'):
        isosheet.Mesh(SimpleNamespace(points=VERTICES, cells_dict={}))
    with pytest.raises(ValueError, match="triangulate"):
        isosheet.Mesh(SimpleNamespace(points=VERTICES, faces=[4, 0, 1, 2, 3], is_all_triangles=False))
    with pytest.raises(TypeError, match="give vertices and faces"):
        isosheet.Mesh(VERTICES)
