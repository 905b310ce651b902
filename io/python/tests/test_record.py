"""Recordings: what a loop leaves is what the command leaves."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import isosheet

SCENE = """
version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
material = "office paper"
damping = 5
[[support]]
at = { vertices = [20] }
hold = { moving_pin = { z = { smooth_step = { to = 0.005, end = 0.2 } } } }
[[support]]
at = { vertices = [4] }
until = 0.1
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
"""


def command(*words, cwd):
    program = os.path.join(os.path.dirname(sys.executable), "isosheet")
    return subprocess.run([program, *words], cwd=cwd, capture_output=True, text=True)


def simulation(**edits):
    return isosheet.Simulation(isosheet.Scene.from_toml(SCENE, {k.replace("__", "."): v for k, v in edits.items()}))


@pytest.fixture(scope="module")
def commanded(tmp_path_factory):
    """The folder that the command leaves."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "scene.toml").write_text(SCENE)
    done = command("simulate", "scene.toml", "--out", "loop", "--quiet", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder / "loop"


def without_wall_time(folder):
    summary = json.loads((folder / "summary.json").read_text())
    assert summary.pop("wall_time") > 0
    return summary


def test_a_recording_goes_beyond_the_end_of_its_scene(tmp_path):
    one = simulation(stop__rest={"speed": 100.0, "duration": 0.02})
    with one.record(tmp_path / "long") as recorder:
        for _ in range(30):
            one.step()
    assert recorder.run.time[-1] == pytest.approx(0.3)
    assert recorder.run.scene["stop.time"] == pytest.approx(0.3)


def test_a_loop_leaves_the_files_of_the_command_bit_for_bit(commanded, tmp_path):
    one = simulation()
    with one.record(tmp_path / "loop") as recorder:
        for _ in range(20):
            one.step()
    left, right = tmp_path / "loop", commanded
    assert {f.name for f in left.iterdir()} == {f.name for f in right.iterdir()}
    for name in ("history.csv", "loads.csv", "measures.csv", "events.csv", "scene.toml", "frames.bin"):
        assert (left / name).read_bytes() == (right / name).read_bytes(), name
    archives = [np.load(folder / "trajectory.npz") for folder in (left, right)]
    assert archives[0].files == archives[1].files
    assert all(np.array_equal(archives[0][name], archives[1][name]) for name in archives[0].files)
    assert without_wall_time(left) == without_wall_time(right)
    assert recorder.run.summary["ending"]["reason"] == "time"
    # The command takes it for its own.
    again = command("simulate", "scene.toml", "--out", left, cwd=commanded.parent)
    assert again.returncode == 0 and "complete" in again.stdout + again.stderr


def test_the_command_reads_a_recording(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run", every=2):
        one.run(0.1)
    assert isosheet.Run(tmp_path / "run").time == pytest.approx(np.arange(0, 0.101, 0.02))
    for words in (["info", "run"], ["page", "run"], ["convert", "run", "film.usda"], ["convert", "run", "end.png"]):
        done = command(*words, cwd=tmp_path)
        assert done.returncode == 0, (words, done.stderr)
    assert (tmp_path / "film.usda").is_file() and (tmp_path / "end.png").is_file()


def test_a_loop_that_ends_early_has_its_own_end_in_the_scene(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run") as recorder:
        one.run(0.08)
    run = recorder.run
    assert run.scene["stop.time"] == pytest.approx(0.08) and run.summary["ending"]["reason"] == "program"
    assert run.time[-1] == one.time and np.array_equal(run.x[-1], one.x)
    again = run.scene.simulate(tmp_path / "again")
    assert np.array_equal(again.x, run.x) and np.array_equal(again.history["total"], run.history["total"])
    assert "control" not in run.summary


def test_what_a_loop_drives_is_in_the_scene_and_makes_the_motion_again(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run") as recorder:
        for k in range(10):
            end = one.time + 0.02
            one.drive({"support[0].hold.moving_pin.x": 0.001 * k, "support[0].hold.moving_pin.z": 0.0}, until=end)
            one.run(end)
    run = recorder.run
    (x, z) = run.summary["control"]
    assert x["what"] == "support[0].hold.moving_pin.x" and x["in_scene"] and z["in_scene"]
    assert x["times"] >= 9 and x["first"] == 0 and x["last"] == pytest.approx(0.18)
    keys = dict(map(tuple, run.scene["support[0].hold.moving_pin.x.keyframes.keys"]))
    assert list(keys)[-1] == pytest.approx(0.2) and list(keys.values())[-1] == pytest.approx(0.009)
    assert np.interp(0.03, list(keys), list(keys.values())) == pytest.approx(0.0005, abs=1e-12)
    again = run.scene.simulate(tmp_path / "again")
    assert again.x == pytest.approx(run.x, abs=1e-9)


def test_other_changes_are_told_and_the_run_is_not_continued(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run", fps=50) as recorder:
        one.run(0.05)
        one.change({"forces.gravity": [0, 0, -1.62]})
        one.step()
        one.step(0.005)
    (gravity, step) = recorder.run.summary["control"]
    assert gravity == {"what": "forces.gravity", "first": 0.05, "last": 0.05, "times": 1, "in_scene": False}
    assert step["what"] == "method.step"
    assert "changed by the program" in recorder.run.html()
    assert recorder.run.scene["forces.gravity"] == [0, 0, -9.81]
    (tmp_path / "run" / "summary.json").unlink()
    done = command("resume", "run", cwd=tmp_path)
    assert done.returncode == 4 and "recorded by a program" in done.stderr


def test_what_would_change_the_columns_is_refused(tmp_path):
    one = simulation()
    with pytest.raises(isosheet.RunFailed, match="`obstacle`") as caught:
        with one.record(tmp_path / "run"):
            one.step()
            one.change({"obstacle": [*one.scene["obstacle"], {"shape": {"sphere": {"radius": 0.01}},
                                                              "pose": {"position": [0, 0, 1]}}]})
            one.step()
    assert caught.value.advice and one.time == 0.01
    one.step()
    assert isosheet.Run(tmp_path / "run").summary["steps"] == 1


def test_poses_are_in_the_scene_and_make_the_motion_again(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run") as recorder:
        for k in range(1, 8):
            end, half = one.time + 0.02, 0.01 * k
            pin = {"position": [0.0005 * k, 0, 0.001 * k], "orientation": [np.cos(half), 0, np.sin(half), 0]}
            box = {"position": [0, 0, -0.05], "orientation": [np.cos(half), 0, 0, np.sin(half)]}
            one.drive({"support[0].hold.moving_pin": pin, "obstacle[0].motion": box}, until=end)
            one.run(end)
    run = recorder.run
    control = {done["what"]: done for done in run.summary["control"]}
    assert set(control) == {"support[0].hold.moving_pin", "obstacle[0].motion"}
    assert all(done["in_scene"] and done["times"] == 7 for done in control.values())
    last = run.scene["support[0].hold.moving_pin.poses.keys"][-1]
    assert last["time"] == pytest.approx(0.14) and last["position"] == pytest.approx([0.0035, 0, 0.007])
    again = run.scene.simulate(tmp_path / "again")
    assert again.x == pytest.approx(run.x, abs=1e-9)


def test_a_first_step_that_fails_leaves_a_page_that_says_so(tmp_path):
    one = simulation()
    one.drive({"support[0].hold.moving_pin.x": 1e9}, until=1e-3)
    with pytest.raises(isosheet.StepFailed) as caught:
        with one.record(tmp_path / "run"):
            one.step()
    run = isosheet.Run(tmp_path / "run")
    assert run.time == [0.0] and run.summary["steps"] == 0
    ending = run.summary["ending"]
    assert ending["reason"] == "error" and ending["failed"].startswith(caught.value.key)
    page = (tmp_path / "run" / "index.html").read_text()
    assert "the step after that failed" in page


def test_an_exception_leaves_what_was_computed(tmp_path):
    one = simulation()
    with pytest.raises(RuntimeError, match="enough"):
        with one.record(tmp_path / "run") as recorder:
            one.run(0.05)
            assert recorder.run.history["time"].size == 6 and recorder.run.summary is None
            raise RuntimeError("enough")
    run = isosheet.Run(tmp_path / "run")
    assert run.summary["ending"]["reason"] == "error" and run.summary["steps"] == 5
    assert (tmp_path / "run" / "index.html").is_file() and np.array_equal(run.x[-1], one.x)
    one.step()  # recorded no more
    assert isosheet.Run(tmp_path / "run").summary["steps"] == 5


@pytest.mark.parametrize("time", [0.0, 0.12])
def test_a_killed_loop_leaves_a_run_that_no_command_continues(time, tmp_path):
    program = (
        "import isosheet, os, sys\n"
        "scene = isosheet.Scene.from_toml(sys.argv[1])\n"
        "one = isosheet.Simulation(scene)\n"
        "one.record('run')\n"
        "one.run(float(sys.argv[2]))\n"
        "os._exit(9)\n"
    )
    (tmp_path / "scene.toml").write_text(SCENE)
    killed = subprocess.run([sys.executable, "-c", program, "scene.toml", str(time)], cwd=tmp_path)
    assert killed.returncode == 9
    assert isosheet.Run(tmp_path / "run").history["time"][-1] == pytest.approx(time)
    for again in (["resume", "run"], ["simulate", "scene.toml", "--out", "run"]):
        done = command(*again, "--quiet", cwd=tmp_path)
        assert done.returncode != 0 and "recorded by a program" in done.stderr, done.stderr
    assert not (tmp_path / "run" / "summary.json").exists()


def test_a_run_is_replaced_only_where_that_is_asked_for(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run"):
        one.step()
        with pytest.raises(ValueError, match="recorded in .* already"):
            one.record(tmp_path / "other")
    with pytest.raises(isosheet.RunFailed, match="holds a run") as caught:
        one.record(tmp_path / "run")
    assert "replace=True" in caught.value.advice
    with one.record(tmp_path / "run", replace=True) as recorder:
        one.step()
    # It does not have what went before.
    (before,) = recorder.run.summary["control"]
    assert before["what"] == "steps that were not recorded" and before["last"] == 0.01
    assert recorder.run.time[0] == 0.01
    for wrong in ({"fps": 10, "every": 2}, {"every": 0}):
        with pytest.raises(ValueError, match="every"):
            one.record(tmp_path / "third", **wrong)
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / "letter.txt").write_text("dear")
    with pytest.raises(isosheet.RunFailed, match="not the folder of a run"):
        one.record(tmp_path / "foreign", replace=True)
    with pytest.raises(isosheet.SceneError, match="frames_per_second"):
        one.record(tmp_path / "third", fps=-1)


def test_a_loop_without_steps_leaves_its_start(tmp_path):
    one = simulation()
    with one.record(tmp_path / "run") as recorder:
        pass
    assert recorder.run.time == [0.0] and recorder.run.summary is None
    with recorder.close().scene.edit({"stop.time": 0.01}) and one.record(tmp_path / "more") as more:
        one.step()
    assert more.close() is more.run
