"""Sections of a report on its flexible bodies: material, mesh, modes, and pictures of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.modal.reduced import EIGENMODE_RESIDUAL
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.checks.stresses import nodal_stresses
from heavylift.pipeline.report.document import Facts, Figure, Section, Table, Text
from heavylift.pipeline.report.inputs import body_input_rows, mesh_input_rows
from heavylift.pipeline.report.interfaces import interface_table
from heavylift.pipeline.results.model_io import read_model, read_reduced, read_states
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.words import number_words, numbers_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.modal.statics import StaticState
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.pictures.bodies import Painter
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.pipeline.results.stress_io import BodyStress
    from heavylift.preprocess.finite_elements.model import FEModel

    Item = Text | Facts | Table | Figure

__all__ = ["body_sections"]

_SHEET_MODES = 30  # modes on a contact sheet at most, unless the case asks for more pictures
_TABLE_MODES = 100  # rows of the table of modes at most
_NODAL = "At the nodes, as the mean of the elements around."
_OF_PARTS = (
    "At the nodes, the largest of both sides of all plates, corners of beams and solids there, each as the mean of its "
    "own elements around."
)
_NOT_EIGENMODES = (
    "“Not an eigenmode”: the vector belongs to the basis but is no eigenmode of the full model (relative residual "
    f"{EIGENMODE_RESIDUAL:g} or more), as static, Krylov, component-mode and stored vectors after the Ritz step. "
    "Its frequency is that of the reduced body, and its residual is no measure of accuracy."
)


def body_sections(
    case: Case,
    name: str,
    body: Any,
    stages: OutputFolder,
    results: Results | None,
    renderer: Renderer | None,
    album: Album,
    log: Log | None = None,
) -> list[Section]:
    """Sections on one flexible body, from whatever stages have run.

    Parameters
    ----------
    case, name, body
        The case, and the name and table of the body.
    stages
        Output folder.
    results
        Time histories, if there are any.
    renderer
        Draws; None on a machine that cannot.
    album
        Takes the pictures.
    log
        Told how far the stress over the run is.
    """
    title = f"Flexible body {name}"
    try:
        model = read_model(stages.model(name))
    except InputError as error:
        facts = Facts((*mesh_input_rows(body), *body_input_rows(body)))
        return [Section(title, (facts, Text(f"No finite-element model: {error}", warning=True)))]
    painter = _painter(case, model, renderer)
    marks = _marks(model, body)
    items: list[Item] = [_model_facts(model, body)]
    if painter is not None:
        kind = _mesh_words(model)
        file = album.add(
            f"{name}_mesh",
            painter.mesh(title=f"{name}: {_shown(model)}", note=kind, marks=marks),
        )
        caption = f"{_shown(model).capitalize()} of {name}: {kind}."
        items.append(Figure(file, caption + (f" Marked: {', '.join(marks)}." if marks else "")))
    sections = [Section(title, tuple(items))]
    try:
        reduced = read_reduced(stages.reduced(name))
    except InputError as error:
        return [*sections, Section(f"Modes of {name}", (Text(f"No modes: {error}", warning=True),))]
    at_rest = read_states(stages.reduced(name))
    items = [_modes_table(reduced)]
    if not reduced.eigenmode_mask.all():
        items.append(Text(_NOT_EIGENMODES))
    if reduced.interfaces:
        items.append(interface_table(reduced))
    if painter is not None:
        items += _mode_figures(case, name, reduced, painter, album)
    sections.append(Section(f"Modes of {name}", tuple(items)))
    if at_rest:
        sections.append(Section(f"Static load cases of {name}", (_static_table(model, at_rest),)))
    over_run = None
    if body.stress is not None and results is not None and len(results.time):
        from heavylift.pipeline.report.stress import stress_of_run

        over_run, items = stress_of_run(case, name, stages, results, painter, album, log)
        sections.append(Section(f"Stress of {name} over the run", tuple(items)))
    if painter is not None:
        items = _stress_figures(case, name, model, reduced, at_rest, results, painter, album, over_run)
        if items:
            sections.append(Section(f"Stress in {name}", tuple(items)))
    return sections


def _painter(case: Case, model: FEModel, renderer: Renderer | None) -> Painter | None:
    if renderer is None:
        return None
    from heavylift.pipeline.drawn.outer_surface import surface_from_nodes, surface_of_model
    from heavylift.pipeline.pictures.bodies import Painter
    from heavylift.pipeline.pictures.camera import choose_view

    surface = surface_of_model(model.mesh, model.structure) or surface_from_nodes(model.nodes)
    up = None
    if case.gravity is not None and any(case.gravity.acceleration):
        # up is where gravity comes from, if that is near an axis of the body frame
        pull = np.abs(case.gravity.acceleration)
        up = np.eye(3)[np.argmax(pull)] * -np.sign(case.gravity.acceleration[int(np.argmax(pull))])
    return Painter(renderer, surface, view=choose_view(surface, up=up))


def _marks(model: FEModel, body: Any) -> dict[str, NDArray[np.int64]]:
    """Node groups worth marking: clamped and interface nodes, nodes fixed by the data."""
    names = dict.fromkeys((*body.modes.clamp, *body.modes.interface))
    marks = {
        f"{name}, clamped" if name in body.modes.clamp else name: model.node_groups[name]
        for name in names
        if name in model.node_groups
    }
    if model.fixed_nodes.size:
        marks["fixed by the data"] = model.fixed_nodes
    if body.supports:
        from heavylift.pipeline.assemble.modes import held_directions

        nodes, axes = np.divmod(held_directions(model, body.supports), 3)
        marks |= {f"{axis} held": nodes[axes == k] for k, axis in enumerate("xyz") if np.any(axes == k)}
    return marks


def _shown(model: FEModel) -> str:
    """What a picture shows, of a model with elements and of one that is matrices alone."""
    bare = model.mesh is None and model.structure is None
    return "nodes of the model" if bare else "finite element mesh"


def _mesh_words(model: FEModel) -> str:
    nodes = f"{model.node_count} nodes, {model.dof_count} degrees of freedom"
    if model.structure is not None:
        shells, beams, solids = model.structure.shells, model.structure.beams, model.structure.solids
        counts = {
            "plates": sum(len(part.elements) for part in shells),
            "beams": sum(len(part.elements) for part in beams),
            "solids": sum(len(part.elements) for part in solids),
        }
        return f"{', '.join(f'{count} {word}' for word, count in counts.items() if count)}, {nodes}"
    if model.mesh is None:
        return f"matrices without elements, {nodes}"
    return f"{model.mesh.element_count} {model.mesh.element_type} elements, {nodes}"


def _model_facts(model: FEModel, body: Any) -> Facts:
    rows: list[tuple[str, str]] = []
    if model.material is not None:
        modulus = scaled_unit("Pa", [np.array([model.material.young_modulus])])
        rows += [
            ("Young's modulus", f"{model.material.young_modulus / modulus.divisor:.6g} {modulus.text}"),
            ("Poisson's ratio", f"{model.material.poisson_ratio:.6g}"),
            ("density", f"{model.material.density:.6g} kg/m³"),
        ]
    size = np.ptp(model.nodes, axis=0)
    unit = scaled_unit("m", [size])
    rows += [
        *mesh_input_rows(body),
        ("mesh", _mesh_words(model)),
        ("size", " × ".join(f"{value / unit.divisor:.5g}" for value in size) + f" {unit.text}"),
        ("mass", f"{model.total_mass:.8g} kg ({'lumped' if model.is_lumped else 'consistent'} mass matrix)"),
    ]
    if model.mesh is not None:
        rows.append(("volume", f"{model.mesh.volume / unit.divisor**3:.8g} {unit.text}³"))
    rows += [("of the file", note) for note in model.notes]
    rows += body_input_rows(body)
    if body.modes.clamp:
        rows.append(("clamped", ", ".join(body.modes.clamp)))
    rows += [("support", _support(support)) for support in body.supports]
    rows += [(f"load case {one.name}", "; ".join(map(_static_load, one.loads))) for one in body.static]
    ratios = sorted({f"{ratio:.4g}" for ratio in body.modes.damping_ratio})
    rows.append(("damping ratio", " to ".join(dict.fromkeys((ratios[0], ratios[-1]))) if ratios else "0"))
    if body.modes.stiffness_damping:
        rows.append(("damping", f"{number_words(body.modes.stiffness_damping, 's')} times the stiffness"))
    return Facts(tuple(rows))


def _place(place: Any) -> str:
    """Groups and box of a support or load."""
    words = [" and ".join(place.on)] if place.on else []
    if place.lower is not None:
        words.append(f"from {numbers_words(place.lower, 'm')} to {numbers_words(place.upper, 'm')}")
    return ", ".join(words)


def _support(support: Any) -> str:
    if support.symmetry is not None:
        return f"symmetry, {support.symmetry} = {number_words(support.at, 'm')}"
    held = [support.fixed] if support.fixed else []
    held += [f"rotations about {support.rotations}"] if support.rotations else []
    return f"{_place(support)}: {' and '.join(held)} held"


def _static_load(load: Any) -> str:
    if load.pressure is not None:
        return f"pressure {number_words(load.pressure, 'Pa')} on {_place(load)}"
    key, unit = next(
        (key, unit)
        for key, unit in (("traction", "Pa"), ("force", "N"), ("moment", "N m"), ("acceleration", "m/s²"))
        if getattr(load, key) is not None
    )
    where = f" on {_place(load)}" if key != "acceleration" else ""
    return f"{key} {numbers_words(getattr(load, key), unit)}{where}"


def _frequencies(reduced: ReducedBody) -> NDArray[np.float64]:
    return np.sqrt(np.maximum(reduced.eigenvalues, 0.0)) / (2.0 * np.pi)


def _hertz(frequency: float) -> str:
    """Six digits, trailing zeros kept."""
    return f"{frequency:#.6g}".rstrip(".") + " Hz"


def _modes_table(reduced: ReducedBody) -> Table:
    rows = [
        (str(number), label, f"{frequency:#.8g}", f"{residual:.1e}" if eigenmode else "not an eigenmode")
        for number, (label, frequency, residual, eigenmode) in enumerate(
            zip(
                reduced.labels, _frequencies(reduced), reduced.residuals, reduced.eigenmode_mask, strict=True
            ),
            start=1,
        )
    ]
    if len(rows) > _TABLE_MODES:
        rows = [*rows[:_TABLE_MODES], ("…", f"{len(rows) - _TABLE_MODES} more", "", "")]
    return Table(
        ("no.", "vector", "frequency [Hz]", "relative residual"), tuple(rows), frozenset({0, 2, 3}), columns=2
    )


def _static_table(model: FEModel, states: Mapping[str, StaticState]) -> Table:
    """Reaction, largest displacement, what is left of the load and buckling factors, a row each load case."""
    rows = []
    buckled = any(state.buckling_factor is not None for state in states.values())
    for state in states.values():
        size = np.linalg.norm(state.displacements, axis=1)
        place = numbers_words(model.nodes[int(np.argmax(size))].tolist(), "m")
        rows.append(
            (
                state.name,
                numbers_words(state.reaction.tolist(), "N"),
                f"{number_words(float(size.max()), 'm')} at {place}",
                f"{state.residual:.0e}",
                *([_factor_words(state.buckling_factor)] if buckled else []),
            )
        )
    columns = ("load case", "reaction of the supports", "largest displacement", "load that is left")
    if buckled:
        return Table((*columns, "buckling factor"), tuple(rows), frozenset({3, 4}))
    return Table(columns, tuple(rows), frozenset({3}))


def _factor_words(factor: float | None) -> str:
    """A buckling factor, if it was asked for."""
    if factor is None:
        return "not asked for"
    return f"{factor:.4g}" if np.isfinite(factor) else "none: it does not buckle"


def _mode_figures(case: Case, name: str, reduced: ReducedBody, painter: Painter, album: Album) -> list[Item]:
    frequencies = _frequencies(reduced)
    small = painter.resized(800, 540)  # two of them side by side
    count = min(len(frequencies), max(_SHEET_MODES, len(case.report.modes)))
    figures: list[Item] = []
    share = case.report.deformation
    if count > 1:
        labels = [f"{number + 1}: {_hertz(frequencies[number])}" for number in range(count)]
        sheet = painter.contact_sheet(
            list(reduced.mode_shapes[:count]), labels, title=f"{name}: mode shapes", share=share
        )
        which = f"first {count} of {len(frequencies)}" if count < len(frequencies) else f"{count}"
        figures.append(Figure(album.add(f"{name}_modes", sheet), f"The {which} shapes of {name}."))
    for number in case.report.modes:
        if number > len(frequencies):
            continue
        title = f"{name}: mode {number}, {_hertz(frequencies[number - 1])}"
        note = reduced.labels[number - 1] + (" · undeformed outline in grey" if painter.has_outline else "")
        content = small.mode(reduced.mode_shapes[number - 1], title=title, note=note, share=share)
        caption = f"Mode {number} of {name} at {_hertz(frequencies[number - 1])}."
        figures.append(Figure(album.add(f"{name}_mode_{number}", content), caption, wide=False))
    return figures


def _stress_figures(
    case: Case,
    name: str,
    model: FEModel,
    reduced: ReducedBody,
    at_rest: Mapping[str, StaticState],
    results: Results | None,
    painter: Painter,
    album: Album,
    over_run: BodyStress | None,
) -> list[Item]:
    """Von Mises stress of the static load cases, the chosen modes and instants."""
    channel = f"{name}.modal_position"
    instants = _instants(case, reduced, results, channel)
    chosen = [number for number in case.report.stress_modes if number <= len(reduced.eigenvalues)]
    if not (chosen or instants or at_rest):
        return []
    if model.structure is None and (model.mesh is None or model.material is None):
        return [Text("No stress: the model came without elements and material.")]
    frequencies = _frequencies(reduced)
    turns: list[NDArray[np.float64] | None] = [state.rotations for state in at_rest.values()]
    kind = _NODAL if model.structure is None else _OF_PARTS
    states: list[tuple[NDArray[np.float64], str, str, str, str]] = []
    for state in at_rest.values():
        title = f"{name}: stress under {state.name}"
        caption = f"Von Mises stress in {name} under {state.name}. {kind}"
        states.append((state.displacements, f"{name}_stress_static_{state.name}", title, "at rest", caption))
    for number in chosen:
        shape, words = _scaled_mode(reduced.mode_shapes[number - 1], painter)
        title = f"{name}: stress in mode {number}, {_hertz(frequencies[number - 1])}"
        caption = f"Von Mises stress of mode {number} of {name} {words}. {kind}"
        states.append((shape, f"{name}_stress_mode_{number}", title, words, caption))
        if reduced.mode_rotations is None:
            turns.append(None)
        else:
            mode = reduced.mode_shapes[number - 1]
            turns.append(
                float(np.vdot(shape, mode) / np.vdot(mode, mode)) * reduced.mode_rotations[number - 1]
            )
    for order, (index, words) in enumerate(instants, start=1):
        assert results is not None
        coordinates = results[channel].reshape(len(results.time), -1)[index]
        unit = scaled_unit("s", [results.time[[index]]])
        when = f"t = {results.time[index] / unit.divisor:.6g} {unit.text}"
        caption = f"Von Mises stress in {name} at {when}{f', {words}' if words else ''}; body frame. {kind}"
        shape = np.tensordot(coordinates, reduced.mode_shapes, axes=1)
        turn = None
        if reduced.mode_rotations is not None:
            turn = np.tensordot(coordinates, reduced.mode_rotations, axes=1)
        if over_run is not None and over_run.loads.shape[1]:
            shape, turn = over_run.corrected(index, shape, turn, reduced.rotating)
        turns.append(turn)
        states.append((shape, f"{name}_stress_time_{order}", f"{name}: stress at {when}", words, caption))
    stresses = nodal_stresses(model, [state[0] for state in states], turns)
    return [
        Figure(album.add(file, painter.stress(shape, stress, title=title, note=note)), caption)
        for (shape, file, title, note, caption), stress in zip(states, stresses, strict=True)
    ]


def _instants(
    case: Case, reduced: ReducedBody, results: Results | None, channel: str
) -> list[tuple[int, str]]:
    """Records whose stress is pictured: the nearest to the times asked for, else that of largest elastic energy."""
    if results is None or channel not in results or not len(results.time):
        return []
    if case.report.stress_times:
        nearest = {int(np.argmin(np.abs(results.time - time))) for time in case.report.stress_times}
        return [(index, "") for index in sorted(nearest)]
    history = results[channel].reshape(len(results.time), -1)
    energy = 0.5 * history**2 @ reduced.eigenvalues
    return [(int(np.argmax(energy)), "largest elastic energy")] if energy.max() > 0.0 else []


def _scaled_mode(shape: NDArray[np.float64], painter: Painter) -> tuple[NDArray[np.float64], str]:
    """Mode shape [m] with a round largest displacement, about a thousandth of the size; and that in words."""
    from heavylift.pipeline.drawn.scales import round_down

    amplitude = round_down(1.0e-3 * painter.diagonal)
    largest = max(float(np.linalg.norm(shape, axis=1).max()), np.finfo(float).tiny)
    unit = scaled_unit("m", [np.array([amplitude])])
    return shape * (
        amplitude / largest
    ), f"at a largest displacement of {amplitude / unit.divisor:g} {unit.text}"
