"""Searches without a start over packed contours, and what becomes of searches that find nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import heavylift.solver.contact.search.search_start  # noqa: F401  its kernel for contours that deform
from heavylift.contours.splines.derivatives import evaluate_contour
from heavylift.contours.splines.neutral import neutral_curve, neutral_surface
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.contact.kind import (
    FOUND,
    LOST,
    NO_END,
    NO_IMPULSES,
    TOO_DEEP,
    ContactRows,
)
from heavylift.solver.contact.search.search_end import judge_searches, note_search
from heavylift.solver.contact.search.search_start import start_at_point
from heavylift.solver.interface import Workspace
from heavylift.solver.layout import Layout, pack_scene
from heavylift.solver.scene.contacts import BoxShape, Contact, Contour, LinearLaw, RigidLaw, SphereShape
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.stop_message import stop_message

pytestmark = pytest.mark.slow

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


@kernel
def start_at(contacts: ContactRows, c: int, x: float, y: float, z: float) -> None:
    start_at_point(contacts, c, x, y, z)


@kernel
def note(contacts: ContactRows, c: int, status: int) -> None:
    note_search(contacts, c, status)


@kernel
def judge(contacts: ContactRows, at_end: bool, work: Workspace) -> None:
    judge_searches(contacts, at_end, work)


def waves() -> Contour:
    """A surface with many hills and valleys, rows at uneven distances."""
    x, y = np.meshgrid(
        np.linspace(-1, 1, 17) ** 3 * 0.5 + np.linspace(-1, 1, 17) * 0.5, np.linspace(-1, 1, 13)
    )
    points = np.stack([x.T, y.T, 0.3 * np.sin(7.0 * x.T) * np.cos(5.0 * y.T)], axis=2)
    return Contour(name="waves", body="ground", neutral=neutral_surface(points))


def circle() -> Contour:
    angle = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    points = np.stack([np.cos(angle), 0.4 * np.sin(angle), 0.1 * np.cos(2.0 * angle)], axis=1)
    return Contour(name="ring", body="ground", neutral=neutral_curve(points, closed=True), radius=0.02)


def pack(*contours: Contour, shape: Any = None, law: Any = None) -> Layout:
    """A body with a contact on each contour."""
    body = RigidBody(name="body", mass=1.0, inertia=np.eye(3), position=np.array([0.0, 0.0, 3.0]))
    contacts = tuple(
        Contact(
            name=f"on {one.name}",
            contour=one.name,
            body="body",
            shape=shape or SphereShape(0.1),
            law=law or LinearLaw(100.0),
        )
        for one in contours
    )
    return pack_scene(Scene(bodies=(body,), contours=contours, contacts=contacts))


@pytest.fixture(scope="module")
def both() -> tuple[tuple[Contour, ...], Layout]:
    contours = (waves(), circle())
    return contours, pack(*contours)


def test_samples_lie_on_their_contours(both: tuple[tuple[Contour, ...], Layout]) -> None:
    """Positions that were packed against an evaluation that knows nothing of the packing."""
    contours, layout = both
    samples = layout.systems[1].samples
    for contour, grid in zip(contours, samples.grids, strict=True):
        assert contour.neutral is not None
        first, a, second, b, at = map(int, grid.tolist()[:5])
        u, v = samples.parameters[first : first + a], samples.parameters[second : second + b]
        pairs = np.stack(np.meshgrid(u, v, indexing="ij"), axis=2).reshape(-1, 2)[
            :, : len(contour.neutral.spaces)
        ]
        wanted = evaluate_contour(contour.neutral, pairs).reshape(len(pairs), -1)[:, :3]
        np.testing.assert_allclose(samples.points[at : at + 3, : a * b].T, wanted, atol=1e-13)


def test_contours_that_stand_still_have_samples_of_their_own() -> None:
    """The first three rows are those of contours that deform."""
    samples = pack(waves(), circle()).systems[1].samples
    assert list(samples.grids["points"]) == [3, 6]
    assert samples.points.shape == (9, int((samples.grids["count_u"] * samples.grids["count_v"]).max()))


def cloud(contour: Contour) -> Array:
    """Very many points of a contour [m]: the nearest is too far by the square of their spacing at most."""
    assert contour.neutral is not None
    if len(contour.neutral.spaces) == 1:
        pairs = np.linspace(0.0, 1.0, 20001)[:-1, None]
    else:
        pairs = np.stack(np.meshgrid(np.linspace(0, 1, 401), np.linspace(0, 1, 401)), axis=2).reshape(-1, 2)
    return evaluate_contour(contour.neutral, pairs).reshape(len(pairs), -1)[:, :3]


def test_start_is_the_nearest_of_several_minima(both: tuple[tuple[Contour, ...], Layout]) -> None:
    contours, layout = both
    contacts = layout.systems[1]
    random = np.random.default_rng(7)
    for c, contour in enumerate(contours):
        assert contour.neutral is not None
        points = cloud(contour)
        for _ in range(12):
            point = random.uniform([-1.2, -1.2, -0.5], [1.2, 1.2, 0.8])
            start_at(contacts, c, *point)
            at = np.array([contacts.state[c].u, contacts.state[c].v])[: len(contour.neutral.spaces)]
            found = evaluate_contour(contour.neutral, at[None, :]).reshape(1, -1)[0, :3]
            wanted = np.linalg.norm(points - point, axis=1).min()
            assert wanted - 1e-3 < np.linalg.norm(found - point) < wanted + 1e-9


def test_search_that_finds_nothing_leaves_the_last_place(both: tuple[tuple[Contour, ...], Layout]) -> None:
    """Counted if open; of a closed contact the step is not good."""
    contours, layout = both
    contacts, work = layout.systems[1], layout.work
    contacts.state[0].u, contacts.state[0].v = 0.3, 0.6
    note(contacts, 0, LOST)
    assert contours[0].neutral is not None
    wanted = evaluate_contour(contours[0].neutral, np.array([[0.3, 0.6]])).reshape(1, -1)[0, :3]
    np.testing.assert_allclose(contacts.scratch.result.position, wanted, atol=1e-13)
    assert contacts.state[0].search == LOST
    contacts.state[0].closed, contacts.state[0].failures = False, 0
    judge(contacts, True, work)
    assert contacts.state[0].failures == 1
    assert contacts.state[0].search == FOUND
    assert work.status.outcome == 0
    state = contacts.state[0]
    state.search, state.closed, state.present = LOST, True, True
    judge(contacts, False, work)
    assert contacts.state[0].failures == 2
    assert work.status.outcome == Outcome.NOT_CONVERGED
    state.closed = state.present = False
    work.status.words[:] = 0.0


@pytest.mark.parametrize("law", [LinearLaw(100.0), RigidLaw()])
def test_stop_names_the_contact_and_what_is_wrong(law: Any) -> None:
    layout = pack(waves(), shape=BoxShape(np.array([0.1, 0.1, 0.1]), 0.01), law=law)
    contacts, work = layout.systems[1], layout.work
    contacts.state[0].search = TOO_DEEP
    judge(contacts, False, work)
    assert work.status.outcome == 0, "in the middle of a step it may still be pushed out"
    judge(contacts, True, work)
    assert work.status.outcome == Outcome.NOT_CONVERGED
    assert layout.block_names[work.status.block] == "on waves"
    text = stop_message(layout, "t = 1 s")
    assert "contact 'on waves'" in text
    assert "larger radius" in text
    assert "deeper inside its contour than its rounding" in text
    assert ("a stiffer law" in text) == isinstance(law, LinearLaw)
    contacts.state[0].search, contacts.state[0].closed, contacts.state[0].present = LOST, True, True
    judge(contacts, True, work)
    assert "a contour with more evenly spaced control points" in stop_message(layout, "t = 1 s")


@pytest.mark.parametrize(
    ("why", "law", "wanted", "unwanted"),
    [
        (NO_IMPULSES, RigidLaw(), "try a compliant law ('linear')", "friction"),
        (NO_IMPULSES, LinearLaw(1e6), "try a smaller step, or less friction", "compliant"),
        (NO_END, RigidLaw(), "try softer stops and ropes", "friction"),
    ],
)
def test_stop_advises_what_can_help(why: int, law: Any, wanted: str, unwanted: str) -> None:
    """Shorter steps have been tried when contacts stop a run, and what is wedged without friction is wedged."""
    layout = pack(waves(), law=law)
    layout.work.status.outcome = int(Outcome.NOT_CONVERGED)
    layout.work.status.block = layout.systems[1].counts.first_block
    layout.systems[1].control.failure = why
    text = stop_message(layout, "t = 1 s")
    assert wanted in text
    assert unwanted not in text
