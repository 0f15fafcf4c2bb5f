"""Stresses that checks name: of material points of bodies, and the largest of a solid; by the rules of pictures.

Solids: stress at the nodes, averaged over the elements around (`heavylift.modal.stress`), in body axes; at a point
between them interpolated by the shape functions of its element. Shells and frames: stress of the element at the point,
without an average over neighbours (`heavylift.solver.bodies.ancf.stress`).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.mesh_motion import mesh_coordinates
from heavylift.pipeline.results.mesh_results import mesh_body
from heavylift.pipeline.results.model_io import read_model, read_reduced

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.statics import StaticState
    from heavylift.modal.stress_points import StressPoints
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.mesh_results import MeshShape
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.pipeline.results.stress_io import BodyStress
    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.solver.scene.meshes import ShellSide

__all__ = [
    "SolidStresses",
    "frame_point_stress",
    "interpolated",
    "nodal_stresses",
    "shell_point_stress",
]

_VALUES = 1_000_000  # stresses handled at once


class SolidStresses:
    """Stresses of a flexible body.

    Parameters
    ----------
    name
        Of the body.
    folder
        Output folder with its model and modes.
    source
        Named in messages.
    stress
        Of a body with a table ``stress``: what its static correction adds to the modes.
    """

    def __init__(
        self, name: str, folder: OutputFolder, source: object, stress: BodyStress | None = None
    ) -> None:
        model = read_model(folder.model(name))
        if model.structure is None and (model.mesh is None or model.material is None):
            raise InputError(
                f"{name!r} has no stress: its model has no elements, or not one material",
                source=str(source),
                expected="a body with geometry 'blocks', 'step' or 'mesh', of one material",
            )
        self.model, self._name, self._source, self._folder = model, name, source, folder
        self._stress = stress
        self._states: dict[str, NDArray[np.float64]] = {}

    @cached_property
    def shapes(self) -> NDArray[np.float64]:
        """Modes and static corrections in the layout of the model, shape (N, nf)."""
        from heavylift.pipeline.checks.body_stress import model_columns

        columns = model_columns(read_reduced(self._folder.reduced(self._name)))
        return columns if self._stress is None else np.hstack([columns, self._stress.correction])

    def coordinates(self, results: Results) -> NDArray[np.float64]:
        """Of the shapes at all records, shape (records, nf)."""
        modal = results[f"{self._name}.modal_position"].reshape(len(results.time), -1)
        return modal if self._stress is None else np.hstack([modal, self._stress.loads])

    @cached_property
    def _points(self) -> list[StressPoints]:
        """Of a structure, all of them."""
        from heavylift.modal.structure_stress import structure_points

        return structure_points(self.model)

    @cached_property
    def _modes(self) -> NDArray[np.float64]:
        """Stress at the nodes by modal coordinate, shape (nf, n, 6)."""
        n = self.model.node_count
        return self._nodal_stress(self.shapes[: 3 * n].T.reshape(-1, n, 3))

    def _nodal_stress(self, displacements: NDArray[np.float64]) -> NDArray[np.float64]:
        from heavylift.modal.stress import stress_modes

        assert self.model.mesh is not None
        assert self.model.material is not None
        return stress_modes(self.model.mesh, self.model.material, displacements)

    def _of(self, state: StaticState) -> NDArray[np.float64]:
        """Stress at the nodes under a static load case [Pa], shape (n, 6)."""
        if state.name not in self._states:
            self._states[state.name] = self._nodal_stress(state.displacements[np.newaxis])[0]
        return self._states[state.name]

    def nodal(self, state: StaticState, component: str) -> NDArray[np.float64]:
        """Component of the stress at all nodes under a static load case [Pa], shape (n,)."""
        from heavylift.modal.stress import stress_component

        if self.model.structure is not None:
            return nodal_stresses(self.model, [state.displacements], [state.rotations], self._points)[0]
        return stress_component(self._of(state), component)

    def at(self, state: StaticState, point: ArrayLike, component: str) -> float:
        """Component of the stress at a point under a static load case [Pa]."""
        from heavylift.modal.stress import stress_component

        self._refuse_points()
        stress = interpolated(self.model, self._of(state)[np.newaxis], point, self._source)[0]
        return float(stress_component(stress, component))

    def _refuse_points(self) -> None:
        if self.model.structure is not None:
            raise InputError(
                f"{self._name!r} has plates or beams, whose stress differs from part to part at one point",
                source=str(self._source),
                expected="stress.BODY.GROUP.von_mises of a group, or a hot spot, of its table 'stress'",
            )

    def fields(self, amplitudes: NDArray[np.float64], nodes: NDArray[np.int64]) -> NDArray[np.float64]:
        """Von Mises stress of some nodes at modal coordinates, shape (k, nf), [Pa], shape (k, len(nodes))."""
        from heavylift.modal.stress import stress_component

        if self.model.structure is not None:
            return _at_nodes(self.model, self._points, self.shapes, amplitudes)[:, nodes]
        modes = self._modes[:, nodes]
        found = np.empty((len(amplitudes), len(nodes)))
        size = max(1, _VALUES // max(1, len(nodes)))
        for start in range(0, len(amplitudes), size):
            part = slice(start, start + size)
            found[part] = stress_component(np.tensordot(amplitudes[part], modes, axes=1), "von_mises")
        return found

    def history(self, results: Results, point: ArrayLike | None, component: str) -> NDArray[np.float64]:
        """Component of the stress at a point, or the largest of all nodes if it is None [Pa], shape (records,)."""
        from heavylift.modal.stress import stress_component

        coordinates = self.coordinates(results)
        if point is not None:
            self._refuse_points()
        if self.model.structure is not None:
            return self._largest(coordinates)
        modes = (
            self._modes
            if point is None
            else interpolated(self.model, self._modes, point, self._source)[:, np.newaxis]
        )
        found = np.empty(len(coordinates))
        size = max(1, _VALUES // modes.shape[1])
        for start in range(0, len(coordinates), size):
            part = slice(start, start + size)
            values = stress_component(np.tensordot(coordinates[part], modes, axes=1), component)
            found[part] = values.max(axis=1)
        return found

    def _largest(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Largest von Mises stress of a structure at each record [Pa], shape (records,)."""
        from heavylift.modal.stress_history import PointGroup, recover_stress

        found = np.zeros(len(coordinates))
        for points in self._points:
            if points.total.any():
                group = PointGroup(points.name, np.arange(len(points)))
                (history,), _ = recover_stress(points, self.shapes, coordinates, [group])
                np.maximum(found, history.largest[:, points.total].max(axis=1), out=found)
        return found


def nodal_stresses(
    model: FEModel,
    displacements: Sequence[NDArray[np.float64]],
    rotations: Sequence[NDArray[np.float64] | None],
    points: list[StressPoints] | None = None,
) -> NDArray[np.float64]:
    """Von Mises stress at all nodes of a body for some displacements of it.

    Parameters
    ----------
    model
        With its elements.
    displacements, rotations
        Of all nodes [m, rad], shapes (n, 3); None where no node has rotations.
    points
        Of a structure, where they are known.

    Returns
    -------
    NDArray
        Shape (k, n) [Pa]; of structures the largest of all points of a node, not a number where there is none.
    """
    from heavylift.modal.stress import stress_modes, von_mises

    if model.structure is None:
        assert model.mesh is not None
        assert model.material is not None
        return von_mises(stress_modes(model.mesh, model.material, np.array(displacements)))
    from heavylift.modal.structure_stress import structure_points

    columns = [
        np.concatenate([moved.ravel(), np.empty(0) if turned is None else turned[model.rotating].ravel()])
        for moved, turned in zip(displacements, rotations, strict=True)
    ]
    found = points if points is not None else structure_points(model)
    return _at_nodes(model, found, np.column_stack(columns), np.eye(len(columns)))


def _at_nodes(
    model: FEModel,
    points: list[StressPoints],
    shapes: NDArray[np.float64],
    amplitudes: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Largest von Mises stress at the nodes of a structure, shape (k, n), for coordinates (k, nf) of shapes (N, nf)."""
    from heavylift.modal.stress_history import stress_at_records
    from heavylift.modal.stress_points import largest_at_nodes

    count = len(amplitudes)
    found = np.empty((count, model.node_count))
    size = max(1, _VALUES // max(1, sum(map(len, points))))
    for start in range(0, count, size):
        part = slice(start, min(start + size, count))
        mises = [stress_at_records(one, shapes, amplitudes[part])[1] for one in points]
        for number in range(part.stop - part.start):
            now = [one[number] for one in mises]
            found[start + number] = largest_at_nodes(points, now, model.node_count)
    return found


def interpolated(
    model: FEModel, nodal: NDArray[np.float64], point: ArrayLike, source: object
) -> NDArray[np.float64]:
    """Nodal values, shape (m, n, k), at a point in coordinates of the geometry [m], shape (m, k)."""
    from heavylift.preprocess.finite_elements.mesh import find_place

    nodes, weights = find_place(model.nodes, model.mesh or model.structure, point, source=source)
    values: NDArray[np.float64] = np.einsum("a,mak->mk", weights, nodal[:, nodes])
    return values


def shell_point_stress(
    shape: MeshShape, results: Results, point: ArrayLike, component: str, source: object
) -> NDArray[np.float64]:
    """``von_mises``, or ``SIDE.von_mises``, ``SIDE.xx``, ``SIDE.yy``, ``SIDE.xy`` of a point [Pa], shape (records,).

    Axes are those of the surface, the first along the lines of the mesh direction x.
    """
    from heavylift.solver.bodies.ancf.shell_packing import locate
    from heavylift.solver.bodies.ancf.stress import shell_stresses

    body: Any = mesh_body(shape)
    element, (x, y) = locate(body, np.asarray(point, dtype=np.float64), str(source), "sensor")
    own = slice(element, element + 1)
    body = replace(
        body,
        elements=body.elements[own],
        lengths=body.lengths[own],
        element_sections=body.element_sections[own],
    )
    found = shell_stresses(body, mesh_coordinates(shape, results, slice(None)), [x], [y])
    side, _, part = component.rpartition(".")
    if part == "von_mises":
        mises: NDArray[np.float64] = found.von_mises(cast("ShellSide", side or "largest"))[:, 0, 0, 0]
        return mises
    stress = found.membrane + {"top": 1.0, "middle": 0.0, "bottom": -1.0}[side] * found.bending
    values: NDArray[np.float64] = stress[:, 0, 0, 0, ("xx", "yy", "xy").index(part)]
    return values


def frame_point_stress(
    shape: MeshShape, results: Results, point: ArrayLike, component: str, source: object
) -> NDArray[np.float64]:
    """``axial``, N/A, or ``largest``, N/A +- M c/I with the sign of N, at a point [Pa], shape (records,)."""
    from heavylift.solver.bodies.ancf.frame_packing import locate
    from heavylift.solver.bodies.ancf.stress import frame_stresses

    body: Any = mesh_body(shape)
    element, (x,) = locate(body, np.asarray(point, dtype=np.float64), str(source), "sensor")
    own = slice(element, element + 1)
    body = replace(
        body,
        elements=body.elements[own],
        element_sections=body.element_sections[own],
        axial_strains=body.axial_strains[own],
    )
    coordinates = mesh_coordinates(shape, results, slice(None))
    found = frame_stresses(body, coordinates, [x], lengths=shape.lengths[own, 0])
    values: NDArray[np.float64] = (found.axial_stress if component == "axial" else found.largest)[:, 0, 0]
    return values
