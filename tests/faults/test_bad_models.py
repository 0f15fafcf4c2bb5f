"""Whatever a program gives as values of components, and does to a model, is right or one clear error."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline.case.errors import known_keys
from heavylift.pipeline.model.components import component_class, component_names

CASES = Path(__file__).parents[2] / "cases"
POINT = {"body": "ground", "point": [0, 0, 1]}
VALUES = [
    *(None, math.nan, math.inf, -1, 0, 1, 2.5, 10**400, True, np.float32(1.0)),
    *("x", "", "5 m", "3 kN", "ground", "b", "a\nb", "\x00", "é" * 500, b"a"),
    *(
        {},
        [],
        [1, 2, 3],
        [[1, 2, 3]] * 3,
        np.eye(3),
        np.array([1.0, np.nan, 3.0]),
        {1, 2},
        [None],
        ("b", "ground"),
    ),
    *({"motion": "free"}, {"a": {"b": [1]}}, {1: 2}, {"times": [0, 1], "speeds": [0, 1]}, [POINT, POINT]),
    *(object(), len, hl.RigidBody, hl),
]
NAMES = ["n1", "n2", "b", "a b", "", 3, None, "ground"]


def told(call) -> bool:
    """Whether a call is refused, in words."""
    words = None
    try:
        call()
    except hl.InputError as error:
        words = str(error)
    assert words is None or (words.strip() and "\n\n" not in words)
    return words is not None


@pytest.mark.parametrize("seed", range(3))
def test_components_of_wrong_values(seed):
    chance = random.Random(seed)  # noqa: S311
    refused = 0
    for name in component_names():
        made = component_class(name)
        keys = sorted(known_keys([made.SECTION]) - {made.TABLE.label})
        given = {key: chance.choice(VALUES) for key in keys if chance.random() < 0.5}
        first = [] if made.TABLE.form == "single" else [chance.choice(NAMES)]
        model = hl.Model("Anything")
        model.add(hl.RigidBody("b", mass=1, inertia=[1, 1, 1], frame={"motion": "free"}))

        def use(made=made, first=first, given=given, model=model):
            model.add(made(*first, **given))
            model.case()

        refused += told(use)
    assert refused > 0.9 * len(component_names())


def paths(node, above=()):
    """Dotted keys of a document, as parts."""
    pairs = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in pairs:
        yield (*above, str(key))
        yield from paths(value, (*above, str(key)))


@pytest.mark.parametrize("name", ["hoist", "staged_lift", "zoo_loads"])
def test_changes_of_a_case_that_make_no_sense(name, tmp_path):
    chance = random.Random(name)  # noqa: S311
    case = hl.load(CASES / name)
    for round_ in range(12):
        model = case.copy()
        for _ in range(3):
            labels = [one._own_name or one.TABLE.key for one in model]
            key = ".".join(chance.choice(list(paths(model.document))))
            change = chance.choice(
                [
                    lambda key=key, model=model: model.set(key, chance.choice(VALUES)),
                    lambda labels=labels, model=model: model.remove(chance.choice(labels)),
                    lambda labels=labels, model=model: model.rename(
                        chance.choice(labels), chance.choice(["z", "a b"])
                    ),
                    lambda model=model: setattr(chance.choice(list(model)), "name", chance.choice(VALUES)),
                ]
            )
            told(change)
        if told(model.case):
            continue
        file = model.save(tmp_path / str(round_))
        found = hl.load(file).document
        assert json.dumps(found, sort_keys=True) == json.dumps(model.document, sort_keys=True)
