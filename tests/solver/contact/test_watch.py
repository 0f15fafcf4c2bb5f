"""What no contact between triangles may do is told; many surfaces among each other run at their defaults."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from mesh_contact_scenes import G, body, run, scene

from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.contact.triangles.outside import closed_parts, outside_of
from heavylift.solver.scene.contacts import HertzLaw, LinearLaw, RigidLaw
from heavylift.solver.simulation import Simulation

NOTHING = (0.0, 0.0, 0.0)
SPRING = LinearLaw(1e6)
STEP = 1e-3
BRICK = (0.4, 0.2, 0.2)


def test_a_wall_of_bricks_stands_on_its_floor() -> None:
    """Twenty bricks in five courses, all pairs: below each course the forces are the weight of what is above."""
    courses, each, mass = 5, 4, 10.0
    bricks = [
        (
            body(
                f"b{i}{j}", (0.408 * (j - 1.5) + 0.102 * (i % 2), 0.0, 0.1 + 0.2 * i), mass=mass, size=BRICK
            ),
            box_surface(BRICK),
        )
        for i in range(courses)
        for j in range(each)
    ]
    names = ["floor", *(one.name for one, _ in bricks)]
    found = run(
        scene(bricks, plane_surface((60.0, 60.0)), list(combinations(names, 2)), friction=0.6), 0.005, 0.25
    )
    assert len(names) * (len(names) - 1) // 2 == 210
    levels = {"floor": -1} | {f"b{i}{j}": i for i in range(courses) for j in range(each)}
    for lower in range(-1, courses - 1):
        carried = sum(
            found[f"{a}-{b}.force"][-1, 2]
            for a, b in combinations(names, 2)
            if (levels[a], levels[b]) == (lower, lower + 1)
        )
        assert carried == pytest.approx((courses - 1 - lower) * each * mass * G, rel=1e-6)
    assert not found.simulation.warning


def test_room_for_contacts_grows_with_surfaces_and_not_with_their_pairs() -> None:
    """1225 pairs of fifty boxes far apart, and one that lands: nothing is refused, and its weight is borne."""
    boxes = [
        (body(f"b{i}", (3.0 * i, 0.0, 0.5 if i == 7 else 50.0)), box_surface((1, 1, 1))) for i in range(50)
    ]
    names = ["floor", *(one.name for one, _ in boxes)]
    found = run(
        scene(boxes, plane_surface((500.0, 10.0)), list(combinations(names, 2)), recorded=0), 0.01, 0.05
    )
    assert found["floor-b7.force"][-1, 2] == pytest.approx(100.0 * G, rel=1e-9)


def wound(surface: TriangleSurface) -> TriangleSurface:
    """Inside out."""
    return TriangleSurface(surface.points, surface.triangles[:, ::-1], surface.radius, surface.name)


def moved(surface: TriangleSurface, by: Any) -> TriangleSurface:
    return TriangleSurface(surface.points + np.asarray(by, dtype=float), surface.triangles, 0.0, "moved")


def joined(*surfaces: TriangleSurface) -> TriangleSurface:
    starts = np.cumsum([0, *(len(one.points) for one in surfaces)])
    triangles = [one.triangles + start for one, start in zip(surfaces, starts, strict=False)]
    return TriangleSurface(np.vstack([one.points for one in surfaces]), np.vstack(triangles), 0.0, "joined")


CUBE = box_surface((1.0, 1.0, 1.0))
HALF_TURNED = TriangleSurface(
    CUBE.points, np.vstack([CUBE.triangles[:3, ::-1], CUBE.triangles[3:]]), 0.0, "half"
)


def test_the_way_out_is_that_of_closed_parts() -> None:
    """Outward normals have a positive product with the place from the middle of a cube, however it is wound."""
    far = (1e4, 0.0, 0.0)
    skins = [CUBE, wound(CUBE), plane_surface((1.0, 1.0)), HALF_TURNED, moved(CUBE, far)]
    skins.append(
        joined(CUBE, moved(wound(CUBE), (3.0, 0.0, 0.0)), moved(plane_surface((1.0, 1.0)), (6.0, 0.0, 0.0)))
    )
    packed = pack_surfaces(skins)
    parts = closed_parts(packed, ())
    middles = packed.points[packed.triangles["corners"]].mean(axis=1)
    of = packed.triangles["surface"]
    for s, middle in ((0, NOTHING), (1, NOTHING), (4, far)):
        out = parts.outward[of == s, np.newaxis] * packed.normals[of == s]
        assert ((out * (middles[of == s] - middle)).sum(axis=1) > 0.4).all()
    assert not parts.outward[(of == 2) | (of == 3)].any()
    three = of == 5
    place = middles[three, 0]
    assert (parts.outward[three] == np.select([place < 1.5, place < 4.5], [1.0, -1.0], 0.0)).all()
    assert not closed_parts(packed, (0,)).outward[of == 0].any()
    edges = np.unique(packed.triangles["edges"][of == 0])
    way = packed.points[packed.edges["ends"][edges]].mean(axis=1)
    assert ((way * parts.edge_outward[edges]).sum(axis=1) > 0.4).all()


@pytest.mark.parametrize(
    ("one", "other", "place", "expected"),
    [
        (CUBE, CUBE, (0.0, 0.0, 1.0), 1.0),  # stands on it
        (CUBE, box_surface((0.2, 0.2, 0.2)), (0.3, 0.0, -0.4), -1.0),  # rests within it
        (wound(CUBE), box_surface((0.2, 0.2, 0.2)), (0.3, 0.0, -0.4), -1.0),
        (CUBE, plane_surface((0.5, 0.5)), (0.0, 0.0, 0.1), -1.0),
        (
            CUBE,
            joined(moved(box_surface((0.1, 0.1, 0.1)), (3.0, 0.0, 0.0)), box_surface((0.1, 0.1, 0.1))),
            NOTHING,
            0.0,
        ),
        (joined(CUBE, moved(CUBE, (5.0, 0.0, 0.0))), box_surface((0.2, 0.2, 0.2)), (2.5, 0.0, 0.0), 1.0),
        (joined(CUBE, moved(CUBE, (5.0, 0.0, 0.0))), box_surface((0.2, 0.2, 0.2)), (5.0, 0.0, 0.0), 0.0),
        (plane_surface((5.0, 5.0)), CUBE, (0.0, 0.0, 0.5), 0.0),
    ],
)
def test_where_a_surface_begins(
    one: TriangleSurface, other: TriangleSurface, place: Any, expected: float
) -> None:
    packed = pack_surfaces([one, other])
    parts = closed_parts(packed, ())
    assert outside_of(packed, parts, 0, 1, np.eye(3), np.asarray(place, dtype=float)) == expected


def rising(ground: TriangleSurface, skin: TriangleSurface, height: float, **motion: Any) -> Simulation:
    """What has just left the ground, or turns on it, still within the reach of the search."""
    law = motion.pop("law", SPRING)
    box = body("box", (0.1, 0.2, height), size=(1.0, 1.0, 0.2), **motion)
    simulation = Simulation(scene([(box, skin)], ground, gravity=NOTHING, law=law), STEP)
    simulation.advance(1)
    return simulation


def contacts_of(simulation: Simulation) -> Any:
    system = simulation._layout.systems[1]
    return system.state[: int(system.counts.total)]


SLAB = moved(box_surface((6.0, 5.0, 1.0)), (0.0, 0.0, -0.5))
LID = box_surface((1.0, 1.0, 0.2))


def test_a_contact_with_a_wrong_side_on_a_closed_surface_is_told() -> None:
    """A box rises from a slab without weight: nothing acts. With its sides turned the slab pulls it: told, and kept."""
    simulation = rising(SLAB, LID, 0.1, velocity=(0.0, 0.0, 0.05))
    state = contacts_of(simulation)
    assert len(state) > 0
    state["side"] *= -1.0
    state["gap"] *= -1.0
    simulation.advance(1)
    time = simulation.time
    simulation.advance(3)
    force = contacts_of(simulation)["normal_force"].max()
    assert force > 0.0
    assert "'floor-box': contacts push into a closed surface from its wrong side" in simulation.warning
    assert f"first at {time:.6g} s" in simulation.warning
    assert f"{force:.4g} N" in simulation.warning
    told = simulation.warning
    kept = simulation.state()
    again = rising(SLAB, LID, 0.1, velocity=(0.0, 0.0, 0.05))
    assert not again.warning
    again.restore(kept)
    assert again.warning == told


def test_an_edge_that_is_pushed_from_both_sides_of_a_plate_is_told() -> None:
    """A plate without thickness turns on a sheet: one side is pressed in; with a wrong side the other is as well."""
    plate, sheet = plane_surface((1.0, 1.0)), plane_surface((6.0, 5.0))
    simulation = rising(sheet, plate, 1e-6, spin=(0.0, 0.1, 0.0))
    state = contacts_of(simulation)
    assert (state["normal_force"] > 0.0).any()
    up = state["gap"] > 0.0
    assert up.any()
    state["side"][up] *= -1.0
    state["gap"][up] *= -1.0
    simulation.advance(2)
    assert "push the ends of an edge from both sides of one face" in simulation.warning


def test_a_contact_that_pulls_is_told() -> None:
    """No law says so, but one of a negative stiffness."""
    simulation = rising(SLAB, LID, 0.1, velocity=(0.0, 0.0, -0.05), law=HertzLaw(1e7))
    assert "pull" not in simulation.warning
    (meshes,) = simulation._layout.systems[1].meshes
    meshes.pair_values["stiffness"] *= -1.0
    simulation.advance(3)
    assert "contacts between its surfaces pull" in simulation.warning


@pytest.mark.parametrize("law", [LinearLaw(1e6, 1e3), RigidLaw(restitution=0.5)])
@pytest.mark.parametrize("spin", [NOTHING, (1.0, 2.0, 0.5)])
def test_nothing_is_told_of_what_tumbles_within_a_closed_box(law: Any, spin: Any) -> None:
    """It hits walls, edges and corners from within, which is the right side there."""
    inner = body("box", size=(0.4, 0.3, 0.2), velocity=(2.0, 1.0, 0.0), spin=spin)
    made = scene([(inner, box_surface((0.4, 0.3, 0.2)))], box_surface((2.0, 2.0, 2.0)), law=law, friction=0.3)
    found = run(made, STEP, 2.0)
    assert found["floor-box.impulse"][-1] > 100.0 * G
    assert not [part for part in found.simulation.warning.split("; ") if "collision 'floor-box'" in part]


def test_nothing_is_told_of_what_tumbles_down_closed_steps() -> None:
    """Boxes fall on a slab and on each other: faces, edges and corners meet from outside."""
    rng = np.random.default_rng(3)
    boxes = [
        (
            body(f"b{i}", (*rng.uniform(-0.3, 0.3, 2), 0.8 + 0.9 * i), size=0.5, spin=rng.normal(size=3)),
            box_surface((0.5,) * 3),
        )
        for i in range(4)
    ]
    names = ["floor", *(one.name for one, _ in boxes)]
    made = scene(boxes, SLAB, list(combinations(names, 2)), law=LinearLaw(1e6, 2e3), friction=0.4)
    found = run(made, STEP, 1.5)
    assert "contacts push" not in found.simulation.warning
    assert "pull" not in found.simulation.warning
