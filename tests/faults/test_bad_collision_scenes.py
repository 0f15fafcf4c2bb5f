"""Scenes with surfaces and collisions that cannot be: one clear error each, before anything is compiled for them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface, sphere_surface
from heavylift.solver.contact.triangles.start import check_overlaps
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import BilateralLaw, HertzLaw, HuntCrossleyLaw, LinearLaw, RigidLaw
from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection
from heavylift.solver.scene.scene import Fixed, Gravity, RigidBody, Scene

if TYPE_CHECKING:
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

INF, NAN = float("inf"), float("nan")


def body(name: str, position: Any = (0.0, 0.0, 0.5), **options: Any) -> RigidBody:
    return RigidBody(
        name=name, mass=2.0, inertia=0.3 * np.eye(3), position=np.array(position, dtype=float), **options
    )


def collision_scene(
    *, skin: TriangleSurface | None = None, position: Any = (0.0, 0.0, 0.5), **options: Any
) -> Scene:
    """A box that stands on the floor, and one that is held in place far away."""
    cube = box_surface(1.0)
    return Scene(
        bodies=(body("box", position), body("held", (9.0, 0.0, 0.5), motion=Fixed())),
        forces=(Gravity(np.array([0.0, 0.0, -9.81])),),
        surfaces=(
            CollisionSurface(name="floor", body="ground", surface=plane_surface(4.0)),
            CollisionSurface(name="wall", body="ground", surface=plane_surface(4.0, (1.0, 0.0, 0.0))),
            CollisionSurface(name="skin", body="box", surface=skin or cube),
            CollisionSurface(name="lid", body="box", surface=plane_surface(0.5)),
            CollisionSurface(name="post", body="held", surface=cube),
        ),
        collisions=(Collision(**{"name": "hit", "surfaces": ("floor", "skin"), **options}),),
    )


@pytest.mark.parametrize(
    ("options", "key", "problem", "expected"),
    [
        (
            {"surfaces": ("flor", "skin")},
            "between",
            "no surface 'flor'",
            "one of floor, lid, post, skin, wall",
        ),
        ({"surfaces": ("floor", "box")}, "between", "no surface 'box'", "one of floor"),
        ({"surfaces": ("skin", "skin")}, "between", "'box' touches itself", "surfaces of two bodies"),
        ({"surfaces": ("skin", "lid")}, "between", "'box' touches itself", "surfaces of two bodies"),
        ({"surfaces": ("floor", "wall")}, "between", "'ground' touches itself", "surfaces of two bodies"),
        ({"surfaces": ("floor", "post")}, "between", "neither 'ground' nor 'held' can move", "one free body"),
        ({"friction": -0.1}, "friction", "-0.1", "0 or more"),
        ({"friction": INF}, "friction", "inf", "0 or more"),
        ({"friction": NAN}, "friction", "nan", "0 or more"),
        ({"law": RigidLaw(restitution=1.01)}, "restitution", "1.01", "0 to 1"),
        ({"law": RigidLaw(restitution=NAN)}, "restitution", "nan", "0 to 1"),
        ({"law": RigidLaw(rest_speed=-1.0)}, "rest_speed", "-1.0 m/s", "0 or more"),
        ({"law": BilateralLaw()}, "law", "bilateral", "a law that can open"),
        ({"law": LinearLaw(0.0)}, "stiffness", "0.0", "a positive number"),
        ({"law": LinearLaw(INF)}, "stiffness", "inf", "a positive number"),
        ({"law": LinearLaw(1e6, -1.0)}, "damping", "-1.0 N s/m", "0 or more"),
        ({"law": HertzLaw(-1e6)}, "stiffness", "-1000000.0", "a positive number"),
        ({"law": HuntCrossleyLaw(1e6, 0.5)}, "exponent", "0.5", "1 to 3"),
        ({"law": HuntCrossleyLaw(1e6, 1.5, 0.0)}, "restitution", "0.0", "above 0, up to 1"),
        ({"method": "quick"}, "method", "'quick'", "'swept' or 'position-difference'"),
        ({"patch_angle": 0.0}, "patch_angle", "0.0 rad", "above 0, up to pi"),
        ({"patch_angle": NAN}, "patch_angle", "nan rad", "above 0, up to pi"),
        ({"patch_size": -1.0}, "patch_size", "-1.0 m", "0 or more"),
        ({"patch_size": INF}, "patch_size", "inf m", "0 or more"),
        ({"most_contacts": 0}, "most_contacts", "0", "1 or more"),
        ({"recorded": -1}, "recorded", "-1", "0 or more"),
    ],
)
def test_what_cannot_be_is_refused_by_name_and_key(
    options: dict[str, Any], key: str, problem: str, expected: str
) -> None:
    with pytest.raises(InputError) as caught:
        pack_scene(collision_scene(**options), "dele2")
    found = str(caught.value)
    assert "\n" not in found
    assert f"hit: {key}: " in found
    assert problem in found.partition("; expected ")[0]
    assert expected in found.partition("; expected ")[2]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"body": "bax"}, r"skin: body: there is no body 'bax'; expected ground or one of box, held"),
        (
            {"surface": None},
            r"skin: body: no triangles on 'box'; expected a rigid body, a body with modes or the ground with",
        ),
    ],
)
def test_a_surface_needs_its_body_and_triangles(change: dict[str, Any], message: str) -> None:
    scene = collision_scene()
    surfaces = tuple(replace(one, **change) if one.name == "skin" else one for one in scene.surfaces)
    with pytest.raises(InputError, match=message):
        pack_scene(replace(scene, surfaces=surfaces), "dele2")


def test_triangles_of_a_frame_are_refused() -> None:
    section = FrameSection(density=7800.0, youngs_modulus=2e11, area=1e-2, second_moment=1e-5)
    mesh = line((0.0, 0.0, 2.0), (1.0, 0.0, 2.0), 2)
    frame = FrameBody(
        name="bar", nodes=mesh.nodes, tangents=mesh.tangents, elements=mesh.elements, sections=(section,)
    )
    scene = collision_scene()
    surfaces = (*scene.surfaces, CollisionSurface(name="hull", body="bar", surface=box_surface(0.1)))
    with pytest.raises(
        InputError, match=r"hull: surface: triangles of its own; expected none: 'bar' touches"
    ):
        pack_scene(replace(scene, bodies=(*scene.bodies, frame), surfaces=surfaces), "dele2")


def overlaps(scene: Scene) -> None:
    """What a simulation does before its first step, without compiling that step."""
    contacts = pack_scene(scene, "dele2").systems[1]
    check_overlaps(contacts, [one.name for one in scene.collisions])


@pytest.mark.parametrize(
    ("skin", "place", "depth", "x"),
    [
        (box_surface(1.0), (0.3, 0.1, 0.4), 0.1, (0.3, 0.1)),
        (box_surface(1.0), (0.3, 0.1, 0.0), 0.5, (0.3, 0.1)),
        (box_surface((1.0, 1.0, 0.01)), (0.3, 0.1, -0.001), 0.004, (0.3, 0.1)),
        (sphere_surface(0.25), (-1.0, 0.5, 0.2), 0.05, (-1.0, 0.5)),
    ],
)
def test_surfaces_that_cross_at_the_start_are_refused_with_depth_and_place(
    skin: TriangleSurface, place: tuple[float, ...], depth: float, x: tuple[float, float]
) -> None:
    with pytest.raises(InputError) as caught:
        overlaps(collision_scene(skin=skin, position=place))
    found = str(caught.value)
    assert "hit: between: the surfaces cross each other at the start" in found
    assert "bodies apart, or an exclusion box" in found
    numbers = re.search(r"([-\d.e]+) m deep at \(([-\d.e]+), ([-\d.e]+), ([-\d.e]+)\) m", found)
    assert numbers is not None
    deep, *at = (float(text) for text in numbers.groups())
    assert deep == pytest.approx(depth, rel=1e-3)
    assert np.linalg.norm(np.array(at[:2]) - x) < 0.75
    assert abs(at[2]) <= depth + skin.radius


@pytest.mark.parametrize("height", [0.5, 0.5 + 1e-9, 0.5 - 1e-6, 0.7])
def test_what_stands_on_the_floor_is_not_refused(height: float) -> None:
    overlaps(collision_scene(position=(0.3, 0.1, height)))


def test_a_ball_may_begin_under_load() -> None:
    """With a compliant law by its radius; a box may not."""
    soft = {"law": LinearLaw(1e6)}
    overlaps(collision_scene(skin=sphere_surface(0.25), position=(0.0, 0.0, 0.2), **soft))
    with pytest.raises(InputError, match=r"0\.05 m deep"):
        overlaps(collision_scene(position=(0.0, 0.0, 0.45), **soft))
