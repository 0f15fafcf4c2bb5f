"""Sections of a report on frames and shells: what they are, what holds and loads them, how far they went."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.case.channel_kinds import lies_along_edge
from heavylift.pipeline.report.described import own_words
from heavylift.pipeline.report.document import Facts, Section, Table, Text, short_table
from heavylift.pipeline.report.inputs import initial_rows
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.words import number_words, numbers_words
from heavylift.solver.scene.descriptions import described_fields
from heavylift.solver.scene.mesh_shapes import ShellShape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.mesh_results import MeshShape

__all__ = [
    "edge_sections",
    "mesh_facts",
    "mesh_sections",
]

_EXTREMES = ("axial_force", "membrane_force", "bending_moment", "axial_stress", "von_mises", "strain_drift")
"""Channels of elements whose extremes are shown."""


def mesh_sections(case: Case, results: Results | None) -> list[Section]:
    """Sections on the frames and shells of a case, one each; with extremes of the results if there are any."""
    sections = []
    for name, body in case.meshes.items():
        shape = results.meshes.get(name) if results is not None else None
        items: list[Facts | Table | Text] = [Facts(tuple(mesh_facts(body, shape)))]
        if results is not None and shape is not None and len(results.time):
            items += [_places(results, shape), _extremes(results, name)]
        sections.append(Section(f"{body.type.capitalize()} {name}", tuple(items)))
    return sections


def mesh_facts(body: Any, shape: MeshShape | None) -> list[tuple[str, str]]:
    """What a frame or shell is, from its table, and its mesh once it is known."""
    rows = [("geometry", _geometry(body.geometry)), ("section", _section(body.section))]
    for name, section in body.sections.items():
        places = [_region(region) for region in body.regions if region.section == name]
        rows.append((f"section {name}", f"{_section(section)}; {', '.join(places) or 'not used'}"))
    for region in body.regions:
        if getattr(region, "axial_strain", None) is not None:
            strain = number_words(region.axial_strain, "")
            rows.append(("initial axial strain", f"{strain}; {_region(region)}"))
    if shape is not None:
        vectors = 1 + shape.vectors.shape[1]
        count = len(shape.nodes)
        words = f"{len(shape.elements)} elements, {count} nodes, {3 * vectors * count} coordinates"
        rows.append(("mesh", f"{words}, {int(shape.fixed.sum())} of them held"))
    rows.append(("elasticity", _elasticity(body)))
    for key, unit in (("axial_force", "N"), ("axial_strain", "")):
        if getattr(body, key, None) is not None:
            rows.append(("initial " + key.replace("_", " "), number_words(getattr(body, key), unit)))
    damping = [f"viscous {body.damping.viscous:.6g} 1/s"] if body.damping.viscous else []
    if body.damping.stiffness:
        damping.append(f"{number_words(body.damping.stiffness, 's')} times the stiffness")
    rows += [("damping", ", ".join(damping))] if damping else []
    rows += [("support", _support(support)) for support in body.supports]
    rows += [("load", _load(load)) for load in body.loads]
    return rows + initial_rows(body.initial)


def _geometry(given: Any) -> str:
    """Kind of a geometry and its measures."""
    if issubclass(given.DESCRIBED, ShellShape):
        count = " x ".join(map(str, given.DESCRIBED.counts(given))) + " elements"
    else:
        count = f"{given.elements} elements" if given.elements else "elements between the points"
    points = getattr(given, "points", ())
    words = [f"{len(points)} points"] if points else []
    words += [
        own_words(field, getattr(given, field.name), "")
        for field in described_fields(given.DESCRIBED)
        if field.name not in {"elements", "points"}
    ]
    return f"{given.type}: {', '.join(filter(None, words))}; {count}"


def _region(region: Any) -> str:
    """Elements of a region."""
    if region.box is None:
        return f"elements {numbers_words(region.elements, '')}"
    return f"from {numbers_words(region.box.lower, 'm')} to {numbers_words(region.box.upper, 'm')}"


def _section(section: Any) -> str:
    """Material and measures of a section."""
    words = [f"E {number_words(section.young_modulus, 'Pa')}", f"density {section.density:.6g} kg/m³"]
    if hasattr(section, "thickness"):
        words[:0] = [f"thickness {number_words(section.thickness, 'm')}"]
        return ", ".join([*words, f"Poisson's ratio {section.poisson_ratio:.6g}"])
    area, second_moment, _ = section.numbers
    shapes = [
        f"{key} {number_words(getattr(section, key), 'm')}"
        for key in ("diameter", "wall", "side")
        if getattr(section, key) is not None
    ]
    words += [f"area {area:.6g} m²", f"second moment {second_moment:.6g} m⁴"]
    return ", ".join([*shapes, *words])


def _elasticity(body: Any) -> str:
    """Strain measure, and how stress enters the step."""
    words = {
        "auto": f"integrated strains, until they drift by {body.drift_tolerance:g}; then energy-momentum",
        "carried": "carried strains",
        "energy-momentum": "energy-momentum",
        "explicit": "explicit forces",
    }[body.elasticity]
    measure = {"green-lagrange": "strain of Green-Lagrange", "exact": "stretch and material curvature"}
    points = f", {body.gauss_points} x {body.gauss_points} points" if body.type == "shell" else ""
    return f"{measure[getattr(body, 'model', 'green-lagrange')]}{points}; {words}"


def _support(support: Any) -> str:
    """Place and kind of a support."""
    for key in ("at", "edge", "corner"):
        names = getattr(support, key, ())
        if names:
            place = f"{'' if key == 'at' else key + ' '}{', '.join(names)}"
            break
    else:
        if support.point is not None:
            place = f"node at {numbers_words(support.point, 'm')}"
        elif support.box is not None:
            place = f"nodes from {numbers_words(support.box.lower, 'm')} to {numbers_words(support.box.upper, 'm')}"
        else:
            place = f"nodes {numbers_words(support.nodes, '')}"
    if support.fixed is not None:
        held = {key: axes for key, axes in support.fixed.model_dump().items() if axes}
        return f"{place}: {', '.join(f'{key} {axes}' for key, axes in held.items())} held"
    more = [
        word
        for key, word in (("sliding", "sliding"), ("twist_free", "twist free"))
        if getattr(support, key, False)
    ]
    return f"{place}: {', '.join([support.fix, *more])}"


def _load(load: Any) -> str:
    """Kind, place and size of a load."""
    words = [
        own_words(field, getattr(load, field.name))
        for field in described_fields(load.DESCRIBED)
        if field.name not in {"times", "factors"}
    ]
    table = f", times a table of {len(load.times)} points" if load.times else ""
    return f"{load.type.replace('_', ' ')}: {', '.join(filter(None, words))}{table}"


def _places(results: Results, shape: MeshShape) -> Table:
    """Ends of a frame, corners and middle of a shell: initially, at start and end; and the farthest node."""
    count = len(shape.nodes)
    positions = results[f"{shape.name}.position"].reshape(len(results.time), count, 3)
    drawn = shape.world_nodes()
    moved = np.linalg.norm(positions - drawn, axis=2)
    record, farthest = np.unravel_index(int(np.argmax(moved)), moved.shape)
    size = float(np.ptp(drawn, axis=0).max())
    unit = scaled_unit("m", [np.array([size])])
    records = {"first record": 0, "last record": -1} if len(positions) > 1 else {"recorded": 0}
    rows = [
        (
            f"{word} (node {node})",
            *(
                ", ".join(f"{round(x / size, 9) * size / unit.divisor + 0.0:.7g}" for x in point)
                for point in (drawn[node], *(positions[index, node] for index in records.values()))
            ),
        )
        for word, node in _named_nodes(shape).items()
    ]
    largest = number_words(float(moved[record, farthest]), "m") + _when(results, int(record), " at ")
    rows.append((f"farthest from its place (node {farthest})", largest, *([""] * len(records))))
    columns = ["initial position", *records]
    return short_table(("node", *(f"{column} [{unit.text}]" for column in columns)), rows)


def _when(results: Results, record: int, word: str = ", ") -> str:
    """Time of a record behind a word, if there are several."""
    if len(results.time) < 2:
        return ""
    return word + number_words(float(results.time[record]), "s")


def _named_nodes(shape: MeshShape) -> dict[str, int]:
    """Nodes worth a row of the table, by what they are called."""
    if shape.type == "frame":
        return {"start": 0, "end": len(shape.nodes) - 1}
    uses = np.bincount(shape.elements.ravel(), minlength=len(shape.nodes))
    named: dict[str, int] = {}
    for local, word in enumerate(("x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max")):
        found = shape.elements[uses[shape.elements[:, local]] == 1, local]
        if len(found) == 1:
            named[f"corner {word}"] = int(found[0])
    middle = shape.nodes.mean(axis=0)
    named["nearest to the middle"] = int(np.argmin(np.linalg.norm(shape.nodes - middle, axis=1)))
    return named


def _extremes(results: Results, name: str) -> Table:
    """Smallest and largest value of the channels of elements: where and when."""
    rows = []
    for kind in _EXTREMES:
        channel = f"{name}.{kind}"
        if channel not in results:
            continue
        history = results[channel].reshape(len(results.time), -1)
        pure = results.unit(channel) == "1"
        unit = scaled_unit("" if pure else results.unit(channel), [history])
        words = kind.replace("_", " ")
        row = [words if pure else f"{words} [{unit.text}]"]
        for index in (int(np.argmin(history)), int(np.argmax(history))):
            record, column = np.unravel_index(index, history.shape)
            place = _component_words(results.components(channel)[column]) if history.shape[1] > 1 else ""
            value = history[record, column] / (1.0 if pure else unit.divisor) + 0.0
            row.append(f"{value:.6g}{place}{_when(results, int(record))}")
        rows.append(tuple(row))
    return short_table(("over all elements and records", "smallest", "largest"), rows)


def _component_words(component: str) -> str:
    """Element and point of a component such as ``"3.top"``."""
    number, _, rest = component.partition(".")
    if not number.isdecimal():
        return f" ({component})" if component else ""
    return f" (element {number}{', ' + rest.replace('.', ' ') if rest else ''})"


def edge_sections(case: Case, results: Results | None) -> list[Section]:
    """Reactions along the edges of a case, one row a joint; nothing without such joints or records."""
    joints = [joint for joint in case.joints if lies_along_edge(joint.type)]
    if results is None or not len(results.time) or not joints:
        return []
    rows = []
    for joint in joints:
        forces = _histories(results, joint.name, "reaction_force")
        moments = _histories(results, joint.name, "reaction_moment")
        if not len(forces):
            continue
        total = forces.sum(axis=0)
        record = int(np.argmax(np.linalg.norm(total, axis=1)))
        rows.append(
            (
                joint.name,
                str(len(forces)),
                _largest(results, forces, "N"),
                _largest(results, moments, "N m"),
                numbers_words(total[record].tolist(), "N") + _when(results, record),
            )
        )
    if not rows:
        return []
    columns = (
        "joint",
        "nodes",
        "largest force at a node",
        "largest moment at a node",
        "largest force of all nodes",
    )
    table: Table = short_table(columns, rows)
    return [Section("Reactions along edges", (table,))]


def _histories(results: Results, joint: str, kind: str) -> NDArray[np.float64]:
    """Reactions of all nodes, shape (nodes, records, 3)."""
    found: list[NDArray[np.float64]] = []
    while f"{joint}.{len(found)}.{kind}" in results:
        found.append(results[f"{joint}.{len(found)}.{kind}"].reshape(len(results.time), 3))
    return np.array(found).reshape(len(found), len(results.time), 3)


def _largest(results: Results, histories: NDArray[np.float64], unit: str) -> str:
    """Largest length of a vector, with its node and time."""
    sizes = np.linalg.norm(histories, axis=2)
    node, record = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
    return f"{number_words(float(sizes[node, record]), unit)} (node {node}){_when(results, int(record))}"
