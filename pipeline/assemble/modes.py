"""From the table of modes of a flexible body to its reduced body."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.modal.stiffening import HERE
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.finite_elements import four_files, in_body
from heavylift.pipeline.assemble.interfaces import arm_notes, held_places, interface_fits, pulled_places
from heavylift.pipeline.case.places import located
from heavylift.preprocess.finite_elements.groups import RELATIVE_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.modal.bases import Basis, Loads
    from heavylift.modal.flexibility import Flexibility
    from heavylift.modal.interfaces import Fit
    from heavylift.modal.reduced import ReducedBody
    from heavylift.modal.statics import StaticState
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.case.modes import ContactPatchSection, ModesSection
    from heavylift.pipeline.case.statics import BodySupportSection, StaticLoadSection
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = ["flexibility_of", "reduce_model", "reduced_properties"]


_BORNE = 1e-12
"""Of a load of a place: what rounding leaves of it where it acts on nodes that are held."""


class Reduction(NamedTuple):
    """What a reduction finds.

    Attributes
    ----------
    body
        Reduced body.
    origin
        Of its frame, in coordinates of the geometry [m].
    states
        Of the static load cases.
    notes
        Sentences on what was chosen.
    """

    body: ReducedBody
    origin: tuple[float, float, float]
    states: list[StaticState]
    notes: list[str]


def reduce_model(case: Case, body: FlexibleBodySection, model: FEModel, folder: OutputFolder) -> Reduction:
    """Reduced body of a model in a folder."""
    name = next(name for name, other in case.bodies.items() if other is body)
    with in_body(case, name, model.name):
        held = held_directions(model, body.supports)
        return _reduce(
            case, name, body, replace(model, fixed_dofs=np.union1d(model.fixed_dofs, held)), folder
        )


def held_directions(model: FEModel, supports: Sequence[BodySupportSection]) -> NDArray[np.int64]:
    """Degrees of freedom that the supports of a body hold, sorted.

    Raises
    ------
    InputError
        A group that does not exist, a support without a node, a body on both sides of its plane of symmetry, rotations
        of nodes that have none.
    """
    held = [np.empty(0, dtype=np.int64)]
    for index, support in enumerate(supports):
        key = f"supports.{index}"
        if support.symmetry is not None:
            axis = "xyz".index(support.symmetry)
            slack = RELATIVE_TOLERANCE * float(np.linalg.norm(np.ptp(model.nodes, axis=0)))
            nodes = np.flatnonzero(np.abs(model.nodes[:, axis] - support.at) <= slack)
            low, high = float(model.nodes[:, axis].min()), float(model.nodes[:, axis].max())
            both = low < support.at - slack and high > support.at + slack
            if not nodes.size or both:
                plane = f"the plane {support.symmetry} = {support.at:.9g} m"
                raise InputError(
                    f"the body is on both sides of {plane}" if both else f"no node in {plane}",
                    key=key,
                    expected="half of a body, which ends at its plane of symmetry, or 'on' a group and 'fixed'; it "
                    f"spans {low:.6g} to {high:.6g} m",
                )
            turning = model.rotation_dofs[nodes]
            held += [
                3 * nodes + axis,
                *(turning[turning >= 0] + other for other in range(3) if other != axis),
            ]
        else:
            nodes = _place_nodes(model, support, key)
            held += [3 * nodes + "xyz".index(axis) for axis in support.fixed or ""]
            turning = model.rotation_dofs[nodes]
            if support.rotations is not None and not (turning >= 0).any():
                raise InputError(
                    f"rotations of {len(nodes)} node(s) that have none",
                    key=f"{key}.rotations",
                    expected="nodes of plates or beams",
                )
            held += [turning[turning >= 0] + "xyz".index(axis) for axis in support.rotations or ""]
    return np.unique(np.concatenate(held))


def _place_nodes(
    model: FEModel, place: BodySupportSection | StaticLoadSection, key: str
) -> NDArray[np.int64]:
    """Nodes of the groups of a support or load that lie in its box."""
    from heavylift.modal.contact_vectors import patch_nodes

    nodes = _nodes_of(model, place.on, f"{key}.on") if place.on else np.arange(model.node_count)
    if place.lower is None or place.upper is None:
        return nodes
    return patch_nodes(model, nodes, box=(place.lower, place.upper), name=key)


def _faces_of(model: FEModel, load: StaticLoadSection, key: str) -> NDArray[np.int64]:
    """Outer faces of each group of a load, once each: a face between two groups is of neither."""
    from heavylift.modal.contact_vectors import outer_faces

    if len(load.on) < 2:
        return outer_faces(model, _place_nodes(model, load, key), name=key)
    parts = [load.model_copy(update={"on": (group,)}) for group in load.on]
    return np.unique(
        np.concatenate([outer_faces(model, _place_nodes(model, part, key), name=key) for part in parts]),
        axis=0,
    )


def _static_states(flexibility: Flexibility, body: FlexibleBodySection) -> list[StaticState]:
    """Equilibrium under each static load case of a body, with the buckling factors that are asked for."""
    from heavylift.modal.buckling import buckling
    from heavylift.modal.statics import solve_static
    from heavylift.modal.stress_stiffness import stress_stiffness

    model, cases = flexibility.model, body.static
    asked = [index for index, one in enumerate(cases) if one.buckling]
    if asked:
        stiffness_of = stress_stiffness(
            model, formulation=body.mesh.formulation, key=f"static.{asked[0]}.buckling"
        )
    states = []
    for index, one in enumerate(cases):
        forces = np.zeros(model.dof_count)
        for number, load in enumerate(one.loads):
            forces += _nodal_forces(model, load, f"static.{index}.loads.{number}")
        state = solve_static(flexibility, forces, f"static.{index}")._replace(name=one.name)
        if one.buckling:
            found = buckling(
                flexibility, stiffness_of(_all_motions(model, state)), key=f"static.{index}.buckling"
            )
            state = state._replace(buckling_factor=found.factor)
        states.append(state)
    return states


def _all_motions(model: FEModel, state: StaticState) -> NDArray[np.float64]:
    """Displacements of all nodes and rotations of those that have some, shape (N,)."""
    if state.rotations is None:
        return state.displacements.ravel()
    return np.concatenate([state.displacements.ravel(), state.rotations[model.rotating].ravel()])


def _nodal_forces(model: FEModel, load: StaticLoadSection, key: str) -> NDArray[np.float64]:
    """Nodal forces of a load [N, N m], node-major, shape (N,)."""
    from heavylift.modal.flexibility import apply_mass
    from heavylift.modal.interfaces import group_weights
    from heavylift.modal.statics import face_area, face_forces

    if load.acceleration is not None:
        field = np.zeros(model.dof_count)
        field[: 3 * model.node_count] = np.tile(load.acceleration, model.node_count)
        return apply_mass(model.mass, field)
    nodes = _place_nodes(model, load, key)
    if load.moment is not None:
        turning = nodes[model.rotation_dofs[nodes] >= 0]
        if not len(turning):
            raise InputError(
                f"a moment on {len(nodes)} node(s) without rotations",
                key=key,
                expected="nodes of plates or beams; forces of a couple on solids",
            )
        moments = np.zeros(model.dof_count)
        shares = group_weights(model, turning)[:, np.newaxis] * np.asarray(load.moment)
        moments[model.rotation_dofs[turning][:, np.newaxis] + np.arange(3)] = shares
        return moments
    try:
        faces = _faces_of(model, load, key)
    except InputError:
        if load.force is None:
            raise
        forces = np.zeros(model.dof_count)
        at_nodes = forces[: 3 * model.node_count].reshape(-1, 3)
        if model.structure is None:
            at_nodes[nodes] = np.asarray(load.force) / len(nodes)
        else:
            at_nodes[nodes] = group_weights(model, nodes)[:, np.newaxis] * np.asarray(load.force)
        return forces
    if load.pressure is not None:
        return face_forces(model, faces, pressure=load.pressure)
    if load.traction is not None:
        return face_forces(model, faces, traction=load.traction)
    assert load.force is not None
    return face_forces(model, faces, traction=np.asarray(load.force) / face_area(model, faces))


@contextlib.contextmanager
def _below_interfaces(model: FEModel) -> Iterator[None]:
    """Put the key of an interface into errors that know its name."""
    try:
        yield
    except InputError as error:
        key = f"interfaces.{error.source}.{error.key}"
        raise InputError(error.problem, source=model.name, key=key, expected=error.expected) from None


def _reduce(
    case: Case, name: str, body: FlexibleBodySection, model: FEModel, folder: OutputFolder
) -> Reduction:
    from heavylift.modal import bases, interfaces
    from heavylift.modal.eigen import eigenmodes
    from heavylift.modal.flexibility import Flexibility
    from heavylift.modal.reduction import reduce_body

    options = body.modes
    clamped = _nodes_of(model, options.clamp, "modes.clamp")
    fits, rigid = _fits(model, body)
    elastic, flexibility = model, None
    masters: dict[str, NDArray[np.int64]] = {}
    if rigid:
        with _below_interfaces(model):
            model, masters = interfaces.stiffened(model, rigid, fixed_nodes=clamped)
    static_loads = _loads(options, model, clamped)
    if options.attach and not options.patches:
        static_loads += contour_loads(case, name, model, folder, fixed_nodes=clamped)
    origin = np.zeros(3)
    if body.frame.origin == "centre_of_mass":
        origin = model.centre_of_mass
    if options.basis == "stored":
        assert body.geometry.type == "four_files"
        shapes = four_files(case, body.geometry).modes
        chosen = [number - 1 for number in options.select] or list(range(shapes.shape[1]))
        if max(chosen) >= shapes.shape[1]:
            raise InputError(
                f"requests shape {max(chosen) + 1}",
                source=case.file,
                key="modes.select",
                expected=f"numbers up to {shapes.shape[1]}, the stored shapes",
            )
        basis = bases.Basis(shapes[:, chosen], tuple(f"stored {number + 1}" for number in chosen))
    elif options.basis == "craig_bampton" and not options.interface:
        basis = interfaces.rigid_craig_bampton(
            model, rigid, masters, options.count, up_to=options.up_to, fixed_nodes=clamped
        )
    elif options.basis == "craig_bampton":
        interface = _nodes_of(model, options.interface, "modes.interface")
        basis = bases.craig_bampton(model, interface, options.count, up_to=options.up_to, fixed_nodes=clamped)
    else:
        flexibility = Flexibility(model, clamped)
        parts = []
        if options.count or options.up_to is not None:
            modes = eigenmodes(model, options.count, up_to=options.up_to, flexibility=flexibility)
            parts.append(bases.eigenmode_basis(modes, options.select or None))
        if options.basis == "krylov":
            parts += [bases.moment_matching(flexibility, loads, options.order) for loads in static_loads]
        basis = sum(parts[1:], start=parts[0])
    if flexibility is None and (options.has_static or body.interfaces or body.static):
        flexibility = Flexibility(model, clamped)
    if flexibility is not None and options.basis != "krylov":
        for loads in static_loads:
            basis += bases.static_vectors(flexibility, loads)
    exact = {}
    for one, found in fits.items():
        assert flexibility is not None
        vectors, exact[one] = _attachment_modes(flexibility, interfaces.attachment_loads(model, found, one))
        if options.basis != "craig_bampton" or options.interface:
            basis += vectors
    joined = {}
    if options.basis != "stored":
        joined = held_places(case, name, body, elastic, origin, fits.values())
    for one, found in joined.items():
        flexibility = flexibility or Flexibility(model, clamped)
        loads = interfaces.attachment_loads(model, found, f"joint {one}")
        basis += _attachment_modes(flexibility, loads)[0]
    if model.structure is not None and options.basis not in {"stored", "krylov"}:
        points = pulled_places(case, name, body, elastic, origin, [*fits.values(), *joined.values()])
        if points:
            flexibility = flexibility or Flexibility(model, clamped)
            basis += bases.static_vectors(flexibility, bases.place_loads(model, np.array(points)))
    reduced = reduce_body(
        model,
        basis.vectors,
        basis.labels,
        fixed_nodes=clamped,
        origin=origin,
        mean_axis=body.frame.motion == "free",
    )
    places = {one: interfaces.interface_of(reduced, found, origin, exact[one]) for one, found in fits.items()}
    reduced = replace(reduced, interfaces=places)
    if options.stiffening:
        reduced = _stiffened(model, reduced, body, clamped, origin, flexibility, {**fits, **joined})
    states = []
    if body.static:
        assert flexibility is not None
        states = _static_states(flexibility, body)
    start = (float(origin[0]), float(origin[1]), float(origin[2]))
    notes = [
        *_ended_by_count(options, basis.labels),
        *arm_notes(elastic, fits),
        *([_held_note(joined, model)] if joined else []),
    ]
    return Reduction(reduced, start, states, notes)


def _fits(model: FEModel, body: FlexibleBodySection) -> tuple[dict[str, Fit], dict[str, Fit]]:
    """All interfaces of a body on its nodes, and those of them that do not deform."""
    fits = interface_fits(model, body.interfaces, lambda group, key: _nodes_of(model, [group], key))
    return fits, {one: fits[one] for one, section in body.interfaces.items() if section.kind == "rigid"}


def flexibility_of(body: FlexibleBodySection, model: FEModel) -> Flexibility:
    """Factorised stiffness of the body that modes were made of: held and clamped, with its rigid interfaces.

    Parameters
    ----------
    body
        Its section.
    model
        As the mesh stage has it.
    """
    from heavylift.modal import interfaces
    from heavylift.modal.flexibility import Flexibility

    model = replace(model, fixed_dofs=np.union1d(model.fixed_dofs, held_directions(model, body.supports)))
    clamped = _nodes_of(model, body.modes.clamp, "modes.clamp")
    rigid = _fits(model, body)[1]
    if rigid:
        model = interfaces.stiffened(model, rigid, fixed_nodes=clamped)[0]
    return Flexibility(model, clamped)


def _attachment_modes(flexibility: Flexibility, loads: Loads) -> tuple[Basis, NDArray[np.float64]]:
    """Deflections under loads of a place, and its compliance along them; loads that supports bear make none."""
    from heavylift.modal import bases

    felt = flexibility.dofs.gathered(loads.forces)[flexibility.unknowns]
    chosen = np.abs(felt).max(axis=0, initial=0.0) > _BORNE * np.abs(loads.forces).max(axis=0)
    vectors = bases.static_vectors(flexibility, loads)
    compliance = np.sum(loads.forces * vectors.vectors, axis=0)
    labels = tuple(label for label, one in zip(vectors.labels, chosen, strict=True) if one)
    return bases.Basis(vectors.vectors[:, chosen], labels), compliance


def _ended_by_count(options: ModesSection, labels: Sequence[str]) -> list[str]:
    """Sentence if the number of eigenmodes ended before their frequency did."""
    if options.up_to is None or not options.count:
        return []
    word = "fixed-interface mode" if options.basis == "craig_bampton" else "eigenmode"
    found = sum(label.startswith(word) for label in labels)
    if found < options.count:
        return []
    return [
        f"WARNING: count = {options.count} ends before up_to = {options.up_to:.6g} Hz: there may be more modes"
    ]


def _held_note(joined: Mapping[str, Fit], model: FEModel) -> str:
    """Sentence on places that joints hold; a point of a plate gets softer with each finer mesh."""
    names = ", ".join(repr(one) for one in joined)
    words = f"attachment modes for forces and moments of joints that hold its directions: {names}"
    if model.structure is None or not model.structure.shells:
        return words
    return (
        f"{words}; a plate that is held at a point gets softer with each finer mesh: an interface over a bracket or a "
        "line of plating does not"
    )


def _stiffened(
    model: FEModel,
    reduced: ReducedBody,
    body: FlexibleBodySection,
    clamped: NDArray[np.int64],
    origin: NDArray[np.float64],
    flexibility: Flexibility | None,
    fits: Mapping[str, Fit],
) -> ReducedBody:
    """With what loads along it do to the stiffness; nothing holds a free body (its clamps are refused before)."""
    from heavylift.modal.bases import Loads, place_loads
    from heavylift.modal.flexibility import Flexibility
    from heavylift.modal.interfaces import attachment_loads
    from heavylift.modal.stress_stiffness import inertia_stiffening, stress_stiffness, with_loads

    free = body.frame.motion == "free"
    if free and (model.fixed_nodes.size or model.fixed_dofs.size):
        raise InputError(
            "its frame is free, and supports hold its nodes",
            key="modes.stiffening",
            expected="a frame that is 'fixed' or 'driven', or no supports",
        )
    stiffness_of = stress_stiffness(model, formulation=body.mesh.formulation)
    flexibility = flexibility or Flexibility(model, clamped)
    stiffening = inertia_stiffening(flexibility, reduced, stiffness_of)
    at = [found.point for found in fits.values()]
    loads = [attachment_loads(model, found, name) for name, found in fits.items()]
    others = [
        point
        for point in body.modes.static_points
        if np.linalg.norm(np.array([*at, np.full(3, np.inf)]) - point, axis=1).min() > HERE * reduced.size
    ]
    if others:
        loads.append(place_loads(model, others, key="modes.static_points"))
    if loads:
        together = Loads(
            np.hstack([one.forces for one in loads]), tuple(label for one in loads for label in one.labels)
        )
        places = np.array([*at, *others]) - origin
        stiffening = with_loads(stiffening, flexibility, reduced, stiffness_of, together, places)
    return replace(reduced, stiffening=stiffening)


def _nodes_of(model: FEModel, groups: Sequence[str], key: str) -> NDArray[np.int64]:
    """Nodes of some groups together."""
    for group in groups:
        if group not in model.node_groups:
            known = ", ".join(sorted(model.node_groups)) or "none"
            raise InputError(f"group {group!r} does not exist", key=key, expected=f"one of: {known}")
    parts = [model.node_groups[group] for group in groups]
    return np.unique(np.concatenate(parts)).astype(np.int64) if parts else np.empty(0, dtype=np.int64)


def _loads(options: ModesSection, model: FEModel, clamped: NDArray[np.int64]) -> list[Loads]:
    """Static loads of the points, groups and contact patches of a reduction."""
    from heavylift.modal import bases

    loads = []
    if options.static_points:
        loads.append(
            bases.place_loads(
                model, options.static_points, options.static_directions, key="modes.static_points"
            )
        )
    for group in options.static_groups:
        nodes = _nodes_of(model, [group], "modes.static_groups")
        loads.append(bases.patch_loads(model, nodes, options.static_directions, name=group))
    for index, patch in enumerate(options.patches):
        members = _nodes_of(model, [patch.on], f"modes.patches.{index}.on")
        loads.append(patch_load(model, patch, members, fixed_nodes=clamped, key=f"modes.patches.{index}"))
    return loads


def patch_load(
    model: FEModel,
    patch: ContactPatchSection,
    members: NDArray[Any],
    *,
    fixed_nodes: Sequence[int] | NDArray[Any] = (),
    key: str,
) -> Loads:
    """Unit loads of a patch.

    Parameters
    ----------
    model
        Finite-element model.
    patch
        What to load.
    members
        Nodes of the group that the patch is on.
    fixed_nodes
        Clamped nodes.
    key
        Place of the patch in the case file, for messages.

    Returns
    -------
    Loads
        See `heavylift.modal.bases.Loads`.

    Raises
    ------
    InputError
        If the group is no face of the body, or the patch has no free node on it.
    """
    from heavylift.modal import bases, contact_vectors

    normal = patch.directions == contact_vectors.NORMAL
    faces = (
        contact_vectors.outer_faces(model, members, name=f"{key}.on") if normal or patch.footprint else None
    )
    if patch.footprint:
        assert faces is not None
        assert patch.centre is not None
        assert patch.radius is not None
        loads = contact_vectors.footprint_loads(
            model, faces, patch.centre, patch.radius, patch.directions, name=key
        )
    else:
        box = None if patch.lower is None or patch.upper is None else (patch.lower, patch.upper)
        disc = None if patch.centre is None or patch.radius is None else (patch.centre, patch.radius)
        nodes = contact_vectors.patch_nodes(model, members, box=box, disc=disc, name=key)
        normals = None if faces is None else contact_vectors.surface_normals(model, faces)
        loads = contact_vectors.contact_loads(
            model, nodes, patch.directions, normals=normals, fixed_nodes=fixed_nodes, name=key
        )
    word = f"{patch.on} footprint" if patch.footprint else patch.on
    return bases.Loads(loads.forces, tuple(label.replace(key, word, 1) for label in loads.labels))


def contour_loads(
    case: Case,
    body: str,
    model: FEModel,
    folder: OutputFolder,
    *,
    fixed_nodes: Sequence[int] | NDArray[Any] = (),
) -> list[Loads]:
    """Unit loads on the nodes of all contours of a body, one set a contour.

    The control points of a contour follow its nodes, so that any contact force on it is a combination of these loads.

    Parameters
    ----------
    case
        The case.
    body
        Name of the body.
    model
        Its finite-element model.
    folder
        Output folder that holds the model.
    fixed_nodes
        Clamped nodes.

    Raises
    ------
    InputError
        If the body has no contour, or a contour no free node.
    """
    from heavylift.modal.contact_vectors import NORMAL, contact_loads, grid_normals
    from heavylift.pipeline.assemble.contacts import contour_nodes
    from heavylift.pipeline.case.contours import SurfaceContourSection

    directions = case.bodies[body].modes.attach_directions
    loads = []
    for name, contour in case.contours.items():
        if contour.body != body:
            continue
        nodes = contour_nodes(case, name, model.nodes, folder)
        if nodes.ndim == 1 and isinstance(contour, SurfaceContourSection):
            with located(case, f"contours.{name}"):
                loads.append(
                    _loads_of_fit(
                        model, nodes, contour.degree, directions or NORMAL, np.asarray(fixed_nodes), name
                    )
                )
            continue
        chosen = directions or (NORMAL if nodes.ndim == 2 else "xyz")
        normals = None
        if chosen == NORMAL and isinstance(contour, SurfaceContourSection):
            normals = np.zeros((model.node_count, 3))
            normals[nodes] = grid_normals(model.nodes[nodes], contour.closed)
        loads.append(
            contact_loads(
                model, np.unique(nodes), chosen, normals=normals, fixed_nodes=fixed_nodes, name=name
            )
        )
    if not loads:
        raise InputError(
            f"no contour is of the body {body!r}",
            source=model.name,
            key="modes.attach",
            expected="a contour of this body, or 'patches' of its surface",
        )
    return loads


def _loads_of_fit(
    model: FEModel,
    nodes: NDArray[np.int64],
    degrees: tuple[int, int],
    directions: str,
    fixed_nodes: Sequence[int] | NDArray[Any],
    name: str,
) -> Loads:
    """Unit forces on each control point of a surface that is fitted to nodes of a face, on the free ones of these."""
    from heavylift.contours.splines.face_fit import fitted_surface
    from heavylift.modal.bases import Loads
    from heavylift.modal.contact_vectors import NORMAL

    fit = fitted_surface(model.nodes, nodes, np.zeros((0, *model.nodes.shape)), degrees=degrees, source=name)
    axes = (
        fit.normal[np.newaxis]
        if directions == NORMAL
        else np.eye(3)[["xyz".index(axis) for axis in directions]]
    )
    free = ~np.isin(nodes, np.union1d(fixed_nodes, model.fixed_nodes))
    forces = np.zeros((model.dof_count, len(axes), len(fit.shares)))
    for k in range(3):
        forces[3 * nodes[free] + k] = axes[:, k][:, np.newaxis] * fit.shares[:, free].T[:, np.newaxis, :]
    labels = [NORMAL] if directions == NORMAL else list(directions)
    count = len(fit.shares)
    return Loads(
        forces.reshape(model.dof_count, -1),
        tuple(f"{name} control point {c + 1} {label}" for label in labels for c in range(count)),
    )


def reduced_properties(reduction: Reduction) -> dict[str, Any]:
    """Numbers of a reduced body and its static load cases for its manifest."""
    reduced, states = reduction.body, reduction.states
    return {
        "notes": [*reduction.notes, *_large_deflections(reduced, states)],
        "interfaces": {
            name: f"{round(100.0 * one.captured, 3):.4g} % of its static compliance captured"
            for name, one in reduced.interfaces.items()
        }
        or None,
        "static": {state.name: f"residual {state.residual:.0e}" for state in states} or None,
        "vector_count": reduced.mode_count,
        "frequencies_hz": [float(f) for f in reduced.frequencies],
        "largest_residual": float(reduced.residuals.max()),
        "orthogonality": reduced.orthogonality,
        "dropped": list(reduced.dropped) or None,
    }


def _large_deflections(reduced: ReducedBody, states: Sequence[StaticState]) -> list[str]:
    """Sentences on static load cases that move the body too far for linear statics."""
    from heavylift.modal.reduced import LARGE_DEFLECTION

    found = []
    for state in states:
        share = float(np.linalg.norm(state.displacements, axis=1).max()) / reduced.size
        if share > LARGE_DEFLECTION:
            found.append(
                f"WARNING: static load case {state.name!r} moves it by {share:.3g} of its size: linear statics are "
                f"for displacements that are small beside it ({LARGE_DEFLECTION:.0%}); take a body of type 'frame' or "
                "'shell', or smaller loads"
            )
    return found
