"""Descriptions of inputs: numbers that are set from outside while a scene runs; in SI units.

Between two settings an input is ``value + rate (t - since)`` until a time, and held from there on. What it drives reads
it as it reads a table of time, and so nothing of a step knows where the number comes from.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import NameOf, Quantity
from heavylift.solver.scene.connections import AlongJoint, ForceElement, Stage
from heavylift.solver.scene.descriptions import Family
from heavylift.solver.scene.operation_state import OperationState, known_thing
from heavylift.solver.scene.outputs import Outputs, channel, outputs

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from heavylift.solver.scene.drawn import Element
    from heavylift.solver.scene.operation_state import Movable
    from heavylift.solver.scene.scenario import Scenario

__all__ = [
    "INPUTS",
    "WHAT",
    "AboutFrame",
    "AlongFrame",
    "AngleInputOutputs",
    "ForceInputOutputs",
    "ForceLimits",
    "Input",
    "Interpolation",
    "LengthInputOutputs",
    "MomentInputOutputs",
    "OnController",
    "OnFluid",
    "OnFrame",
    "OnJoint",
    "OnRope",
    "SpeedInputOutputs",
    "SpeedLimits",
    "TurnRateInputOutputs",
    "check_inputs",
    "check_limits",
]

INPUTS: Family[Any] = Family("input", "heavylift.solver.inputs")
"""All inputs, by their types in a case file."""

Interpolation = Literal["held", "linear"]
"""Whether an input jumps when it is set, or moves from what it was."""

WHAT = "what the input was set to, as it acts at the record"


@outputs
class ForceInputOutputs(Outputs):
    """What every input records: a number; kernels write all of them as this one."""

    value: float = channel("force", WHAT)


@outputs
class MomentInputOutputs(Outputs):
    """Of inputs that are moments."""

    value: float = channel("moment or energy", WHAT, by_owner=True)


@outputs
class SpeedInputOutputs(Outputs):
    """Of inputs that are speeds."""

    value: float = channel("velocity", WHAT, by_owner=True)


@outputs
class TurnRateInputOutputs(Outputs):
    """Of inputs that are rates of an angle."""

    value: float = channel("angular velocity", WHAT, by_owner=True)


@outputs
class LengthInputOutputs(Outputs):
    """Of inputs that are lengths, heights and displacements."""

    value: float = channel("length", WHAT, by_owner=True)


@outputs
class AngleInputOutputs(Outputs):
    """Of inputs that are angles."""

    value: float = channel("angle", WHAT, by_owner=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class Input(ForceElement):
    """What all inputs have.

    Attributes
    ----------
    name
        Its own name; its channel is ``NAME.value``.
    ACTS
        ``"force"``, ``"moment"`` or ``"load"`` of those that act on markers themselves; empty of those that drive
        something else.
    DRIVES, TARGET
        What that is, as a scenario calls what it commands: ``"winch"``, ``"drive"``, ``"tank"``; or ``"controller"``,
        ``"fluid"``; and the key that names it.
    PART
        What of that it is, if several inputs may drive it; or it has a key ``keeps`` that says so.
    MOVES
        Whether it is a place or a length, which never jumps.
    """

    STAGE: ClassVar[Stage] = Stage.LOADS
    ACTS: ClassVar[str] = ""
    DRIVES: ClassVar[str] = ""
    TARGET: ClassVar[str] = ""
    PART: ClassVar[str] = ""
    MOVES: ClassVar[bool] = False

    name: str

    def packed_by(self, integrator: str) -> str:
        """All inputs are one kind."""
        del integrator
        return "heavylift.solver.inputs.packing"

    def obstacle(self, integrator: str) -> str:
        """What moves bodies as prescribed jumps in its speed, which only 'dele2' follows."""
        if integrator != "dele2" and self.DRIVES not in {"", "winch", "fluid"}:
            return "drives what only 'dele2' follows"
        return ""

    @property
    def target(self) -> str:
        """Name of what it drives, as a scenario would command it; empty of one that acts itself."""
        return ""

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        raise NotImplementedError

    @property
    def start(self) -> float:
        """Value at the start, of one that has a key for it."""
        return float(getattr(self, "value", 0.0))

    def drawn(self) -> Iterable[Element]:
        """Nothing."""
        return ()


@dataclass(frozen=True, eq=False, kw_only=True)
class ForceLimits:
    """Start and limits of an input that is a force."""

    CHANNELS: ClassVar = ForceInputOutputs.CHANNELS

    value: Annotated[float, Quantity("force")] = 0.0
    """At the start [N]; held until it is set."""
    smallest: Annotated[float | None, Quantity("force")] = None
    """Smallest value that it may be set to [N]."""
    largest: Annotated[float | None, Quantity("force")] = None
    """Largest value that it may be set to [N]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SpeedLimits:
    """Start and limits of an input that is a speed."""

    CHANNELS: ClassVar = SpeedInputOutputs.CHANNELS

    value: Annotated[float, Quantity("velocity")] = 0.0
    """At the start [m/s]; held until it is set."""
    smallest: Annotated[float | None, Quantity("velocity")] = None
    """Smallest value that it may be set to [m/s]."""
    largest: Annotated[float | None, Quantity("velocity")] = None
    """Largest value that it may be set to [m/s]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class OnRope(Input):
    """What both have."""

    DRIVES: ClassVar[str] = "winch"
    TARGET: ClassVar[str] = "rope"

    rope: Annotated[str, NameOf("rope")]
    """Name of a wire rope, whose winch has no plan of its own."""

    @property
    def target(self) -> str:
        """The rope."""
        return self.rope


@dataclass(frozen=True, eq=False, kw_only=True)
class OnJoint(AlongJoint, Input):
    """What inputs of driven joints have."""

    DRIVES: ClassVar[str] = "drive"
    TARGET: ClassVar[str] = "joint"

    @property
    def target(self) -> str:
        """The joint."""
        return self.joint


@dataclass(frozen=True, eq=False, kw_only=True)
class OnFrame(Input):
    """What inputs of driven frames have."""

    DRIVES: ClassVar[str] = "drive"
    TARGET: ClassVar[str] = "body"

    body: Annotated[str, NameOf("body")]
    """Body whose frame is driven or fixed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AlongFrame(OnFrame):
    """Along an axis of the world."""

    axis: Annotated[Literal["x", "y", "z"], "of the world"]
    """Axis of the world along which it moves."""

    @property
    def target(self) -> str:
        """The axis of the frame."""
        return f"{self.body}.{self.axis}"


@dataclass(frozen=True, eq=False, kw_only=True)
class AboutFrame(OnFrame):
    """About the axis of the frame."""

    @property
    def target(self) -> str:
        """The angle of the frame."""
        return f"{self.body}.angle"


@dataclass(frozen=True, eq=False, kw_only=True)
class OnController(Input):
    """What both set points have."""

    DRIVES: ClassVar[str] = "controller"
    TARGET: ClassVar[str] = "controller"
    interpolation: ClassVar[Interpolation] = "held"

    controller: Annotated[str, NameOf("pump")]
    """Controller of ballast."""

    @property
    def target(self) -> str:
        """The controller."""
        return self.controller


@dataclass(frozen=True, eq=False, kw_only=True)
class OnFluid(Input):
    """What inputs of winds and currents have."""

    DRIVES: ClassVar[str] = "fluid"
    TARGET: ClassVar[str] = "fluid"
    interpolation: ClassVar[Interpolation] = "held"

    fluid: Annotated[str, NameOf("fluid")] = "wind"
    """Name of a wind or a current."""

    @property
    def target(self) -> str:
        """The wind or current."""
        return self.fluid


def check_limits(spec: Any) -> None:
    """A range that is not empty, with the start in it.

    Raises
    ------
    InputError
        If it is.
    """
    low, high = spec.smallest, spec.largest
    if low is not None and high is not None and low > high:
        raise InputError(
            f"{low:g} is above 'largest', {high:g}", key="smallest", expected=f"at most {high:g}"
        )
    value = getattr(spec, "value", None)
    if value is None:
        return
    if low is not None and value < low:
        raise InputError(f"{value:g} is below 'smallest'", key="value", expected=f"{low:g} or more")
    if high is not None and value > high:
        raise InputError(f"{value:g} is above 'largest'", key="value", expected=f"at most {high:g}")


def check_inputs(
    inputs: Sequence[Any],
    scenario: Scenario | None,
    movable: Movable,
    controllers: Mapping[str, Any],
    fluids: Iterable[str],
) -> None:
    """Refuse inputs that drive what is not there, what something else drives, or one thing twice.

    Parameters
    ----------
    inputs
        Of a scene, or sections of a case.
    scenario
        What commands other things.
    movable
        What a scenario could command.
    controllers, fluids
        Controllers by name; names of winds and currents.

    Raises
    ------
    InputError
        The first thing that is wrong; the key begins with the number of the input.
    """
    state = OperationState(movable, (), ())
    known = {"controller": controllers, "fluid": frozenset(fluids)}
    commanded = {name for one in (scenario.commands if scenario else ()) for name in (one.name, one.leader)}
    commanded |= set(scenario.prepared) if scenario else set()
    taken: dict[tuple[str, ...], str] = {}
    for number, one in enumerate(inputs):
        described = getattr(one, "DESCRIBED", type(one))
        if not described.DRIVES:
            continue
        target, key = described.target.fget(one), f"inputs.{number}.{described.TARGET}"
        try:
            _check_target(described, target, key, state, known)
        except InputError as error:
            raise InputError(error.problem, source=one.name, key=error.key, expected=error.expected) from None
        problem, expected = "", "one input for each"
        if described.DRIVES not in known and target in commanded:
            problem, expected = (
                f"{target!r} is commanded by the scenario too",
                "an input, or a scenario, for each",
            )
        driven = described.DRIVES, target, described.PART or getattr(one, "keeps", "")
        if driven in taken:
            problem = f"{taken[driven]!r} drives {target!r} too"
        if problem:
            raise InputError(problem, source=one.name, key=key, expected=expected)
        taken[driven] = one.name


def _check_target(
    described: Any, target: str, key: str, state: OperationState, known: Mapping[str, Any]
) -> None:
    """What an input drives is there, and can be driven."""
    drives = described.DRIVES
    if drives == "winch":
        _check_winch(state.winch(target, key), key, by_length=described.MOVES)
    elif drives == "drive":
        state.drive(target, key)
    elif drives == "tank":
        state.tank(target, key)
    else:
        known_thing("controller" if drives == "controller" else "wind or current", target, known[drives], key)


def _check_winch(rope: Any, key: str, *, by_length: bool) -> None:
    """A rope whose winch has no plan of its own, and keeps no tension; with a brake that slips no length is kept."""
    winch = rope.winch
    if winch is None:
        return
    for told in ("lengths", "tensions", "follow", *["brake"] * by_length):
        value = getattr(winch, told)
        if value is not None and (isinstance(value, str | float) or len(value)):
            raise InputError(
                f"the winch of {rope.name!r} has {told!r}",
                key=key,
                expected="a winch without a plan of its own",
            )
    if any(speed != 0.0 for speed in winch.speeds):
        raise InputError(
            f"the winch of {rope.name!r} has 'speeds'",
            key=key,
            expected="a winch without a plan of its own: speeds of 0",
        )
