"""Runs: what the command wrote, compared bit for bit with the module."""

import copy
import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import isosheet

SCENE = """
version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
density = 0.08
[[support]]
at = { vertices = [20] }
hold = { moving_pin = { z = { smooth_step = { to = 0.02, end = 0.2 } } } }
[[obstacle]]
shape = "half_space"
pose = { position = [0, 0, -0.05] }
[[measure]]
name = "corner"
at = { vertices = [20] }
quantity = "z"
[forces]
gravity = [0, 0, -9.81]
[method]
step = 0.01
[stop]
time = 0.2
[output]
frames_per_second = 50
"""


def command(*words, cwd):
    """The command as pip installs it."""
    program = os.path.join(os.path.dirname(sys.executable), "isosheet")
    return subprocess.run([program, *words], cwd=cwd, capture_output=True, text=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder of a run that the command made."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "scene.toml").write_text(SCENE)
    done = command("simulate", "scene.toml", "--out", "run", "--quiet", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder / "run"


def test_the_module_takes_the_steps_of_the_command_bit_for_bit(folder):
    run = isosheet.Run(folder)
    simulation = isosheet.Simulation(isosheet.Scene.from_toml(SCENE))
    for time, x in zip(run.time, run.x, strict=True):
        simulation.run(time)
        assert np.array_equal(simulation.x, x), time
    history, state = run.history, simulation.energies
    assert history["time"][-1] == simulation.time
    assert (history["kinetic"][-1], history["total"][-1]) == (state["kinetic"], state["total"])
    assert run.rod_forces[-1] == pytest.approx(simulation.rod_forces, abs=1e-12)
    assert np.array_equal(run.contact_forces[-1], simulation.contact_forces)


def test_a_run_is_what_its_files_say(folder):
    run = isosheet.Run(folder)
    file = np.load(folder / "trajectory.npz")
    for name in ("x", "faces", "edges", "rest_lengths", "rod_forces", "contact_forces", "gaps"):
        assert np.array_equal(getattr(run, name), file[name]), name
    assert np.array_equal(run.time, file["t"])
    table = np.genfromtxt(folder / "history.csv", delimiter=",", names=True)
    for name, column in (("time", "t"), ("total", "H"), ("iterations", "iterations"), ("strain", "strain")):
        assert np.array_equal(run.history[name], table[column]), name
    assert np.isnan(run.history["plastic"]).all()  # nothing can yield
    assert run.plastic_angles is None and run.plastic_curvatures is None and run.crease_bends is None
    summary = json.loads((folder / "summary.json").read_text())
    assert run.summary["ending"] == summary["ending"] and run.summary["steps"] == summary["steps"] == 20
    assert run.scene["stop.time"] == 0.2 and "gravity" in run.modelled


def test_a_rolled_strip_is_ruled(tmp_path):
    """A moment of 2e-4 N m bends 0.05 m of a plate of 5e-4 N m to the curvature of 8 / m."""
    held = {"point": [1e-6, 0, 0], "normal": [-1, 0, 0]}
    mesh = {"rectangle": {"width": 0.1, "height": 0.05, "columns": 12, "rows": 6, "diagonals": "rising"}}
    plate = {"plate": {"rigidity": 5e-4, "poisson": 0}}
    moment = {
        "at": {"half_space": {"point": [0.0999, 0, 0], "normal": [1, 0, 0]}},
        "axis": [0, -1, 0],
        "size": {"smooth_step": {"to": 2e-4, "end": 1}},
    }
    scene = isosheet.Scene(
        sheet={"mesh": mesh, "material": "office paper", "bending": plate, "damping": 10},
        support=[{"at": {"half_space": held}, "hold": "clamp"}],
        forces={"moment": [moment]},
        stop={"time": 2},
    )
    run = scene.simulate(tmp_path / "run")
    count = len(run.time)
    assert run.rulings.shape == (count, len(run.faces), 3)
    assert run.gauss_curvatures.shape == run.x.shape[:2]
    curvature, along = run.ruling_curvatures[-1], np.abs(run.rulings[-1, :, 1])
    assert np.median(curvature) == pytest.approx(8, rel=0.02) and np.median(along) > 0.999
    assert not run.rulings[0].any() and not run.ruling_curvatures[0].any()  # flat
    assert np.isfinite(run.gauss_curvatures).all()


def test_a_run_shows_its_page(folder, tmp_path):
    run = isosheet.Run(folder)
    page = run.html()
    assert page.lower().startswith("<!doctype html>")
    run.write_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page
    shown = run._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and shown.count('"') == 6
    with pytest.raises(isosheet.Error, match="budget"):
        run.html(budget=10)


def test_several_sheets_have_slices(tmp_path):
    sheet = {"mesh": {"square": {"side": 0.1, "level": 0}}, "density": 0.08}
    above = {"position": [0, 0, 0.05]}
    scene = isosheet.Scene.from_dict(
        {
            "sheet": [{**sheet, "name": "low"}, {**sheet, "name": "high", "placement": above}],
            "stop": {"time": 0.05},
        }
    )
    simulation = isosheet.Simulation(scene)
    run = scene.simulate(tmp_path / "run")
    assert simulation.sheets == run.sheets == {"low": slice(0, 9, 1), "high": slice(9, 18, 1)}
    assert np.array_equal(simulation.x[simulation.sheets["high"]], simulation.x[:9] + above["position"])
    assert np.array_equal(run.x[-1, run.sheets["high"]], simulation.x[9:])
    alone = isosheet.Simulation(isosheet.Scene.from_dict({"sheet": sheet}))
    assert alone.sheets == {}


def test_a_scene_runs_in_a_folder_as_the_command_does(folder, tmp_path):
    run = isosheet.Scene.from_toml(SCENE).simulate(tmp_path / "again")
    assert np.array_equal(run.x, isosheet.Run(folder).x)
    other = isosheet.Scene.from_toml(SCENE, {"sheet.density": 0.1})
    with pytest.raises(isosheet.RunFailed) as caught:
        other.simulate(tmp_path / "again")
    assert "another folder" in caught.value.advice
    with pytest.raises(isosheet.RunFailed, match="not the folder of a run"):
        isosheet.Run(tmp_path)


def test_the_command_of_the_wheel_is_the_command(tmp_path):
    assert command("--version", cwd=tmp_path).stdout.split() == ["isosheet", isosheet.__version__]
    assert command("simulate", cwd=tmp_path).returncode == 2
    wrong = command("info", "nothing", cwd=tmp_path)
    assert wrong.returncode == 3 and "error" in wrong.stderr
    new = command("new", "cloth", "--kind", "hanging", cwd=tmp_path)
    assert new.returncode == 0 and (tmp_path / "cloth.toml").is_file()
    assert isosheet.Scene.from_toml(tmp_path / "cloth.toml") == isosheet.Scene.new("hanging")
    swept = command("sweep", "cloth.toml", "--over", "sheet.density=0.1,0.2", "--set", "stop.time=0.05", cwd=tmp_path)
    assert swept.returncode == 0, swept.stderr
    assert len(list((tmp_path / "cloth-sweep").glob("*/summary.json"))) == 2
    module = subprocess.run([sys.executable, "-m", "isosheet", "--version"], capture_output=True, text=True)
    assert module.stdout == command("--version", cwd=tmp_path).stdout


def test_a_run_has_its_measures_and_loads(folder):
    run = isosheet.Run(folder)
    assert list(run.measures) == ["corner"]
    corner, time = run.measures["corner"], run.history["time"]
    assert corner.shape == time.shape
    assert corner[[0, -1]] == pytest.approx([0.0, 0.02], abs=1e-12)
    assert run.x[-1, 20, 2] == corner[-1]
    assert list(run.loads) == ["support[0]", "obstacle[0]"]
    support, floor = run.loads["support[0]"], run.loads["obstacle[0]"]
    assert np.array_equal(support["time"], time[1:])
    assert np.isfinite(support["force"]).all() and support["force"].shape == (time.size - 1, 3)
    for load in (floor, support):
        assert load["torque"].shape == load["force"].shape == support["force"].shape
    ending = run.summary["ending"]
    assert ending["supports"][0] == pytest.approx(support["force"][-1])


def test_films_and_files_have_the_frames_a_second_that_are_asked_for(tmp_path):
    run = isosheet.Scene.new("hanging", {"stop.time": 0.5}).simulate(tmp_path / "run")
    files = run.save(tmp_path / "slow.npz", fps=10)
    assert files == [tmp_path / "slow.npz"]
    slow = np.load(tmp_path / "slow.npz")
    assert slow["t"] == pytest.approx(np.arange(6) / 10)
    expected = [np.interp(slow["t"], run.time, along) for along in run.x.reshape(run.time.size, -1).T]
    assert slow["x"].reshape(6, -1).T == pytest.approx(np.array(expected), abs=1e-15)
    run.film(tmp_path / "slow.apng", fps=10, height=40)
    # The number of frames is in the chunk acTL.
    film = (tmp_path / "slow.apng").read_bytes()
    at = film.index(b"acTL") + 4
    assert int.from_bytes(film[at : at + 4], "big") == 6
    with pytest.raises(ValueError, match="give one of them"):
        run.film(tmp_path / "both.apng", fps=10, every=2)
    with pytest.raises(isosheet.Error, match="frames a second"):
        run.save(tmp_path / "none.npz", fps=0.0)


def test_runs_are_copied_and_pickled_as_their_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = isosheet.Scene.new("hanging", {"stop.time": 0.05}).simulate("run")
    for other in (pickle.loads(pickle.dumps(run)), copy.copy(run), copy.deepcopy(run)):
        assert other.folder == tmp_path / "run"
        assert np.array_equal(other.x, run.x) and other.summary == run.summary
