"""Simulations: exact motions, forces, control, checkpoints, threads."""

import copy
import multiprocessing
import pickle
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

import isosheet

GRAVITY = 9.81


def hanging(**more):
    """A square that hangs by a corner, which can be moved."""
    return isosheet.Scene.from_dict(
        {
            "sheet": {"mesh": {"square": {"side": 0.2, "level": 1}}, "density": 0.08},
            "support": [{"at": {"vertices": [20]}, "hold": {"moving_pin": {}}}],
            "forces": {"gravity": [0, 0, -GRAVITY]},
            "method": {"step": 0.01},
            **more,
        }
    )


def test_a_free_sheet_falls_as_newton_says():
    """BDF2 is exact for constant accelerations but for its first step, which is one of implicit Euler: it begins as if
    1.5 g h^2 / 2 had been fallen before. Velocities are exact."""
    for h in (0.01, 0.0025):
        simulation = isosheet.Simulation(hanging(support=[], method={"step": h}))
        start = simulation.x
        reports = simulation.run(0.2)
        assert len(reports) == round(0.2 / h) and simulation.time == pytest.approx(0.2, abs=1e-14)
        fall = GRAVITY * (0.2**2 / 2 + 0.75 * h**2)
        assert simulation.x - start == pytest.approx(np.tile([0, 0, -fall], (25, 1)), abs=1e-12)
        assert simulation.v == pytest.approx(np.tile([0, 0, -GRAVITY * 0.2], (25, 1)), abs=1e-11)


def test_forces_balance_the_weight_at_rest():
    scene = hanging(sheet={"mesh": {"square": {"side": 0.2, "level": 0}}, "density": 0.08, "damping": 10.0},
                    support=[{"at": {"vertices": [6]}}])
    simulation = isosheet.Simulation(scene)
    simulation.run(6.0)
    weight = simulation.masses.sum() * GRAVITY
    assert weight == pytest.approx(0.08 * 0.2**2 * GRAVITY, rel=1e-12)
    assert list(simulation.pins) == [6]
    assert simulation.reactions[6] == pytest.approx([0, 0, weight], abs=1e-3 * weight)
    assert simulation.support_forces == pytest.approx(simulation.reactions[[6]], abs=1e-9 * weight)
    assert simulation.rod_forces.shape == simulation.rest_lengths.shape
    # The rods at the pin hold everything but the mass of the pin itself.
    at_pin = (simulation.edges == 6).any(axis=1)
    ends = simulation.x[simulation.edges[at_pin]]
    along = (ends[:, 1] - ends[:, 0]) / simulation.rest_lengths[at_pin, None]
    along *= np.where(simulation.edges[at_pin, :1] == 6, 1, -1)
    pull = (simulation.rod_forces[at_pin, None] * along).sum(axis=0)
    assert pull[2] == pytest.approx(-weight + simulation.masses[6] * GRAVITY, rel=1e-2)
    assert simulation.contact_forces is None and simulation.gap is None and simulation.gaps is None
    assert set(simulation.energies) == {"kinetic", "potential", "total"}


def test_reports_and_arrays_agree():
    simulation = isosheet.Simulation(hanging())
    report = simulation.step()
    assert report.h == 0.01 and report.time == simulation.time == 0.01
    assert report.total == report.kinetic + report.potential == simulation.energies["total"]
    assert report.strain == simulation.strain < 1e-11
    kinetic = 0.5 * (simulation.masses[:, None] * simulation.v**2).sum()
    assert report.kinetic == pytest.approx(kinetic, rel=1e-12)
    values = report.to_dict()
    assert values["path"] in ("newton", "globalised") and values["iterations"] == report.iterations > 0
    a, b = simulation.edges.T
    lengths = np.linalg.norm(simulation.x[a] - simulation.x[b], axis=1)
    assert lengths == pytest.approx(simulation.rest_lengths, rel=1e-11)
    x = simulation.x
    x[:] = 0.0
    assert np.abs(simulation.x).max() > 0.1, "arrays are copies"


def test_contact_has_forces_and_gaps():
    floor = {"shape": "half_space", "pose": {"position": [0, 0, -0.001]}}
    scene = hanging(support=[], obstacle=[floor])
    simulation = isosheet.Simulation(scene)
    simulation.run(0.3)
    weight = simulation.masses.sum() * GRAVITY
    assert 0 < simulation.gap < 1e-3 and simulation.gaps.shape == (25,)
    assert simulation.gaps.min() == pytest.approx(simulation.gap, rel=1e-12)
    assert simulation.contact_forces[:, 2].sum() == pytest.approx(weight, rel=0.1)
    assert simulation.obstacle_forces[0] == pytest.approx(-simulation.contact_forces.sum(axis=0), abs=1e-9)


def test_a_control_loop_holds_a_height():
    """The support follows the lowest vertex: an integral controller brings it to a height."""
    scene = hanging(sheet={"mesh": {"square": {"side": 0.2, "level": 0}}, "density": 0.08, "damping": 20.0},
                    support=[{"at": {"vertices": [6]}, "hold": {"moving_pin": {}}}])
    simulation = isosheet.Simulation(scene)
    simulation.run(6.0)
    goal = simulation.x[:, 2].min() + 0.03
    lift = 0.0
    for _ in range(60):
        lift += 0.2 * (goal - simulation.x[:, 2].min())
        end = simulation.time + 0.02
        simulation.drive({"support[0].hold.moving_pin.z": lift}, until=end)
        simulation.run(end)
        assert simulation.x[6, 2] == pytest.approx(lift, abs=1e-12), "the pin is where it was sent"
    assert simulation.x[:, 2].min() == pytest.approx(goal, abs=1e-4)
    assert lift == pytest.approx(0.03, abs=1e-3)


def test_gravity_and_loads_change_between_steps():
    """A free sheet gets the impulse of each phase: p = m g t, then F t."""
    load = {"at": "all", "direction": [1, 0, 0], "size": 0}
    simulation = isosheet.Simulation(hanging(support=[], forces={"gravity": [0, 0, -GRAVITY], "load": [load]}))
    mass = simulation.masses.sum()
    simulation.run(0.1)
    simulation.change({"forces.gravity": [0, 0, 0], "forces.load[0].size": 0.002})
    simulation.run(0.3)
    momentum = (simulation.masses[:, None] * simulation.v).sum(axis=0)
    assert momentum[2] == pytest.approx(-mass * GRAVITY * 0.1, rel=0.1)
    assert momentum[0] == pytest.approx(0.002 * 0.2, rel=0.05)
    assert simulation.scene["forces.gravity"] == [0, 0, 0]


def test_what_cannot_change_is_refused_and_changes_nothing():
    simulation = isosheet.Simulation(hanging())
    simulation.step()
    before = simulation.checkpoint()
    with pytest.raises(isosheet.SceneError) as caught:
        simulation.change({"method.integrator": "implicit_euler"})
    assert caught.value.key == "method" and "new simulation" in caught.value.advice
    with pytest.raises(isosheet.SceneError) as caught:
        simulation.change({"support[0].hold.moving_pin.z": 0.001})
    assert caught.value.key.startswith("support[0]")
    with pytest.raises(isosheet.SceneError, match="during a simulation") as caught:
        simulation.change({"sheet.density": 0.1})
    assert "checkpoint" not in str(caught.value)
    with pytest.raises(isosheet.SceneError, match="no function of time"):
        simulation.drive({"sheet.mesh": 1.0}, until=1.0)
    with pytest.raises(KeyError):
        simulation.drive({"support[": 1.0}, until=1.0)
    for h in (0, -0.01, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="positive length"):
            simulation.step(h)
    assert simulation.checkpoint() == before


def test_a_simulation_is_resumed_bit_for_bit():
    simulation = isosheet.Simulation(hanging())
    simulation.run(0.05)
    simulation.drive({"support[0].hold.moving_pin.x": 0.01}, until=0.1)
    simulation.step()
    bytes_ = simulation.checkpoint()
    assert isinstance(bytes_, bytes)
    resumed = isosheet.Simulation.resume(simulation.scene, bytes_)
    for one in (simulation, resumed):
        one.run(0.2)
    assert np.array_equal(simulation.x, resumed.x) and np.array_equal(simulation.v, resumed.v)
    with pytest.raises(isosheet.Error) as caught:
        isosheet.Simulation.resume(simulation.scene, bytes_[:-1])
    assert caught.value.advice
    with pytest.raises(isosheet.SceneError, match="masses"):
        isosheet.Simulation.resume(hanging(sheet={**simulation.scene["sheet"], "density": 0.1}), bytes_)


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_objects_are_copied_and_pickled(again):
    scene = hanging()
    assert again(scene).text == scene.text and again(scene).to_dict() == scene.to_dict()
    simulation = isosheet.Simulation(scene)
    report = simulation.step()
    assert again(report).to_dict() == report.to_dict()
    other = again(simulation)
    assert other is not simulation and other.time == simulation.time
    for one in (simulation, other):
        one.run(0.05)
    assert np.array_equal(simulation.x, other.x) and np.array_equal(simulation.v, other.v)
    mesh = isosheet.Mesh.generate("square", side=0.2, level=1)
    assert np.array_equal(again(mesh).vertices, mesh.vertices) and np.array_equal(again(mesh).faces, mesh.faces)


def turned(axis, angle):
    """The unit quaternion w, x, y, z of a rotation, and its matrix by the formula of Rodrigues."""
    n = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) * n)]), matrix


def test_a_hand_is_set_to_a_pose_in_each_control_step():
    clamp = {"box": {"min": [-1e-6, 0, 0], "max": [1e-6, 1, 0]}}
    poses = {"keys": [{"position": [0.0, 0.1, 0.05]}]}
    scene = hanging(
        sheet={"mesh": {"square": {"side": 0.2, "level": 1}}, "material": "office paper"},
        support=[{"at": clamp, "hold": {"moving_clamp": {"poses": poses}}}],
        obstacle=[{"name": "hand", "shape": {"box": {"size": [0.05] * 3}}, "pose": {"position": [0, 0, -1]}}],
    )
    simulation = isosheet.Simulation(scene)
    start, tool = simulation.x, np.array([0.0, 0.1, 0.05])
    held = np.flatnonzero(start[:, 0] < 1e-9)
    with_obstacle = {"obstacle[0].motion": {"position": [0.1, 0, -1], "orientation": [0.5, 0.5, 0.5, 0.5]}}
    for k in range(1, 9):
        q, matrix = turned([1, 2, -0.5], 0.03 * k)
        tool_now = tool + [0.001 * k, 0, 0.002 * k]
        pose = {"position": tool_now, "orientation": q if k % 2 else list(-q)}
        simulation.drive({"support[0].hold.moving_clamp": pose, **with_obstacle}, until=simulation.time + 0.01)
        simulation.step()
        assert simulation.x[held] == pytest.approx((start[held] - tool) @ matrix.T + tool_now, abs=1e-14)
    for wrong, says in (
        ([2, 0, 0, 0], "norm differs by 1 from 1"),
        ([np.nan, 0, 0, 0], "nan"),
        ([1, 0, 0], "no pose"),
    ):
        with pytest.raises(isosheet.SceneError, match=says) as caught:
            pose = {"position": [0, 0, 0], "orientation": wrong}
            simulation.drive({"obstacle[0].motion": pose}, until=simulation.time + 0.01)
        assert caught.value.key.startswith("obstacle[0].motion") and caught.value.advice
    with pytest.raises(isosheet.SceneError, match="no rigid motion"):
        simulation.drive({"obstacle[0].motion.x": {"position": [0, 0, 0]}}, until=1.0)
    simulation.step()


def test_a_failed_step_has_time_and_advice():
    simulation = isosheet.Simulation(hanging())
    simulation.step()
    # A hand that is faster than the sheet can follow within the smallest part of a step.
    simulation.drive({"support[0].hold.moving_pin.x": 1e9}, until=0.011)
    with pytest.raises(isosheet.StepFailed) as caught:
        simulation.step()
    assert 0.01 <= caught.value.time < 0.02 and caught.value.key is not None
    assert caught.value.advice
    assert simulation.time == caught.value.time


def test_a_run_ends_where_it_is_told():
    simulation = isosheet.Simulation(hanging())
    seen = []
    reports = simulation.run(0.035, each=lambda report: seen.append(report.time))
    assert [r.time for r in reports] == seen == pytest.approx([0.01, 0.02, 0.03, 0.035])
    assert len(simulation.run(1.0, each=lambda report: report.time > 0.05)) == 2
    assert simulation.run(0.01) == []
    with pytest.raises(ValueError, match="nan"):
        simulation.run(float("nan"))

    def fail(report):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        simulation.run(1.0, each=fail)


def test_ctrl_c_ends_a_run_and_it_goes_on():
    simulation = isosheet.Simulation(hanging())

    def interrupt(report):
        import signal

        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        simulation.run(1.0, each=interrupt)
    reached = simulation.time
    assert 0 < reached < 1.0
    simulation.run(reached + 0.02)


def test_other_threads_run_during_a_step():
    """Python changes threads where one waits or lets others run. This one does so in steps alone: while they lock the
    interpreter, the other thread counts nothing, in however many steps."""
    simulation = isosheet.Simulation(hanging())
    counted, stop = [], threading.Event()

    def count():
        while not stop.is_set():
            counted.append(len(counted))
            time.sleep(0)

    thread = threading.Thread(target=count)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(3600)
    try:
        thread.start()
        before, steps = len(counted), 0
        while len(counted) == before and steps < 1000:
            simulation.step()
            steps += 1
        within = len(counted) - before
    finally:
        stop.set()
        sys.setswitchinterval(interval)
        thread.join()
    assert within > 0


def test_a_simulation_that_threads_share_takes_their_steps_in_turn():
    simulation = isosheet.Simulation(hanging())
    threads = [threading.Thread(target=lambda: [simulation.step() for _ in range(5)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    alone = isosheet.Simulation(hanging())
    for _ in range(20):
        alone.step()
    assert np.array_equal(simulation.x, alone.x)


def positions_later(simulation):
    """For another thread or process."""
    simulation.run(0.1)
    return simulation.x


@pytest.mark.parametrize("executor", [
    ThreadPoolExecutor,
    lambda workers: ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")),
], ids=["threads", "processes"])
def test_executors_make_a_batch_of_runs_with_the_bits_of_one(executor):
    scenes = [hanging(sheet={"mesh": {"square": {"side": 0.2, "level": 1}}, "density": d}) for d in (0.06, 0.08, 0.1)]
    with executor(2) as pool:
        batch = list(pool.map(positions_later, map(isosheet.Simulation, scenes)))
    for scene, x in zip(scenes, batch, strict=True):
        assert np.array_equal(x, positions_later(isosheet.Simulation(scene)))
