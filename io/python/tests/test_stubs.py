"""The stubs name what the module has, and everything has a docstring."""

import ast
import doctest
import inspect
import json
from pathlib import Path

import pytest

import isosheet
from isosheet import _isosheet

STUBS = Path(isosheet.__file__).with_name("_isosheet.pyi")
NAMED = ("__new__", "__getitem__", "__enter__", "__exit__", "_repr_html_")


def public(names):
    """Names for users, and those by which Python calls methods."""
    return {name for name in names if not name.startswith("_") or name in NAMED}


def test_stubs_have_the_names_of_the_module():
    stubs = {node.name: node for node in ast.parse(STUBS.read_text()).body if hasattr(node, "name")}
    assert public(vars(_isosheet)) == public(stubs)
    assert set(isosheet.__all__) == public(vars(_isosheet)) - {"command"} | {"__version__"}
    for name, node in stubs.items():
        if not isinstance(node, ast.ClassDef) or name.startswith("_"):
            continue
        members = [m.name if hasattr(m, "name") else m.target.id for m in node.body if not isinstance(m, ast.Expr)]
        kind = getattr(_isosheet, name)
        found = public(vars(kind)) - (set() if "__new__" in members else {"__new__"})
        if issubclass(kind, Exception) and kind is not isosheet.Error:
            found = set()
        assert found == set(members), name
        for member in public(vars(kind)) - {*NAMED, "key", "time", "advice", "problems"}:
            assert getattr(kind, member).__doc__, f"{name}.{member} has no docstring"
        assert kind.__doc__, name


def test_scenes_are_completed_with_the_keys_of_the_schema():
    schema = json.loads((Path(__file__).parents[3] / "docs" / "scene.schema.json").read_text())
    keys = set(schema["properties"]) | {"folder"}
    assert set(inspect.signature(isosheet.Scene).parameters) == keys
    scene = next(node for node in ast.parse(STUBS.read_text()).body if getattr(node, "name", "") == "Scene")
    new = next(member for member in scene.body if member.name == "__new__")
    assert {argument.arg for argument in new.args.kwonlyargs} == keys


@pytest.mark.parametrize("name", sorted(set(isosheet.__all__) - {"__version__", "materials"}))
def test_each_class_has_an_example_that_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = inspect.getdoc(getattr(isosheet, name))
    test = doctest.DocTestParser().get_doctest(text, {"isosheet": isosheet}, name, None, 0)
    assert test.examples
    assert doctest.DocTestRunner().run(test).failed == 0
