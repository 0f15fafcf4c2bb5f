"""The table of a case file that says how time is integrated."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.fields import NoDefault, Positive, Quantity, Section, reject
from heavylift.solver.scene.scene import Start

__all__ = ["DEFAULT_TOLERANCES", "SimulateSection"]

DEFAULT_TOLERANCES = {"accurate": 1e-7, "auto": 1e-5}
"""Tolerances of the integrators that have no fixed step, if the case gives none."""

_ZERO = r"^\s*[+-]?0+(\.0*)?\s*[^\d\s.eE]"
_STEP_OR_TOLERANCE: dict[str, Any] = {
    "anyOf": [
        {"required": ["step", "output_interval"]},
        {"required": ["tolerance", "output_interval"]},
        {
            "required": ["integrator", "output_interval"],
            "properties": {"integrator": {"enum": list(DEFAULT_TOLERANCES)}},
        },
        {"properties": {"duration": {"anyOf": [{"const": 0}, {"type": "string", "pattern": _ZERO}]}}},
    ]
}

MOST_STEPS = 1e15
"""Of a run: what counts them exactly, and takes more than ten years with the fastest of steps."""


class SimulateSection(Section):
    """Time integration."""

    model_config = ConfigDict(json_schema_extra=_STEP_OR_TOLERANCE)

    integrator: Literal["dele2", "accurate", "thesis", "auto"] = "dele2"
    """``dele2``: second order, fixed step or by tolerance, the default; ``accurate``: eighth order by tolerance;
    ``thesis``: first order, as published; ``auto``: the better one of the first two, by tolerance."""
    step: Annotated[float, Positive("time")] | None = None
    """Time step [s]: for ``thesis``, and for ``dele2`` and ``auto`` without a tolerance; if ``auto`` chooses
    ``accurate`` it is not used."""
    tolerance: Annotated[float, Positive("length")] | None = None
    """Error of the displacements in a step [m], by which the integrator chooses its steps: for ``dele2`` and ``auto``
    without a step; 1e-7 m for ``accurate``, 1e-5 m for ``auto`` if absent."""
    output_interval: Annotated[float, Positive("time"), NoDefault()] = 1.0
    """Time between recorded states [s], a multiple of a fixed step; needed with a duration."""
    duration: Annotated[float, Quantity("time", minimum=0.0, closed=True)]
    """Simulated time [s], a multiple of the output interval; with 0 only the start is computed and recorded."""
    start: Start = "check"
    """``check``: a start that violates joints is refused; ``project``: bodies are moved to close the joints first;
    ``equilibrium``: and then to where they are in equilibrium, at rest; ``relax``: the same by damped motion, for
    scenes whose equilibrium is hard to find. With contacts both are a damped motion, and what lies on something lies
    where its law carries it."""

    @field_validator("output_interval")
    @classmethod
    def _is_a_multiple(cls, value: float, info: ValidationInfo) -> float:
        _refuse_a_part(value, "step", info.data.get("step"))
        return value

    @model_validator(mode="after")
    def _has_a_step_or_a_tolerance(self) -> "SimulateSection":
        if self.step is not None and self.integrator == "accurate":
            reject(
                "a fixed step with integrator 'accurate'", "'tolerance', or integrator 'dele2'", key="step"
            )
        if self.tolerance is not None and self.integrator == "thesis":
            reject("a tolerance with integrator 'thesis'", "'step', or integrator 'dele2'", key="tolerance")
        if self.integrator == "thesis" and self.step is None:
            reject("integrator 'thesis' without 'step'", "a fixed time step", key="step")
        if self.step is not None and self.tolerance is not None:
            reject("both 'step' and 'tolerance'", "'step' (fixed) or 'tolerance' (adaptive)")
        if self.duration == 0.0:
            if self.start == "check":
                reject(
                    "0 s with start 'check': there is nothing to compute",
                    "a time > 0 s, or start 'equilibrium'",
                    key="duration",
                )
            return self
        if "output_interval" not in self.model_fields_set:
            reject("is missing", "a value", key="output_interval")
        if self.duration / self.solver_step > MOST_STEPS:
            reject(
                f"{self.duration / self.solver_step:.3g} steps of {self.solver_step:.3g} s",
                f"at most {MOST_STEPS:.0e} in {self.duration:g} s",
                key="output_interval" if self.step is None else "step",
            )
        _refuse_a_part(self.duration, "output_interval", self.output_interval, key="duration")
        if self.step is None and self.tolerance is None and self.integrator == "dele2":
            reject("neither 'step' nor 'tolerance'", "'step' (fixed) or 'tolerance' (adaptive)")
        return self

    @property
    def solver_step(self) -> float:
        """What the solver counts [s]: fixed steps, or output intervals."""
        return self.output_interval if self.step is None else self.step

    @property
    def solver_tolerance(self) -> float | None:
        """Tolerance the solver is given; none with a fixed step."""
        if self.step is not None:
            return None
        return self.tolerance if self.tolerance is not None else DEFAULT_TOLERANCES.get(self.integrator)

    @property
    def record_every(self) -> int:
        """Steps between recorded states."""
        return multiple(self.output_interval, self.solver_step) or 1

    @property
    def interval_count(self) -> int:
        """Output intervals of the whole simulation."""
        return multiple(self.duration, self.output_interval) or 0


def _refuse_a_part(value: float, name: str, unit: float | None, *, key: str = "") -> None:
    """Refuse a time that is no multiple of another one."""
    if unit is not None and multiple(value, unit) is None:
        problem = f"{value:.12g} s is {value / unit:.9g} times {name} = {unit:.12g} s"
        reject(problem, f"a multiple of {name}", key=key)


def multiple(value: float, unit: float) -> int | None:
    """Which whole multiple of a unit a value is; None if it is none, to 1e-6 of a unit."""
    ratio = value / unit
    if not math.isfinite(ratio):
        return None
    count = round(ratio)
    return count if count >= 1 and abs(ratio - count) <= 1e-6 * max(1.0, 1e-6 * count) else None
