"""Force elements find the module that packs them, and say themselves whether they are rows or forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from law_scenes import DOWN, body

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.clutch import Clutch
from heavylift.solver.force_elements.registry import elements_of, packing_module
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.forces.tugger import Tugger
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, ForceElement, Limits, RopePoint, Stage
from heavylift.solver.scene.scene import Scene

UP = np.array([0.0, 0.0, 5.0])
ENDS: dict[str, Any] = {"body_a": GROUND, "point_a": UP, "body_b": "load", "point_b": np.zeros(3)}
TABLE = {"elongations": np.array([0.0, 1.0]), "forces": np.array([0.0, 10.0])}


@dataclass(frozen=True, eq=False)
class Stray(ForceElement):
    """Its module packs nothing."""

    name: str


def scene(*forces: ForceElement, **more: Any) -> Scene:
    return Scene((body("load", 10.0, [0.0, 0.0, 0.0]),), forces=forces, **more)


def kinds(table: Any) -> list[str]:
    return [type(kind).__name__ for kind in table.kinds]


def test_what_nothing_packs_is_named() -> None:
    with pytest.raises(
        InputError, match=r"stray.*: type: a Stray, which nothing packs; expected a function 'pack' in"
    ):
        packing_module(Stray("stray"), "dele2")


@pytest.mark.parametrize(
    ("keys", "integrator", "rows", "forces", "blocks"),
    [
        ({"stiffness": 10.0}, "dele2", ["Springs"], [], 1),
        ({"stiffness": 10.0}, "thesis", ["Springs"], [], 1),
        ({"stiffness": 10.0}, "accurate", ["Springs"], ["Springs"], 0),
        ({}, "dele2", ["Springs"], ["Springs"], 0),
        (TABLE, "dele2", ["ScalarLaws"], [], 1),
        (TABLE, "thesis", ["Springs"], ["Springs"], 0),
        (TABLE, "accurate", ["Springs"], ["Springs"], 0),
    ],
)
def test_a_spring_says_what_it_is_with_an_integrator(
    keys: dict[str, Any], integrator: str, rows: list[str], forces: list[str], blocks: int
) -> None:
    """Linear ones are rows but with `accurate`; tables are laws with `dele2`, else forces; nothing is no row."""
    packed = pack_scene(scene(Spring(name="spring", length=4.0, **ENDS, **keys)), integrator)
    assert (kinds(packed.joints), kinds(packed.forces)) == (rows, forces)
    assert packed.block_names == ("spring",) * blocks


@pytest.mark.parametrize(("integrator", "blocks"), [("dele2", 1), ("accurate", 0)])
def test_a_rope_says_so_too(integrator: str, blocks: int) -> None:
    path = (RopePoint(GROUND, UP), RopePoint("load", np.zeros(3)))
    packed = pack_scene(scene(ropes=(Rope(name="rope", path=path, axial_stiffness=1e5),)), integrator)
    assert kinds(packed.joints) == ["Ropes"]
    assert kinds(packed.forces) == ["Ropes"] * (1 - blocks)
    assert packed.block_names == ("rope",) * blocks


def test_kinds_have_an_order_of_their_own() -> None:
    """Whatever that of the scene: sums on a body are rounded in one way. Those that are not listed come last."""
    joint = Hinge(name="hinge", body_a=GROUND, body_b="load", limits=Limits(-1.0, 1.0), friction=1.0)
    forces = (
        Clutch(name="clutch", joint="hinge", torque=1.0),
        Spring(name="table", length=4.0, **ENDS, **TABLE),
        JointMotor(name="motor", joint="hinge", load=1.0),
        Tugger(name="tugger", tension=1.0, **ENDS),
        Spring(name="spring", length=4.0, stiffness=1.0, **ENDS),
        PointForce("push", "load", np.zeros(3), force=np.ones(3)),
        DOWN,
    )
    for given in (forces, forces[::-1]):
        packed = pack_scene(scene(*given, joints=(joint,)))
        assert kinds(packed.joints) == ["RowJoints", "Springs", "Motors", "ScalarLaws", "Clutches"]
        assert kinds(packed.forces) == ["UniformGravity", "PointForces", "Tuggers", "Motors"]
        assert packed.block_names == ("hinge", "spring", "table", "hinge", "hinge", "clutch")


def test_stages_keep_what_is_given_apart_from_what_has_rows() -> None:
    spring, tugger = Spring(name="spring", length=4.0, **ENDS), Tugger(name="tugger", tension=1.0, **ENDS)
    whole = scene(spring, tugger, DOWN)
    assert elements_of(whole, Stage.LOADS) == [DOWN]
    assert elements_of(whole, Stage.FORCES) == [tugger]
    assert elements_of(whole, Stage.ROWS) == [spring]


@pytest.mark.parametrize("integrator", ["accurate", "thesis"])
def test_rows_that_are_fitted_are_refused_where_nothing_fits_them(integrator: str) -> None:
    joint = Hinge(name="hinge", body_a=GROUND, body_b="load")
    clutch = Clutch(name="clutch", joint="hinge", torque=1.0)
    with pytest.raises(
        InputError, match=f"clutch: integrator: {integrator!r} with rows that are fitted to a law"
    ):
        pack_scene(scene(clutch, joints=(joint,)), integrator)
