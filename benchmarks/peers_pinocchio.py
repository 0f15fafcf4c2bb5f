"""Pinocchio: its articulated-body and proximal constraint dynamics under a Runge-Kutta loop.

Pinocchio has no integrator of its own; a plain loop in Python is what its users write, and 15 us of each
step are spent there. Constraints are stabilised after Baumgarte, which the singular poses of A02 need.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from peers_measure import SAMPLES, History, Ladder
from peers_problems import GROUND, Mechanism, Problem

__all__ = ["NAME", "VERSION", "ladders"]

NAME = "Pinocchio"
VERSION = pin.__version__

TINY = 1e-14
"""Inertia in place of none [kg m2]."""
AXES = ("X", "Y", "Z")
GAINS = {"A02": 20.0, "A03": 1000.0, "A04": 0.0}
"""Rate of the Baumgarte stabilisation that is best for each closed mechanism [1/s]."""

Acceleration = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def ladders(problem: Problem) -> list[Ladder]:
    """RK4, numbers of steps from cheap to dear. Not for A05: it has no springs, and Python would compute them."""
    settings = {
        "A01": (60, 80, 100, 150, 200, 400, 600),
        "A02": (100, 150, 200, 300, 400, 500, 700, 1000, 1500),
        "A03": (100, 150, 200, 500, 700, 1000, 1500, 2500),
        "A04": (700, 800, 1000, 1200, 1500, 2000, 2500),
        "chain": (40, 50, 60, 70, 100, 150, 200, 300, 400, 700),
    }
    counts = settings.get(problem.name.split("-")[0], ())
    return [Ladder(NAME, "RK4", tuple(partial(_Run, problem, count) for count in counts))] if counts else []


def _model(mechanism: Mechanism) -> pin.Model:
    """Joint tree; joint k + 1 carries link k, because links come after their parents."""
    model = pin.Model()
    model.gravity.linear = np.array(mechanism.gravity)
    for number, link in enumerate(mechanism.links):
        kind = ("JointModelP" if link.slides else "JointModelR") + AXES[link.axis.index(1.0)]
        place = pin.SE3(np.eye(3), np.array(link.offset))
        joint = model.addJoint(link.parent + 1, getattr(pin, kind)(), place, f"joint{number}")
        inertia = pin.Inertia(link.mass, np.array(link.centre), np.diag(np.maximum(link.inertia, TINY)))
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    return model


def _constraints(mechanism: Mechanism, model: pin.Model, gain: float) -> pin.StdVec_RigidConstraintModel:
    """Point constraints that close the loops; a hinge is closed by two points on its axis."""
    found = pin.StdVec_RigidConstraintModel()
    for closure in mechanism.closures:
        for shift in [np.zeros(3)] if closure.axis is None else [np.zeros(3), np.array(closure.axis)]:
            (a, b), (p, q) = closure.links, closure.points
            places = [pin.SE3(np.eye(3), np.array(point) + shift) for point in (p, q)]
            kind, frame = pin.ContactType.CONTACT_3D, pin.ReferenceFrame.LOCAL
            constraint = pin.RigidConstraintModel(kind, model, a + 1, places[0], b + 1, places[1], frame)
            constraint.setBaumgarteCorrectorParameters(pin.BaumgarteCorrectorParameters(gain**2, 2.0 * gain))
            found.append(constraint)
    return found


def _loads(mechanism: Mechanism, model: pin.Model) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Joint torques: the constant one, and those of planar springs from the ground to links hinged on it."""
    torques = np.zeros(model.nv)
    torques[model.joints[1].idx_v] = mechanism.torque
    springs = []
    for spring in mechanism.springs:
        link = mechanism.links[spring.links[1]]
        if not (mechanism.planar and spring.links[0] == link.parent == GROUND and spring.damping == 0.0):
            raise ValueError("only springs between the ground and a link hinged on it, without damping")
        index = model.joints[spring.links[1] + 1].idx_v
        (cx, cy, _), (px, py, _) = spring.points
        springs.append(
            (index, cx - link.offset[0], cy - link.offset[1], px, py, spring.stiffness, spring.length)
        )

    def loads(q: NDArray[np.float64]) -> NDArray[np.float64]:
        for index, cx, cy, px, py, stiffness, length in springs:
            c, s = math.cos(q[index]), math.sin(q[index])
            rx, ry = c * px - s * py, s * px + c * py
            dx, dy = cx - rx, cy - ry
            distance = math.hypot(dx, dy)
            force = stiffness * (distance - length) / distance
            torques[index] = force * (rx * dy - ry * dx)
        return torques

    return loads


class _Run:
    """A number of equal steps."""

    def __init__(self, problem: Problem, steps: int) -> None:
        self._mechanism = mechanism = problem.mechanism()
        self.setting = f"{steps} steps"
        self._duration, self._steps = problem.duration, steps
        self._model = _model(mechanism)
        gain = GAINS.get(problem.name.split("-")[0], 0.0)
        self._start = np.zeros(self._model.nq), np.zeros(self._model.nv)
        for number, link in enumerate(mechanism.links):
            index = self._model.joints[number + 1].idx_v
            self._start[0][index], self._start[1][index] = link.start, link.rate
        self._acceleration = self._dynamics(_constraints(mechanism, self._model, gain))

    def _dynamics(self, constraints: pin.StdVec_RigidConstraintModel) -> Acceleration:
        """Joint accelerations as a function of coordinates and speeds."""
        model = self._model
        data = self._data = model.createData()
        loads = _loads(self._mechanism, model)
        if not len(constraints):
            torques = loads(self._start[0])
            return lambda q, v: pin.aba(model, data, q, v, torques).copy()
        datas = pin.StdVec_RigidConstraintData()
        for constraint in constraints:
            datas.append(constraint.createData())
        proximal = pin.ProximalSettings(1e-12, 1e-10, 20)
        pin.initConstraintDynamics(model, data, constraints, datas)
        return lambda q, v: pin.constraintDynamics(
            model, data, q, v, loads(q), constraints, datas, proximal
        ).copy()

    def reset(self) -> None:
        """Nothing: the state lives in the loop."""

    def _integrate(self, keep: Callable[[NDArray[np.float64], NDArray[np.float64]], None] | None) -> None:
        """Classical Runge-Kutta of order 4; every coordinate is an angle or a travel, so they simply add."""
        h, acceleration = self._duration / self._steps, self._acceleration
        q, v = self._start
        if keep:
            keep(q, v)
        for _ in range(self._steps):
            a1 = acceleration(q, v)
            v2 = v + 0.5 * h * a1
            a2 = acceleration(q + 0.5 * h * v, v2)
            v3 = v + 0.5 * h * a2
            a3 = acceleration(q + 0.5 * h * v2, v3)
            v4 = v + h * a3
            a4 = acceleration(q + h * v3, v4)
            q = q + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
            v = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
            if keep:
                keep(q, v)

    def go(self) -> None:
        self._integrate(None)

    def history(self) -> History:
        model, data = self._model, self._data
        joint, point = self._mechanism.marked + 1, np.array(self._mechanism.point)
        positions, velocities = [], []

        def keep(q: NDArray[np.float64], v: NDArray[np.float64]) -> None:
            pin.forwardKinematics(model, data, q, v)
            place, motion = data.oMi[joint], data.v[joint]
            positions.append(place.act(point))
            velocities.append(place.rotation @ (motion.linear + np.cross(motion.angular, point)))

        self._integrate(keep)
        stride = self._steps // (SAMPLES - 1) if self._steps % (SAMPLES - 1) == 0 else 1
        times = np.linspace(0.0, self._duration, self._steps + 1)
        return History(times[::stride], np.array(positions)[::stride], np.array(velocities)[::stride])
