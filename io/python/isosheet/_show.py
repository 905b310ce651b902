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
    names, known_units = names or list(measures) or ["kinetic", "potential", "total"], run.units
    for name in names:
        if name not in known_units:
            known = ", ".join([*measures, *history, *loads])
            raise KeyError(f"the run has no {name!r}; it has {known}")
    units = {name: known_units[name] for name in names}
    # One unit is that of the axis; of several each curve has its own.
    one = set(units.values()) if len(set(units.values())) == 1 else set()
    for name, unit in units.items():
        label = name if one or not unit else f"{name}, {unit}"
        if name in measures:
            ax.plot(history["time"][: measures[name].size], measures[name], label=label)
        elif name in history:
            ax.plot(history["time"], history[name], label=label)
        else:
            ax.plot(loads[name]["time"], np.linalg.norm(loads[name]["force"], axis=1), label=label)
    ax.set_xlabel("time, s")
    what = [list(units)[0] if len(units) == 1 else "", *one]
    ax.set_ylabel(", ".join(part for part in what if part))
    ax.legend()
    return ax
