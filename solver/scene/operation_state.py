"""What is so while an operation goes from phase to phase, as far as it is known before it runs."""

from __future__ import annotations

import math
from dataclasses import field
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.operations import CONNECT, FAIL, FOLLOW, RELEASE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from heavylift.solver.scene.commands import Command

__all__ = [
    "AXES",
    "RELEASABLE",
    "Movable",
    "OperationState",
    "drives_of",
    "helpers_of",
    "known_thing",
    "releases_of",
]


AXES = ("x", "y", "z", "angle")
"""Along which a frame is driven, or about which."""


@dataclass(frozen=True)
class Movable:
    """What a scene or a case has that can be commanded.

    Attributes
    ----------
    ropes
        By name: of the scene, or sections of a case.
    tanks
        Names.
    drives
        By name: whether harmonics are added to it.
    duration
        Of the run [s]; infinite if it is not known.
    pumped
        Tanks with `[[pumps]]`, which nothing else is to fill, and one of these each.
    vehicles
        Transporters with a path by name: of the scene, or sections of a case.
    capacities
        Masses of full tanks [kg], as far as they are known.
    releases
        Joints by name, and why they cannot be released: in words, empty if they can.
    helpers
        Pumps and levelled transporters by name, and why they cannot fail: in words, empty if they can.
    """

    ropes: Mapping[str, Any]
    tanks: frozenset[str] = frozenset()
    drives: Mapping[str, bool] = field(default_factory=dict)
    duration: float = math.inf
    pumped: Mapping[str, str] = field(default_factory=dict)
    vehicles: Mapping[str, Any] = field(default_factory=dict)
    capacities: Mapping[str, float] = field(default_factory=dict)
    releases: Mapping[str, str] = field(default_factory=dict)
    helpers: Mapping[str, str] = field(default_factory=dict)


def helpers_of(
    pumps: Iterable[Any], controllers: Iterable[Any], transporters: Iterable[Any]
) -> dict[str, str]:
    """Pumps and levelled transporters by name, and why one cannot fail; empty if it can.

    Parameters
    ----------
    pumps, controllers, transporters
        Of a scene or a case.
    """
    controlled = {name for one in controllers for name in one.pumps}
    found = {
        pump.name: "" if pump.name in controlled else "follows its own plan, without a controller"
        for pump in pumps
    }
    return found | {one.name: "" for one in transporters if one.levelling is not None}


def drives_of(joints: Iterable[Any], motions: Mapping[str, Any]) -> dict[str, bool]:
    """Names of all drives, and whether harmonics are added to one.

    Parameters
    ----------
    joints
        Of a scene or a case.
    motions
        Motions of the frames of bodies by name, of a scene or a case. One that is fixed can be commanded to move.
    """
    found = {}
    for joint in joints:
        drive = getattr(joint, "drive", None)
        if drive is not None:
            found[joint.name] = bool(drive.harmonics)
    for name, motion in motions.items():
        if getattr(motion, "motion", type(motion).__name__.lower()) not in {"fixed", "driven"}:
            continue
        for axis in AXES:
            profile = getattr(motion, axis, None)
            found[f"{name}.{axis}"] = profile is not None and bool(profile.harmonics)
    return found


RELEASABLE = frozenset(
    {"ball", "cylindrical", "fixed", "hinge", "planar", "slider", "slider_hinge", "universal"}
)
"""Words of joints that can be released: each is one block of rows, and nothing but these."""


def releases_of(joints: Iterable[Any], users: Iterable[Any]) -> dict[str, str]:
    """Names of all joints, and why one cannot be released; empty if it can.

    Parameters
    ----------
    joints
        Of a scene or a case.
    users
        What may act along a joint, as springs and motors do.
    """
    used = {one.joint: one.name for one in users if isinstance(getattr(one, "joint", None), str)}
    own = ("limits", "angle_limits", "travel_limits", "friction", "angle_friction", "travel_friction")
    found = {}
    for joint in joints:
        word = getattr(joint, "DESCRIBED", type(joint)).WORD
        reason = ""
        if word not in RELEASABLE:
            reason = f"is a joint of type {word!r}"
        elif getattr(joint, "drive", None) is not None:
            reason = "has a drive"
        elif any(getattr(joint, key, None) for key in own):
            reason = "has stops or friction"
        elif joint.name in used:
            reason = f"has {used[joint.name]!r} along it"
        found[joint.name] = reason
    return found


class OperationState:
    """What is connected, commanded and broken, from action to action of a track.

    Parameters
    ----------
    movable
        What there is.
    prepared
        Names of ropes that are not connected at the start.
    others
        Commands of other tracks.

    Attributes
    ----------
    elsewhere
        Names of what is commanded in other tracks.
    followed
        Leaders of winches that follow one, by name: those of other tracks at any time, since nobody knows when.
    loose
        Ropes that are not connected, and joints that are released.
    braked
        Ropes whose winch has its brake set.
    planned
        Speeds of winches [m/s], by rope: positive hauls in.
    largest
        Speeds of what moves by itself, at most: in the phase, and behind it.
    levels
        Speeds at most of winches that keep a level, beside that.
    lengths
        Unstretched lengths of ropes at which their winches stop [m].
    arriving
        Names of what comes to rest somewhere, or is so.
    failed
        Names of what has failed.
    """

    def __init__(self, movable: Movable, prepared: Iterable[str], others: Iterable[Command]) -> None:
        commands = list(others)
        self.movable, self.elsewhere = movable, {command.name for command in commands} - {""}
        self.followed = {one.name: one.leader for one in commands if one.operation == FOLLOW}
        for name, rope in movable.ropes.items():
            leader = getattr(getattr(rope, "winch", None), "follow", None)
            if leader is not None:
                self.followed[name] = leader
        self.loose = set(prepared)
        self.braked: set[str] = set()
        self.planned: dict[str, float] = {}
        self.largest: dict[str, tuple[float, float]] = {}
        self.levels: dict[str, float] = {}
        self.lengths: dict[str, float] = {}
        self.arriving: set[str] = set()
        self.failed: set[str] = set()

    def check_command(self, command: Command, key: str) -> None:
        """Refuse what another track commands, or what has failed.

        Raises
        ------
        InputError
            With the key.
        """
        if command.name in self.elsewhere:
            raise InputError(
                f"{command.name!r} is commanded by another sequence",
                key=key,
                expected="actions of one sequence for each component",
            )
        if command.operation not in {FAIL, RELEASE, CONNECT}:
            for name in (command.name, command.leader):
                if name in self.failed:
                    raise InputError(
                        f"the actuator of {name!r} has failed then",
                        key=key,
                        expected="'restore' before, or another one",
                    )

    def rope(self, name: str, key: str) -> Any:
        """A rope of type wire."""
        rope = known_thing("rope", name, self.movable.ropes, key)
        described = getattr(rope, "DESCRIBED", type(rope))  # of a case file, or an object
        if described.WORD != "wire":
            raise InputError(
                f"{name!r} is a rope of type {described.WORD!r}", key=key, expected="a rope of type 'wire'"
            )
        return rope

    def winch(self, name: str, key: str) -> Any:
        """A rope with one winch: what that does, or another one copies, is not the sum of two."""
        rope = self.rope(name, key)
        if rope.other_winch is not None:
            raise InputError(
                f"{rope.name!r} has two winches", key=key, expected="a rope without 'other_winch'"
            )
        return rope

    def drive(self, name: str, key: str) -> None:
        """A drive that is there, and is a table alone."""
        if known_thing("drive", name, self.movable.drives, key) is True:
            raise InputError(
                f"harmonics are added to {name!r}", key=key, expected="a drive without 'harmonics'"
            )

    def tank(self, name: str, key: str, *, expected: str = "a tank without [[pumps]]") -> None:
        """A tank that nothing else fills or empties."""
        known_thing("tank", name, self.movable.tanks, key)
        if name in self.movable.pumped:
            pump = self.movable.pumped[name]
            raise InputError(
                f"the pump {pump!r} fills or empties {name!r}", key=key, expected=expected.format(repr(pump))
            )

    def joint(self, name: str, key: str) -> None:
        """A joint that is there still, and is rows alone."""
        reason = known_thing("joint", name, self.movable.releases, key)
        if reason:
            raise InputError(
                f"{name!r} {reason}",
                key=key,
                expected=f"a joint of type {', '.join(sorted(RELEASABLE))} that nothing drives, stops or loads",
            )
        if name in self.loose:
            raise InputError(f"{name!r} is released then", key=key, expected="a joint that is not")

    def end_phase(self, arrived: Iterable[str]) -> None:
        """What has arrived in a phase that waits for it rests."""
        for name, (_, behind) in self.largest.items():
            self.largest[name] = behind, behind
        self.largest |= dict.fromkeys(arrived, (0.0, 0.0))


def known_thing(what: str, name: str, known: Any, key: str) -> Any:
    """What has a name; None of a set.

    Raises
    ------
    InputError
        If there is no such thing.
    """
    if name not in known:
        near = get_close_matches(name, list(known), 1)
        raise InputError(
            f"{name!r} is no {what}" + (f"; did you mean {near[0]!r}?" if near else ""),
            key=key,
            expected=f"one of: {', '.join(sorted(known)) or 'there are none'}",
        )
    return known[name] if hasattr(known, "__getitem__") else None
