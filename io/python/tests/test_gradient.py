"""Gradients of runs by keys of their scenes."""

import numpy
import pytest

import isosheet

KEYS = ["forces.gravity[1]", "sheet.damping"]


def scene(edits=None):
    found = isosheet.Scene(
        sheet={"mesh": {"square": {"side": 0.2, "level": 1}}, "material": "office paper", "damping": 1.0},
        support=[{"at": {"nearest": [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0]]}}],
        forces={"gravity": [0.0, 0.3, -9.81]},
        method={"step": 0.01},
        stop={"time": 0.05},
    )
    return found.edit(edits or {})


def height(times, positions):
    assert times.shape == (6,) and positions.shape == (6, 25, 3)
    slopes = numpy.zeros_like(positions)
    slopes[-1, 24, 2] = 1.0
    return positions[-1, 24, 2], slopes


def test_a_gradient_is_that_of_differences():
    value, slopes = scene().gradient(height, of=KEYS)
    assert list(slopes) == KEYS
    for key, at in zip(KEYS, (0.3, 1.0)):
        h = 1e-3 * at
        up, down = (scene({key: at + s * h}).gradient(height, of=[])[0] for s in (1, -1))
        assert abs((up - down) / (2 * h) - slopes[key]) < 1e-3 * abs(slopes[key])
        assert down != value != up


def test_what_cannot_be_differentiated_is_refused():
    with pytest.raises(isosheet.Error, match="sheet.material"):
        scene().gradient(height, of=["sheet.material"])
    with pytest.raises(ValueError, match="shape"):
        scene().gradient(lambda t, x: (0.0, x[1:].copy()), of=KEYS)
    with pytest.raises(ValueError, match="refuse"):
        scene().gradient(height, of=KEYS, branches="no")
    with pytest.raises(ZeroDivisionError):
        scene().gradient(lambda t, x: 1 / 0, of=KEYS)


def test_a_loss_of_velocities_forces_and_energies():
    def loss(times, positions, velocities, forces, energies):
        slopes = [numpy.zeros_like(own) for own in (positions, velocities, forces, energies)]
        slopes[1][-1, 3, 2], slopes[2][:, :, 2], slopes[3][-1] = 1.0, 0.1, (2.0, 3.0)
        value = velocities[-1, 3, 2] + 0.1 * forces[..., 2].sum() + energies[-1] @ (2.0, 3.0)
        return value, *slopes

    also = ["velocities", "support_forces", "energies"]
    value, slopes = scene().gradient(loss, of=KEYS, also=also)
    for key in KEYS:
        at = scene()[key]
        h = 1e-4 * abs(at)
        up, down = (scene({key: at + s * h}).gradient(loss, of=[], also=also)[0] for s in (1, -1))
        assert slopes[key] == pytest.approx((up - down) / (2 * h), rel=1e-4)


def test_the_forces_of_supports_carry_the_weight_at_rest():
    still = scene({"method.integrator": "static", "stop.time": 1.0})

    def lifted(times, positions, forces):
        slopes = numpy.zeros_like(forces)
        slopes[-1, :, 2] = 1.0
        return forces[-1, :, 2].sum(), numpy.zeros_like(positions), slopes

    value, slopes = still.gradient(lifted, of=["forces.gravity[2]"], also=["support_forces"])
    mass = -value / scene()["forces.gravity[2]"]
    assert mass > 0.0 and slopes["forces.gravity[2]"] == pytest.approx(-mass, rel=1e-6)


def test_what_a_loss_gets_and_returns_is_checked():
    with pytest.raises(ValueError, match="sheet.density"):
        scene().gradient(height, of=KEYS, sizes={"sheet.density": 1.0})
    with pytest.raises(ValueError, match="positive"):
        scene().gradient(height, of=KEYS, sizes={KEYS[0]: 0.0})
    with pytest.raises(ValueError, match="velocities"):
        scene().gradient(height, of=KEYS, also=["speed"])
    with pytest.raises(ValueError, match="returns 2 values"):
        scene().gradient(lambda t, x, v: (0.0, x), of=KEYS, also=["velocities"])
    with pytest.raises(ValueError, match="by energies"):
        scene().gradient(lambda t, x, e: (0.0, 0 * x, e[:, 0]), of=KEYS, also=["energies"])


def test_the_size_of_a_place():
    ball = {"shape": {"sphere": {"radius": 0.05}}, "pose": {"position": [0.1, 0.1, -0.0503]}}
    edits = {"obstacle": [ball], "contact": {"friction": 0.3}, "stop.time": 0.1}
    key = "obstacle[0].pose.position[2]"

    def corner(times, positions):
        slopes = numpy.zeros_like(positions)
        slopes[-1, 24, 2] = 1.0
        return positions[-1, 24, 2], slopes

    _, slopes = scene(edits).gradient(corner, of=[key], sizes={key: 1e-4})
    up, down = (
        scene({**edits, key: -0.0503 + s}).gradient(corner, of=[])[0] for s in (1e-7, -1e-7)
    )
    assert slopes[key] == pytest.approx((up - down) / 2e-7, rel=1e-2)


def test_arrays_of_whole_numbers_lists_and_one_name_will_do():
    def one(times, positions):
        slopes = numpy.zeros(positions.shape, dtype=int)
        slopes[-1, 24, 2] = 1
        return [positions[-1, 24, 2], slopes]

    _, slopes = scene().gradient(one, of=KEYS[0])
    assert slopes == {KEYS[0]: scene().gradient(height, of=KEYS)[1][KEYS[0]]}
    with pytest.raises(ValueError, match="NaN"):
        scene().gradient(lambda t, x: (float("nan"), 0 * x), of=KEYS)
    with pytest.raises(isosheet.Error, match="no derivative"):
        scene().gradient(height, of="stop.time")
