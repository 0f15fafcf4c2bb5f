"""Names of computed quantities, as checks and convergence studies write them.

=============================================  ==========================================================
``mesh.BODY.node_count``                       also ``element_count``, ``dof_count``, ``mass``, ``volume``
``modes.BODY.frequency.I``                     natural frequency of vector I of the reduced body
``modes.BODY.residual.I``                      relative residual of that vector in the full model
``modes.BODY.orthogonality``                   largest deviation of the modal mass from the identity
``static.BODY.CASE.stress.POINT.COMPONENT``    stress at a sensor under a static load case, components below
``static.BODY.CASE.displacement.POINT.AXIS``   displacement of a sensor, ``x``, ``y`` or ``z``
``static.BODY.CASE.von_mises``                 largest stress of all nodes; ``static.BODY.CASE.reaction.AXIS``:
                                               resultant of the forces of all supports
``static.BODY.CASE.buckling``                  factor by which the load may grow until the body buckles, of load
                                               cases with ``buckling = true``
``ringdown.BODY.I``                            frequency of one sinusoid fitted to modal coordinate I
``drift.energy``                               also ``momentum``, ``angular_momentum``: largest deviation
                                               from the initial value, relative
``channel.OWNER.KIND[.COMPONENT].STATISTIC``   ``end``, ``min``, ``max``, ``mean`` or ``rms`` of a recorded
                                               channel, e.g. ``channel.tip.position.y.max``, or its mean
                                               ``rate`` over the run, per second; component ``largest`` or
                                               ``smallest``: of all components; ``norm``: of the vector.
                                               ``max`` and ``min`` are those of all steps where the channel
                                               has extremes beside it (``tension_max``), else of the records
``stress.POINT.COMPONENT.STATISTIC``           ``end``, ``min``, ``max``, ``mean`` or ``rms`` over the records of the
                                               stress at a sensor, see below
``stress.BODY.von_mises.STATISTIC``            the same of the largest stress of all nodes of a flexible body
``stress.BODY.GROUP.von_mises.STATISTIC``      largest stress of a group of a flexible body with a table ``stress``;
                                               ``stress.BODY.GROUP.SIDE.von_mises.STATISTIC`` of plates on one of
                                               ``top``, ``bottom``, ``membrane``, ``bending``, and ``centre``: the
                                               membrane at the centres of elements
``stress.BODY.GROUP.utilisation.STATISTIC``    the same over the yield strength, with a side likewise
``stress.BODY.GROUP.buckling.STATISTIC``       utilisation by buckling of the worst plate panel of a group
``stress.BODY.SPOT.hot_spot.STATISTIC``        structural stress at a weld toe
``frequency.OWNER.KIND[.COMPONENT]``           frequency of one sinusoid about a mean fitted to a channel,
                                               e.g. ``frequency.bead.position.y``
``angular_frequency.OWNER.KIND[.COMPONENT]``   the same in rad/s
``growth.OWNER.KIND[.COMPONENT]``              rate a of the growth ``exp(a t)`` of a channel, fitted to the last
                                               half of the records, e.g. ``growth.trailer.pitch``
``deviation.NAME``                             largest distance of a channel from the reference history
                                               NAME, divided by its scale if it has one;
                                               ``deviation.NAME.rms``: root mean square over its times
``lines.NAME.length``                          unstretched length of a mooring line
``hydrostatics.HULL.FIGURE``                   of a hull with a surface where it floats by itself: ``volume``,
                                               ``draft``, ``KB``, ``GM_T``, ``GM_L``, ``waterplane_area``, ...
``tipping.TRANSPORTER.static``                 tilt of the road at which a transporter tips over, on rigid groups;
                                               ``compliant``: with what its groups give way
``errors.PREFIX``                              largest error of the checks whose ids begin with ``PREFIX_``
=============================================  ==========================================================

Components of the channels of frames and shells begin with the number of a node or element:
``channel.plate.position.60.z.end``. Channels of joints along edges have the number of a node before their kind:
``channel.rim.0.reaction_force.z.max``. Channels of the recorded contacts of a collision have ``contact_1``,
``contact_2``, ... before their kind: ``channel.landing.contact_1.force.max``.

A sensor on a flexible body has the stress ``xx``, ``yy``, ``zz``, ``xy``, ``yz``, ``zx`` in body axes and
``von_mises``; on a shell ``von_mises``, the largest of its sides, and ``top.xx``, ``top.yy``, ``top.xy``,
``top.von_mises``, likewise of ``middle`` and ``bottom``, in axes of the surface whose first one follows the mesh
direction x; on a frame ``axial``, N/A, and ``largest``, N/A +- M c/I. Solids: at the nodes the mean of the elements
around, between them interpolated. Shells and frames: of one element at the point, not averaged.

What channels there are depends on the owner: a hinge has an ``angle``, a rope a ``tension``; see
`heavylift.pipeline.case.channel_kinds`. In place of a channel there may be a combination of channels, and in place of
an owner a pattern, which makes the quantity a group: see `heavylift.pipeline.case.channel_names`.
"""

from __future__ import annotations

import contextlib
import re
from difflib import get_close_matches
from typing import TYPE_CHECKING, NamedTuple

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, Kind
from heavylift.numerics.words import nearest
from heavylift.pipeline.case.channel_kinds import (
    COLLISION_CONTACT,
    RESERVED_NAMES,
    SCENE_CHANNELS,
    Declared,
    all_channels,
    channel_components,
    lies_along_edge,
)
from heavylift.pipeline.case.channel_names import (
    combination_of,
    combined_kind,
    fitting,
    is_pattern,
    patterns_in,
    split_name,
    substituted,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

__all__ = ["QuantityName", "channel_kind", "channel_members", "parse_quantity_name", "single_components"]

MESH_QUANTITIES = {
    "node_count": "number",
    "element_count": "number",
    "dof_count": "number",
    "mass": "mass",
    "volume": "volume",
}
DRIFTS = ("energy", "momentum", "angular_momentum")
TIPPING = {"static": "angle", "compliant": "angle"}
"""Figures of transporters, and their quantities."""

HYDROSTATICS = {
    "displacement": "mass",
    "volume": "volume",
    "draft": "length",
    "draft_aft": "length",
    "draft_forward": "length",
    "trim": "angle",
    "list": "angle",
    "origin_z": "length",
    "KB": "length",
    "LCB": "length",
    "KG": "length",
    "LCF": "length",
    "BM_T": "length",
    "BM_L": "length",
    "GM_T": "length",
    "GM_L": "length",
    "waterplane_area": "area",
    "wetted_area": "area",
}
"""Figures of a floating hull, and their kinds."""
_SIDES = ("top", "middle", "bottom")
STRESSES = {
    "flexible": ("von_mises", "xx", "yy", "zz", "xy", "yz", "zx"),
    "shell": (
        "von_mises",
        *(f"{side}.{part}" for side in _SIDES for part in ("von_mises", "xx", "yy", "xy")),
    ),
    "frame": ("axial", "largest"),
    "rod": ("axial", "largest"),
}
"""Components of the stress at a material point, by the type of its body."""
RECOVERED = {"von_mises": "pressure", "utilisation": "number", "buckling": "number", "hot_spot": "pressure"}
"""What is told of a group or a hot spot of a body with a table ``stress``, and the quantity."""
PLATE_SIDES = ("top", "bottom", "membrane", "bending", "centre")
"""Sides of plates of such a body."""
ACROSS = ("largest", "smallest", "norm")  # in this order `heavylift.pipeline.checks.quantities` has them
"""Components that are made of all components of a record."""
STATISTICS = ("end", "min", "max", "absolute", "mean", "rms", "rate")
_RATES = {
    "length": "velocity",
    "velocity": "acceleration",
    "angle": "angular velocity",
    "momentum": "force",
    "angular momentum": "moment or energy",
    "number": "rate",
}
"""Kinds of channels whose rate over time has a kind of its own."""
_CONTACT = re.compile(r"contact_([1-9]\d*)")


class QuantityName(NamedTuple):
    """A quantity string, taken apart."""

    text: str
    family: str
    """``mesh``, ``modes``, ``static``, ``ringdown``, ``drift``, ``channel``, ``stress``, ``frequency``, ``growth``,
    ``deviation``, ``lines``, ``hydrostatics``, ``tipping`` or ``errors``."""
    owner: str
    """Body, sensor, joint, rope or force; empty for quantities of the whole scene, combinations and groups."""
    item: str
    """What of the owner, e.g. ``frequency`` or the channel name ``tip.position``; the name of a reference."""
    component: str
    """One-based number of a vector; or component of a channel, with dots as in ``60.z``; may be empty."""
    statistic: str
    """Of a channel or a deviation."""
    kind: Kind
    """Its unit and dimension."""
    members: tuple[tuple[str, str], ...] = ()
    """Of a group: the names that fit its pattern, and their quantities."""

    @property
    def stage(self) -> str:
        """The last stage that must have run."""
        if self.family in {"hydrostatics", "errors"}:  # what checks need they say themselves
            return "mesh"
        if self.family == "static":
            return "modes"
        return self.family if self.family in {"mesh", "modes"} else "simulate"


def parse_quantity_name(text: str, names: Declared | None = None) -> QuantityName:
    """Take a quantity string apart.

    Parameters
    ----------
    text
        As in the case file.
    names
        What the case declares. Without it any owner may have any channel, and the kinds of deviations and of
        loads along joints are not known: a number, a moment.

    Raises
    ------
    InputError
        If it is not one of the forms in the table above, or its owner has no such channel; if no name fits a
        pattern, or those that fit have quantities of several units.
    """
    parts = split_name(text)
    if names is not None and is_pattern(text):
        members = _members(text, parts, names)
        if members:
            return _group(text, members, names)
    if parts[0] == "channel":
        return _channel(text, parts, names)
    if parts[0] in {"frequency", "angular_frequency", "growth"}:
        return _fitted(text, parts, names)
    if parts[0] == "stress":
        return _stress(text, parts, names)
    if parts[0] == "deviation":
        return _deviation(text, parts, names)
    if parts[0] in {"lines", "hydrostatics", "tipping"}:
        return _figures(text, parts, names)
    if parts[0] == "errors":
        return _errors(text, names)
    if parts[0] == "static":
        return _static(text, parts, names)
    readers = {"mesh": _mesh, "modes": _modes, "ringdown": _ringdown, "drift": _drift}
    if parts[0] not in readers:
        known = [
            *readers,
            "static",
            "channel",
            "stress",
            "frequency",
            "angular_frequency",
            "growth",
            "deviation",
            "lines",
            "hydrostatics",
            "tipping",
            "errors",
        ]
        raise InputError(_unknown(text, parts[0], known), expected=f"one of {', '.join(known)} as first word")
    return readers[parts[0]](text, parts)


def _members(text: str, parts: list[str], names: Declared) -> tuple[tuple[str, str], ...]:
    """Names that fit the pattern of a quantity, and their quantities; none if it has no pattern of an owner."""
    family, rest = parts[0], ".".join(parts[1:])
    flexible = sorted(name for name, kind in names.body_types.items() if kind == "flexible")
    owners = {
        "channel": list(names.names),
        "deviation": list(names.references),
        "lines": sorted(names.lines),
        "hydrostatics": sorted(names.hulls),
        "tipping": sorted(names.transporters),
    }
    owners |= dict.fromkeys(("frequency", "angular_frequency", "growth", "stress"), owners["channel"])
    owners |= dict.fromkeys(("mesh", "modes", "static", "ringdown"), flexible)
    if family not in owners or not rest:
        return ()
    return _expanded(
        rest, text, owners[family], lambda name: parse_quantity_name(f"{family}.{name}", names), f"{family}."
    )


def _expanded(
    name: str, text: str, owners: list[str], check: Callable[[str], object], prefix: str = ""
) -> tuple[tuple[str, str], ...]:
    patterns = patterns_in(name)
    if not patterns:
        return ()
    if len(patterns) > 1:
        raise InputError(f"{text!r} has {len(patterns)} patterns", expected="one pattern, also several times")
    (pattern,) = patterns
    found = fitting(text, pattern, owners, lambda owner: check(substituted(name, pattern, owner)))
    return tuple((owner, prefix + substituted(name, pattern, owner)) for owner in found)


def _group(text: str, members: tuple[tuple[str, str], ...], names: Declared) -> QuantityName:
    """A quantity of all members, which have one kind."""
    parsed = [parse_quantity_name(member, names) for _, member in members]
    odd = next((one for one in parsed if one.kind.dimension != parsed[0].kind.dimension), None)
    if odd is not None:
        raise InputError(
            f"quantity {text!r}: {parsed[0].text!r} is in {parsed[0].kind.unit}, {odd.text!r} in {odd.kind.unit}",
            expected="a pattern of quantities of one unit",
        )
    return parsed[0]._replace(text=text, owner="", item="", members=members)


def channel_members(name: str, names: Declared) -> tuple[str, ...]:
    """Channels that the name of a channel with a pattern stands for; the name itself if it has none.

    Raises
    ------
    InputError
        If no owner fits, or none that fits has such a channel.
    """
    found = _expanded(name, name, list(names.names), lambda one: channel_kind(one, one, names))
    return tuple(channel for _, channel in found) or (name,)


def _unknown(text: str, word: str, known: Iterable[str]) -> str:
    near = nearest(word, known)
    return f"quantity {text!r} is unknown" + (f"; did you mean {near!r}?" if near else "")


def _mesh(text: str, parts: list[str]) -> QuantityName:
    if len(parts) != 3 or parts[2] not in MESH_QUANTITIES:
        word = parts[2] if len(parts) > 2 else ""
        raise InputError(
            _unknown(text, word, MESH_QUANTITIES), expected="mesh.BODY." + "|".join(MESH_QUANTITIES)
        )
    return QuantityName(text, "mesh", parts[1], parts[2], "", "", KINDS[MESH_QUANTITIES[parts[2]]])


def _modes(text: str, parts: list[str]) -> QuantityName:
    numbered = len(parts) == 4 and parts[2] in {"frequency", "residual"} and _is_index(parts[3])
    if not numbered and not (len(parts) == 3 and parts[2] == "orthogonality"):
        raise InputError(
            f"quantity {text!r} is unknown",
            expected="modes.BODY.frequency.I, modes.BODY.residual.I (I from 1) or modes.BODY.orthogonality",
        )
    kind = KINDS["frequency" if parts[2] == "frequency" else "number"]
    return QuantityName(text, "modes", parts[1], parts[2], parts[3] if numbered else "", "", kind)


def _static(text: str, parts: list[str], names: Declared | None) -> QuantityName:
    """``static.BODY.CASE.ITEM[.POINT][.COMPONENT]``; the component keeps the words from the item on."""
    items = {
        "stress": ("pressure", 6, STRESSES["flexible"]),
        "displacement": ("length", 6, tuple("xyz")),
        "reaction": ("force", 5, tuple("xyz")),
        "von_mises": ("pressure", 4, ("von_mises",)),
        "buckling": ("number", 4, ("buckling",)),
    }
    item = parts[3] if len(parts) > 3 else ""
    quantity, count, components = items.get(item, ("number", 0, ()))
    if len(parts) != count or parts[-1] not in components:
        word = parts[-1] if len(parts) == count else item
        raise InputError(
            _unknown(text, word, components if len(parts) == count else items),
            expected="static.BODY.CASE.stress.SENSOR.COMPONENT with COMPONENT one of "
            f"{', '.join(STRESSES['flexible'])}, static.BODY.CASE.displacement.SENSOR.AXIS, "
            "static.BODY.CASE.reaction.AXIS, static.BODY.CASE.von_mises or static.BODY.CASE.buckling",
        )
    if count == 6 and names is not None and names.sensors.get(parts[4]) != parts[1]:
        known = ", ".join(name for name, body in names.sensors.items() if body == parts[1])
        raise InputError(
            f"quantity {text!r}: {parts[4]!r} is no sensor on {parts[1]!r}",
            expected=f"one of the sensors on it: {known or 'there are none'}",
        )
    return QuantityName(text, "static", parts[1], parts[2], ".".join(parts[3:]), "", KINDS[quantity])


def _ringdown(text: str, parts: list[str]) -> QuantityName:
    if len(parts) != 3 or not _is_index(parts[2]):
        raise InputError(f"quantity {text!r} is unknown", expected="ringdown.BODY.I, I from 1")
    return QuantityName(text, "ringdown", parts[1], "frequency", parts[2], "", KINDS["frequency"])


def _drift(text: str, parts: list[str]) -> QuantityName:
    if len(parts) != 2 or parts[1] not in DRIFTS:
        raise InputError(_unknown(text, parts[-1], DRIFTS), expected="drift." + "|".join(DRIFTS))
    return QuantityName(text, "drift", "", parts[1], "", "", KINDS["number"])


def _channel(text: str, parts: list[str], names: Declared | None) -> QuantityName:
    least = 3 if "(" in text else 4
    if len(parts) < least or "" in parts or parts[-1] not in STATISTICS:
        raise InputError(
            f"quantity {text!r} is unknown",
            expected="channel.OWNER.KIND.STATISTIC or channel.OWNER.KIND.COMPONENT.STATISTIC with STATISTIC one of "
            + ", ".join(STATISTICS),
        )
    owner, name, component = _channel_parts(parts[1:-1])
    kind = channel_kind(name, text, names)
    _check_component(name, component, text, names)
    if parts[-1] == "rate":
        if kind.name not in _RATES:
            raise InputError(
                f"quantity {text!r}: {name!r} has no 'rate'", expected=f"a rate of: {', '.join(_RATES)}"
            )
        kind = KINDS[_RATES[kind.name]]
    return QuantityName(text, "channel", owner, name, component, parts[-1], kind)


def _fitted(text: str, parts: list[str], names: Declared | None) -> QuantityName:
    if len(parts) < (2 if "(" in text else 3) or "" in parts:
        raise InputError(
            f"quantity {text!r} is unknown",
            expected=f"{parts[0]}.OWNER.KIND or {parts[0]}.OWNER.KIND.COMPONENT",
        )
    owner, name, component = _channel_parts(parts[1:])
    channel_kind(name, text, names)
    _check_component(name, component, text, names)
    of = {"frequency": "frequency", "angular_frequency": "angular velocity", "growth": "rate"}
    kind = KINDS[of[parts[0]]]
    return QuantityName(text, parts[0], owner, name, component, "", kind)


def _stress(text: str, parts: list[str], names: Declared | None) -> QuantityName:
    statistics = [word for word in STATISTICS if word != "rate"]
    if len(parts) < 4 or "" in parts or parts[-1] not in statistics:
        raise InputError(
            f"quantity {text!r} is unknown",
            expected=f"stress.SENSOR.COMPONENT.STATISTIC with STATISTIC one of {', '.join(statistics)}",
        )
    owner, component = parts[1], ".".join(parts[2:-1])
    if len(parts) > 4 and (names is None or names.body_types.get(owner) == "flexible"):
        what = parts[-2]
        if what in RECOVERED and (
            len(parts) == 5
            or (len(parts) == 6 and parts[3] in PLATE_SIDES and what in {"von_mises", "utilisation"})
        ):
            unit = KINDS[RECOVERED[what]]
            return QuantityName(text, "stress", owner, parts[2], ".".join(parts[3:-1]), parts[-1], unit)
        if names is not None:
            raise InputError(
                _unknown(text, what, RECOVERED),
                expected=f"of {owner!r}: GROUP.von_mises or GROUP.utilisation, of plates also GROUP.SIDE.von_mises "
                f"with SIDE one of {', '.join(PLATE_SIDES)}, or SPOT.hot_spot",
            )
    if names is not None and owner in names.names:
        body = names.sensors.get(owner)
        if body is None and names.body_types.get(owner) != "flexible":
            raise InputError(
                f"quantity {text!r}: {owner!r} is neither a sensor nor a flexible body",
                expected="a sensor on a flexible body, frame or shell, or a flexible body; the largest stress of a "
                "shell is channel.NAME.von_mises.largest.max, of a frame channel.NAME.axial_stress.largest.max",
            )
        kind = "" if body is None else names.body_types.get(body, "")
        known = ("von_mises",) if body is None else STRESSES.get(kind, ())
        if component not in known:
            whose = repr(owner) if body is None else f"{owner!r} on {body!r}"
            raise InputError(
                _unknown(text, component, known),
                expected=f"of {whose} one of: {', '.join(known)}"
                if known
                else f"a body with stress, {body!r} has none",
            )
    return QuantityName(text, "stress", owner, "", component, parts[-1], KINDS["pressure"])


def _channel_parts(parts: list[str]) -> tuple[str, str, str]:
    """Owner, channel and component of ``OWNER.KIND[.COMPONENT]``, split at the dots; a combination has no owner."""
    if "(" in parts[0]:
        return "", parts[0], ".".join(parts[1:])
    # a node of an edge, or a contact of a collision, stands before the kind
    own = 3 if len(parts) > 2 and (parts[1].isdecimal() or _CONTACT.fullmatch(parts[1])) else 2
    return "" if parts[0] in RESERVED_NAMES else parts[0], ".".join(parts[:own]), ".".join(parts[own:])


def channel_kind(name: str, text: str, names: Declared | None) -> Kind:
    """Kind of a channel such as ``"tip.position"``; `text` is what a message says is unknown."""
    combination = combination_of(name)
    if combination is not None:
        kinds = [_term_kind(term, text, names) for term in combination.terms]
        combined = combined_kind(name, combination.function, kinds)
        if names is not None:
            _check_same_components(name, combination.terms, names)
        return combined
    owner, _, last = name.partition(".")
    scene = owner in RESERVED_NAMES
    own = SCENE_CHANNELS if scene else None if names is None else names.channels.get(owner)
    known: Mapping[str, str] = all_channels() if own is None else own
    key = name if scene else last
    number, dot, kind = last.partition(".")
    if not scene and _CONTACT.fullmatch(number):
        return KINDS[_contact_channel(owner, number, kind, text, names)]
    edge = names is not None and lies_along_edge(names.joints.get(owner, ""))
    if dot and number.isdecimal() and (edge or names is None):
        key = kind
    elif edge:
        raise InputError(
            f"quantity {text!r} names no node",
            expected=f"a channel of a node of the edge, from 0: {owner}.0.reaction_force, {owner}.0.reaction_moment",
        )
    if key not in known:
        whose = "a channel" if scene else f"a channel of {owner!r}"
        raise InputError(_unknown(text, key, known), expected=f"{whose}: {', '.join(known) or 'none'}")
    return KINDS[known[key]]


def _term_kind(term: str, text: str, names: Declared | None) -> Kind:
    """Kind of a term of a combination; of a pattern in a sum that of all that fit."""
    if names is not None and patterns_in(term):
        members = channel_members(term, names)
        return combined_kind(text, "sum", [_term_kind(member, text, names) for member in members])
    parts = split_name(term)
    alone = "(" in parts[0]
    if "" in parts or len(parts) < (1 if alone else 2):
        raise InputError(f"{text!r}: {term!r} is no channel", expected="OWNER.CHANNEL, e.g. tip.position.z")
    owner, name, component = _channel_parts(parts)
    if names is not None and owner and owner not in names.names:
        near = get_close_matches(owner, names.names, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InputError(
            f"{text!r} names {owner!r}, which does not exist{hint}",
            expected=f"one of: {', '.join(names.names)}",
        )
    kind = channel_kind(name, text, names)
    _check_component(name, component, text, names, across=False)
    return kind


def _check_same_components(name: str, terms: Sequence[str], names: Declared) -> None:
    """Refuse a combination of a vector with a number, or of vectors of other components, where known."""
    known = [
        (term, components) for term in terms if (components := _term_components(term, names)) is not None
    ]
    for term, components in known[1:]:
        first, of_first = known[0]
        if len(components) != len(of_first) or (len(components) > 1 and components != of_first):
            raise InputError(
                f"{name!r} combines {first!r}, of {_in_words(of_first)}, with {term!r}, of {_in_words(components)}",
                expected="channels with the same components, or one component of each",
            )


def _in_words(components: Sequence[str]) -> str:
    return "one number" if len(components) == 1 else f"components {', '.join(components)}"


def _term_components(term: str, names: Declared) -> tuple[str, ...] | None:
    """Components of a term of a combination, one of a number; None if the case does not determine them."""
    if patterns_in(term):
        return None
    _, name, component = _channel_parts(split_name(term))
    if component:
        return ("",)
    combination = combination_of(name)
    if combination is None:
        return single_components(name, names)
    found = (_term_components(inner, names) for inner in combination.terms)
    return next((components for components in found if components is not None), None)


def single_components(name: str, names: Declared) -> tuple[str, ...] | None:
    """Components of a channel known from the case file; None if they depend on a mesh or a number of modes."""
    if "(" in name or name.partition(".")[0] in names.meshes:
        return None
    return channel_components(name.rpartition(".")[2])


def _check_component(
    name: str, component: str, text: str, names: Declared | None, *, across: bool = True
) -> None:
    """Refuse a component that the channel does not have, where that is known before the run."""
    known = None if names is None else single_components(name, names)
    if not component or known is None or component in known or (across and component in ACROSS):
        return
    words = f"a component: {', '.join(known)}" if len(known) > 1 else f"{name}, which is one number"
    raise InputError(
        f"quantity {text!r}: {name!r} has no {component!r}",
        expected=words + (f"; or {', '.join(ACROSS)}" if across and len(known) > 1 else ""),
    )


def _contact_channel(owner: str, contact: str, kind: str, text: str, names: Declared | None) -> str:
    """Name of the kind of a channel of a recorded contact of a collision."""
    recorded = 0 if names is None else names.collisions.get(owner, 0)
    known = names is not None and owner in names.names  # an owner that does not exist is reported as such
    if known and int(contact.partition("_")[2]) > recorded:
        expected = f"contact_1 to contact_{recorded}, or a larger 'recorded'" if recorded else "a collision"
        raise InputError(f"quantity {text!r}: {owner!r} has no {contact!r}", expected=expected)
    if kind not in COLLISION_CONTACT:
        raise InputError(
            _unknown(text, kind, COLLISION_CONTACT),
            expected=f"a channel of a recorded contact: {', '.join(COLLISION_CONTACT)}",
        )
    return COLLISION_CONTACT[kind]


def _deviation(text: str, parts: list[str], names: Declared | None) -> QuantityName:
    statistic = "rms" if len(parts) > 2 and parts[-1] == "rms" else ""
    name = ".".join(parts[1:-1] if statistic else parts[1:])
    kind = KINDS["number"]
    if names is not None:
        if name not in names.references:
            raise InputError(
                _unknown(text, name, names.references),
                expected="deviation.NAME or deviation.NAME.rms with a [[reference]]: "
                + (", ".join(names.references) or "none"),
            )
        channel, scaled = names.references[name]
        if not scaled:
            with contextlib.suppress(InputError):  # errors of the channel are reported with the reference
                kind = channel_kind(channel, text, names)
    return QuantityName(text, "deviation", "", name, "", statistic, kind)


def _figures(text: str, parts: list[str], names: Declared | None) -> QuantityName:
    """Lengths of lines, figures of floating hulls, angles at which transporters tip over."""
    family = parts[0]
    items = {"lines": {"length": "length"}, "hydrostatics": HYDROSTATICS, "tipping": TIPPING}[family]
    owners = None
    if names is not None:
        owners = {"lines": names.lines, "hydrostatics": names.hulls, "tipping": names.transporters}[family]
    if len(parts) != 3 or parts[2] not in items or (owners is not None and parts[1] not in owners):
        word = parts[2] if len(parts) > 2 else ""
        whose = "" if owners is None else f" of: {', '.join(sorted(owners)) or 'none'}"
        raise InputError(_unknown(text, word, items), expected=f"{family}.NAME.{'|'.join(items)}{whose}")
    return QuantityName(text, family, parts[1], parts[2], "", "", KINDS[items[parts[2]]])


def _errors(text: str, names: Declared | None) -> QuantityName:
    """The largest error of some checks, which must be of one kind."""
    prefix, kind = text.partition(".")[2], KINDS["number"]
    if names is not None:
        found = [
            quantity
            for name, quantity in names.checks.items()
            if name.startswith(f"{prefix}_") and not quantity.startswith("errors")
        ]
        kinds = set()
        for quantity in found:
            with contextlib.suppress(InputError):  # errors of a quantity are reported with its check
                kinds.add(parse_quantity_name(quantity, names).kind)
        if not prefix or not found or len(kinds) > 1:
            several = f": checks of {', '.join(sorted(k.name for k in kinds))}" if len(kinds) > 1 else ""
            raise InputError(
                f"quantity {text!r} is unknown{several}",
                expected="errors.PREFIX with checks PREFIX_..., all of one kind",
            )
        kind = kinds.pop() if kinds else kind
    return QuantityName(text, "errors", "", prefix, "", "", kind)


def _is_index(text: str) -> bool:
    return text.isdecimal() and int(text) >= 1
