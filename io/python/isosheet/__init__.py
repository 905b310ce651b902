"""isosheet simulates sheets that bend and crease and do not stretch: paper, sheet metal, plastic film, cloth.

A scene (`Scene`) has the keys of scene files. A `Simulation` moves it step by step, a `Run` reads what the
command ``isosheet simulate`` or `Scene.simulate` wrote. Arrays are numpy arrays; units are metres, seconds,
kilograms and newtons, angles in scenes are in degrees.

    >>> import isosheet
    >>> scene = isosheet.Scene.new("hanging", {"stop.time": 0.1})
    >>> simulation = isosheet.Simulation(scene)
    >>> report = simulation.step()
    >>> report.strain < 0.01
    True
"""

from ._isosheet import (
    Error,
    Mesh,
    Recorder,
    Run,
    RunFailed,
    Scene,
    SceneError,
    Simulation,
    StepFailed,
    StepReport,
    __version__,
    materials,
)

__all__ = [
    "Error",
    "Mesh",
    "Recorder",
    "Run",
    "RunFailed",
    "Scene",
    "SceneError",
    "Simulation",
    "StepFailed",
    "StepReport",
    "__version__",
    "materials",
]
