"""Files, pictures, plots and pages of runs and simulations."""

import struct
import webbrowser

import numpy as np
import pytest

import isosheet


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    scene = isosheet.Scene.new("hanging", {"stop.time": 0.2})
    scene = scene.edit({"measure": [{"name": "tip", "at": {"vertices": [0]}, "quantity": "z"}]})
    return scene.simulate(tmp_path_factory.mktemp("runs") / "run")


def png(path):
    """Width and height of a PNG file, and the names of its chunks."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, names = 8, []
    while place < len(data):
        (length,) = struct.unpack(">I", data[place : place + 4])
        names.append(data[place + 4 : place + 8])
        place += 12 + length
    return struct.unpack(">II", data[16:24]), names


@pytest.mark.parametrize("extension", ["usda", "glb", "pvd", "pc2", "obj", "fold", "csv", "npz"])
def test_a_run_is_saved_in_all_formats(run, tmp_path, extension):
    files = run.save(tmp_path / f"file.{extension}")
    assert files and all(file.is_file() and file.stat().st_size > 0 for file in files)


def test_every_second_frame_is_saved(run, tmp_path):
    run.save(tmp_path / "half.npz", every=2)
    half = np.load(tmp_path / "half.npz")
    assert np.array_equal(half["t"], run.time[::2]) and np.array_equal(half["x"], run.x[::2])
    with pytest.raises(ValueError, match="is a file of the run"):
        run.save(run.folder / "history.csv")
    with pytest.raises(ValueError, match="no frame near"):
        run.save(tmp_path / "late.obj", time=100)
    with pytest.raises(isosheet.Error, match="no format"):
        run.save(tmp_path / "run.xyz")
    with pytest.raises(isosheet.Error):
        run.save(tmp_path / "none.npz", every=0)


def test_one_frame_is_saved_by_number_or_time(run, tmp_path):
    for k, choice in ((0, {"frame": 0}), (-1, {"frame": -1}), (2, {"time": run.time[2] + 1e-4}), (-1, {"time": run.time[-1] + 1e-4})):
        (file,) = run.save(tmp_path / "one.ply", **choice)
        assert isosheet.Mesh.read(file).vertices == pytest.approx(run.x[k], abs=1e-6)
    # As the command has it: of two that are as near the later one.
    (file,) = run.save(tmp_path / "between.ply", time=float(np.mean(run.time[1:3])))
    assert isosheet.Mesh.read(file).vertices == pytest.approx(run.x[2], abs=1e-6)
    run.picture(tmp_path / "timed.png", time=run.time[1], height=100)
    run.picture(tmp_path / "numbered.png", 1, height=100)
    assert (tmp_path / "timed.png").read_bytes() == (tmp_path / "numbered.png").read_bytes()
    with pytest.raises(IndexError, match="no frame 99"):
        run.save(tmp_path / "none.obj", frame=99)
    for wrong in ({"time": float("nan")}, {"frame": 0, "time": 0.0}, {"frame": 0, "fps": 10}, {"time": 0.0, "every": 2}):
        with pytest.raises(ValueError):
            run.save(tmp_path / "none.obj", **wrong)
    assert not (tmp_path / "none.obj").exists()


def test_pictures_and_films(run, tmp_path, monkeypatch):
    run.picture(tmp_path / "end.png", height=200, view=(30, 40))
    run.picture(tmp_path / "same.png", run.time.size - 1, height=200, view=(30, 40))
    (width, height), names = png(tmp_path / "end.png")
    assert height == 200 and width > 0 and b"acTL" not in names
    assert (tmp_path / "end.png").read_bytes() == (tmp_path / "same.png").read_bytes()
    run.picture(tmp_path / "strain.png", height=200, colour="strain", range=(1e-6, 1e-2))
    assert png(tmp_path / "strain.png")[0][1] == 200
    assert (tmp_path / "strain.png").read_bytes() != (tmp_path / "end.png").read_bytes()
    for wrong, words in (({"colour": "warmth"}, "no quantity `warmth`.*`height`"), ({"range": (0, 1)}, "no quantity")):
        with pytest.raises(isosheet.Error, match=words):
            run.picture(tmp_path / "none.png", **wrong)
    run.film(tmp_path / "film.apng", every=2, height=100)
    (_, height), names = png(tmp_path / "film.apng")
    assert height == 100 and names.count(b"fcTL") == len(run.time[::2])
    for frame in (run.time.size, -run.time.size - 1):
        with pytest.raises(IndexError, match="no frame"):
            run.picture(tmp_path / "none.png", frame)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(isosheet.Error, match="ffmpeg"):
        run.film(tmp_path / "film.mp4")
    with pytest.raises(ValueError, match="ffmpeg"):
        run.film(tmp_path / "film.txt")
    with pytest.raises(ValueError, match="every is 0"):
        run.film(tmp_path / "film.apng", every=0)
    with pytest.raises(isosheet.Error, match="elevation"):
        run.picture(tmp_path / "none.png", view=(0, 100))
    assert not (tmp_path / "none.png").exists()


def test_pages_open_in_the_browser(run, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    simulation = isosheet.Simulation(run.scene)
    simulation.step()
    for one in (run, simulation):
        page = one.show()
        assert opened.pop() == page.as_uri() and page.read_text() == one.html()
        page.unlink()
    assert simulation._repr_html_().startswith("<iframe srcdoc=")


class Axes:
    """What matplotlib has."""

    def __init__(self):
        self.lines = {}

    def plot(self, time, values, label):
        assert len(time) == len(values)
        self.lines[label] = values

    def set_xlabel(self, text):
        assert text == "time, s"

    def set_ylabel(self, text):
        self.ylabel = text

    def legend(self):
        pass


def test_plots(run):
    axes = Axes()
    assert run.plot(ax=axes) is axes and list(axes.lines) == ["tip"] and axes.ylabel == "tip, m"
    assert run.plot("kinetic", "total", ax=axes).ylabel == "J" and "kinetic" in axes.lines
    assert run.plot("strain", ax=axes).ylabel == "strain"
    run.plot("tip", "total", "support[0]", ax=axes)
    assert axes.ylabel == "" and run.units["support[0]"] == "N"
    assert np.array_equal(axes.lines["tip, m"], run.measures["tip"])
    assert axes.lines["support[0], N"] == pytest.approx(np.linalg.norm(run.loads["support[0]"]["force"], axis=1))
    with pytest.raises(KeyError, match="no 'speed'; it has tip, time"):
        run.plot("speed", ax=axes)


def test_plots_need_matplotlib(run, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib", None)
    with pytest.raises(ModuleNotFoundError, match="pip install matplotlib"):
        run.plot()
