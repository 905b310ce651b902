"""What `Run` and `Simulation` show by means of Python."""

import os
import tempfile
import webbrowser
from pathlib import Path

import numpy as np


def show(page):
    """Opens a page in the browser; returns its file.

    It is in the folder of temporary files and stays there, because the browser reads it later."""
    number, path = tempfile.mkstemp(prefix="isosheet-", suffix=".html")
    with os.fdopen(number, "w", encoding="utf-8") as file:
        file.write(page)
    webbrowser.open(Path(path).as_uri())
    return Path(path)


def plot(run, names, ax):
    """Plots quantities of a run over time; returns the axes."""
    if ax is None:
        try:
            from matplotlib import pyplot
        except ImportError as error:
            message = "Run.plot needs matplotlib, which is no part of isosheet: pip install matplotlib"
            raise ModuleNotFoundError(message, name="matplotlib") from error
        ax = pyplot.gca()
    history, measures, loads = run.history, run.measures, run.loads
    for name in names or list(measures) or ["kinetic", "potential", "total"]:
        if name in measures:
            values = measures[name]
            ax.plot(history["time"][: values.size], values, label=name)
        elif name in history:
            ax.plot(history["time"], history[name], label=name)
        elif name in loads:
            load = loads[name]
            ax.plot(load["time"], np.linalg.norm(load["force"], axis=1), label=name)
        else:
            known = ", ".join([*measures, *history, *loads])
            raise KeyError(f"the run has no {name!r}; it has {known}")
    ax.set_xlabel("time, s")
    ax.legend()
    return ax
