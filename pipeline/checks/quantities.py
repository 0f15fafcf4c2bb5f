"""Computed quantities and checks: numbers that results are judged by."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import asdict, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.quantity_names import ACROSS
from heavylift.pipeline.case.rope_parts import words_of_inner_ropes
from heavylift.pipeline.results.histories import Results, load_results
from heavylift.pipeline.results.model_io import open_hdf5, read_states
from heavylift.pipeline.results.sinusoid import fit_sinusoid
from heavylift.pipeline.results.storage import OutputFolder, read_json
from heavylift.solver.integrate.run_watch import RunWatch
from heavylift.solver.scene.channels import Channel

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.checks import CheckSection
    from heavylift.pipeline.case.quantity_names import QuantityName
    from heavylift.pipeline.checks.stresses import SolidStresses
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.stress_io import BodyStress

__all__ = ["CheckResult", "Quantities", "energy_drift", "evaluate_check", "relative_drift"]

_REDUCTIONS: tuple[Callable[..., NDArray[np.float64]], ...] = (np.max, np.min, np.linalg.norm)
_ACROSS = dict(zip(ACROSS, _REDUCTIONS, strict=True))
_SHOWN = 20  # components of a message at most
_TOUCH = 1e-9  # of the latest time, by which a record may miss a time that a check names


@dataclass(frozen=True)
class CheckResult:
    """A quantity beside its reference, or within its limits.

    Attributes
    ----------
    id, quantity
        From the case.
    value
        In `unit` (SI); of a group that of the worst member: with limits the least margin, else the largest error.
    unit, source
        Unit of value, reference and limits; where these come from.
    passed
        Whether ``error <= tolerance``, or the value is within the limits.
    reference
        None with limits, as are `error` and `tolerance`.
    error
        ``|value - reference|``, divided by ``|reference|`` if the tolerance is relative.
    tolerance
        Largest error that passes.
    relative
        Whether error and tolerance are relative.
    maximum, minimum
        Limits; None if absent.
    seen
        Of a largest or smallest value: of what, e.g. ``"largest of 40,000 steps"``; else empty.
    where
        Name of the worst member of a group, and when an extreme was: ``"sling_3 at 12.4 s"``, ``"at 12.4 s"``. Of all
        steps it is the record that ends the interval with the extreme.
    time, member
        When an extreme was [s], else None; the quantity, of a group that of its worst member.
    note
        What the limit does not see: the other side of a channel with a sign.
    """

    id: str
    quantity: str
    value: float
    unit: str
    source: str
    passed: bool
    reference: float | None = None
    error: float | None = None
    tolerance: float | None = None
    relative: bool = False
    maximum: float | None = None
    minimum: float | None = None
    seen: str = ""
    where: str = ""
    time: float | None = None
    member: str = ""
    note: str = ""

    @property
    def has_limits(self) -> bool:
        """Whether it has limits, not a reference."""
        return self.reference is None

    @property
    def governing(self) -> tuple[str, float]:
        """The limit to which the value is nearest: ``"maximum"`` or ``"minimum"``, and its value."""
        limits = {"maximum": self.maximum, "minimum": self.minimum}
        given = {side: limit for side, limit in limits.items() if limit is not None}
        side = min(given, key=lambda one: _room(one, given[one], self.value))
        return side, given[side]

    @property
    def margin(self) -> float | None:
        """How far the value is within its limits, in `unit`; negative beyond them; None with a reference."""
        return None if not self.has_limits else _room(*self.governing, self.value)

    @property
    def utilisation(self) -> float | None:
        """Value divided by the maximum, if that governs and is positive and the value is not negative; else None."""
        if not self.has_limits:
            return None
        side, limit = self.governing
        return self.value / limit if side == "maximum" and limit > 0.0 and self.value >= 0.0 else None

    def row(self) -> dict[str, Any]:
        """The check as plain values, in the order of the ``verify --json`` document."""
        row = asdict(self)
        order = ("id", "value", "reference", "error", "tolerance", "unit", "source", "passed")
        limits = ("maximum", "minimum", "margin", "utilisation") if self.has_limits else ()
        words = {key: row[key] for key in ("seen", "where", "note") if row[key]}
        return {key: row[key] for key in order} | {key: getattr(self, key) for key in limits} | words


def _room(side: str, limit: float, value: float) -> float:
    """How far a value is within a limit."""
    return limit - value if side == "maximum" else value - limit


class Quantities:
    """Evaluates quantities of one case from the files of its stages.

    Parameters
    ----------
    case
        The case.
    out
        Its output folder; the stages that the quantities need must have run.
    log
        Told how far the stress of a body over the run is.

    Attributes
    ----------
    bounds
        First and last time of the records of which statistics are [s]; None for that of the run.
    """

    def __init__(self, case: Case, out: Path, log: Log | None = None) -> None:
        self._case = case
        self._log = log
        self._folder = OutputFolder(out)
        self._positions: dict[str, Any] = {}
        self._solids: dict[str, SolidStresses] = {}
        self._recovered_bodies: dict[str, BodyStress] = {}
        self._stresses: dict[tuple[str, str], NDArray[np.float64]] = {}
        self.bounds: tuple[float | None, float | None] = (None, None)

    @cached_property
    def results(self) -> Results:
        """Time histories, read when a quantity needs them."""
        return load_results(self._case, self._folder.root)

    def within(self, check: CheckSection) -> Quantities:
        """The same, whose statistics are of the time that a check names.

        Raises
        ------
        InputError
            If there is no record within it.
        """
        if (check.after, check.until) == self.bounds:
            return self
        self.results  # noqa: B018  what is read is kept for all
        made = copy(self)
        made.bounds = (check.after, check.until)
        if not made.inside.any():
            raise InputError(
                f"there is no record{made.span}",
                source=self._case.file,
                expected=f"'after' and 'until' within the records, which end at {self.results.time[-1]:.6g} s",
            )
        return made

    @property
    def span(self) -> str:
        """Of which time statistics are, in words with a blank before them; empty if of the whole run."""
        after, until = self.bounds
        words = ("" if after is None else f" from {after:g} s", "" if until is None else f" to {until:g} s")
        return "".join(words)

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Records of which statistics are, shape (nt,)."""
        times, (after, until) = self.results.time, self.bounds
        slack = _TOUCH * max(1.0, float(np.abs(times).max(initial=0.0)))
        late = times >= (-math.inf if after is None else after - slack)
        return np.asarray(late & (times <= (math.inf if until is None else until + slack)))

    @property
    def _begins(self) -> int | None:
        """Number of the record that is just at the beginning of that time, if one is."""
        after, times = self.bounds[0], self.results.time
        if after is None:
            return None
        nearest = int(np.abs(times - after).argmin())
        slack = _TOUCH * max(1.0, float(np.abs(times).max(initial=0.0)))
        return nearest if abs(times[nearest] - after) <= slack else None

    def evaluate(self, text: str) -> NDArray[np.float64]:
        """Value of a quantity in SI: a number, or an array for a channel without component and for a group.

        Raises
        ------
        InputError
            If a mode, channel or component does not exist, or the results are missing.
        """
        name = self._case.quantity(text)
        if name.members:
            return np.concatenate([self.evaluate(member).ravel() for _, member in name.members])
        readers = {
            "mesh": self._mesh,
            "modes": self._modes,
            "static": self._static,
            "ringdown": self._ringdown,
            "drift": self._drift,
            "channel": self._channel,
            "stress": self._stress,
            "frequency": self._frequency,
            "angular_frequency": lambda name: 2.0 * math.pi * self._frequency(name),
            "growth": self._growth,
            "deviation": self._deviation,
            "lines": self._lines,
            "hydrostatics": self._hydrostatics,
            "tipping": self._tipping,
            "errors": self._errors,
        }
        return np.asarray(readers[name.family](name), dtype=np.float64)

    def seen(self, text: str) -> str:
        """Of how many steps or records a quantity is the largest or smallest value, and within which time."""
        name = self._case.quantity(text)
        words = {"max": "largest", "min": "smallest", "absolute": "largest amount"}
        if name.family != "channel" or name.statistic not in words:
            return self.span.strip()
        side = "min" if name.statistic == "min" else "max"
        return f"{words[name.statistic]} of {self.results.extremes(name.item, side)[1]}{self.span}"

    def other_side(self, text: str, limit: float | None) -> str:
        """That the smallest value is beyond the amount that limits the largest one, or the reverse; else empty."""
        name = self._case.quantity(text)
        other = {"max": "min", "min": "max"}.get(name.statistic)
        if name.family not in {"channel", "stress"} or other is None or not limit:
            return ""
        value = self.number(f"{text.rpartition('.')[0]}.{other}")
        sign = 1.0 if name.statistic == "max" else -1.0
        if sign * limit < 0.0 or sign * value >= -abs(limit):
            return ""
        what = "smallest" if other == "min" else "largest"
        unit = "" if name.kind.unit == "1" else f" {name.kind.unit}"
        return f"the {what} is {value:.6g}{unit}; the statistic 'absolute' judges both sides"

    def time_of_extreme(self, text: str) -> float | None:
        """When a largest or smallest value was [s]; None of other quantities. Of all steps it is the next record."""
        name = self._case.quantity(text)
        if name.family == "deviation" and name.statistic != "rms":
            times, distances = self._distances(name)
            return float(times[distances.argmax()])
        reader = {"channel": self._history, "stress": self._stress_history}.get(name.family)
        if reader is None or name.statistic not in {"max", "min", "absolute"}:
            return None
        history = reader(name)[self.inside]
        if name.statistic == "absolute":
            history = np.abs(history)
        index = history.argmin() if name.statistic == "min" else history.argmax()
        return float(self.results.time[self.inside][index]) if history.ndim == 1 else None

    def history(self, text: str) -> NDArray[np.float64]:
        """What the statistic of a channel or of a stress is taken of, one number a record: shape (nt,)."""
        name = self._case.quantity(text)
        history = {"channel": self._history, "stress": self._stress_history}[name.family](name)
        if history.ndim > 1:
            components = self.results.components(name.item)
            raise self._missing(name, f"one component: {', '.join(components[:_SHOWN])}")
        return history

    @staticmethod
    def statistic(word: str, history: NDArray[np.float64], times: NDArray[np.float64]) -> Any:
        """Statistic of a history, shape (nt, ...), at times [s]; shape (...)."""
        reductions = {
            "end": lambda a: a[-1],
            "min": lambda a: a.min(axis=0),
            "max": lambda a: a.max(axis=0),
            "absolute": lambda a: np.abs(a).max(axis=0),
            "mean": lambda a: a.mean(axis=0),
            "rms": lambda a: np.sqrt(np.mean(a**2, axis=0)),
            "rate": lambda a: (a[-1] - a[0]) / (times[-1] - times[0]),
        }
        return reductions[word](history)

    def number(self, text: str) -> float:
        """Value of a quantity that is one number."""
        value = self.evaluate(text)
        if value.ndim:
            raise InputError(
                f"quantity {text!r} has {value.size} components",
                source=self._case.file,
                expected="one component, e.g. ....x.end",
            )
        return float(value)

    def _mesh(self, name: QuantityName) -> float:
        manifest = read_json(self._folder.manifest("mesh")) or {}
        properties = manifest.get("items", {}).get(name.owner, {}).get("properties", {})
        if properties.get(name.item) is None:
            raise self._missing(name, "a mesh made here, by `heavylift mesh CASE`")
        return float(properties[name.item])

    def _modes(self, name: QuantityName) -> float:
        with open_hdf5(self._folder.reduced(name.owner), "make it with `heavylift modes CASE`") as file:
            if name.item == "orthogonality":
                return float(file.attrs["orthogonality"])
            values = file["residuals"][:] if name.item == "residual" else _frequencies(file["eigenvalues"][:])
        return float(values[self._vector(name, len(values))])

    def _static(self, name: QuantityName) -> float:
        """Of a static load case: stress or displacement of a sensor, largest stress, reaction, buckling factor."""
        from heavylift.pipeline.checks.stresses import interpolated

        state = read_states(self._folder.reduced(name.owner)).get(name.item)
        if state is None:
            raise self._missing(name, "static load cases of this case file; `heavylift modes CASE`")
        item, _, rest = name.component.partition(".")
        if item == "reaction":
            return float(state.reaction["xyz".index(rest)])
        if item == "buckling":
            if state.buckling_factor is None:
                raise self._missing(name, f"buckling = true in static load case {name.item!r}")
            return state.buckling_factor
        if item == "von_mises":
            return float(self._solid(name.owner).nodal(state, "von_mises").max())
        point, _, component = rest.rpartition(".")
        sensor = next(one for one in self._case.sensors if one.name == point)
        if item == "stress":
            return self._solid(name.owner).at(state, sensor.point, component)
        model = self._solid(name.owner).model
        moved = interpolated(model, state.displacements[np.newaxis], sensor.point, self._case.file)[0]
        return float(moved["xyz".index(component)])

    def _ringdown(self, name: QuantityName) -> float:
        history = self.results[f"{name.owner}.modal_position"]
        history = history.reshape(len(history), -1)
        values = history[:, self._vector(name, history.shape[1])]
        body = self._case.bodies[name.owner]
        damped = body.BODY.MODAL and (any(body.modes.damping_ratio) or body.modes.stiffness_damping > 0.0)
        return self._fitted_frequency(name, values, damped=damped)

    def _frequency(self, name: QuantityName) -> float:
        history = self._history(name)
        if history.ndim > 1:
            components = self.results.components(name.item)
            raise self._missing(name, f"{name.text}.COMPONENT, one of: {', '.join(components[:_SHOWN])}")
        return self._fitted_frequency(name, history, damped=False)

    def _growth(self, name: QuantityName) -> float:
        """Slope of the logarithm of a channel over the last half of the records [1/s], by least squares."""
        history = self._history(name)
        if history.ndim > 1:
            components = self.results.components(name.item)
            raise self._missing(name, f"{name.text}.COMPONENT, one of: {', '.join(components[:_SHOWN])}")
        half = len(history) // 2
        times, values = self.results.time[half:], history[half:]
        if len(values) < 2 or not np.all(values * values[0] > 0.0):
            raise InputError(
                f"{name.text}: the channel passes zero, or has fewer than two records, in the last half of the run",
                source=self._case.file,
                expected="a channel that grows or decays without a change of sign",
            )
        return float(np.polyfit(times - times[0], np.log(np.abs(values)), 1)[0])

    def _fitted_frequency(self, name: QuantityName, values: NDArray[np.float64], *, damped: bool) -> float:
        """Frequency [Hz] of one sinusoid about a mean; a message of the fit is reported with the quantity."""
        try:
            return fit_sinusoid(self.results.time, values, damped=damped).frequency
        except InputError as error:
            raise InputError(
                f"{name.text}: {error.problem}", source=self._case.file, expected=error.expected
            ) from None

    def _drift(self, name: QuantityName) -> float:
        if name.item == "energy":
            return energy_drift(self.results)
        channel = "momentum.linear" if name.item == "momentum" else "momentum.angular"
        history = self.results[channel]
        if not np.any(history[0]):
            raise self._missing(name, f"{channel} that is not zero at the start")
        return relative_drift(history)

    def _channel(self, name: QuantityName) -> NDArray[np.float64]:
        return self._statistic(name, self._history(name))

    def _stress(self, name: QuantityName) -> NDArray[np.float64]:
        return self._statistic(name, self._stress_history(name))

    def _stress_history(self, name: QuantityName) -> NDArray[np.float64]:
        """Stress at a sensor, or the largest of a flexible body, at all records [Pa], shape (nt,)."""
        if name.item:
            return self._recovered(name)
        key = (name.owner, name.component)
        if key not in self._stresses:
            self._stresses[key] = self._stresses_over_time(name)
        return self._stresses[key]

    def _recovered(self, name: QuantityName) -> NDArray[np.float64]:
        """Of a group or a hot spot of a body with a table ``stress``, shape (nt,)."""
        stress = self.body_stress(name.owner)
        *side, what = name.component.split(".")
        try:
            if what == "hot_spot":
                return stress.hot_spots[name.item]
            if what == "buckling" and stress.panels is not None:
                return np.asarray(
                    stress.panels.use[:, stress.panels.of(name.item)].max(axis=1), dtype=np.float64
                )
            return stress.group(name.item).history("".join(side), used=what == "utilisation")
        except InputError as error:
            raise InputError(
                f"{name.text}: {error.problem}", source=self._case.file, expected=error.expected
            ) from None

    def body_stress(self, body: str) -> BodyStress:
        """Stress of a flexible body with a table ``stress`` over the run."""
        from heavylift.pipeline.checks.body_stress import body_stress

        if body not in self._recovered_bodies:
            self._recovered_bodies[body] = body_stress(
                self._case, body, self._folder, self.results, self._log
            )
        return self._recovered_bodies[body]

    def _stresses_over_time(self, name: QuantityName) -> NDArray[np.float64]:
        from heavylift.pipeline.checks.stresses import frame_point_stress, shell_point_stress

        sensor = next((one for one in self._case.sensors if one.name == name.owner), None)
        owner, point = (name.owner, None) if sensor is None else (sensor.body, sensor.point)
        if self._case.bodies[owner].BODY.MODAL:
            return self._solid(owner).history(self.results, point, name.component)
        assert point is not None
        shape = self.results.meshes[owner]
        of_point = shell_point_stress if shape.type == "shell" else frame_point_stress
        return of_point(shape, self.results, point, name.component, self._case.file)

    def _solid(self, body: str) -> SolidStresses:
        from heavylift.pipeline.checks.stresses import SolidStresses

        if body not in self._solids:
            asked = self._case.bodies[body].stress is not None and self._case.simulate is not None
            stress = self.body_stress(body) if asked else None
            self._solids[body] = SolidStresses(body, self._folder, self._case.file, stress)
        return self._solids[body]

    def _statistic(self, name: QuantityName, history: NDArray[np.float64]) -> NDArray[np.float64]:
        inside = self.inside
        return np.asarray(self.statistic(name.statistic, history[inside], self.results.time[inside]))

    def _history(self, name: QuantityName) -> NDArray[np.float64]:
        """Records of a channel, shape (nt,), or (nt, components) if none of several is named."""
        results = self.results
        history = results[name.item]
        if name.statistic in ("max", "min", "absolute"):
            ends = history
            if name.statistic == "absolute":
                both = [np.abs(results.extremes(name.item, side)[0]) for side in ("max", "min")]
                ends, history = np.abs(ends), np.maximum(*both)
            else:
                history = results.extremes(name.item, name.statistic)[0]
            begins = self._begins  # the interval before it does not count
            if begins is not None:
                history = history.copy()
                history[begins] = ends[begins].reshape(history[begins].shape)
        history = history.reshape(len(results.time), -1)
        components = results.components(name.item)
        if name.component in components and name.component:
            history = history[:, components.index(name.component)]
        elif name.component in _ACROSS:
            history = _ACROSS[name.component](history, axis=1)
        elif name.component:
            more = f" and {len(components) - _SHOWN} more" if len(components) > _SHOWN else ""
            raise self._missing(
                name, f"a component: {', '.join(components[:_SHOWN])}{more}; or {', '.join(_ACROSS)}"
            )
        elif len(components) == 1:
            history = history[:, 0]
        lost = np.isnan(history.reshape(len(results.time), -1)).any(axis=1) & self.inside
        if "(" in name.item and lost.any():
            time = results.time[lost][0]
            raise self._missing(
                name, f"numbers; at {time:.6g} s a ratio divides by zero, or the run has none"
            )
        if lost.any() and name.item.rpartition(".")[2] in {"gap", "gap_min"}:
            raise self._missing(
                name,
                "surfaces whose distance is measured while they are out of reach: 'clearance = true' in the collision",
            )
        return np.asarray(history)

    def _distances(self, name: QuantityName) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times [s] and distances from a reference history."""
        from heavylift.pipeline.checks.deviation import deviation_history

        reference = next(entry for entry in self._case.reference if entry.name == name.item)
        return deviation_history(self._case, reference, self.results)

    def _deviation(self, name: QuantityName) -> float:
        _, distances = self._distances(name)
        return float(np.sqrt(np.mean(distances**2)) if name.statistic == "rms" else distances.max())

    def _lines(self, name: QuantityName) -> float:
        lengths = self.results.metadata.get("sea", {}).get("line_lengths", {})
        if name.owner not in lengths:
            raise self._missing(name, "results of a simulation with this line")
        return float(sum(lengths[name.owner]))

    def _tipping(self, name: QuantityName) -> float:
        found = self.results.metadata.get("tipping", {}).get(name.owner)
        if found is None:
            raise self._missing(name, "results of a simulation with this transporter under a rigid body")
        return float(found[name.item])

    def _hydrostatics(self, name: QuantityName) -> float:
        if name.owner not in self._positions:
            from heavylift.pipeline.assemble.hulls import resting_position

            if self._case.hulls[name.owner].surface is None:
                raise self._missing(name, "a hull with a surface")
            self._positions[name.owner] = resting_position(self._case, name.owner, self._folder)
        position = self._positions[name.owner]
        values = {
            "displacement": position.mass,
            "trim": position.pose.trim,
            "list": position.pose.list,
            "origin_z": position.level + position.pose.height,
        }
        return float(values[name.item] if name.item in values else getattr(position, name.item))

    def _errors(self, name: QuantityName) -> float:
        checks = [
            check
            for check in self._case.check
            if check.id.startswith(f"{name.item}_")
            and check.reference is not None
            and not check.quantity.startswith("errors")
        ]
        return float(
            max(
                np.abs(one.evaluate(check.quantity) - one.reference(check)).max()
                for check, one in ((check, self.within(check)) for check in checks)
            )
        )

    def reference(self, check: CheckSection) -> float:
        """Reference of a check that has one, in SI."""
        given = check.reference
        assert given is not None
        return given if isinstance(given, float) else self.number(given.quantity)

    def _vector(self, name: QuantityName, count: int) -> int:
        if int(name.component) > count:
            raise self._missing(name, f"a number from 1 to {count}")
        return int(name.component) - 1

    def _missing(self, name: QuantityName, expected: str) -> InputError:
        return InputError(
            f"quantity {name.text!r} cannot be computed", source=self._case.file, expected=expected
        )


def _frequencies(eigenvalues: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.sqrt(np.maximum(eigenvalues, 0.0)) / (2.0 * np.pi)


def relative_drift(history: NDArray[np.float64]) -> float:
    """Largest norm of the deviation from the first row, divided by the norm of the first row."""
    rows = history.reshape(len(history), -1)
    with np.errstate(invalid="ignore", over="ignore"):
        deviation = np.linalg.norm(rows - rows[0], axis=1).max()
        return float(deviation / np.linalg.norm(rows[0]))


def energy_drift(results: Results) -> float:
    """Largest deviation of the energy balance from its initial value, over the energy turned over.

    The balance (kinetic + elastic + potential - work put in + dissipated) is constant in exact arithmetic. A run has
    measured it itself, see `heavylift.solver.integrate.run_watch`; of one that was cut off the records tell, without
    the floor that scenes at rest have. Not a number for a run that diverged.
    """
    if "energy_drift" in results.metadata:
        return float(results.metadata["energy_drift"])
    names = [name for name in results if name.startswith("energy.")]
    watch = RunWatch([Channel(name, "J", ("",), i, "") for i, name in enumerate(names)])
    watch.add(np.column_stack([results[name] for name in names]))
    return watch.drift


def evaluate_check(case: Case, quantities: Quantities, check: CheckSection) -> CheckResult:
    """The check of the member of a group that is worst, or of a quantity by itself."""
    within, name = quantities.within(check), case.quantity(check.quantity)
    results = [
        _of_member(check, within, name.kind.unit, owner, text)
        for owner, text in name.members or (("", check.quantity),)
    ]
    worst = max(results, key=_badness)
    words = words_of_inner_ropes(case, check.quantity) if worst.has_limits else ""
    return replace(worst, note="; ".join(filter(None, (worst.note, words)))) if words else worst


def _badness(check: CheckResult) -> tuple[bool, float]:
    """What grows with the error, or as the margin shrinks; a value that is no number is worse than any."""
    worse = check.error if check.error is not None else -(check.margin or 0.0)
    return math.isnan(worse), worse


def _of_member(
    check: CheckSection, quantities: Quantities, unit: str, owner: str, quantity: str
) -> CheckResult:
    value = quantities.number(quantity)
    time = quantities.time_of_extreme(quantity)
    result = CheckResult(
        id=check.id,
        quantity=check.quantity,
        value=value,
        unit=unit,
        source=check.source or "",
        passed=False,
        maximum=check.maximum,
        minimum=check.minimum,
        seen=quantities.seen(quantity),
        where=" ".join(filter(None, (owner, "" if time is None else f"at {time:.6g} s"))),
        time=time,
        member=quantity,
    )
    if (check.maximum is None) != (check.minimum is None):
        limit = check.maximum if check.minimum is None else check.minimum
        side = "max" if check.minimum is None else "min"
        if quantity.endswith(f".{side}"):
            result = replace(result, note=quantities.other_side(quantity, limit))
    if check.reference is None:
        margin = result.margin
        return replace(result, passed=bool(margin is not None and margin >= 0.0))
    assert check.tolerance is not None
    reference = quantities.reference(check)
    relative = check.tolerance.relative is not None
    tolerance = float((check.tolerance.relative if relative else check.tolerance.absolute) or 0.0)
    error = abs(value - reference) / (abs(reference) if relative else 1.0)
    return replace(
        result,
        passed=bool(error <= tolerance),
        reference=reference,
        error=error,
        tolerance=tolerance,
        relative=relative,
    )
