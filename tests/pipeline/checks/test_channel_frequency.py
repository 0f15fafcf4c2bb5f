"""The frequency of a channel is that of a sinusoid about any mean; one component must be named."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.results.histories import ChannelInfo, Results

TIMES = 0.02 * np.arange(251)


@pytest.fixture
def evaluate(tmp_path):
    folder = tmp_path / "linkage"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "linkage.toml", folder / "case.toml")
    case = load_case(folder)
    swing = 3e-4 * np.sin(2.0 * np.pi * 0.606 * TIMES + 0.4) - 1e-4
    columns = {
        "hook.position": np.column_stack([1.35 + 0.01 * TIMES, swing, 0.0 * TIMES]),
        "foot.angle": (2.0 + np.cos(2.0 * np.pi * 1.25 * TIMES))[:, None],
    }
    infos = {
        "hook.position": ChannelInfo("hook.position", "m", ("x", "y", "z"), 0),
        "foot.angle": ChannelInfo("foot.angle", "rad", ("angle",), 3),
    }
    quantities = Quantities(case, folder / "out")
    quantities.__dict__["results"] = Results(Path("results.h5"), TIMES, infos, columns, {})
    return quantities.number


def test_a_component_and_a_single_number(evaluate):
    assert evaluate("frequency.hook.position.y") == pytest.approx(0.606, rel=1e-9)
    assert evaluate("frequency.foot.angle") == pytest.approx(1.25, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("frequency.hook.position", r"hook\.position.*COMPONENT, one of: x, y, z"),
        ("frequency.hook.position.w", "a component: x, y, z"),
        ("frequency.hook.position.z", "do not oscillate"),
        ("frequency.hook", r"frequency\.OWNER\.KIND"),
        ("frequency.hook.tension", "a channel of 'hook'"),
        ("frequencies.hook.position.y", "did you mean 'frequency'"),
    ],
)
def test_what_cannot_be_computed_says_why(evaluate, text, words):
    with pytest.raises(InputError, match=words):
        evaluate(text)
