"""Names of interfaces stand for their reference points, wherever a point of a body does."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from heavylift.numerics.outcome import InputErrors
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.case.interface_names import put_interface_points

LUG, PAD = ["1 m", 0, "2 m"], [0.5, 0.5, 0]
BODIES = {
    "block": {
        "type": "flexible",
        "interfaces": {"LUG": {"at": LUG, "radius": 0.1}, "PAD": {"at": PAD}, "EDGE": {"group": "edge"}},
    },
    "hook": {"type": "rigid"},
}


def put(**tables: Any) -> tuple[dict[str, Any], list[str]]:
    document, errors = put_interface_points({"bodies": BODIES, **tables}, Path("case.toml"))
    return document, [f"{error.key}: {error.problem}; {error.expected}" for error in errors]


def test_names_become_reference_points() -> None:
    """Of one body, of sides, of paths of ropes and of tables below others; points in numbers stay."""
    document, errors = put(
        sensors=[{"name": "eye", "body": "block", "point": "LUG"}],
        joints=[
            {"name": "pin", "between": ["hook", "block"], "points": [[0, 0, 0], "PAD"]},
            {"name": "bolt", "between": ["block", "ground"], "points": ["LUG", [1, 2, 3]]},
        ],
        ropes=[{"path": [{"body": "hook", "point": [0, 0, 0]}, {"body": "block", "point": "LUG"}]}],
        fenders=[{"body_a": "block", "point_a": "PAD", "body_b": "hook", "point_b": [1, 1, 1]}],
        criteria=[{"name": "reach", "hook": {"body": "block", "point": "PAD"}}],
    )
    assert not errors
    assert document["sensors"][0]["point"] == LUG
    assert document["joints"][0]["points"] == [[0, 0, 0], PAD]
    assert document["joints"][1]["points"] == [LUG, [1, 2, 3]]
    assert [stop["point"] for stop in document["ropes"][0]["path"]] == [[0, 0, 0], LUG]
    assert document["fenders"][0]["point_a"] == PAD
    assert document["criteria"][0]["hook"]["point"] == PAD


@pytest.mark.parametrize(
    ("body", "name", "words"),
    [
        (
            "block",
            "LUGG",
            "'block' has no interface 'LUGG'; did you mean 'LUG'?; a point of three lengths, or one of",
        ),
        (
            "block",
            "EDGE",
            "no reference point that is known before its group is; 'at' in [bodies.block.interfaces.EDGE]",
        ),
        ("hook", "LUG", "'hook' has no interface 'LUG'; a point of three lengths"),
        ("sling", "LUG", "'sling' has no interface 'LUG'"),
    ],
)
def test_other_names_are_errors(body: str, name: str, words: str) -> None:
    _, errors = put(sensors=[{"body": "hook", "point": [0, 0, 0]}, {"body": body, "point": name}])
    assert len(errors) == 1
    assert errors[0].startswith("sensors.1.point: ")
    assert words in errors[0]


def test_an_unknown_name_is_the_only_error_of_a_case(tmp_path: Path) -> None:
    text = (Path(__file__).parents[1] / "small_beam.toml").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(
        text.replace('point = ["200 mm", "20 mm", "10 mm"]', 'point = "LUG"'), encoding="utf-8"
    )
    with pytest.raises(InputErrors) as caught:
        load_case(tmp_path)
    (error,) = caught.value.errors
    assert error.key == "sensors.0.point"
    assert "'beam' has no interface 'LUG'" in error.problem
