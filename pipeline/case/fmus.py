"""The tables of a case file that name functional mock-up units, which run beside the scene and exchange values."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, StrictBool, StrictFloat, StrictInt, StrictStr, StringConstraints

from heavylift.pipeline.case.fields import InFolder, Name, Positive, Section, reject
from heavylift.pipeline.case.simulate import SimulateSection, multiple

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

__all__ = ["FmuSection", "check_fmus"]

VariableName = Annotated[str, StringConstraints(min_length=1, max_length=1000)]


class FmuSection(Section):
    """A functional mock-up unit (FMI 2 or 3, co-simulation): a controller, a force, a machine from another program."""

    name: Name
    """For messages."""
    file: Annotated[str, InFolder()]
    """Its .fmu in the case folder, or the modelDescription.xml of an unpacked one; sources are compiled if there is no
    binary for this machine."""
    sample_time: Annotated[float, Positive("time")]
    """Time between two exchanges [s]: a multiple of a fixed step, or of the output interval with a tolerance."""
    reads: dict[VariableName, str] = Field(default_factory=dict)
    """Its inputs, and the channel that each of them gets: ``{ x = "module.position.x" }``. Values are converted where
    the FMU gives a unit."""
    writes: dict[VariableName, str] = Field(default_factory=dict)
    """Its outputs, and the input of the case that each of them drives: ``{ u = "gust" }``."""
    parameters: dict[VariableName, StrictBool | StrictInt | StrictFloat | StrictStr] = Field(
        default_factory=dict
    )
    """Values of its parameters, in its own units."""
    coupling: Literal["sequential", "iterated"] = "sequential"
    """``sequential``: the FMU makes its step with what it reads, constant, then the scene with what the FMU then
    writes; first order in the sample time. ``iterated``: both repeat the interval until what they exchange fits at its
    end, linear in between; second order, for FMUs that can get and set their state."""
    timeout: Annotated[float, Positive("time")] = 60.0
    """Longest time of the clock [s] that a call of the FMU may take."""


def check_fmus(
    fmus: "Sequence[FmuSection]", simulate: SimulateSection | None, inputs: "Collection[str]"
) -> None:
    """See that sample times fit the steps of a case, and that each input is driven once."""
    driven: dict[str, str] = {}
    names: set[str] = set()
    for index, fmu in enumerate(fmus):
        key = f"fmus.{index}"
        if fmu.name in names:
            reject(f"{fmu.name!r} occurs twice", "one FMU a name", key=f"{key}.name")
        names.add(fmu.name)
        if simulate is None or not simulate.duration:
            reject("needs a [simulate] section with a duration", "a run in which it takes part", key=key)
        unit = "step" if simulate.step is not None else "output_interval"
        for value, of, what in (
            (fmu.sample_time, simulate.solver_step, unit),
            (simulate.duration, fmu.sample_time, "sample_time"),
        ):
            if multiple(value, of) is None:
                problem = f"{value:.12g} s is {value / of:.9g} times {what} = {of:.12g} s"
                owner = "duration: " if what == "sample_time" else ""
                reject(f"{owner}{problem}", f"a multiple of {what}", key=f"{key}.sample_time")
        for output, name in fmu.writes.items():
            if name not in inputs:
                known = f"one of: {', '.join(inputs)}" if inputs else "an [[inputs]] table of this name"
                reject(f"there is no input {name!r}", known, key=f"{key}.writes.{output}")
            if name in driven:
                reject(
                    f"{name!r} is driven by {driven[name]} too",
                    "one FMU an input",
                    key=f"{key}.writes.{output}",
                )
            driven[name] = f"{output!r} of {fmu.name!r}"
        if "iterated" in {one.coupling for one in fmus} and (
            fmu.coupling != fmus[0].coupling or fmu.sample_time != fmus[0].sample_time
        ):
            reject(
                f"{fmu.coupling!r}, {fmu.sample_time:g} s beside {fmus[0].coupling!r}, {fmus[0].sample_time:g} s",
                "all FMUs alike where one is 'iterated', since they repeat their intervals together",
                key=f"{key}.coupling",
            )
