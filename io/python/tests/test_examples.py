"""The notebooks run from start to end, and the samples of the book too."""

import re
from pathlib import Path

import pytest

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
