"""Scenes, meshes, materials and errors."""

import numpy as np
import pytest

import isosheet

TRIANGLE = {"sheet": {"mesh": {"square": {"side": 0.2, "level": 0}}, "density": 0.08}}


def test_a_dictionary_is_the_same_scene_as_its_text(tmp_path):
    text = """
version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.1, columns = 4, rows = 2 } }
density = 0.08
[[support]]
at = { vertices = [0, 1] }
[forces]
gravity = [0, 0, -9.81]
"""
    by_dict = isosheet.Scene.from_dict(
        {
            "sheet": {
                "mesh": {"rectangle": {"width": np.float64(0.2), "height": 0.1, "columns": np.int32(4), "rows": 2}},
                "density": 0.08,
                "material": None,
            },
            "support": ({"at": {"vertices": np.arange(2)}},),
            "forces": {"gravity": np.array([0, 0, -9.81])},
        }
    )
    file = tmp_path / "scene.toml"
    file.write_text(text)
    assert by_dict == isosheet.Scene.from_toml(text)
    assert by_dict == isosheet.Scene.from_toml(file) == isosheet.Scene.from_toml(str(file))
    assert isosheet.Scene.from_dict(by_dict.to_dict()) == by_dict
    assert by_dict != by_dict.edit({"sheet.density": 0.1})


def test_values_are_edited_and_read_by_key():
    scene = isosheet.Scene.new("drape", {"stop.time": 0.25})
    assert scene["stop.time"] == 0.25
    edited = scene.edit({"obstacle[0].friction": 0.75, "method.step": 0.005, "sheet.material": "office paper"})
    assert (edited["obstacle[0].friction"], edited["method.step"]) == (0.75, 0.005)
    assert edited["sheet.material"] == "office paper"
    assert scene["method.step"] != 0.005, "a scene does not change"
    with pytest.raises(KeyError):
        scene["method.stride"]
    with pytest.raises(ValueError, match="hanging, clamp"):
        isosheet.Scene.new("nonsense")


def test_a_wrong_scene_has_key_and_advice():
    with pytest.raises(isosheet.SceneError) as caught:
        isosheet.Scene.from_dict({"sheet": {**TRIANGLE["sheet"], "density": -1.0}})
    error = caught.value
    assert error.key == "sheet.density" and "above 0" in error.advice
    assert error.problems[0]["key"] == "sheet.density" and error.problems[0]["line"] > 0
    assert error.time is None and isinstance(error, isosheet.Error)
    with pytest.raises(isosheet.SceneError) as caught:
        isosheet.Scene.from_dict(TRIANGLE).edit({"support[3].at": "all"})
    assert caught.value.key == "support[3].at" and "count the entries" in caught.value.advice
    with pytest.raises(isosheet.SceneError, match="cannot read"):
        isosheet.Scene.from_toml("no such file.toml")
    with pytest.raises(TypeError, match="object"):
        isosheet.Scene.from_dict({"sheet": object()})


def test_meshes_are_arrays():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * 0.1
    mesh = isosheet.Mesh(vertices, [[0, 1, 2], [0, 2, 3]])
    assert mesh.vertices.shape == (4, 3) and mesh.faces.dtype == np.uint32
    assert np.array_equal(mesh.vertices, vertices)
    a, b = mesh.edges.T
    assert np.allclose(np.linalg.norm(vertices[a] - vertices[b], axis=1), mesh.rest_lengths, rtol=1e-15)
    assert mesh.area == pytest.approx(0.01, rel=1e-15)
    for faces, error in (
        ([[0, 1, 2], [0, 1, 3]], isosheet.Error),
        ([[0, 1, 9]], isosheet.Error),
        ([[0, 1, -1]], ValueError),
        ([[0, 1, 1.5]], ValueError),
        ([[0, 1]], ValueError),
    ):
        with pytest.raises(error):
            isosheet.Mesh(vertices, faces)


def test_a_mesh_of_a_program_moves_as_the_generated_one(tmp_path):
    square = isosheet.Mesh.generate("square", side=0.2, level=1)
    square.write(tmp_path / "square.obj")
    meshes = [
        {"square": {"side": 0.2, "level": 1}},
        isosheet.Mesh(square.vertices, square.faces),
        isosheet.Mesh.read(tmp_path / "square.obj"),
        {"file": {"path": tmp_path / "square.obj"}},
    ]
    ends = []
    for mesh in meshes:
        scene = {"sheet": {"mesh": mesh, "density": 0.08}, "support": [{"at": {"vertices": [20]}}]}
        simulation = isosheet.Simulation(isosheet.Scene.from_dict({**scene, "forces": {"gravity": [0, 0, -9.81]}}))
        simulation.run(0.05)
        ends.append(simulation.x)
    for end in ends[1:]:
        assert np.array_equal(end, ends[0])
    with pytest.raises(isosheet.SceneError):
        isosheet.Mesh.generate("square", side=-1.0, level=1)
    with pytest.raises(ValueError, match="sides"):
        isosheet.Mesh.generate("square", sides=0.2, level=1)


def test_materials_are_those_of_scenes():
    materials = isosheet.materials()
    paper = materials["office paper"]
    assert 0.05 < paper["density"] < 0.2 and paper["source"]
    sheet = {**TRIANGLE["sheet"], "density": None, "material": "office paper"}
    simulation = isosheet.Simulation(isosheet.Scene.from_dict({"sheet": sheet}))
    assert simulation.masses.sum() == pytest.approx(paper["density"] * 0.2**2, rel=1e-12)


def test_values_that_contain_themselves_or_are_too_deep_are_refused():
    circle = {}
    circle["sheet"] = circle
    deep = value = []
    for _ in range(30_000):
        value.append([])
        value = value[0]
    for wrong in [circle, {"sheet": deep}]:
        with pytest.raises(ValueError, match="contains itself, or is nested deeper than 64 levels"):
            isosheet.Scene.from_dict(wrong)


def test_masked_and_huge_arrays_are_refused():
    masked = np.ma.masked_array([0.0, 0.0, -9.81], mask=[True, False, False])
    huge = np.broadcast_to(0.0, (10**9, 3))
    for wrong, words in [(masked, "has a mask"), (huge, "3000000000 numbers")]:
        with pytest.raises(ValueError, match=words):
            isosheet.Scene.from_dict({**TRIANGLE, "forces": {"gravity": wrong}})
        with pytest.raises(ValueError, match=words):
            isosheet.Mesh(wrong, [[0, 1, 2]])


def test_a_run_needs_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(isosheet.RunFailed, match="the path of the folder is empty"):
        isosheet.Scene.from_dict(TRIANGLE).simulate("")
    assert not list(tmp_path.iterdir())
