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
