"""What a class of components is, in words: for `help` and for editors."""

from __future__ import annotations

import textwrap
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin

if TYPE_CHECKING:
    from heavylift.pipeline.case.fields import Section

__all__ = ["docstring", "key_lines", "words_of"]

_WORDS = ("type", "motion", "law")
"""Keys by which a table says which section it is."""


WIDTH = 100


@cache
def docstring(component: Any) -> str:
    """Docstring of a class of components: its sentence, its keys as in the case file, its channels."""
    from heavylift.pipeline.case.schema import section_keys

    if not hasattr(component, "SECTION"):
        return str(vars(component).get("__doc__") or _BASE)
    sentence, _, channels = section_keys(component.SECTION)
    parts = [sentence or f"The table [{component.TABLE.key}] of a case.", "Parameters", "----------"]
    lines = [parts[0], "", *parts[1:]]
    for key, value, words in key_lines(component):
        lines.append(f"{key} : {value}" if value else key)
        lines += textwrap.wrap(words, WIDTH, initial_indent="    ", subsequent_indent="    ")
    if channels:
        names = ", ".join(f"{one['name']} [{one['unit']}]" for one in channels)
        lines += ["", "Notes", "-----", *textwrap.wrap(f"Channels: {names}.", WIDTH)]
    return "\n".join(lines)


_BASE = "A table of a case: a body, a joint, a rope, a sea, ..."


def key_lines(component: Any) -> list[tuple[str, str, str]]:
    """Its arguments: name, what it may be with its default, sentence; those that are needed first."""
    from heavylift.pipeline.case.schema import section_keys

    _, keys, _ = section_keys(component.SECTION)
    own, label = words_of(component.SECTION), component.TABLE.label
    found = []
    if component.TABLE.form == "named":
        found.append(("name", "text", "Name."))
    for one in keys:
        if one.key == label:
            found.insert(0, ("name", one.value, one.sentence))
    for one in sorted(keys, key=lambda one: not one.needed):
        if one.key in own or one.key == label:
            continue
        optional = "" if one.needed else "optional" if one.default == "none" else f"default {one.default}"
        found.append((one.key, ", ".join(filter(None, (one.value, optional))), one.sentence))
    return found


def words_of(section: type[Section], *, needed: bool = False) -> dict[str, str]:
    """Keys by which a table says which section it is; `needed` are those without which it would be another one."""
    found = {}
    for key in _WORDS:
        field = section.model_fields.get(key)
        if (
            field is not None
            and get_origin(field.annotation) is Literal
            and (field.is_required() or not needed)
        ):
            words = get_args(field.annotation)
            if len(words) == 1:
                found[key] = words[0]
    return found
