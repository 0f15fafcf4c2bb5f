"""From the frames and shells of a case to what the solver integrates: shapes, bodies, and joints along edges."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.memory import refuse_beyond_memory
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.assemble.frames import start_of_frame
from heavylift.pipeline.case.meshes import CORNERS, EDGES, RodBodySection
from heavylift.solver.joints.edges import expand_edge
from heavylift.solver.scene import meshes as m
from heavylift.solver.scene.mesh_loads import numbered

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.geometry import BoxGroup
    from heavylift.pipeline.case.meshes import (
        FrameBodySection,
        FrameSectionTable,
        RegionSection,
        ShellBodySection,
        ShellSectionTable,
        ShellSupportSection,
    )
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.connections import EdgeJoint, Joint
    from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
    from heavylift.solver.scene.scene import AnyBody

__all__ = [
    "Place",
    "assemble_body",
    "assemble_edge",
    "assemble_frame",
    "assemble_shell",
    "check_drawn_points",
    "check_on_mesh",
    "check_points",
    "check_pulleys",
    "frame_mesh",
    "joints_of_edge",
    "shell_mesh",
    "start_body",
]


@dataclass(frozen=True)
class Place:
    """A body of a case, for errors: where something in it stands in the case file."""

    case: Case
    name: str

    def error(self, key: str, problem: str, expected: str) -> InputError:
        """An error at a key below the body."""
        place = self.case.place(f"bodies.{self.name}.{key}")
        return InputError(problem, source=self.case.file, key=place, expected=expected)


FRAME_BYTES, FRAME_SECONDS = 4e3, 20e-6
"""Of an element of a frame, with its part of the factor; seconds until time starts."""
SHELL_BYTES, SHELL_SECONDS = 20e3, 100e-6
"""Of an element of a shell."""


def _refuse_beyond_memory(place: Place, count: float, bytes_each: float, seconds_each: float) -> None:
    """Refuse more elements than there is memory for, in the order of magnitude."""
    refuse_beyond_memory(
        count,
        "elements",
        bytes_each=bytes_each,
        seconds_each=seconds_each,
        source=place.case.file,
        key=place.case.place(f"bodies.{place.name}.geometry.elements"),
        remedy="fewer elements",
    )


def frame_mesh(place: Place, geometry: Any) -> FrameMesh:
    """Mesh of the geometry of a frame."""
    _refuse_beyond_memory(place, geometry.DESCRIBED.count(geometry), FRAME_BYTES, FRAME_SECONDS)
    with _reported(place):
        made: FrameMesh = assemble(geometry, {}, place.case.folder).mesh()
        return made


def shell_mesh(place: Place, geometry: Any) -> ShellMesh:
    """Mesh of the geometry of a shell."""
    _refuse_beyond_memory(place, geometry.DESCRIBED.count(geometry), SHELL_BYTES, SHELL_SECONDS)
    with _reported(place):
        made: ShellMesh = assemble(geometry, {}, place.case.folder).mesh()
        return made


@contextlib.contextmanager
def _reported(place: Place) -> Iterator[None]:
    """Put the place in the case file into errors on a geometry."""
    try:
        yield
    except InputError as error:
        if error.source:
            raise
        geometry = place.case.meshes[place.name].geometry
        key = "file" if error.key == "points" and getattr(geometry, "file", None) else error.key
        raise place.error(f"geometry.{key}", error.problem, error.expected) from None


AnyMesh = TypeVar("AnyMesh", m.FrameBody, m.ShellBody)

NEAR = 1e-6
"""Distance from a node, relative to the size of the mesh, at which a point or box still means it; and of two nodes that
are meant to be at one place, relative to the length of an edge."""
SQUARE = 1e-9
"""Deviation from one of the component of a normal along the axis it belongs to."""


def assemble_body(
    case: Case, name: str, body: Any, _folder: OutputFolder
) -> tuple[m.MeshBody, NDArray[np.float64]]:
    """Frame or shell of a case, and the origin of its axes in the coordinates of its geometry: zero."""
    return start_body(case, name, body)


def start_body(case: Case, name: str, body: Any) -> tuple[m.MeshBody, NDArray[np.float64]]:
    """The same: nothing of it waits for a stage."""
    origin = np.zeros(3)
    make: Any = {"curve": assemble_frame, "surface": assemble_shell}[body.BODY.SHAPE]
    return make(case, name, body, start_of_frame(body.initial, origin)), origin


def check_points(
    case: Case, body: Any, _origin: NDArray[np.float64], points: Sequence[tuple[str, ArrayLike]]
) -> None:
    """Points that it carries lie on the mesh, and pulleys turn about its tangent."""
    for key, point in points:
        check_on_mesh(body, point, case.file, key)
    if body.SHAPE == "curve" and not body.HAS_AXES:
        check_pulleys(case, body)


def check_drawn_points(
    case: Case, _section: Any, body: Any, points: Sequence[tuple[str, ArrayLike]]
) -> Iterator[tuple[str, InputError]]:
    """The same, as errors with their keys."""
    for key, point in points:
        try:
            check_on_mesh(body, point, case.file, key)
        except InputError as error:
            yield key, error
    if body.SHAPE == "curve" and not body.HAS_AXES:
        check_pulleys(case, body)


def assemble_frame(
    case: Case, name: str, body: FrameBodySection, initial: Mapping[str, NDArray[np.float64]]
) -> m.FrameBody:
    """Frame of a case.

    Parameters
    ----------
    case, name, body
        The case, and the name and table of the body.
    initial
        Position, orientation, velocity and angular velocity of its frame.

    Raises
    ------
    InputError
        If a node, element or point is not there; what is wrong with the mesh is left to the solver.
    """
    place = Place(case, name)
    mesh = frame_mesh(place, body.geometry)
    sections, chosen = _sections(place, body, mesh)
    supports = []
    for index, support in enumerate(body.supports):
        ends = [{"start": 0, "end": len(mesh.nodes) - 1}[end] for end in support.at]
        found = _nodes(place, f"supports.{index}", support, mesh.nodes, ends)
        supports.append(m.Support(found, support.held))
    common: dict[str, Any] = {
        "name": name,
        "nodes": mesh.nodes,
        "tangents": mesh.tangents,
        "elements": mesh.elements,
        "sections": tuple(
            _frame_section(section, body.shear_modulus if isinstance(body, RodBodySection) else 0.0)
            for section in sections
        ),
        "element_sections": chosen,
        "model": body.model,
        "axial_strains": _prestrain(place, body, sections, chosen, mesh),
        "supports": tuple(supports),
        "loads": tuple(_load(place, index, load, mesh) for index, load in enumerate(body.loads)),
        **_common(body, initial),
    }
    if isinstance(body, RodBodySection):
        return _checked(place, m.RodBody(normals=_normals(place, body, mesh), **common))
    return _checked(place, m.FrameBody(**common))


def _normals(place: Place, body: RodBodySection, mesh: FrameMesh) -> NDArray[np.float64]:
    """First directors of the nodes of a rod, shape (n, 3): carried along without turning about it, then twisted."""
    tangents, nodes = mesh.tangents, mesh.nodes
    given = np.eye(3)[np.argmin(np.abs(tangents[0]))] if body.normal is None else np.asarray(body.normal)
    across = given - (given @ tangents[0]) * tangents[0]
    if np.linalg.norm(across) <= 1e-6 * np.linalg.norm(given):
        raise place.error("normal", f"{list(given)} is along the first tangent", "a direction across it")
    found = [across / np.linalg.norm(across)]
    # two reflections: W. Wang and others, "Computation of rotation minimizing frames", ACM Trans. Graphics 27 (2008)
    for i in range(len(nodes) - 1):
        v = nodes[i + 1] - nodes[i]
        normal = found[-1] - 2.0 * (v @ found[-1]) / (v @ v) * v
        tangent = tangents[i] - 2.0 * (v @ tangents[i]) / (v @ v) * v
        w = tangents[i + 1] - tangent
        if w @ w > 0.0:
            normal = normal - 2.0 * (w @ normal) / (w @ w) * w
        found.append(normal / np.linalg.norm(normal))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    angle = body.twist * along / along[-1]
    normals = np.array(found)
    binormals = np.cross(tangents, normals)
    return np.cos(angle)[:, None] * normals + np.sin(angle)[:, None] * binormals


def assemble_shell(
    case: Case, name: str, body: ShellBodySection, initial: Mapping[str, NDArray[np.float64]]
) -> m.ShellBody:
    """Shell of a case: parameters and errors as of `assemble_frame`."""
    place = Place(case, name)
    mesh = shell_mesh(place, body.geometry)
    sections, chosen = _sections(place, body, mesh)
    supports = [
        made
        for index, support in enumerate(body.supports)
        for made in _shell_supports(place, index, support, mesh)
    ]
    shell = m.ShellBody(
        name=name,
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=tuple(
            m.ShellSection(s.thickness, s.density, s.young_modulus, s.poisson_ratio) for s in sections
        ),
        element_sections=chosen,
        gauss_points=body.gauss_points,
        supports=tuple(supports),
        loads=tuple(_load(place, index, load, mesh) for index, load in enumerate(body.loads)),
        **_common(body, initial),
    )
    return _checked(place, shell)


def check_on_mesh(body: m.FrameBody | m.ShellBody, point: ArrayLike, source: object, key: str) -> None:
    """Refuse a point that is not on the unloaded mesh of a body [m, frame of the body]."""
    from heavylift.solver.bodies.ancf.types import type_of

    type_of(body).locate(body, np.asarray(point, dtype=np.float64), str(source), key)


def check_pulleys(case: Case, body: m.FrameBody) -> None:
    """Refuse pulleys on a frame whose axis is across it: a frame has no torsion that would carry the axis along."""
    from heavylift.solver.bodies.ancf.bases import ALONG, frame_tangent

    for i, rope in enumerate(case.ropes):
        for k, stop in enumerate(rope.path):
            if stop.body != body.name or not stop.radius:
                continue
            axis = np.array([0.0, 0.0, 1.0] if stop.axis is None else stop.axis)
            tangent = frame_tangent(body, np.array(stop.point), rope.name)
            if np.linalg.norm(np.cross(tangent, axis)) > ALONG * np.linalg.norm(axis):
                raise InputError(
                    f"the axis of a pulley on the frame {body.name!r} is not along its tangent "
                    f"({', '.join(f'{x:.6g}' for x in tangent)})",
                    source=case.file,
                    key=case.place(f"ropes.{i}.path.{k}.axis"),
                    expected="an axis along the tangent, or a pulley on a small rigid body that is fixed to the frame",
                )


def _common(body: Any, initial: Mapping[str, NDArray[np.float64]]) -> dict[str, Any]:
    return {
        "viscous_damping": body.damping.viscous,
        "stiffness_damping": body.damping.stiffness,
        "elasticity": body.elasticity,
        "drift_tolerance": body.drift_tolerance,
        **initial,
    }


def _frame_section(section: FrameSectionTable, shear_modulus: float) -> m.FrameSection:
    area, second_moment, outer_fibre = section.numbers
    return m.FrameSection(
        section.density,
        section.young_modulus,
        area,
        second_moment,
        outer_fibre,
        shear_modulus * (section.torsion or 0.0),
    )


def _prestrain(
    place: Place,
    body: FrameBodySection,
    sections: Sequence[FrameSectionTable],
    chosen: NDArray[np.int64],
    mesh: FrameMesh,
) -> NDArray[np.float64]:
    """Strain of each element in the given shape, shape (e,); none if empty."""
    stiffness = np.array([section.young_modulus * section.numbers[0] for section in sections])
    strains: NDArray[np.float64] = (body.axial_force or 0.0) / stiffness[chosen] + (body.axial_strain or 0.0)
    for index, region in enumerate(body.regions):
        if region.axial_strain is not None:
            strains[_region(place, index, region, mesh)] = region.axial_strain
    return strains if np.any(strains) else np.zeros(0)


def _sections(
    place: Place, body: FrameBodySection | ShellBodySection, mesh: FrameMesh | ShellMesh
) -> tuple[list[Any], NDArray[np.int64]]:
    """Tables of the sections, that of all elements first, and the number of that of each element."""
    tables: list[FrameSectionTable | ShellSectionTable] = [body.section, *body.sections.values()]
    numbers = {name: number for number, name in enumerate(body.sections, start=1)}
    chosen = np.zeros(len(mesh.elements), dtype=np.int64)
    for index, region in enumerate(body.regions):
        found = _region(place, index, region, mesh)
        if region.section is not None:
            chosen[found] = numbers[region.section]
    return tables, chosen


def _region(
    place: Place, index: int, region: RegionSection, mesh: FrameMesh | ShellMesh
) -> NDArray[np.int64]:
    """Elements of a region."""
    key = f"regions.{index}"
    if region.box is None:
        return _numbers(place, f"{key}.elements", region.elements, len(mesh.elements), "element")
    found = np.flatnonzero(_inside(region.box, mesh.nodes[mesh.elements].mean(axis=1), 0.0))
    if not len(found):
        raise place.error(f"{key}.box", "no element has its centre in it", "a box around elements")
    return found


def _numbers(place: Place, key: str, numbers: Sequence[int], count: int, what: str) -> NDArray[np.int64]:
    """Numbers that must be those of nodes or elements."""
    try:
        return numbered(key, numbers, count, what)
    except InputError as error:
        raise place.error(error.key, error.problem, error.expected) from None


def _inside(box: BoxGroup, points: NDArray[np.float64], margin: float) -> NDArray[np.bool_]:
    lower, upper = np.array(box.lower) - margin, np.array(box.upper) + margin
    inside: NDArray[np.bool_] = np.all((points >= lower) & (points <= upper), axis=1)
    return inside


def _nodes(
    place: Place, key: str, support: Any, nodes: NDArray[np.float64], named: Sequence[int]
) -> NDArray[np.int64]:
    """Nodes of a support: those of its named place, or by number, point or box."""
    if named:
        return np.array(named, dtype=np.int64)
    near = NEAR * float(np.ptp(nodes, axis=0).max())
    if support.box is not None:
        found = np.flatnonzero(_inside(support.box, nodes, near))
        if not len(found):
            raise place.error(f"{key}.box", "no node lies in it", "a box around nodes")
        return found
    if support.point is not None:
        distances = np.linalg.norm(nodes - np.array(support.point), axis=1)
        nearest = int(np.argmin(distances))
        if distances[nearest] > near:
            shown = ", ".join(f"{1e3 * x:.6g}" for x in nodes[nearest])
            raise place.error(
                f"{key}.point",
                f"no node is there: the nearest one, {nearest} at ({shown}) mm, is {1e3 * distances[nearest]:.6g} mm "
                "away",
                "the place of a node; a joint to the ground holds any point",
            )
        return np.array([nearest], dtype=np.int64)
    return _numbers(place, f"{key}.nodes", support.nodes, len(nodes), "node")


def _shell_supports(
    place: Place, index: int, support: ShellSupportSection, mesh: ShellMesh
) -> list[m.Support]:
    """Supports of one table, one an edge: edges along x and along y hold different slopes."""
    key = f"supports.{index}"
    if not support.edge:
        corners = CORNERS if "all" in support.corner else support.corner
        named = [int(mesh.corners[CORNERS.index(corner)]) for corner in corners]
        found = _nodes(place, key, support, mesh.nodes, named)
        held = support.held
        if not held:
            axes = _normal_axis(place, key, mesh.slopes) if support.sliding else "xyz"
            vectors = ("position",) if support.fix == "pinned" else ("position", "slope_x", "slope_y")
            held = dict.fromkeys(vectors, axes)
        return [m.Support(found, held)]
    made = []
    for edge in EDGES if "all" in support.edge else dict.fromkeys(support.edge):
        held = support.held or _edge_fixed(place, key, support, edge, mesh.slopes)
        made.append(m.Support(mesh.edges[edge], held))
    return made


def _edge_fixed(
    place: Place, key: str, support: ShellSupportSection, edge: str, slopes: NDArray[np.float64]
) -> dict[str, str]:
    """Axes that an edge holds, by vector; the table of `heavylift.pipeline.case.meshes`."""
    along, across = ("slope_y", "slope_x") if edge.startswith("x") else ("slope_x", "slope_y")
    normal = _normal_axis(place, key, slopes) if support.sliding or support.fix == "clamped" else ""
    axes = normal if support.sliding else "xyz"
    held = {"position": axes}
    if support.fix != "pinned":
        held[along] = axes
    if support.fix == "clamped":
        held[across] = normal
        if not support.twist_free:
            held["twist"] = normal
    return held


def _normal_axis(place: Place, key: str, slopes: NDArray[np.float64]) -> str:
    """Axis of the body across the plane of the mesh."""
    normal = np.cross(slopes[0, 0], slopes[0, 1])
    normal /= max(float(np.linalg.norm(normal)), np.finfo(float).tiny)
    axis = int(np.argmax(np.abs(normal)))
    if abs(normal[axis]) < 1.0 - SQUARE:
        raise place.error(
            f"{key}.fix",
            f"the normal of the mesh, ({', '.join(f'{x:.6g}' for x in normal)}), is along no axis of the body",
            "a mesh in the x-y plane that 'initial.orientation' turns, or 'fixed'",
        )
    return "xyz"[axis]


def _load(
    place: Place, index: int, load: Any, mesh: FrameMesh | ShellMesh
) -> m.DistributedLoad | m.FollowerLoad:
    try:
        made: m.DistributedLoad | m.FollowerLoad = assemble(load, {}, place.case.folder).load(mesh)
    except InputError as error:
        raise place.error(f"loads.{index}.{error.key}", error.problem, error.expected) from None
    return made


_SHAPE_KEYS = ("elements", "nodes", "tangents", "slopes", "lengths")
"""What the solver says of arrays that come from the geometry."""


def _checked(place: Place, body: AnyMesh) -> AnyMesh:
    """The body, if the solver accepts it; errors are reported at the table that made it."""
    from heavylift.solver.bodies.ancf.types import type_of

    try:
        type_of(body).check(body)
    except InputError as error:
        head, _, rest = error.key.partition("[")
        number = rest.partition("]")[0]
        key, problem = error.key.replace("[", ".").replace("]", ""), error.problem
        if head in _SHAPE_KEYS:
            what = {"elements": "element", "lengths": "element"}.get(head, "node")
            key, problem = "geometry", f"{what} {number}: {problem}" if number else problem
        elif head == "sections" and number:
            tables = list(place.case.meshes[place.name].sections)
            key = "section" if number == "0" else f"sections.{tables[int(number) - 1]}"
        raise place.error(key, problem, error.expected) from None
    return body


def assemble_edge(case: Case, joint: Any, sides: Mapping[str, Side]) -> EdgeJoint:
    """Hinge or clamp of a case.

    Nodes of the second edge are put in the order of the first.

    Raises
    ------
    InputError
        If a node is not there, or the edges of two shells do not coincide; its key is below the joint.
    """
    given: list[NDArray[np.int64]] = []
    places: list[NDArray[np.float64]] = []
    names = joint.edges or ((joint.edge,) if joint.edge else ())
    for number in range(len(names) or len(joint.node_lists)):
        body = joint.between[number]
        table: Any = case.meshes[body]
        mesh = shell_mesh(Place(case, body), table.geometry)
        nodes = mesh.edges[names[number]] if names else np.array(joint.node_lists[number], dtype=np.int64)
        if nodes.max() >= len(mesh.nodes):
            raise InputError(
                f"there is no node {nodes.max()} in {body!r}",
                key=_key(joint, number),
                expected=f"numbers from 0 to {len(mesh.nodes) - 1}",
            )
        side = sides[body]
        given.append(nodes)
        places.append(side.position + mesh.nodes[nodes] @ side.rotation.T)
    if len(given) == 2:
        given[1] = _matched(joint, given[1], places)
    return joint.DESCRIBED(
        name=joint.name,
        body_a=joint.between[0],
        body_b=joint.between[1],
        nodes_a=given[0],
        nodes_b=given[1] if len(given) == 2 else np.zeros(0, dtype=np.int64),
        compliance=joint.compliance,
        relaxation=joint.relaxation,
    )


def _matched(
    joint: Any, nodes: NDArray[np.int64], places: Sequence[NDArray[np.float64]]
) -> NDArray[np.int64]:
    """Nodes of the second edge in the order of the first."""
    first, second = places
    if len(first) != len(second):
        raise InputError(
            f"{len(first)} nodes of {joint.between[0]!r} and {len(second)} of {joint.between[1]!r}",
            key=_key(joint),
            expected="edges that are divided into the same elements",
        )
    ways = [np.linalg.norm(first - other, axis=1) for other in (second, second[::-1])]
    turned = ways[1].max() < ways[0].max()
    distances = ways[int(turned)]
    if distances.max() > NEAR * np.linalg.norm(np.diff(first, axis=0), axis=1).sum():
        worst = int(np.argmax(distances))
        raise InputError(
            f"the edges do not coincide: node {worst} along them is {1e3 * distances[worst]:.6g} mm from the other one",
            key=_key(joint),
            expected="two edges at one place at the start; 'initial' places a body",
        )
    return nodes[::-1].copy() if turned else nodes


def joints_of_edge(joint: Any, made: EdgeJoint, bodies: Sequence[AnyBody]) -> list[Joint]:
    """Joints of its nodes, as the solver makes them; errors are reported with keys of the case."""
    try:
        return expand_edge(made, bodies)
    except InputError as error:
        number = {"nodes_a": 0, "nodes_b": 1}.get(error.key)
        key = error.key if number is None else _key(joint, number)
        raise InputError(error.problem, key=key, expected=error.expected) from None


def _key(joint: Any, number: int | None = None) -> str:
    """Key of the edges of a joint, or of one of them."""
    if joint.edge:
        return "edge"
    key = "edges" if joint.edges else "nodes"
    return key if number is None or (key == "nodes" and len(joint.node_lists) == 1) else f"{key}.{number}"
