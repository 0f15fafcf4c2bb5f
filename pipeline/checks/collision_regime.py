"""Whether a force between colliding bodies is a force: how many steps its pulse has, and what it is estimated by."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.assemble.described import spec_of
from heavylift.solver.scene.contacts import HertzLaw, ThesisLaw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results

__all__ = [
    "RESOLVED",
    "Peak",
    "Regime",
    "effective_mass",
    "linear_restitution",
    "mean_step",
    "peak_estimate",
    "regime",
]

RESOLVED = 0.3
"""Largest product of the natural frequency of a contact and the step at which a force is resolved: about ten steps a
pulse."""


class Regime(NamedTuple):
    """How well a compliant contact is resolved.

    Attributes
    ----------
    stiffness
        Of a patch at the largest force [N/m].
    mass
        Effective mass [kg]; None if it is not known.
    restitution
        That the law has at this mass; None if it is not known.
    step
        [s].
    phase
        ``omega h`` with ``omega = sqrt(k / m)``; None if the mass is not known.
    """

    stiffness: float
    mass: float | None
    restitution: float | None
    step: float
    phase: float | None

    @property
    def resolved(self) -> bool | None:
        """Whether a pulse has enough steps; None if that is not known."""
        return None if self.phase is None else self.phase <= RESOLVED

    @property
    def steps(self) -> float:
        """Steps in half a period."""
        return math.pi / self.phase if self.phase else math.inf


class Peak(NamedTuple):
    """Estimate of the peak force of an impact without compliance."""

    force: float
    """``v sqrt(k m)`` [N]."""
    speed: float
    """Approach v [m/s], from the impulse."""
    mass: float
    """Effective mass m [kg]."""


def mean_step(results: Results, case: Case) -> float:
    """Fixed step of a run, or the mean one [s]."""
    if case.simulate is not None and case.simulate.step is not None:
        return case.simulate.step
    steps = float(results.metadata.get("steps") or len(results.time) - 1)
    return float(results.time[-1] - results.time[0]) / max(steps, 1.0)


def effective_mass(
    case: Case,
    results: Results,
    pair: tuple[str, str],
    record: int,
    place: NDArray[np.float64] | None = None,
    normal: NDArray[np.float64] | None = None,
) -> float | None:
    """Mass that two rigid bodies have at a point of contact, along its normal [kg].

    Parameters
    ----------
    case, results
        The case and its time histories.
    pair
        Names of both surfaces.
    record
        When.
    place, normal
        Point in the world [m] and unit vector, shape (3,); without them rotation is left out.

    Returns
    -------
    float or None
        None if a frame or shell takes part, or nothing gives way.

    Notes
    -----
    ``1/m = sum 1/m_i + (r x n) . J^-1 (r x n)`` over the bodies that give way, r from the centre of mass to the point.
    Joints and ropes are left out: what holds a body makes it heavier.
    """
    bodies = {surface.name: surface.body for surface in case.surfaces}
    inverse = 0.0
    for name in {bodies[surface] for surface in pair}:
        body = case.bodies.get(name)
        if body is None:
            continue
        if not body.has_inertia:
            return None
        if body.frame.motion != "free":
            continue
        inverse += 1.0 / body.mass
        channels = (f"{name}.position", f"{name}.orientation")
        if place is None or normal is None or any(channel not in results for channel in channels):
            continue
        R = rotation_matrix(results[channels[1]][record])
        centre = results[channels[0]][record]
        if body.frame.origin == "geometry":
            centre = centre + R @ np.array(body.centre_of_mass)
        arm = R.T @ np.cross(place - centre, normal)
        inverse += float(arm @ np.linalg.solve(np.array(body.inertia), arm))
    return 1.0 / inverse if inverse > 0.0 else None


def linear_restitution(stiffness: float, damping: float, mass: float) -> float:
    """Velocity after an impact over that before it of a spring and damper that do not pull.

    Parameters
    ----------
    stiffness, damping, mass
        [N/m], [N s/m], and the effective mass [kg].

    Notes
    -----
    ``e = exp(-zeta theta / s)`` with ``zeta = c / (2 sqrt(k m))``, ``s = sqrt(1 - zeta^2)`` and
    ``theta = atan2(2 zeta s, 2 zeta^2 - 1)``, the phase at which the force becomes zero; beyond critical damping with
    hyperbolic functions.
    """
    zeta = damping / (2.0 * math.sqrt(stiffness * mass))
    if zeta < 1.0:
        s = math.sqrt(1.0 - zeta * zeta)
        return math.exp(-zeta * math.atan2(2.0 * zeta * s, 2.0 * zeta * zeta - 1.0) / s)
    if zeta == 1.0:
        return math.exp(-2.0)
    s = math.sqrt(zeta * zeta - 1.0)
    return math.exp(-zeta * math.atanh(2.0 * zeta * s / (2.0 * zeta * zeta - 1.0)) / s)


def regime(section: Any, force: float, mass: float | None, step: float) -> Regime | None:
    """How well a collision is resolved at its largest force; None of rigid laws and without a force.

    Parameters
    ----------
    section
        Of the case file.
    force
        Largest force of a patch [N].
    mass
        Effective mass there [kg]; None if it is not one number.
    step
        [s].
    """
    if section.law == "rigid" or force <= 0.0:
        return None
    law = section.DESCRIBED(**spec_of(section, section.DESCRIBED))
    taken = law.at_step(step) if isinstance(law, ThesisLaw) else law
    stiffness, damping = taken.stiffness, getattr(taken, "damping", 0.0)
    exponent = 1.5 if isinstance(taken, HertzLaw) else getattr(taken, "exponent", 1.0)
    restitution: float | None = 1.0 if isinstance(taken, HertzLaw) else getattr(taken, "restitution", None)
    # tangent of F = k d^n at the force
    tangent = exponent * stiffness ** (1.0 / exponent) * force ** (1.0 - 1.0 / exponent)
    if restitution is None and mass is not None:
        restitution = linear_restitution(stiffness, damping, mass)
    phase = None if mass is None else math.sqrt(tangent / mass) * step
    return Regime(tangent, mass, restitution, step, phase)


def peak_estimate(impulse: float, restitution: float, stiffness: float, mass: float) -> Peak:
    """Peak force of an impact on a spring: ``v sqrt(k m)``, ``v = p / ((1 + e) m)``.

    Parameters
    ----------
    impulse, restitution, stiffness, mass
        [N s], coefficient, [N/m] and effective mass [kg].
    """
    speed = impulse / ((1.0 + restitution) * mass)
    return Peak(speed * math.sqrt(stiffness * mass), speed, mass)
