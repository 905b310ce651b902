"""The stubs name what the module has, and everything has a docstring."""

import ast
from pathlib import Path

import isosheet
from isosheet import _isosheet

STUBS = Path(isosheet.__file__).with_name("_isosheet.pyi")


def public(names):
    """Names for users, and those by which Python calls methods."""
    return {name for name in names if not name.startswith("_") or name in ("__new__", "__getitem__", "_repr_html_")}


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
        for member in public(vars(kind)) - {"__new__", "key", "time", "advice", "problems"}:
            assert getattr(kind, member).__doc__, f"{name}.{member} has no docstring"
        assert kind.__doc__, name
