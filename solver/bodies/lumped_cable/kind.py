"""The kind of cables of lumped masses: where everything is in its arrays.

Nodes i have masses m and positions q in world axes; a segment with the rest length L is a spring of the stiffness
``k = EA/L`` between two of them, with the energy ``W(l) = k/2 (l - L)^2``, or, if it does not push, zero below L.

The step is that of energy and momentum (J. C. Simo and N. Tarnow, Z. angew. Math. Phys. 43, 1992) with the discrete
gradient of a function of a distance (O. Gonzalez, J. Nonlinear Sci. 6, 1996). With chords ``r0, r1`` of lengths
``l0, l1`` at both ends of the step::

    M vb = M v + h/2 ( f + sum T m ) + G^T P,     q1 = q + h vb,     v1 = 2 vb - v
    m = (r0 + r1)/(l0 + l1),    T = (W(l1) - W(l0))/(l1 - l0) + c (l1 - l0)/h

so that ``T m . (r1 - r0)`` is the change of W, and the force is along the mean chord: energy and both momenta are kept
exactly, whatever the step. Newton's method finds vb; its matrix is block tridiagonal in blocks of three.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.records import Record, Records
from heavylift.solver.bodies.lumped_cable.lumped_cable import LumpedCableParts
from heavylift.solver.interface import FORCES, BodyKind, Workspace
from heavylift.solver.markers import PackedMarker

__all__ = ["CableData", "LumpedCables"]


class CableData(Record):
    """A cable: where it is among the others, its numbers, and what it carries from step to step.

    Attributes
    ----------
    number, dof
        Of the body in the scene; its first velocity in the workspace.
    first_node, node_count
        Of its nodes; its segments have the numbers of their first nodes.
    column, parts
        In a record.
    stiffness, rest_length, damping
        Of each segment [N/m], [m], [N s/m].
    pushes
        Whether it carries compression.
    mass, size
        [kg], unstretched length [m].
    external_work, dissipated_work
        [J].
    change, change_before
        Of the iteration: displacement in the last round [m], negative before the first, and in the one before.
    rounds
        Of the iteration.
    """

    number: int
    dof: int
    first_node: int
    node_count: int
    column: int
    parts: LumpedCableParts
    stiffness: float
    rest_length: float
    damping: float
    pushes: bool
    mass: float
    size: float
    external_work: float
    dissipated_work: float
    change: float
    change_before: float
    rounds: int


class LumpedCables(BodyKind):
    """All cables of lumped masses of a scene.

    Attributes
    ----------
    table
        By cable.
    constants
        Of markers and sensors: number of a node among all, and the share of the next one.
    mass
        Of the nodes [kg].
    position, velocity, acceleration
        Of the nodes, world axes, shape (nodes, 3), as all other nodal arrays: carried.
    mid_position
        Of the stage, for markers.
    load
        External forces of the stage [N].
    right
        Right-hand side, then solution; scratch.
    kept
        Velocities of the stage while rows are made anew.
    tension
        Of the segments, as recorded [N].
    diagonal, coupling
        Of the factor: inverse of the diagonal block of each node, and the block to the next one, shape (nodes, 9).
    markers, sensors
        Points.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.lumped_cable.step",
        "heavylift.solver.bodies.lumped_cable.record",
    )
    carried_fields: ClassVar[tuple[str, ...]] = ("table", "position", "velocity", "acceleration")

    table: Records[CableData]
    constants: Floats1
    mass: Floats1
    position: Floats2
    velocity: Floats2
    acceleration: Floats2
    mid_position: Floats2
    load: Floats2
    right: Floats2
    kept: Floats2
    tension: Floats1
    diagonal: Floats2
    coupling: Floats2
    markers: Records[PackedMarker]
    sensors: Records[PackedMarker]

    def lengths(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses and unstretched lengths."""
        return self.table["mass"], self.table["size"]

    def _places(self, cable: CableData) -> tuple[slice, slice]:
        """Of its nodes, and of its velocities in the workspace."""
        nodes = slice(cable.first_node, cable.first_node + cable.node_count)
        return nodes, slice(cable.dof, cable.dof + 3 * cable.node_count)

    def survey(
        self, places: NDArray[np.float64], inertia: NDArray[np.float64], velocity: NDArray[np.float64]
    ) -> None:
        """Centres of mass; masses of the nodes."""
        for cable in self.table:
            nodes, dofs = self._places(cable)
            centre = self.mass[nodes] @ self.position[nodes] / cable.mass
            places[cable.number] = cable.dof, *centre, 1.0, 0.0, 0.0, 0.0
            inertia[dofs] = np.repeat(self.mass[nodes], 3)
            velocity[dofs] = self.velocity[nodes].ravel()

    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace the nodes."""
        for cable in self.table:
            nodes, dofs = self._places(cable)
            self.position[nodes] += increment[dofs].reshape(-1, 3)

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Of the nodes."""
        for cable in self.table:
            nodes, dofs = self._places(cable)
            self.velocity[nodes] = velocity[dofs].reshape(-1, 3)
            self.acceleration[nodes] = 0.0

    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """``J^T f`` of the markers that forces act on, weight, and tension."""
        for marker in self.markers[self.markers["level"] == FORCES]:
            node, share = int(self.constants[marker.data]), self.constants[marker.data + 1]
            cable = self.table[marker.body]
            force = np.asarray(work.markers["force"][marker.number])
            for at, part in ((node, 1.0 - share), (node + 1, share)):
                if part:
                    dof = int(cable.dof) + 3 * (at - int(cable.first_node))
                    load[dof : dof + 3] += part * force
        for cable in self.table:
            nodes, dofs = self._places(cable)
            chords = np.diff(self.position[nodes], axis=0)
            length = np.linalg.norm(chords, axis=1)
            tension = cable.stiffness * (length - cable.rest_length)
            if not cable.pushes:
                tension = np.maximum(tension, 0.0)
            pull = (tension / length)[:, None] * chords
            own = self.mass[nodes][:, None] * np.asarray(work.sums.gravity)
            own[:-1] += pull
            own[1:] -= pull
            load[dofs] += own.ravel()
