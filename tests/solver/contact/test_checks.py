"""Contacts that cannot be are refused with the key, the value and what would be right; nothing is compiled for that."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flexible_scenes import hit, plate

from heavylift.contours.splines.neutral import neutral_curve, neutral_surface
from heavylift.modal.stiffening import Stiffening
from heavylift.numerics.outcome import InputError
from heavylift.solver.contact.check_start import check_places
from heavylift.solver.contact.kind import LOST, TOO_DEEP
from heavylift.solver.layout import Layout, pack_scene
from heavylift.solver.scene.contacts import (
    BilateralLaw,
    BoxShape,
    CapsuleShape,
    CircleShape,
    Contact,
    Contour,
    CylinderShape,
    EllipsoidShape,
    PointShape,
    RigidLaw,
    SphereShape,
    Turn,
)
from heavylift.solver.scene.scene import RigidBody, Scene

GRID = np.stack(
    [*np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 1, 5), indexing="ij"), np.zeros((5, 5))], axis=2
)
LINE = np.stack([np.linspace(0, 2, 5), np.zeros(5), np.zeros(5)], axis=1)
FLOOR = Contour(name="floor", body="ground", neutral=neutral_surface(GRID))
RAIL = Contour(name="rail", body="ground", neutral=neutral_curve(LINE))


def pack(contour: Contour = FLOOR, **contact: Any) -> Layout:
    """A body over a contour."""
    body = RigidBody(name="box", mass=1.0, inertia=np.eye(3), position=np.array([1.0, 0.5, 1.0]))
    touch = {"name": "touch", "contour": contour.name, "body": "box", **contact}
    return pack_scene(Scene(bodies=(body,), contours=(contour,), contacts=(Contact(**touch),)))


def refused(key: str, *words: str, contour: Contour = FLOOR, **contact: Any) -> None:
    """The message names the key and contains the words."""
    with pytest.raises(InputError) as caught:
        pack(contour, **contact)
    assert caught.value.key == key
    for word in words:
        assert word in str(caught.value)


def test_right_contacts_are_packed() -> None:
    """Else the refusals below would say nothing."""
    for shape in (
        PointShape(),
        SphereShape(0.1),
        CircleShape(0.1, np.eye(3)[1]),
        EllipsoidShape(np.array([0.1, 0.2, 0.3])),
        BoxShape(np.array([0.1, 0.2, 0.3]), 0.01),
        CapsuleShape(0.1, 0.2, np.eye(3)[0]),
        CylinderShape(0.1, 0.2, 0.01, np.eye(3)[0]),
    ):
        assert len(pack(shape=shape).systems[1].table) == 1
    assert len(pack(RAIL, law=BilateralLaw()).systems[1].table) == 1
    assert len(pack(replace(RAIL, radius=0.1)).systems[1].table) == 1
    assert len(pack(replace(RAIL, width=0.1, director=np.eye(3)[1])).systems[1].table) == 1


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("degree", [1, 2])
def test_curvature_must_not_jump(closed: bool, degree: int) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    points = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    ring = Contour(name="ring", body="ground", neutral=neutral_curve(points, degree=degree, closed=closed))
    refused("degree", f"degree {degree}", "3 or more", contour=ring, law=BilateralLaw())


@pytest.mark.parametrize(
    ("shape", "key"),
    [
        (BoxShape(np.array([0.1, 0.2, 0.3]), 0.0), "shape.rounding"),
        (BoxShape(np.array([0.1, 0.2, 0.3]), -0.01), "shape.rounding"),
        (CylinderShape(0.1, 0.2, 0.0, np.eye(3)[0]), "shape.rounding"),
    ],
)
def test_sharp_edges_are_refused(shape: Any, key: str) -> None:
    refused(key, "touch", "too small; expected a length > 0 m", shape=shape)


@pytest.mark.parametrize(
    ("shape", "key"),
    [
        (SphereShape(0.0), "shape.radius"),
        (CircleShape(np.inf, np.eye(3)[1]), "shape.radius"),
        (CapsuleShape(0.0, 0.2, np.eye(3)[0]), "shape.radius"),
        (CapsuleShape(0.1, np.nan, np.eye(3)[0]), "shape.length"),
        (CylinderShape(-1.0, 0.2, 0.01, np.eye(3)[0]), "shape.radius"),
        (EllipsoidShape(np.array([0.1, 0.2, 0.0])), "shape.half_axes"),
        (EllipsoidShape(np.array([0.1, 0.2])), "shape.half_axes"),
        (BoxShape(np.array([0.1, -0.2, 0.3]), 0.01), "shape.size"),
        (BoxShape(np.array([0.1, 0.2, 0.3]), 0.05), "shape.rounding"),
        (CylinderShape(0.1, 0.2, 0.1, np.eye(3)[0]), "shape.rounding"),
        (EllipsoidShape(np.array([0.1, 0.2, 0.3]), Turn(np.eye(3)[0], np.nan)), "shape.turned.angle"),
    ],
)
def test_sizes_of_shapes_must_be_lengths(shape: Any, key: str) -> None:
    refused(key, shape=shape)


def test_shape_must_fit_its_contour() -> None:
    refused("shape", "CapsuleShape", contour=RAIL, shape=CapsuleShape(0.1, 0.2, np.eye(3)[0]))
    refused("shape", "flip", contour=replace(FLOOR, flip=True), shape=CircleShape(0.1, np.eye(3)[1]))
    refused("law", "no side", contour=RAIL)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"radius": -0.1}, "radius"),
        ({"radius": 0.1, "width": 0.1, "director": np.eye(3)[1]}, "width"),
        ({"width": 0.1}, "director"),
        ({"width": 0.1, "director": np.eye(3)[0]}, "director"),
    ],
)
def test_cylinder_or_band_about_a_curve(change: dict[str, Any], key: str) -> None:
    refused(key, contour=replace(RAIL, **change), shape=SphereShape(0.1))


def test_surface_has_neither_radius_nor_width() -> None:
    refused("radius", "on a surface", contour=replace(FLOOR, radius=0.1))


def placed(gap: float, search: float = 0.0, **contact: Any) -> None:
    """Check a contact that has been located."""
    contacts = pack(**contact).systems[1]
    contacts.state[0].gap, contacts.state[0].search = gap, search
    check_places(contacts, ["touch"])


def test_start_deep_inside_is_refused_and_offers_the_flip() -> None:
    """A ball may start a tenth of its radius inside, a point 5 mm per metre of contour."""
    placed(-0.009, shape=SphereShape(0.1))
    placed(-0.009)
    for shape in (SphereShape(0.1), PointShape()):
        with pytest.raises(InputError, match=r"touch: point: starts 0\.5 m inside .*'flip'"):
            placed(-0.5, shape=shape)


def test_start_deeper_than_the_rounding_is_refused() -> None:
    box = BoxShape(np.array([0.3, 0.2, 0.1]), 0.01)
    with pytest.raises(InputError, match=r"touch: shape: starts 0\.02 m inside .* deeper than its rounding"):
        placed(-0.02, TOO_DEEP, shape=box)


def test_start_off_the_rail_is_refused() -> None:
    contacts = pack(RAIL, law=BilateralLaw()).systems[1]
    contacts.state[0].gap = 0.1
    with pytest.raises(InputError, match=r"touch: point: starts 0\.1 m off its contour"):
        check_places(contacts, ["touch"])


def test_contour_without_a_nearest_point_is_refused() -> None:
    with pytest.raises(InputError, match="no nearest point"):
        placed(1.0, LOST)


def test_contacts_on_a_body_whose_loads_stiffen_it() -> None:
    """Their forces move over it, and the stress of each is not known."""
    scene = hit(plate((30.0,)), 0.1, 1.0, RigidLaw())
    flexible, ball = scene.bodies
    nothing = Stiffening(np.zeros((6, 1, 1)), np.zeros((3, 1, 1)), np.zeros((3, 1, 1)))
    touched = replace(flexible, reduced=replace(flexible.reduced, stiffening=nothing))
    pack_scene(scene)
    with pytest.raises(InputError, match="touches the flexible body 'plate'"):
        pack_scene(replace(scene, bodies=(touched, ball)))
