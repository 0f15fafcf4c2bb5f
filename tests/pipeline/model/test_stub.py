"""The types that editors see are those of the sections."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import heavylift as hl
from heavylift.pipeline.model.components import component_class, component_names
from heavylift.pipeline.model.stub import stub_text
from heavylift.pipeline.model.words import key_lines

STUB = Path(hl.__file__).with_suffix(".pyi")


def test_the_stub_is_current():
    """Else: `heavylift schema --python > heavylift/__init__.pyi`."""
    assert STUB.read_text(encoding="utf-8") == stub_text()


def test_all_names_are_there_and_in_the_stub():
    (listed,) = [
        ast.literal_eval(node.value)
        for node in ast.parse(STUB.read_text(encoding="utf-8")).body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__"
    ]
    assert listed == hl.__all__
    assert set(listed) <= set(dir(hl))
    for name in listed:
        assert getattr(hl, name).__name__ == name
    names = component_names()
    assert len(set(names)) == len(names) > 60
    assert not set(names) & set(vars(hl)["_HOMES"])
    assert not hasattr(hl, "Nothing")


def test_every_class_says_what_its_keys_are():
    for name in component_names():
        made = component_class(name)
        first, *_ = made.__doc__.splitlines()
        assert first.endswith((".", ":")), (name, first)
        shown = set(inspect.signature(made).parameters)
        keys = {key for key, _, _ in key_lines(made)}
        assert shown <= keys, name
        assert {key for key in keys - shown if key.isidentifier()} <= {"name"}, name
        missing = [key for key, _, words in key_lines(made) if not words]
        assert missing == [], (name, missing)
