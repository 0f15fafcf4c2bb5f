"""Exact frames in the energy-momentum scheme: forces of a step, energy and momenta over many large steps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from frame_examples import EXAMPLES, Example, arc, line
from frame_meshes import find_strains, get, pack, put

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.bodies.ancf import elements as generics
from heavylift.solver.bodies.ancf.kind import FrameMeshes
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from frame_oracle import OracleElement

EXACT = [name for name, example in EXAMPLES.items() if example.body.model == "exact"]


@kernel
def add_mean_stress_forces(kind, factor):  # type: ignore[no-untyped-def]
    generics.add_mean_stress_forces(kind, 0, kind.external_force, factor)


@kernel
def add_stress_forces(kind, factor):  # type: ignore[no-untyped-def]
    generics.add_stress_forces(kind, 0, kind.mid_position, kind.stage_strain, kind.external_force, factor)


@pytest.fixture(params=EXACT)
def example(request: pytest.FixtureRequest) -> Example:
    return EXAMPLES[request.param]


@dataclass
class Change:
    """A function at both ends of a step, and what its change is, times that of the coordinates."""

    start: np.ndarray | float
    end: np.ndarray | float
    by: np.ndarray

    @property
    def mean(self) -> np.ndarray | float:
        return 0.5 * (self.start + self.end)

    def __add__(self, other: Change | float) -> Change:
        if not isinstance(other, Change):
            return Change(self.start + other, self.end + other, self.by)
        return Change(self.start + other.start, self.end + other.end, self.by + other.by)

    def __mul__(self, other: Change | float) -> Change:
        if not isinstance(other, Change):
            return Change(self.start * other, self.end * other, self.by * other)
        by = np.multiply.outer(self.mean, other.by) + np.multiply.outer(other.mean, self.by)
        return Change(self.start * other.start, self.end * other.end, by)

    def inverse(self) -> Change:
        return Change(1.0 / self.start, 1.0 / self.end, -self.by / (self.start * self.end))

    def root(self) -> Change:
        ends = np.sqrt(self.start), np.sqrt(self.end)
        return Change(*ends, self.by / sum(ends))


def product(first: np.ndarray, second: np.ndarray, ends: tuple[np.ndarray, np.ndarray]) -> Change:
    """Inner product of two derivatives along the element, given by their rows of the shape functions."""
    F, S = np.kron(first, np.eye(3)), np.kron(second, np.eye(3))
    matrix = F.T @ S + S.T @ F
    start, end = (0.5 * q @ matrix @ q for q in ends)
    return Change(start, end, 0.5 * matrix @ (ends[0] + ends[1]))


def normal(first: np.ndarray, second: np.ndarray, ends: tuple[np.ndarray, np.ndarray]) -> Change:
    """``r' x r''``, by = its derivatives at the middle; shape (3, 12)."""
    F, S = np.kron(first, np.eye(3)), np.kron(second, np.eye(3))
    d, c = (0.5 * A @ (ends[0] + ends[1]) for A in (F, S))
    start, end = (np.cross(F @ q, S @ q) for q in ends)
    return Change(start, end, np.array([np.cross(d, s) + np.cross(f, c) for f, s in zip(F.T, S.T)]).T)  # noqa: B905


def step_forces(
    element: OracleElement, ends: tuple[np.ndarray, np.ndarray], stress: np.ndarray
) -> np.ndarray:
    """Sum over Gauss points of weights times mean strains times changes of strains, by rules of differences.

    The mean part of the vector strain of straight elements acts along the change of half its square.
    """
    at, total = 0, np.zeros(12)
    weights, e0, e1 = element.weights(), element.strains(ends[0]), element.strains(ends[1])
    for first, _, _ in element.axial:
        total += weights[at] * stress[at] * product(first, first, ends).root().by
        at += 1
    for first, second, _ in element.bending:
        inverse = product(first, first, ends).inverse()
        slope = product(first, second, ends) * inverse
        square = product(second, second, ends) * inverse + slope * slope * -1.0
        if element.curved:
            total += weights[at] * stress[at] * square.root().by
            at += 1
        else:
            own = slice(at, at + 3)
            rest = stress[own] - 0.5 * (e0[own] + e1[own])
            vector = normal(first, second, ends) * inverse
            total += weights[at] * (0.5 * square.by + rest @ vector.by)
            at += 3
    return total


def prepare(kind: FrameMeshes, amount: float, seed: int = 7) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of a step between two shapes, far from each other and from rest at amount 1; their strains."""
    random = np.random.default_rng(seed)
    start = get(kind.position)
    start = start + 0.2 * random.normal(size=start.shape)
    end = start + amount * 0.3 * random.normal(size=start.shape)
    for nodal, q in (
        (kind.position, start),
        (kind.trial_position, end),
        (kind.mid_position, 0.5 * (start + end)),
    ):
        put(nodal, q)
    find_strains(kind, 0, kind.position, kind.start_strain)
    find_strains(kind, 0, kind.trial_position, kind.shape_strain)
    kind.stage_strain[:] = 0.5 * (kind.start_strain + kind.shape_strain)
    return start, end


def found(kind: FrameMeshes, factor: float = 1.0) -> np.ndarray:
    kind.external_force[:] = 0.0
    add_mean_stress_forces(kind, factor)
    return get(kind.external_force)


def moments(kind: FrameMeshes, force: np.ndarray) -> np.ndarray:
    """Resultant of the forces and moment about the origin, with arms of the middle."""
    middle, vectors = get(kind.mid_position).reshape(-1, 3), force.reshape(-1, 3)
    return np.concatenate((vectors[::2].sum(axis=0), np.cross(middle, vectors).sum(axis=0)))


def test_kernels_equal_rules_of_differences(example: Example) -> None:
    kind = pack(example.body)
    start, end = prepare(kind, 1.0)
    stress = 0.1 * np.random.default_rng(1).normal(size=kind.strain.shape[0])
    kind.stage_strain[:] += stress
    force, at = np.zeros(18), 0
    for e, element in enumerate(example.oracle()):
        own = slice(6 * e, 6 * e + 12)
        count = len(element.weights())
        part = kind.stage_strain[at : at + count]
        force[own] += 1.7 * step_forces(element, (start[own], end[own]), part)
        at += count
    np.testing.assert_allclose(found(kind, 1.7), force, atol=1e-12 * abs(force).max())


def test_the_work_of_a_step_is_that_of_the_mean_strain(example: Example) -> None:
    """For any mean strain: also with what is left of a drift, and with the rate of damping."""
    kind = pack(example.body)
    start, end = prepare(kind, 1.0)
    weights = np.concatenate([element.weights() for element in example.oracle()])
    change = kind.shape_strain - kind.start_strain
    for more in (0.0, 0.3):
        kind.stage_strain[:] += more * np.random.default_rng(1).normal(size=len(change))
        work = float(np.sum(weights * kind.stage_strain * change))
        scale = float(np.sum(weights * abs(kind.stage_strain * change)))
        assert found(kind) @ (end - start) == pytest.approx(work, abs=1e-13 * scale)


def test_the_forces_of_a_step_have_no_resultant_and_no_moment(example: Example) -> None:
    kind = pack(example.body)
    prepare(kind, 1.0)
    force = found(kind)
    np.testing.assert_allclose(moments(kind, force), 0.0, atol=1e-13 * abs(force).sum())
    kind.stage_strain[:] += 0.3
    assert abs(moments(kind, found(kind))[:3]).max() < 1e-13 * abs(force).sum()


def test_forces_of_a_step_become_those_of_the_shape_with_the_square_of_its_length(example: Example) -> None:
    errors = []
    for amount in (0.02, 0.01, 0.0):
        kind = pack(example.body)
        prepare(kind, amount)
        kind.stage_strain[:] += 0.1
        step = found(kind)
        kind.external_force[:] = 0.0
        add_stress_forces(kind, 1.0)
        errors.append(abs(step - get(kind.external_force)).max() / abs(step).max())
    assert errors[2] < 1e-13
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_strains_of_green_lagrange_need_the_middle_only() -> None:
    kind = pack(EXAMPLES["green-lagrange"].body)
    prepare(kind, 1.0)
    step = found(kind)
    kind.external_force[:] = 0.0
    add_stress_forces(kind, 1.0)
    np.testing.assert_array_equal(step, get(kind.external_force))


def test_a_straight_shape_at_both_ends_is_no_singularity() -> None:
    """Curved elements, bent straight: no direction of the curvature, no force of the moment."""
    kind = pack(arc(1.4, 1.3, 2))
    x = np.array([0.0, 0.9, 1.8])
    straight = np.zeros((3, 2, 3))
    straight[:, 0, 0], straight[:, 1, 0] = x, 1.0
    for nodal in (kind.position, kind.trial_position, kind.mid_position):
        put(nodal, straight.ravel())
    for strain in (kind.start_strain, kind.shape_strain, kind.stage_strain):
        find_strains(kind, 0, kind.position, strain)
    force = found(kind)
    assert np.isfinite(force).all()
    np.testing.assert_allclose(force.reshape(-1, 3)[:, 1:], 0.0, atol=1e-12)


def beam(curved: bool, modulus: float, **more: object) -> FrameBody:
    """1.5 m of a bar of 20 x 20 mm, along x or an arc from there towards y."""
    section = FrameSection(7850.0, modulus, 4e-4, 0.02**4 / 12)
    body = arc(1.5, 1.0, 4) if curved else line([0.375] * 4, model="exact")
    return replace(body, sections=(section,), elasticity="energy-momentum", **more)


def simulate(body: FrameBody, step: float, every: int = 1, gravity: float = 0.0) -> Simulation:
    return Simulation(
        Scene(bodies=(body,), forces=(Gravity(np.array([0.0, -gravity, 0.0])),)), step, record_every=every
    )


def channel(simulation: Simulation, records: np.ndarray, name: str) -> np.ndarray:
    place = next(c for c in simulation.channels if c.name == name)
    return records[:, place.column : place.column + len(place.components)]


def kick(simulation: Simulation, plane: bool, speed: float) -> FrameMeshes:
    """Random velocities of the nodes at the start; in a plane for a curved frame."""
    kind = next(k for k in simulation._layout.bodies if isinstance(k, FrameMeshes))
    velocity = kind.velocity.reshape(-1, 8)[:, : 2 if plane else 3]
    velocity += speed * np.random.default_rng(0).normal(size=velocity.shape)
    return kind


PINNED = (Support(np.array([0]), {"position": "xyz"}),)


def steps_of(simulation: Simulation, kind: FrameMeshes, count: int) -> tuple[np.ndarray, float]:
    """Records of all steps and the mean number of rounds of a sample of them."""
    parts, rounds = [], []
    for _ in range(count // 10):
        parts.append(simulation.advance(10)[1])
        assert simulation.outcome is Outcome.COMPLETED, simulation.message
        rounds.append(kind.body[0].iterations)
    return np.concatenate(parts), float(np.mean(rounds))


@pytest.mark.parametrize(
    ("curved", "modulus", "step"), [(False, 1e8, 1e-2), (False, 2.1e11, 1e-2), (True, 1e9, 2e-3)]
)
def test_a_free_frame_keeps_energy_and_momenta(curved: bool, modulus: float, step: float) -> None:
    """Steps beyond any explicit limit."""
    spin = np.array([0.0, 0.0, 3.0]) if curved else np.array([1.0, 2.0, 3.0])
    simulation = simulate(beam(curved, modulus, angular_velocity=spin), step)
    kind = kick(simulation, curved, 0.3)
    records, rounds = steps_of(simulation, kind, 2000)
    kinetic = channel(simulation, records, "energy.kinetic")
    assert channel(simulation, records, "energy.elastic").max() > 1e-3 * kinetic.max()
    assert np.ptp(channel(simulation, records, "energy.balance")) < 1e-10 * kinetic.max()
    for name in ("momentum.linear", "momentum.angular"):
        momentum = channel(simulation, records, name)
        assert abs(momentum - momentum[0]).max() < 1e-11 * np.linalg.norm(momentum[0])
    assert rounds < 12.0


@pytest.mark.parametrize(("curved", "modulus", "step"), [(False, 1e9, 1e-2), (True, 2.1e11, 1e-2)])
def test_a_swinging_frame_keeps_its_energy(curved: bool, modulus: float, step: float) -> None:
    simulation = simulate(beam(curved, modulus, supports=PINNED), step, gravity=9.81)
    kind = kick(simulation, curved, 0.0)
    records, rounds = steps_of(simulation, kind, 2000)
    kinetic = channel(simulation, records, "energy.kinetic")
    assert np.ptp(channel(simulation, records, "energy.balance")) < 1e-10 * kinetic.max()
    assert rounds < 10.0


@pytest.mark.slow
@pytest.mark.parametrize("curved", [False, True])
def test_order_against_the_accurate_integrator(curved: bool) -> None:
    """Pendulums of large bending."""
    body = beam(curved, 1e8, supports=PINNED)
    scene = Scene(bodies=(body,), forces=(Gravity(np.array([0.0, -9.81, 0.0])),))
    accurate = Simulation(scene, 0.02, "accurate", tolerance=1e-10)
    best = channel(accurate, accurate.advance(10)[1], "frame.position")
    errors = []
    for step in (1e-3, 5e-4):
        simulation = simulate(body, step, round(0.02 / step), 9.81)
        records = simulation.advance(round(0.2 / step))[1]
        errors.append(abs(channel(simulation, records, "frame.position") - best).max())
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)


def test_stiff_frames_of_both_models_move_alike() -> None:
    """Steel at 20 ms: strains of 1e-6 tell no difference between the measures; their whole motion is resolved alike."""
    tips = []
    for model in ("exact", "green-lagrange"):
        body = replace(beam(False, 2.1e11, supports=PINNED), model=model)
        simulation = simulate(body, 0.02, 1, 9.81)
        tips.append(channel(simulation, simulation.advance(100)[1], "frame.position")[:, -3:])
    assert np.ptp(tips[0][:, 1]) > 1.0
    np.testing.assert_allclose(tips[0], tips[1], atol=1e-5)
