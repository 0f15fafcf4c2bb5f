"""The same scene said otherwise gives the same numbers: every channel and criterion, to 1e-8 of its range.

Turned by 37 degrees, moved by a kilometre, renamed, in another order, in other units, and twice beside each other.
Where a number may differ by more, a `Reason` of the scene says by how much and why.
"""

from __future__ import annotations

import copy
import math
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parent))
import changed_scenes as changed

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.case.case_file import read_document
from heavylift.pipeline.case.repeat import expand
from tests.pipeline.judged import judged_criteria

ROOT = Path(__file__).resolve().parents[2]
R, BY = changed.about_vertical(math.radians(37.0)), [1000.0, 700.0, 0.0]
TOLERANCE = 1e-8
VARIANTS = ("turned", "moved", "reordered", "other units", "renamed", "doubled")


class Reason(NamedTuple):
    """By how much channels may differ in some variants, and why."""

    variants: str
    channels: str
    bound: float
    why: str


class Scene(NamedTuple):
    """A case, how long it runs, what is added and what goes, variants that it cannot have and why, and reasons."""

    folder: str
    duration: str
    add: Mapping[str, Any] = MappingProxyType({})
    without: tuple[str, ...] = ()
    cannot: Mapping[str, str] = MappingProxyType({})
    reasons: tuple[Reason, ...] = ()


SLINGS = [f"sling_{k}" for k in range(1, 5)]
OF_SLINGS = [
    {"name": "slings", "type": "sling", "ropes": SLINGS, "breaking_load": "1 MN", "termination_factor": 1.25},
    {"name": "angles", "type": "sling_angle", "ropes": SLINGS},
    {"name": "shackles", "type": "shackle", "ropes": SLINGS, "working_load_limit": "55 t"},
    {"name": "taut", "type": "slack", "ropes": SLINGS},
    {"name": "level", "type": "tilt", "body": "module", "maximum": "2 deg"},
]
WAVES = {
    "moved": "the phase of a wave belongs to a place",
    "doubled": "the phase of a wave belongs to a place",
}
PHASES = {"doubled": "a phase names what it moves"}
HEADINGS = Reason(
    "turned", r".*", 2e-3, "wave forces are interpolated between headings in the world, in cells of some degrees"
)  # fmt: skip
SHARES = Reason(
    ".*", r".*\.(largest_force|force|normal_force_m..|contact_\d+\..*)", math.inf,
    "more contacts than needed share a force, and friction at its limit, as they are found",
)  # fmt: skip
NUMBERS = Reason(".*", r".*\.contact_\d+\..*", math.inf, "contacts of a pair are numbered as they are found")
FITTED = Reason(
    "turned|moved|reordered|doubled", r".*", 5e-7,
    "friction, stops and oil are fitted by iteration until a force changes by a millionth of the largest in the scene",
)  # fmt: skip
RESTS = Reason(
    "moved|doubled", r".*(velocity|rate|momentum).*", 5e-6,
    "it hangs almost at rest, and the equilibrium that it starts from is found to 1e-9 of the weights",
)  # fmt: skip
SCENES = {
    "lift": Scene("pipeline/templates/lift", "5 s", add={"criteria": OF_SLINGS}),
    "hoist": Scene("cases/hoist", "5 s"),
    "tugger": Scene("cases/tugger", "1 s"),
    "joints": Scene("cases/zoo_limits_friction", "0.9 s", reasons=(FITTED,)),
    "pulleys": Scene("cases/pulleys_with_efficiency", "1 s", reasons=(FITTED,)),
    "equalizer": Scene("cases/equalizer", "3 s", reasons=(FITTED,)),
    "gantry": Scene(
        "cases/gantry_lift", "5 s", cannot={"turned": "its girder lies along x"}, reasons=(FITTED, RESTS)
    ),
    "crane afloat": Scene("cases/floating_crane_lift", "10 s", cannot=WAVES, reasons=(HEADINGS,)),
    "load-out": Scene("cases/load_out_level", "60 s", without=("ballast",), reasons=(FITTED,)),
    "bumpy road": Scene("cases/spmt_warp", "5 s", reasons=(FITTED,)),
    "falling box": Scene("cases/box_drop", "0.8 s", reasons=(NUMBERS,)),
    "incline": Scene("cases/incline", "1 s", reasons=(SHARES, FITTED)),
    "rocking": Scene("cases/rocking_block", "2 s", reasons=(NUMBERS,)),
    "phases": Scene("cases/staged_lift", "30 s", cannot=PHASES, reasons=(SHARES,)),
    "moored": Scene("cases/irregular_sea", "60 s", cannot=WAVES, reasons=(HEADINGS,)),
    "plate": Scene("cases/thin_plate_lift", "1 s", cannot={"turned": "points of its mesh are in the world"}),
}
QUICK = ("lift", "tugger", "joints", "bumpy road")
"""What the default run has: a second each."""


def document_of(scene: Scene) -> tuple[dict[str, Any], Path]:
    """The scene with its blocks written out, and the file it comes from."""
    file = ROOT / scene.folder / "case.toml"
    document = copy.deepcopy(expand(read_document(file), file).document)
    for key in ("reference", "converge", "report", "check", "repeat", "parameters", *scene.without):
        document.pop(key, None)
    document["simulate"]["duration"] = scene.duration
    return document | copy.deepcopy(dict(scene.add)), file


def outcome_of(document: dict[str, Any], file: Path, folder: Path) -> tuple[Any, dict[str, float]]:
    """Records of a run, and what is used of each line of its criteria."""
    case = load_case(changed.written(document, folder, file))
    report = run_case(case, stages=("mesh", "modes", "simulate"))
    phases = document.get("scenario")
    assert report.outcome in ({Outcome.COMPLETED, Outcome.PHASES_LEFT} if phases else {Outcome.COMPLETED}), (
        report.message
    )
    lines = judged_criteria(case, report.folder.root) if case.criteria else []
    return load_results(case), {
        f"{line.name} {number}": float(line.value) for number, line in enumerate(lines)
    }


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Runs of the scenes as they are, made once."""
    made: dict[str, Any] = {}

    def run(name: str):
        if name not in made:
            document, file = document_of(SCENES[name])
            made[name] = outcome_of(document, file, tmp_path_factory.mktemp("as_it_is") / file.parent.name)
        return made[name]

    return run


def follows(name: str, variant: str, found: list[changed.Difference]) -> None:
    """Every channel is what it must be, or within the bound of a reason."""
    reasons = [one for one in SCENES[name].reasons if re.fullmatch(one.variants, variant)]
    for channel, error in found:
        bound = max([TOLERANCE, *(one.bound for one in reasons if re.fullmatch(one.channels, channel))])
        assert error <= bound, f"{channel}: {error:.2g} of its range, {bound:g} is allowed"


SOME = [
    pytest.param(name, variant, marks=() if name in QUICK else pytest.mark.slow)
    for name, scene in SCENES.items()
    for variant in VARIANTS
    if variant not in scene.cannot
]


@pytest.mark.parametrize(("name", "variant"), SOME)
def test_channels_and_criteria_follow(name, variant, runs, tmp_path):
    document, file = document_of(SCENES[name])
    before, criteria = runs(name)
    folder = tmp_path / file.parent.name
    ways: dict[str, Any] = {}
    if variant == "turned":
        document, ways = changed.turned(document, R), {"R": R}
    elif variant == "moved":
        document, ways = changed.moved(document, BY), {"move": np.array(BY)}
    elif variant == "reordered":
        document = changed.reordered(document)
    elif variant == "other units":
        other = changed.in_other_units(document)
        assert other != document
        document = other
    elif variant == "renamed":
        document, change = changed.renamed(document, "q")
        ways = {"name": change}
    else:
        document, change = changed.doubled(document, BY)
        ways = {"copies": 2}
    after, judged = outcome_of(document, file, folder)
    follows(name, variant, list(changed.differences(before, after, **ways)))
    if variant == "doubled":
        ways = {"copies": 2, "name": change, "move": np.array(BY)}
        follows(name, variant, list(changed.differences(before, after, **ways)))
    loose = [
        one.bound
        for one in SCENES[name].reasons
        if re.fullmatch(one.variants, variant) and math.isfinite(one.bound)
    ]
    for (line, value), (_, other) in zip(criteria.items(), judged.items(), strict=variant != "doubled"):
        np.testing.assert_allclose(other, value, rtol=max([TOLERANCE, *loose]), atol=1e-9, err_msg=line)


def test_a_fault_of_a_millionth_is_found(runs, tmp_path):
    """Of the scenes that run quickly: one mass changed by a millionth is no invariance."""
    document, file = document_of(SCENES["lift"])
    document["bodies"]["module"]["mass"] = "100.0001 t"
    after, _ = outcome_of(document, file, tmp_path / "lift")
    assert max(one.error for one in changed.differences(runs("lift")[0], after)) > 1e-7
