"""Contours and contacts of a case in a report: what they are, and what happened at each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.quantity import ByExponent, Quantity
from heavylift.pipeline.pictures.plots import Series, history_plot
from heavylift.pipeline.report.document import Figure, Section, Table, Text, short_table
from heavylift.pipeline.results.words import number_words, numbers_words
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["contact_sections", "contact_tables", "law_words"]

_PLOTS = 4  # contacts with plots of their own at most


def contact_tables(case: Case) -> list[Table]:
    """Tables of the contours and contacts of a case; none of what it has not."""
    tables = []
    if case.contours:
        rows = [_contour(name, contour) for name, contour in case.contours.items()]
        tables.append(short_table(("contour", "type", "body", "points", "besides"), rows))
    if case.contacts:
        header = ("contact", "body", "contour", "touches with", "law", "besides")
        tables.append(short_table(header, [_contact(contact) for contact in case.contacts]))
    return tables


def _contour(name: str, contour: Any) -> tuple[str, ...]:
    words = []
    degrees = contour.degree if isinstance(contour.degree, tuple) else (contour.degree,)
    closed = contour.closed if isinstance(contour.closed, tuple) else (contour.closed,)
    source = _source(contour)
    if source != "own shape" and contour.spline is None:
        words.append(f"degree {' and '.join(str(degree) for degree in dict.fromkeys(degrees))}")
    if any(closed) or getattr(contour, "circle", None) is not None:
        which = "" if len(closed) == 1 or all(closed) else f" along direction {1 + closed.index(True)}"
        words.append(f"closed{which}")
    sizes = [key for key in ("radius", "width") if hasattr(contour, key)]
    words += [f"{key} {number_words(getattr(contour, key), 'm')}" for key in sizes]
    given = [key for key in ("across", "normal") if getattr(contour, key, None) is not None]
    words += [f"{key} {numbers_words(getattr(contour, key), '')}" for key in given]
    if getattr(contour, "flip", False):
        words.append("normal turned round")
    return (name, contour.type, contour.body, source, "; ".join(words))


def _source(contour: Any) -> str:
    """Where the points of a contour come from."""
    if contour.nodes is not None or contour.file is not None:
        return f"nodes in {contour.nodes}" if contour.nodes is not None else f"points in {contour.file}"
    face, line = getattr(contour, "face", None), getattr(contour, "line", None)
    if face is not None:
        where = f"group {face.on}" if face.on is not None else f"{face.plane} = {number_words(face.at, 'm')}"
        return f"nodes of the face {where}" + (", part of it" if face.lower is not None else "")
    if line is not None:
        return f"nodes from {numbers_words(line.start, 'm')} to {numbers_words(line.end, 'm')}"
    circle = getattr(contour, "circle", None)
    if circle is not None:
        return (
            f"circle, radius {number_words(circle.radius, 'm')}, centre {numbers_words(circle.centre, 'm')}"
        )
    if contour.points is not None:
        rows = contour.points
        count = f"{len(rows)} x {len(rows[0])}" if contour.type == "surface" else str(len(rows))
        return f"{count} points"
    return "spline" if contour.spline is not None else "own shape"


def _contact(contact: Any) -> tuple[str, ...]:
    words = [f"friction {contact.friction:g}"] if contact.friction else []
    if contact.footprint:
        words.append(f"footprint {number_words(contact.footprint, 'm')}")
    if contact.law == "rigid":
        words.append("impacts split the step" if contact.events else "impacts at ends of steps")
    body, contour = contact.between
    return (contact.name, body, contour, _shape(contact), law_words(contact), "; ".join(words))


def _shape(contact: Any) -> str:
    shape = contact.shape
    if contact.at is not None:
        where = f" at {numbers_words(contact.at, 'm')} in the world"
    else:
        where = f" at {numbers_words(contact.point, 'm')}" if contact.point is not None else ""
    if shape.type in {"ellipsoid", "box"}:
        sizes = shape.half_axes if shape.type == "ellipsoid" else shape.size
        size = f" {numbers_words(sizes, 'm')}"
    else:
        lengths = [key for key in ("radius", "length") if hasattr(shape, key)]
        size = "".join(f", {key} {number_words(getattr(shape, key), 'm')}" for key in lengths)
    rounding = f", rounded by {number_words(shape.rounding, 'm')}" if hasattr(shape, "rounding") else ""
    return shape.type + size + rounding + where


def law_words(section: Any, of: str = "") -> str:
    """Law of a contact or collision with its numbers; `of` says what a stiffness is of."""
    words = []
    for field in described_fields(section.DESCRIBED):
        value, name, quantity = getattr(section, field.name), field.name.replace("_", " "), field.quantity
        if isinstance(quantity, ByExponent) and value is not None:
            power = quantity.exponent or section.exponent
            words.append(f"{name}{of} {value:.6g} N/m" + (f"^{power:g}" if power != 1.0 else ""))
        elif isinstance(quantity, Quantity) and quantity.unit == "1":
            words.append(f"{name} {value:g}")
        elif isinstance(quantity, Quantity) and value:
            name = "none below" if name == "rest speed" else name
            words.append(f"{name}{of if name == 'stiffness' else ''} {number_words(value, quantity.unit)}")
    if getattr(section, "contact_modulus", None) is not None:
        words.append(f"contact modulus {number_words(section.contact_modulus, 'Pa')}")
    return ", ".join([section.law, *words])


def contact_sections(
    case: Case, stages: OutputFolder, results: Results | None, renderer: Renderer | None, album: Album
) -> list[Section]:
    """What happened at each contact, a picture, and plots of force and gap; nothing without contacts or records.

    Parameters
    ----------
    case, stages, results
        The case, its output folder, and its time histories if there are any.
    renderer
        Draws; None on a machine that cannot. Scenes with frames or shells have pictures of their own.
    album
        Takes pictures and plots.
    """
    if results is None or not len(results.time):
        return []
    contacts = [contact for contact in case.contacts if f"{contact.name}.normal_force" in results]
    if not contacts:
        return []
    columns = (
        "contact",
        "contour",
        "law",
        "largest normal force",
        "total impulse",
        "impacts",
        "deepest penetration",
        "path slid",
        "dissipated",
    )
    items: list[Table | Figure | Text] = [
        short_table(
            columns, [_happened(contact, results) for contact in contacts], frozenset({3, 4, 5, 6, 7, 8})
        )
    ]
    if renderer is not None and not results.meshes:
        items += _picture(case, stages, results, renderer, album)
    if len(results.time) > 1:
        for contact in contacts[:_PLOTS]:
            items += _figures(contact, results, album)
        if len(contacts) > _PLOTS:
            items.append(Text(f"Plots of the first {_PLOTS} of {len(contacts)} contacts."))
    return [Section("Contacts", tuple(items))]


def _picture(
    case: Case, stages: OutputFolder, results: Results, renderer: Renderer, album: Album
) -> list[Figure]:
    """The scene at its largest force or impact; nothing if the case can no longer be put together."""
    from heavylift.pipeline.pictures.contacts import touch_picture
    from heavylift.pipeline.report.scene import scene_view

    record, words = _moment(case, results)
    others = scene_view(case, stages, results, [record])
    if others is None:
        return []
    up = None
    if case.gravity is not None and any(case.gravity.acceleration):
        up = -np.array(case.gravity.acceleration)
    when = number_words(float(results.time[record]), "s")
    seen = others.seen(record)
    content = touch_picture(
        renderer, seen, title=case.title, note=f"t = {when}{words and f' · {words}'}", up=up
    )
    if content is None:
        return []
    caption = (
        f"The scene at {when}{words and f', {words}'}, true to scale. Violet: contours; ochre: what touches them; "
        "red: the force on it."
    )
    return [Figure(album.add("contacts", content), caption)]


def _moment(case: Case, results: Results) -> tuple[int, str]:
    """Record of the largest normal force; of rigid contacts that only hit, after the largest impact; and what it is."""
    found = {}
    for kind in ("normal_force", "impulse"):
        for contact in case.contacts:
            history = np.abs(_history(results, contact, kind))
            history = np.diff(history, prepend=history[0]) if kind == "impulse" else history
            found[contact.name] = int(np.argmax(history)), float(history.max())
        name = max(found, key=lambda key: found[key][1])
        record, size = found[name]
        if size > 0.0:
            unit, words = ("N", "normal force") if kind == "normal_force" else ("N s", "impulse")
            return record, f"largest {words}: {name}, {number_words(size, unit)}"
    return 0, ""


def _happened(contact: Any, results: Results) -> tuple[str, ...]:
    """Largest and final values of a contact."""
    force = _history(results, contact, "normal_force")
    peak = int(np.argmax(np.abs(force)))
    gap = _history(results, contact, "gap")
    depth = max(0.0, -float(gap.min()))
    return (
        contact.name,
        contact.between[1],
        contact.law,
        f"{number_words(float(force[peak]), 'N')}, {number_words(float(results.time[peak]), 's')}"
        if force[peak]
        else "none recorded",
        number_words(float(_history(results, contact, "impulse")[-1]), "N s"),
        f"{_history(results, contact, 'impacts')[-1]:.0f}",
        number_words(depth, "m") if contact.law != "bilateral" else "–",
        number_words(float(_history(results, contact, "slip_path")[-1]), "m"),
        number_words(float(_history(results, contact, "dissipated")[-1]), "J"),
    )


def _history(results: Results, contact: Any, kind: str) -> NDArray[np.float64]:
    """A channel that is one number, shape (nt,); zeros if it is not recorded."""
    name = f"{contact.name}.{kind}"
    return results[name].reshape(len(results.time)) if name in results else np.zeros(len(results.time))


def _figures(contact: Any, results: Results, album: Album) -> list[Figure]:
    """Plots of normal force, or impulse if only impacts happened, and gap; of what never leaves the contour no gap."""
    found = []
    wanted = [("normal_force", "N", "Normal force")]
    if not np.any(_history(results, contact, "normal_force")) and f"{contact.name}.impulse" in results:
        wanted = [("impulse", "N s", "Sum of the normal impulses")]
    if contact.law != "bilateral":
        wanted.append(("gap", "m", "Gap"))
    for kind, unit, words in wanted:
        if f"{contact.name}.{kind}" not in results:
            continue
        series = [Series(kind.replace("_", " "), _history(results, contact, kind))]
        if kind == "normal_force" and contact.friction and f"{contact.name}.friction_force" in results:
            series.append(Series("friction force", _history(results, contact, "friction_force")))
        title = f"{contact.name}: {' and '.join(curve.label for curve in series)}"
        content = history_plot(results.time, series, title=title, unit=unit)
        caption = f"{words} of {contact.name} on {contact.between[1]} over time"
        caption += ", and friction." if len(series) > 1 else "."
        found.append(Figure(album.add(f"contact_{contact.name}_{kind}", content), caption))
    return found
