"""Pairs of surfaces that stand still are not searched: the same bits as when all are searched in every step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from mesh_contact_scenes import body, scene, turn

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.contact.triangles.standing import STILL
from heavylift.solver.scene.collisions import CollisionSurface
from heavylift.solver.scene.contacts import LinearLaw
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.contact.kind import ContactRows

CUBE, FLOOR = box_surface(1.0), plane_surface(60.0)
STEP = 0.01


def contacts_of(simulation: Simulation) -> ContactRows:
    simulation.warm_up()
    return simulation._layout.systems[1]


def stack(count: int, **options: Any) -> Scene:
    """Boxes beside each other by a few centimetres, dropped onto each other by a centimetre."""
    offsets = 0.05 * np.random.default_rng(1).standard_normal((count, 2)) + (0.13, 0.07)
    bodies = [(body(f"b{i}", (x, y, 0.51 + 1.01 * i)), CUBE) for i, (x, y) in enumerate(offsets)]
    pairs = [("floor" if i == 0 else f"b{i - 1}", f"b{i}") for i in range(count)]
    return scene(bodies, FLOOR, pairs, **{"friction": 0.5, "most_contacts": 64, "recorded": 0, **options})


def dominoes(count: int) -> Scene:
    """The first one is turned by a quarter of a radian; all end up lying on each other."""
    skin = box_surface(np.array([0.1, 0.5, 1.0]))
    bodies = [
        (
            body(
                f"b{i}", (0.4 * i, 0.0, 0.5), mass=10.0, size=(0.1, 0.5, 1.0), spin=(0.0, 2.5 * (i == 0), 0.0)
            ),
            skin,
        )
        for i in range(count)
    ]
    pairs = [("floor", f"b{i}") for i in range(count)] + [(f"b{i}", f"b{i + 1}") for i in range(count - 1)]
    return scene(bodies, FLOOR, pairs, friction=0.3, most_contacts=64, recorded=0)


def arch(count: int) -> Scene:
    """A semicircle of wedges, radii 4 m and 5 m, between the ground and itself; the last ones belong to the ground."""
    angles = np.linspace(0.0, np.pi, count + 1)
    bodies, skins = [], []
    for i in range(count):
        edge = [
            (r * np.cos(a), y, r * np.sin(a))
            for a in angles[i : i + 2]
            for r in (4.0, 5.0)
            for y in (-0.5, 0.5)
        ]
        points = np.array(edge)
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 2, 6, 4), (1, 5, 7, 3), (0, 4, 5, 1), (2, 3, 7, 6)]
        triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
        middle = points.mean(axis=0)
        bodies.append(body(f"b{i}", middle))
        skins.append(TriangleSurface(points - middle, triangles, 0.0, f"b{i}"))
    inner = scene(
        zip(bodies[1:-1], skins[1:-1], strict=True),
        None,
        [(f"b{i}", f"b{i + 1}") for i in range(count - 1)],
        friction=0.8,
        most_contacts=64,
        recorded=0,
    )
    ends = tuple(
        CollisionSurface(
            name=f"b{i}",
            body="ground",
            surface=TriangleSurface(skins[i].points + bodies[i].position, skins[i].triangles, 0.0, f"b{i}"),
        )
        for i in (0, count - 1)
    )
    return Scene(**{**vars(inner), "surfaces": (*inner.surfaces, *ends)})


def chute(count: int) -> Scene:
    """Boxes slide down an incline onto a floor and come to rest there, on each other."""
    slope, random = plane_surface(8.0), np.random.default_rng(3)
    R = np.array([[np.cos(0.6), 0.0, np.sin(0.6)], [0.0, 1.0, 0.0], [-np.sin(0.6), 0.0, np.cos(0.6)]])
    skin = box_surface(0.2)
    bodies = []
    for i in range(count):
        x = -1.0 - 0.4 * (i // 2)
        axis, angle = random.standard_normal(3), random.uniform(0.0, 3.0)
        place = (x, 0.4 * (i % 2), -np.tan(0.6) * (x + 0.3) + 0.35)
        bodies.append((body(f"b{i}", place, mass=8.0, size=0.2, orientation=turn(axis, angle)), skin))
    names = [one.name for one, _ in bodies]
    pairs = [(a, b) for i, b in enumerate(names) for a in ("floor", "slope", *names[:i])]
    made = scene(bodies, FLOOR, pairs, friction=0.4, events=False, most_contacts=64, recorded=0)
    incline = TriangleSurface(slope.points @ R.T + (-0.3, 0.0, 0.0), slope.triangles, 0.0, "slope")
    return Scene(
        **{
            **vars(made),
            "surfaces": (*made.surfaces, CollisionSurface(name="slope", body="ground", surface=incline)),
        }
    )


SCENES = [
    pytest.param(lambda: stack(3), 1.5, id="stack"),
    pytest.param(lambda: stack(1, law=LinearLaw(1e6, 3e4)), 1.0, id="compliant stack"),
    pytest.param(lambda: stack(10), 2.0, id="ten", marks=pytest.mark.slow),
    pytest.param(lambda: dominoes(4), 3.0, id="dominoes", marks=pytest.mark.slow),
    pytest.param(lambda: arch(9), 1.0, id="arch", marks=pytest.mark.slow),
    pytest.param(lambda: chute(8), 5.0, id="chute", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("make", "duration"), SCENES)
def test_kept_and_whole_searches_are_the_same_bits(make: Any, duration: float) -> None:
    """At every step, from the fall to the rest; and at the end searches are kept."""
    made = make()
    kept, whole = Simulation(made, STEP), Simulation(made, STEP)
    a, b = contacts_of(kept), contacts_of(whole)
    b.meshes[0].pairs["keeps"] = False
    most = 0
    for _ in range(round(duration / STEP)):
        records = [simulation.advance(1)[1] for simulation in (kept, whole)]
        np.testing.assert_array_equal(*records)
        assert not kept.outcome, kept.message
        assert a.counts.total == b.counts.total
        assert np.array_equal(a.state[: a.counts.total], b.state[: b.counts.total])
        assert not b.stood["still"].any()
        most = max(most, int(np.count_nonzero(a.stood["still"])))
    assert most >= 1


def test_what_creeps_is_searched_when_it_has_crept_so_far() -> None:
    """A box without friction creeps by a fifth of what counts as none in each step; one on it does not move on it."""
    made = stack(2, friction=0.0)
    creeping = tuple(
        RigidBody(
            **{
                **vars(one),
                "position": one.position - (0.0, 0.0, 0.01 * (i + 1)),
                "velocity": (0.2 * STILL / STEP, 0.0, 0.0),
            }
        )
        for i, one in enumerate(made.bodies)
    )
    simulation = Simulation(Scene(**{**vars(made), "bodies": creeping}), STEP)
    contacts, seen = contacts_of(simulation), []
    for _ in range(40):
        simulation.advance(1)
        seen.append(contacts.stood["still"].copy())
    below, above = np.array(seen).T
    assert 3 <= below.max() <= 5
    assert np.count_nonzero(below == 0) >= 6
    np.testing.assert_array_equal(np.diff(above[2:]), 1)


def test_what_has_stood_goes_on_in_a_saved_run(tmp_path: Any) -> None:
    """A run that is cut while it stands continues with the searches that it has kept."""
    made = stack(3)
    whole = Simulation(made, STEP)
    whole.advance(150)
    for cut in (40, 140):
        first = Simulation(made, STEP)
        first.advance(cut)
        np.savez(tmp_path / "state.npz", **first.state())
        again = Simulation(made, STEP)
        with np.load(tmp_path / "state.npz") as saved:
            again.restore(dict(saved))
        again.advance(150 - cut)
        found, expected = again.state(), whole.state()
        for name in expected:
            if name not in {"cpu_seconds", "watch"}:
                np.testing.assert_array_equal(found[name], expected[name], err_msg=name)
    assert contacts_of(whole).stood["still"].min() > 10


def test_what_moves_together_is_near_when_one_of_both_stops() -> None:
    """Two boxes fly at 4 m/s, 0.1 m apart; the first one hits a wall, the other one then hits it; steps are not split.

    While they fly nothing is near: what counts is how far they go relative to each other. Without restitution both end
    at the wall with the momentum gone, and none inside another.
    """
    front, behind = (
        body(name, (x, 0.0, 0.0), velocity=(4.0, 0.0, 0.0)) for name, x in (("front", 0.0), ("behind", -1.1))
    )
    wall = TriangleSurface(CUBE.points + np.array([1.61, 0.11, 0.07]), CUBE.triangles, 0.0, "wall")
    made = scene(
        [(front, CUBE), (behind, CUBE)],
        wall,
        [("floor", "front"), ("behind", "front")],
        gravity=(0.0, 0.0, 0.0),
        events=False,
        most_contacts=64,
        recorded=0,
    )
    simulation = Simulation(made, 0.005)
    contacts, gaps, near = contacts_of(simulation), [], []
    column = next(c.column for c in simulation.channels if c.name == "front.position")
    other = next(c.column for c in simulation.channels if c.name == "behind.position")
    for _ in range(60):
        record = simulation.advance(1)[1][0]
        gaps.append((0.61 - record[column], record[column] - record[other] - 1.0))
        near.append(int(contacts.counts.total))
    assert not simulation.outcome, simulation.message
    wall_gap, gap = np.array(gaps).T
    assert not any(near[: int(np.argmax(wall_gap < 0.085))])
    assert wall_gap.min() > -1e-9
    assert gap.min() > -1e-9
    assert wall_gap[-1] < 1e-6
    assert gap[-1] < 1e-6


def test_a_state_holds_the_contacts_that_there_are() -> None:
    """Not the room for all that there may be; and it goes on where more had been in between."""
    made = stack(2, most_contacts=512)
    whole = Simulation(made, STEP)
    before = whole.state()
    whole.advance(20)
    state, count = whole.state(), int(contacts_of(whole).counts.total)
    whole.advance(20)
    assert count == 8
    assert before["ContactRows.state"].size == 0
    assert state["ContactRows.state"].size == count * len(contacts_of(whole).state[0].words)
    for saved, steps in ((state, 20), (before, 40)):
        whole.restore(saved)
        again = Simulation(made, STEP)
        again.restore(saved)
        np.testing.assert_array_equal(whole.advance(steps)[1], again.advance(steps)[1])
    cut = {**state, "ContactRows.state": state["ContactRows.state"][:-1]}
    with pytest.raises(InputError, match="does not fit"):
        whole.restore(cut)
