"""Exudyn: joint trees in minimal coordinates, closed loops in redundant ones; fixed steps."""

from __future__ import annotations

import sys
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

sys.exudynFast = True  # type: ignore[attr-defined]  # the build without range checks

import exudyn as exu  # noqa: E402
import exudyn.itemInterface as items  # noqa: E402, N813
from exudyn.rigidBodyUtilities import RigidBodyInertia  # noqa: E402
from peers_measure import SAMPLES, History, Ladder  # noqa: E402
from peers_problems import GROUND, Mechanism, Problem, Vector  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["NAME", "VERSION", "ladders"]

NAME = "Exudyn"
VERSION = exu.__version__

exu.SetWriteToConsole(False)  # steps that are too large are told by its return value

SPARSE_FROM = 10
"""Planar bodies from which the sparse linear solver is cheaper."""


def ladders(problem: Problem) -> list[Ladder]:
    """Solvers worth running on a problem; numbers of steps from cheap to dear.

    On trees without stiff springs the adaptive ones cost more for the same error.
    """
    halving = (500, 1000, 2000, 5000, 10000)
    settings: dict[str, dict[str, Iterable[int]]] = {
        "A01": {
            "RK44": (40, 60, 80, 100, 150, 200, 400, 600),
            "RK67": (30, 40, 50, 60, 80, 100, 150, 200),
        },
        "A02": {"GeneralizedAlpha": halving},
        "A03": {"TrapezoidalIndex2": (200, 500, 1000, 2000, 5000, 10000, 25000)},
        "A04": {"GeneralizedAlpha": (200, *halving)},
        "A05": {"TrapezoidalIndex2": (200, *halving, 20000)},
        "chain-10": {
            "RK44": (50, 70, 100, 200, 300, 400, 700),
            "RK67": (30, 40, 50, 70, 100, 150, 200),
        },
        "chain-50": {"RK44": (50, 70, 100, 200, 300, 400), "TrapezoidalIndex2": (50, 100, 200, 400, 1000)},
        "chain-200": {"TrapezoidalIndex2": (50, 100, 200, 400, 1000)},
    }
    chosen = settings.get(problem.name) or settings[problem.name.split("-")[0]]
    return [
        Ladder(NAME, solver, tuple(partial(_Run, problem, solver, value) for value in values))
        for solver, values in chosen.items()
    ]


class _Model:
    """A system with one ground, and the marked point to be recorded."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        self.mechanism = mechanism
        self.ground = self.add(items.ObjectGround())
        self.marked: Any = None  # interface of the sensor of the marked point, without what it records
        self.markers: Any = None  # function (link, point) -> marker

    def add(self, item: Any) -> int:
        """Add an object, load, marker, node or sensor."""
        kind = type(item).__name__
        for base in ("Marker", "Load", "Node", "Sensor"):
            if kind.startswith(base):
                return getattr(self.system, f"Add{base}")(item)
        return self.system.AddObject(item)

    def ground_marker(self, point: Iterable[float]) -> int:
        return self.add(items.MarkerBodyPosition(bodyNumber=self.ground, localPosition=list(point)))

    def finish(self) -> None:
        for spring in self.mechanism.springs:
            ends = [self.markers(*end) for end in zip(spring.links, spring.points, strict=True)]
            self.add(
                items.ObjectConnectorSpringDamper(
                    markerNumbers=ends,
                    stiffness=spring.stiffness,
                    damping=spring.damping,
                    referenceLength=spring.length,
                )
            )
        kinds = (exu.OutputVariableType.Position, exu.OutputVariableType.Velocity)
        self.sensors = [
            self.add(self.marked(outputVariableType=kind, writeToFile=False, storeInternal=True))
            for kind in kinds
        ]
        self.system.Assemble()


def _tree(mechanism: Mechanism) -> _Model:
    """Minimal coordinates: one kinematic tree."""
    model, links = _Model(mechanism), mechanism.links
    joints = [
        getattr(exu.JointType, ("Prismatic" if link.slides else "Revolute") + "XYZ"[link.axis.index(1.0)])
        for link in links
    ]
    count = len(links)
    node = model.add(
        items.NodeGenericODE2(
            referenceCoordinates=[0.0] * count,
            initialCoordinates=[link.start for link in links],
            initialCoordinates_t=[link.rate for link in links],
            numberOfODE2Coordinates=count,
        )
    )
    tree = model.add(
        items.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=joints,
            linkParents=[link.parent for link in links],
            jointTransformations=exu.Matrix3DList([np.eye(3)] * count),
            jointOffsets=exu.Vector3DList([np.array(link.offset) for link in links]),
            linkInertiasCOM=exu.Matrix3DList([np.diag(link.inertia) for link in links]),
            linkCOMs=exu.Vector3DList([np.array(link.centre) for link in links]),
            linkMasses=[link.mass for link in links],
            gravity=list(mechanism.gravity),
        )
    )
    model.markers = lambda link, point: model.add(
        items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=link, localPosition=list(point))
    )
    model.marked = partial(
        items.SensorKinematicTree,
        objectNumber=tree,
        linkNumber=mechanism.marked,
        localPosition=list(mechanism.point),
    )
    model.finish()
    return model


def _start_speeds(mechanism: Mechanism) -> list[float]:
    """Angular speed of every link of a planar mechanism at the start [rad/s]."""
    speeds: list[float] = []
    for link in mechanism.links:
        speeds.append(link.rate + (0.0 if link.parent == GROUND else speeds[link.parent]))
    return speeds


def _plane(mechanism: Mechanism) -> _Model:
    """Planar bodies with three coordinates each."""
    model = _Model(mechanism)
    poses, speeds, bodies = mechanism.start_poses(), _start_speeds(mechanism), []
    joint_velocities: list[Any] = []
    for link, (R, joint), speed in zip(mechanism.links, poses, speeds, strict=True):
        velocity = np.zeros(2)
        if link.parent != GROUND:
            dx, dy, _ = joint - poses[link.parent][1]
            velocity = joint_velocities[link.parent] + speeds[link.parent] * np.array([-dy, dx])
        joint_velocities.append(velocity)
        centre = R @ np.array(link.centre)
        angle = float(np.arctan2(R[1, 0], R[0, 0]))
        node = model.add(
            items.NodeRigidBody2D(
                referenceCoordinates=[*(joint + centre)[:2], angle],
                initialVelocities=[*(velocity + speed * np.array([-centre[1], centre[0]])), speed],
            )
        )
        body = model.add(
            items.ObjectRigidBody2D(nodeNumber=node, physicsMass=link.mass, physicsInertia=link.inertia[2])
        )
        bodies.append(body)
        if any(mechanism.gravity):
            marker = model.add(items.MarkerBodyMass(bodyNumber=body))
            model.add(items.LoadMassProportional(markerNumber=marker, loadVector=list(mechanism.gravity)))

    def local(link: int, point: Vector) -> list[float]:
        return list(np.array(point) - np.array(mechanism.links[link].centre))

    def marker(link: int, point: Vector) -> int:
        if link == GROUND:
            return model.ground_marker(point)
        return model.add(items.MarkerBodyPosition(bodyNumber=bodies[link], localPosition=local(link, point)))

    for number, link in enumerate(mechanism.links):
        ends = [marker(link.parent, link.offset), marker(number, (0.0, 0.0, 0.0))]
        model.add(items.ObjectJointRevolute2D(markerNumbers=ends))
    for closure in mechanism.closures:
        ends = [marker(*end) for end in zip(closure.links, closure.points, strict=True)]
        model.add(items.ObjectJointRevolute2D(markerNumbers=ends))
    if mechanism.torque:
        rigid = model.add(items.MarkerBodyRigid(bodyNumber=bodies[0]))
        model.add(items.LoadTorqueVector(markerNumber=rigid, loadVector=[0.0, 0.0, mechanism.torque]))
    model.markers = marker
    point = local(mechanism.marked, mechanism.point)
    model.marked = partial(items.SensorBody, bodyNumber=bodies[mechanism.marked], localPosition=point)
    model.finish()
    return model


def _space(mechanism: Mechanism) -> _Model:
    """Bodies that start at rest, with rotation vectors and Lie-group integration, and hinges between them."""
    model, bodies = _Model(mechanism), []
    for number, (link, (R, joint)) in enumerate(zip(mechanism.links, mechanism.start_poses(), strict=True)):
        body = model.system.CreateRigidBody(
            inertia=RigidBodyInertia(mass=link.mass, inertiaTensor=np.diag(link.inertia)),
            nodeType=exu.NodeType.RotationRotationVector,
            referencePosition=list(joint + R @ np.array(link.centre)),
            referenceRotationMatrix=R,
            gravity=list(mechanism.gravity),
        )
        parent = model.ground if link.parent == GROUND else bodies[link.parent]
        model.system.CreateRevoluteJoint(
            bodyNumbers=[parent, body], position=list(joint), axis=list(R @ link.axis)
        )
        bodies.append(body)
        for closure in mechanism.closures:
            if closure.links == (number, GROUND) and closure.axis is not None:
                place, axis = list(closure.points[1]), list(closure.axis)
                model.system.CreateRevoluteJoint(bodyNumbers=[body, model.ground], position=place, axis=axis)
    link = mechanism.links[mechanism.marked]
    point = list(np.array(mechanism.point) - np.array(link.centre))
    model.marked = partial(items.SensorBody, bodyNumber=bodies[mechanism.marked], localPosition=point)
    model.finish()
    return model


class _Run:
    """A number of equal steps."""

    def __init__(self, problem: Problem, solver: str, steps: int) -> None:
        mechanism = problem.mechanism()
        self.setting = f"{steps} steps"
        self._duration, self._steps = problem.duration, steps
        self._type = getattr(exu.DynamicSolverType, solver)
        make = _plane if mechanism.planar else _space
        if not mechanism.closures and (solver.startswith("RK") or mechanism.springs):
            make = _tree
        self._model = make(mechanism)
        self._settings = settings = exu.SimulationSettings()
        settings.solutionSettings.writeSolutionToFile = False
        settings.parallel.numberOfThreads = 1
        linear = exu.LinearSolverType
        large = len(mechanism.links) >= SPARSE_FROM and make is _plane
        settings.linearSolverType = linear.EigenSparse if large else linear.EXUdense
        integration = settings.timeIntegration
        integration.endTime = problem.duration
        integration.numberOfSteps = steps
        integration.newton.useModifiedNewton = True
        if make is _space:  # overconstrained: the dense solver that copes with redundant rows
            settings.linearSolverType = linear.EigenDense
            settings.linearSolverSettings.ignoreSingularJacobian = True
        if mechanism.springs and make is _tree:  # as Exudyn's own example of this governor
            integration.newton.maxModifiedNewtonIterations = 2
            integration.newton.numericalDifferentiation.jacobianConnectorDerivative = False
            integration.newton.relativeTolerance = 1e-6
            integration.generalizedAlpha.spectralRadius = 0.7

    def _solve(self, period: float) -> None:
        """Integrate, and record the marked point at a period [s]."""
        self._settings.solutionSettings.sensorsWritePeriod = period
        if not self._model.system.SolveDynamic(self._settings, solverType=self._type, showHints=False):
            raise RuntimeError("the solver gave up")

    def reset(self) -> None:
        """Nothing: every solution starts from the initial values."""

    def go(self) -> None:
        self._solve(2.0 * self._duration)

    def history(self) -> History:
        intervals = SAMPLES - 1 if self._steps % (SAMPLES - 1) == 0 else self._steps
        self._solve(self._duration / intervals)
        positions, velocities = (
            np.array(self._model.system.GetSensorStoredData(sensor)) for sensor in self._model.sensors
        )
        return History(positions[:, 0], positions[:, 1:4], velocities[:, 1:4])
