"""Rods in case files: directors along a curve, constants of torsion, supports, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputErrors
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.meshes import assemble_frame

CASE = """
title = "Rods"

[bodies.rod]
type = "rod"
geometry = { type = "arc", radius = "2 m", to = "90 deg", elements = 8 }
section = { density = "7850 kg/m^3", young_modulus = "210 GPa", diameter = "40 mm", wall = "5 mm" }
shear_modulus = "80 GPa"
normal = [0, 0, 1]
twist = "90 deg"
supports = [{ at = "start", fix = "clamped" }, { at = "end", fixed = { position = "xy", normal = "z" } }]

[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "1 s"
"""
START = {
    "position": np.zeros(3),
    "orientation": np.array([1.0, 0.0, 0.0, 0.0]),
    "velocity": np.zeros(3),
    "angular_velocity": np.zeros(3),
}


def test_directors_follow_the_line_and_twist_evenly(tmp_path):
    """Across the plane of an arc at its start, in the plane at its end; square to the tangents; J = 2 I of a tube."""
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path)
    body = assemble_frame(case, "rod", case.bodies["rod"], START)
    tangents, normals = body.tangents, body.normals
    np.testing.assert_allclose(np.sum(tangents * normals, axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(normals[0], [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(normals[:, 2], np.cos(np.linspace(0.0, 0.5 * np.pi, 9)), atol=1e-12)
    np.testing.assert_allclose(normals[-1], np.cross(tangents[-1], [0.0, 0.0, 1.0]), atol=1e-12)
    (section,) = body.sections
    assert section.torsional_stiffness == pytest.approx(80e9 * 2.0 * section.second_moment)
    assert dict(body.supports[0].fixed) == dict.fromkeys(("position", "tangent", "normal", "binormal"), "xyz")
    assert dict(body.supports[1].fixed) == {"position": "xy", "normal": "z"}


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (
            "section={ density = 7850, young_modulus = 2e11, area = 1e-4, second_moment = 1e-8 }",
            "section.torsion_constant",
            "resists torsion",
        ),
        ("model=exact", "model", "green-lagrange"),
        ("elasticity=explicit", "elasticity", "sections are stiff"),
        ("shear_modulus=-1", "shear_modulus", "too small"),
    ],
)
def test_what_a_rod_of_a_case_is_not_given(tmp_path, change, key, words):
    """One line with key and expectation."""
    (tmp_path / "case.toml").write_text(CASE)
    with pytest.raises(InputErrors) as caught:
        load_case(tmp_path, [f"bodies.rod.{change}"])
    assert f"bodies.rod.{key}" in str(caught.value)
    assert words in str(caught.value)
