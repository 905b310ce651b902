"""Scenes, meshes, materials and errors."""

import dataclasses

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
    square.write(tmp_path / "square.ply")
    meshes = [
        {"square": {"side": 0.2, "level": 1}},
        isosheet.Mesh(square.vertices, square.faces),
        isosheet.Mesh.read(tmp_path / "square.obj"),
        isosheet.Mesh.read(tmp_path / "square.ply"),
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
    with pytest.raises(isosheet.SceneError, match="sides"):
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


def test_a_sheet_starts_at_arrays():
    square = isosheet.Mesh.generate("square", side=0.2, level=1)
    rolled = square.vertices
    radius = 0.1
    angle = rolled[:, 0] / radius
    bent = np.column_stack([radius * np.sin(angle), rolled[:, 1], radius * (1 - np.cos(angle))])
    # Rods keep their lengths: the lengths of the bent mesh are the rest lengths.
    mesh = isosheet.Mesh(bent, square.faces)
    moved = bent @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    velocities = np.zeros_like(moved)
    velocities[:, 2] = np.arange(len(moved))
    scene = isosheet.Scene(
        sheet={
            "mesh": mesh,
            "density": 0.08,
            "placement": {"position": [0, 0, 1]},
            "start": {"positions": moved, "velocities": velocities, "velocity": [1, 0, 0]},
        }
    )
    simulation = isosheet.Simulation(scene)
    assert simulation.x == pytest.approx(moved + [0, 0, 1], abs=1e-15)
    assert simulation.v == pytest.approx(velocities + [1, 0, 0], abs=1e-15)
    assert "velocities at the start" in simulation.modelled
    for name in ("positions", "velocities"):
        with pytest.raises(isosheet.SceneError, match="has 24 entries, and the mesh 25 vertices") as caught:
            isosheet.Simulation(scene.edit({f"sheet.start.{name}": moved[:-1]}))
        assert caught.value.key == f"sheet.start.{name}" and caught.value.advice
    with pytest.raises(isosheet.SceneError, match="leave one of both out"):
        scene.edit({"sheet.start.file": {"path": "start.obj"}})


def test_a_refined_sheet_starts_at_arrays_of_its_mesh():
    mesh = isosheet.Mesh([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], [[0, 1, 2]])
    raised = mesh.vertices + [0, 0, 0.5]
    start = {"positions": raised, "velocities": [[0, 0, 0], [0, 0, 2], [0, 0, 4]]}
    scene = isosheet.Scene(sheet={"mesh": mesh, "density": 0.08, "refine": 1, "start": start})
    simulation = isosheet.Simulation(scene)
    a, b = np.triu_indices(3, 1)
    middle = {tuple(np.round(p, 12)) for p in np.vstack([raised, (raised[a] + raised[b]) / 2])}
    assert {tuple(np.round(p, 12)) for p in simulation.x} == middle
    # Of a linear field.
    assert simulation.v[:, 2] == pytest.approx(20 * simulation.x[:, 0] + 40 * simulation.x[:, 1], abs=1e-12)


def test_an_obstacle_of_arrays_is_that_of_the_formula():
    x, y, z = 0.2, 0.3, 0.1
    corners = np.array([[i, j, k] for k in (-z, z) for j in (-y, y) for i in (-x, x)]) / 2
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    box = isosheet.Mesh(corners, [[a, b, c] for a, *rest in quads for b, c in (rest[:2], rest[1:])])
    found = []
    for shape in (box, {"box": {"size": [x, y, z]}}):
        scene = isosheet.Scene(
            sheet={"mesh": {"square": {"side": 0.05, "level": 1}}, "density": 0.08, "damping": 20.0,
                   "placement": {"position": [0, 0, 0.06]}},
            obstacle=[{"shape": shape, "friction": 0.5}],
            forces={"gravity": [0, 0, -9.81]},
            method={"step": 0.01},
        )
        simulation = isosheet.Simulation(scene)
        simulation.run(0.3)
        found.append(simulation.x)
        weight = simulation.masses.sum() * 9.81
        assert simulation.obstacle_forces[0] == pytest.approx([0, 0, -weight], abs=1e-6 * weight)
    assert found[0] == pytest.approx(found[1], abs=1e-5)


@dataclasses.dataclass
class Ball:
    radius: float


@dataclasses.dataclass
class Obstacle:
    shape: dict
    friction: float = 0.5
    name: object = None


def test_objects_of_dataclasses_are_tables():
    scene = isosheet.Scene(**TRIANGLE, obstacle=[Obstacle({"sphere": Ball(0.1)})])
    assert scene["obstacle[0].shape.sphere.radius"] == 0.1 and scene["obstacle[0].friction"] == 0.5
    with pytest.raises(isosheet.SceneError, match="fricton"):
        isosheet.Scene(**TRIANGLE, obstacle=[{"shape": {"sphere": Ball(0.1)}, "fricton": 1}])


def test_a_scene_is_made_of_keyword_arguments():
    scene = isosheet.Scene(**TRIANGLE)
    assert scene == isosheet.Scene.from_dict(TRIANGLE)
    with pytest.raises(isosheet.SceneError, match="shet"):
        isosheet.Scene(shet=TRIANGLE["sheet"])
    with pytest.raises(isosheet.SceneError, match="sheet"):
        isosheet.Scene()
    with pytest.raises(TypeError):
        isosheet.Scene(TRIANGLE)


def test_a_scene_at_rest_ends_at_an_equilibrium(tmp_path):
    scene = isosheet.Scene.new("clamp").at_rest()
    assert scene["method.integrator"] == "static"
    run = scene.simulate(tmp_path / "rest")
    assert run.summary["steps"] == 1
    assert run.summary["ending"]["lowest_frequency"] > 0
