"""Ropes whose tension at the start is given, and winches by length."""

from __future__ import annotations

import numpy as np
import pytest
from law_scenes import G, body, eye, run, scene, wire

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

MASS, STIFFNESS, EA = 1000.0, 2e5, 1e6
TENSION = 0.4 * MASS * G


def partly_lifted(**more: object) -> Scene:
    """A load on a spring of 2 m and on a rope of 8 m up to the ground."""
    spring = Spring(
        name="deck",
        body_a=GROUND,
        body_b="load",
        point_a=np.array([0.0, 0.0, -6.0]),
        point_b=np.zeros(3),
        stiffness=STIFFNESS,
        length=2.0,
    )
    rope = wire(eye(GROUND), eye("load"), stiffness=EA, **more)
    return scene([body("load", MASS, (0.0, 0.0, -8.0))], ropes=[rope], forces=(spring,))


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_load_rests_under_the_tension_that_is_given(integrator: str) -> None:
    """0.4 of its weight on the rope, the rest on the spring; and the rope has that tension from then on."""
    options = {"tolerance": 1e-9} if integrator == "accurate" else {}
    found = run(partly_lifted(tension=TENSION), 0.01, 1.0, integrator, start="equilibrium", **options)
    sunk = (MASS * G - TENSION) / STIFFNESS
    np.testing.assert_allclose(found["load.position"][:, 2], -8.0 - sunk, atol=1e-8)
    np.testing.assert_allclose(found["rope.tension"], TENSION, rtol=1e-8)
    np.testing.assert_allclose(found["rope.rest_length"], (8.0 + sunk) / (1.0 + TENSION / EA), rtol=1e-9)


def test_without_a_search_the_length_is_that_of_the_place_as_drawn() -> None:
    simulation = Simulation(partly_lifted(tension=TENSION), 0.01)
    row, columns = simulation.record(), {c.name: c.column for c in simulation.channels}
    assert row[columns["rope.rest_length"]] == pytest.approx(8.0 / (1.0 + TENSION / EA), rel=1e-14)
    assert row[columns["rope.tension"]] == pytest.approx(TENSION, rel=1e-12)


def test_slings_of_a_hyperstatic_rig_share_as_told() -> None:
    """Four slings of a block: three tensions are free to choose no more than one; opposite pairs of 0.3 and 0.2."""
    corners = [(2.0, 1.0), (-2.0, 1.0), (-2.0, -1.0), (2.0, -1.0)]
    sine = 4.0 / np.sqrt(21.0)  # of a sling from a corner to the hook 4 m above the middle
    wanted = [share * MASS * G / sine for share in (0.3, 0.2, 0.3, 0.2)]
    slings = [
        Rope(
            name=f"sling_{n}",
            path=(RopePoint(GROUND, np.array([0.0, 0.0, 4.0])), RopePoint("block", np.array([x, y, 0.0]))),
            axial_stiffness=EA,
            tension=tension,
            damping=1e3,
        )
        for n, ((x, y), tension) in enumerate(zip(corners, wanted, strict=True))
    ]
    made = scene([body("block", MASS, (0.0, 0.0, 0.0))], ropes=slings)
    found = run(made, 0.01, 1.0, start="equilibrium")
    for n, tension in enumerate(wanted):
        np.testing.assert_allclose(found[f"sling_{n}.tension"], tension, rtol=1e-6)
    np.testing.assert_allclose(found["block.position"], 0.0, atol=1e-6)


def test_a_tension_that_nothing_else_shares_cannot_be_chosen() -> None:
    """A load that hangs on one rope has its weight in it."""
    hung = scene(
        [body("load", MASS, (0.0, 0.0, -8.0))], ropes=[wire(eye(GROUND), eye("load"), tension=TENSION)]
    )
    with pytest.raises(InputError, match=r"rope: tension: 3924 N is given, and 9810 N is left at rest"):
        run(hung, 0.01, 0.1, start="equilibrium")


def test_a_frame_is_bent_by_the_tension_that_is_given() -> None:
    """A cantilever on a sling at its tip, against the same with a force; its weight is none."""
    section = FrameSection(1000.0, 1e9, 0.01, 1e-5)
    length, pull = 5.0, 5.0
    mesh = line(np.zeros(3), np.array([length, 0.0, 0.0]), 6)
    beam = FrameBody(
        name="beam",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(section,),
        supports=(Support(np.array([0]), {"position": "xyz", "tangent": "xyz"}),),
    )
    tip = np.array([length, 0.0, 0.0])
    rope = Rope(
        name="sling",
        path=(RopePoint(GROUND, np.array([length, 0.0, 100.0])), RopePoint("beam", tip)),
        axial_stiffness=1e7,
        tension=pull,
    )
    force = PointForce("pull", "beam", tip, np.zeros(1), np.array([[0.0, 0.0, pull]]))
    rises = []
    for more in ({"ropes": (rope,)}, {"forces": (force,)}):
        simulation = Simulation(Scene(bodies=(beam,), **more), 0.01, start="equilibrium")
        columns = {c.name: c.column for c in simulation.channels}
        row = simulation.record()
        rises.append(row[columns["beam.position"]])
    assert simulation.start_text
    assert rises[0] == pytest.approx(rises[1], rel=1e-5)


def test_a_winch_passes_its_lengths_and_none_beyond() -> None:
    times, lengths = np.array([0.0, 10.0, 15.0, 40.0, 50.0, 60.0]), np.array([30, 29, 22, 20, 20, 24.0])
    winch = Winch(times, lengths=lengths)
    at, speeds = winch.profile
    assert speeds[0] == speeds[-1] == 0.0
    fine = np.linspace(0.0, 60.0, 6001)
    v = np.interp(fine, at, speeds)
    found = 30.0 - np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.01)])
    np.testing.assert_allclose(np.interp(times, fine, found), lengths, atol=1e-9)
    for k in range(5):
        part = found[(fine >= times[k]) & (fine <= times[k + 1])]
        assert part.min() > min(lengths[k : k + 2]) - 1e-9
        assert part.max() < max(lengths[k : k + 2]) + 1e-9
    rope = wire(eye(GROUND), eye("load"), stiffness=1e9, damping=1e6, winch=winch)
    hung = scene([body("load", MASS, (0.0, 0.0, -30.0))], ropes=[rope])
    run_found = run(hung, 0.05, 60.0)
    np.testing.assert_allclose(
        run_found["rope.rest_length"], np.interp(run_found.times, fine, found), atol=1e-6
    )


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"tension": 1e3, "length": 8.0}, "rope: tension: both 'length' and 'tension'"),
        ({"tension": 0.03 * EA}, "rope: tension: 30000 N is a strain of 3 %"),
        (
            {"tension": 1e3, "winch": Winch(np.array([0.0, 1.0]), lengths=np.array([8.0, 7.0]))},
            "rope: winch.lengths: both 'tension' and 'winch.lengths'",
        ),
        ({"winch": Winch(np.array([0.0, 1.0]))}, "neither 'speeds' nor 'lengths'"),
        ({"winch": Winch(np.array([0.0, 1.0]), lengths=np.array([8.0]))}, "2 times and 1 lengths"),
        ({"winch": Winch(np.array([0.0, 1.0]), lengths=np.array([8.0, -1.0]))}, r"winch\.lengths"),
    ],
)
def test_bad_starts_are_refused(more: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Simulation(partly_lifted(**more), 0.01)


def test_relaxation_takes_no_step_that_is_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """A step whose change is no number is not taken: SciPy would refuse to turn bodies by it, without a name."""

    class Singular:
        def solve(self, force: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return np.full(len(force), np.nan), np.full(len(gap), np.nan)

    monkeypatch.setattr("heavylift.solver.statics.relaxation.factorise", lambda *_, **__: Singular())
    swinging = scene([body("load", 1e3, (1.0, 0.0, -1.0))], ropes=[wire(eye(GROUND), eye("load"))])
    with pytest.raises(InputError, match="simulation: start: no static equilibrium found"):
        Simulation(swinging, 1e-2, start="relax").advance(1)
