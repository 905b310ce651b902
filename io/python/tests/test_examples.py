"""The notebooks run from start to end, and the samples of the book too."""

import ast
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

import isosheet

ROOT = Path(__file__).parent.parent
BOOK = ROOT.parent.parent / "docs" / "python.md"


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("scipy")
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert all(not cell.get("outputs") for cell in notebook.cells), "notebooks are committed without outputs"
    client = nbclient.NotebookClient(notebook, kernel_name="python3", resources={"metadata": {"path": tmp_path}})
    client.execute()


def test_the_samples_of_the_book_run_one_after_the_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    samples = re.findall(r"```python\n(.*?)```", BOOK.read_text(), re.DOTALL)
    assert len(samples) >= 5
    names = {}
    for sample in samples:
        exec(sample, names)
    assert (tmp_path / "sheet-run" / "index.html").is_file()


# What the sample for Blender uses, with the pages of Blender's Python API that describe it.
BLENDER = {
    "bpy.context": {"scene", "object", "evaluated_depsgraph_get"},
    "bpy.data": {"materials", "objects", "lights", "cameras", "worlds"},
    "bpy.ops": {"wm", "mesh", "render", "read_factory_settings", "usd_import", "primitive_plane_add"},
    "bpy.types.Collection": {"objects", "link", "new"},
    "bpy.types.BlendDataObjects": {"remove"},
    "bpy.types.Scene": {
        "frame_set", "frame_end", "objects", "collection", "camera", "world", "render", "cycles", "view_settings",
    },
    "bpy.types.RenderSettings": {"engine", "fps", "resolution_x", "resolution_y", "filepath"},
    "bpy.types.ColorManagedViewSettings": {"view_transform"},
    "cycles": {"samples", "use_denoising"},
    "bpy.types.Object": {
        "type", "name", "data", "evaluated_get", "matrix_world", "bound_box", "location", "rotation_euler",
    },
    "bpy.types.Mesh": {"materials", "polygons", "clear", "append", "shade_smooth", "set_sharp_from_angle"},
    "bpy.types.SunLight": {"energy", "angle"},
    "bpy.types.Camera": {"lens", "clip_start", "clip_end"},
    "bpy.types.NodeTree": {"use_nodes", "node_tree", "nodes", "links", "inputs", "outputs", "default_value"},
    "mathutils.Vector": {"x", "y", "z", "length", "to_track_quat"},
    "mathutils.Quaternion": {"to_euler"},
    "Python": {"argv", "startswith", "resolve"},
}


def test_the_sample_for_blender_uses_documented_names_alone():
    page = (BOOK.parent / "blender.md").read_text()
    (sample,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    known = set().union(*BLENDER.values())
    used = {node.attr for node in ast.walk(ast.parse(sample)) if isinstance(node, ast.Attribute)}
    assert used - {"context", "data", "ops"} <= known
    for operator in re.findall(r"bpy\.ops\.\w+\.(\w+)", sample):
        assert operator in BLENDER["bpy.ops"] | {"render"}


def blender_renders_the_sample(tmp_path):
    page = (BOOK.parent / "blender.md").read_text()
    (sample,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    (tmp_path / "render.py").write_text(sample)
    run = isosheet.Scene.new("drape", {"stop.time": 0.1}).simulate(tmp_path / "run")
    run.save(tmp_path / "cloth.usda")
    done = subprocess.run([sys.executable, "render.py", "cloth.usda", "cloth.png"], cwd=tmp_path, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "cloth.png").stat().st_size > 10_000


# Blender is a large package, and only where it is installed is there this test.
if importlib.util.find_spec("bpy"):
    test_blender_renders_the_sample = blender_renders_the_sample
