"""Tables of a case file that describe what floats: what restores hulls, and their hydrodynamic databases.

Both are about files and what a stage makes of them, surfaces and databases, so they are sections of their own; the
numbers of a hull and of its tanks are described where the solver takes them.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import PurePath
from typing import Annotated, Literal, Self

from numpy import linspace
from pydantic import Field, model_validator

from heavylift.numerics.foreign_files import converter_words
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.described import make_section, section_of
from heavylift.pipeline.case.fields import (
    InFolder,
    KnownHull,
    LengthVector,
    Positive,
    Quantity,
    Section,
    reject,
)
from heavylift.preprocess.hydrodynamics.repairs import (
    FEWEST,
    LARGEST_TOLERANCE,
    TOLERANCE,
    Repair,
    refuse_between,
)
from heavylift.preprocess.hydrodynamics.words import ExcitingForces, FileFormat, FirstColumn, TimeConvention
from heavylift.solver.scene.sea import Hull, LinearRestoring, Memory
from heavylift.solver.scene.wind_loads import Heading

__all__ = [
    "DATABASE_FORMATS",
    "ComputeSection",
    "DatabaseSection",
    "FrequenciesSection",
    "hull_section",
]

DATABASE_FORMATS = {
    ".nc": "netcdf",
    ".h5": "bemio",
    ".out": "wamit-out",
    ".1": "wamit",
    ".3": "wamit",
    ".hst": "wamit",
}
"""Formats of databases by the ending of a file."""

_READER_KEYS = {
    "length_scale": ("wamit",),
    "first_column": ("wamit",),
    "time_convention": ("netcdf",),
    "forces": ("wamit-out",),
    "symmetric": ("wamit", "wamit-out", "bemio"),
    "reference_points": ("wamit", "bemio", "netcdf"),
}
"""Keys of databases in files, and the formats that need them."""


class HangingSection(Section):
    """What hangs on a hull by ropes, as if its mass were where it hangs."""

    mass: Annotated[float, Positive("mass")]
    """Mass [kg]."""
    point: LengthVector
    """Where it hangs, in the coordinates of the geometry of the hull [m]."""


class _RestoredSection(Section):
    """What gives a hull its buoyancy, and where."""

    surface: str | None = None
    """Name of a closed surface of this body, clipped by the still water."""
    linear: section_of(LinearRestoring) | None = None  # type: ignore[valid-type]
    """In place of `surface`, linear restoring in numbers."""
    restoring: Literal["clipped", "linear", "none"] | None = None
    """``clipped``: of the surface at every instant, the default with one; ``linear``: for small motions, of the numbers
    in `linear` or of the surface where it floats by itself; ``none``: of a body whose weight is given under water."""
    open_deck: Annotated[float, Quantity("length")] | None = None
    """Height in the coordinates of the geometry [m] from which on the surface may be open."""
    hanging: HangingSection | None = None
    """What hangs on ropes while it rests: for linear restoring, a database of the surface, and `hydrostatics`, which
    count what joints hold, and no ropes. In the run ropes pull as they do."""

    @property
    def kind(self) -> str:
        """How it is restored: ``clipped``, ``linear`` or ``none``."""
        return self.restoring or ("clipped" if self.surface is not None else "linear")

    @model_validator(mode="after")
    def _has_one_restoring(self) -> Self:
        if self.surface is not None and self.linear is not None:
            reject("both 'surface' and 'linear'", "one of them: buoyancy must not count twice", key="linear")
        if self.restoring != "none" and self.surface is None and self.linear is None:
            reject("neither 'surface' nor 'linear'", "one of them, or restoring 'none'")
        if self.restoring == "none" and self.linear is not None:
            reject("'linear' with restoring 'none'", "one of them", key="linear")
        if self.restoring == "clipped" and self.surface is None:
            reject("'clipped' without 'surface'", "the name of a surface of this body", key="restoring")
        if self.open_deck is not None and self.surface is None:
            reject("'open_deck' without 'surface'", "a surface, or no 'open_deck'", key="open_deck")
        return self


@cache
def hull_section(described: type[Hull]) -> type[Section]:
    """Section of a hull."""
    return make_section(described, _RestoredSection)


class FrequenciesSection(Section):
    """Equal steps of the frequency."""

    first: Annotated[float, Positive("angular velocity")]
    """[rad/s]."""
    last: Annotated[float, Positive("angular velocity")]
    """[rad/s]."""
    count: Annotated[int, Field(ge=3, le=1000, strict=True)]
    """How many."""

    @model_validator(mode="after")
    def _increases(self) -> Self:
        if self.last <= self.first:
            reject(f"{self.first:g} to {self.last:g} rad/s", "the lower frequency first")
        return self


class ComputeSection(Section):
    """A database that the mesh stage computes with Capytaine, from the surfaces of the hulls below the still water."""

    panel_size: Annotated[float, Positive("length")]
    """Side of a panel [m]; at most a sixth of the shortest wave. Round faces get smaller ones if volume asks."""
    frequencies: FrequenciesSection
    """[rad/s]; the limit of infinite frequency is computed, too."""
    heading_step: Annotated[float, Quantity("angle", minimum=0.0, maximum=0.1745329252, closed=True)] = (
        0.1745329251994
    )
    """Between headings [rad], at most 10 degrees."""
    headings: tuple[Annotated[float, Heading()], ...] = ()
    """In place of `heading_step`, the only directions [rad] that waves will have, in the axes of the first hull."""
    symmetric: Annotated[bool, Field(strict=True)] = False
    """Hulls are symmetric about y = 0 of the first one: headings of half a turn are enough."""
    lid: Annotated[bool, Field(strict=True)] = True
    """Cover the water inside the hulls, which removes irregular frequencies."""
    processes: Annotated[int, Field(ge=0, le=1000, strict=True)] = 0
    """How many work side by side; 0: one for each core."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.heading_step == 0.0:
            reject("a step of 0", "an angle above 0, up to 10 degrees", key="heading_step")
        if any(b <= a for a, b in pairwise(self.headings)):
            reject("headings that do not increase", "increasing angles [rad]", key="headings")
        return self


class DatabaseSection(Section):
    """Added mass, damping and excitation of one hull, or of several that interact."""

    file: Annotated[str, InFolder()] | None = None
    """netCDF of this program or of Capytaine (.nc), BEMIO (.h5), WAMIT (.1, with .3 and .hst beside it; or .out)."""
    compute: ComputeSection | None = None
    """In place of `file`: computed in the mesh stage, which needs the extra ``heavylift[hydro]``."""
    hulls: Annotated[tuple[KnownHull, ...], Field(min_length=1)]
    """Names of hulls, in the order of the database."""
    frequency_range: (
        tuple[Annotated[float, Positive("angular velocity")], Annotated[float, Positive("angular velocity")]]
        | None
    ) = None
    """Lowest and highest frequency that are used [rad/s]; all if absent."""
    leave_out: tuple[Annotated[float, Positive("angular velocity")], ...] = ()
    """Frequencies that are left out [rad/s], in between is interpolated: irregular ones, or where a gap between hulls
    resonates and panels give no reciprocal matrix. Each is one that there is, to a tenth of their distance."""
    symmetrise: Annotated[bool, Field(strict=True)] = True
    """Take symmetric parts where added mass or damping are further from symmetric than 5 % of the largest, and the
    nearest passive damping where it drives by more than 2 %; ``false``: refuse both."""
    tolerance: Annotated[float, Quantity("number", minimum=0.0, maximum=LARGEST_TOLERANCE)] = TOLERANCE
    """Of the largest: up to this matrices are repaired, and a limit of the added mass that is not that of the damping;
    beyond it they are refused."""
    memory: Memory = "exponentials"
    """Of radiated waves. ``exponentials``: recursive and fast; ``direct``: convolution, for fixed steps; ``none``."""
    memory_length: Annotated[float, Positive("time")] | None = None
    """Length of the memory [s]; until the kernel has decayed if absent."""
    fit_error: Annotated[float, Quantity("number", minimum=0.0, maximum=0.5)] = 1e-3
    """Of the kernel relative to its largest value in each coordinate, that the exponentials may have; coordinates that
    hardly radiate count as if they had a thousandth of the critical damping."""
    drift: Annotated[bool, Field(strict=True)] = False
    """Whether mean drift forces of the database act, slowly varying by Newman's approximation."""
    format: FileFormat | None = None
    """Of the file; by its ending if absent."""
    length_scale: Annotated[float, Positive("length")] | None = None
    """ULEN of a WAMIT file [m]; 1 m if absent."""
    first_column: FirstColumn | None = None
    """Of WAMIT's numeric files; periods if absent."""
    forces: ExcitingForces | None = None
    """Which of the two sets of exciting forces of a WAMIT listing."""
    time_convention: TimeConvention | None = None
    """Of a netCDF file that does not state it."""
    symmetric: Annotated[bool, Field(strict=True)] | None = None
    """Headings of half a turn represent their mirror images too, in a file that does not state it."""
    reference_points: tuple[LengthVector, ...] | None = None
    """Of the hulls in the axes of the database [m], for a file that does not state them."""

    @property
    def file_format(self) -> str:
        """Format of its file."""
        return self.format or DATABASE_FORMATS.get(PurePath(self.file or "").suffix.lower(), "")

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Frequencies that are computed [rad/s], increasing."""
        assert self.compute is not None
        steps = self.compute.frequencies
        low, high = self.frequency_range or (steps.first, steps.last)
        step = (steps.last - steps.first) / (steps.count - 1)
        out = {round((omega - steps.first) / step) for omega in self.leave_out}
        every = enumerate(linspace(steps.first, steps.last, steps.count).tolist())
        return tuple(w for i, w in every if i not in out and low - 1e-9 * step <= w <= high + 1e-9 * step)

    @property
    def repair(self) -> Repair:
        """What may be repaired; of a computed one no frequencies are left out, which are not computed."""
        asked = Repair(symmetrise=self.symmetrise, tolerance=self.tolerance)
        if self.compute is not None:
            return asked
        return replace(asked, frequency_range=self.frequency_range, leave_out=self.leave_out)

    @model_validator(mode="after")
    def _has_one_source(self) -> Self:
        if (self.file is None) == (self.compute is None):
            problem = "neither 'file' nor 'compute'" if self.file is None else "both 'file' and 'compute'"
            reject(problem, "one of them")
        if self.file is not None and not self.file_format:
            endings = ", ".join(DATABASE_FORMATS)
            reject(
                f"{self.file!r} has an unknown ending",
                f"one of {endings}; or 'format'{converter_words(self.file)}",
                key="file",
            )
        if self.format is not None and self.file is None:
            reject("'format' with 'compute'", "'file', or no 'format'", key="format")
        if self.frequency_range is not None and self.frequency_range[1] <= self.frequency_range[0]:
            low, high = self.frequency_range
            reject(f"{low:g} to {high:g} rad/s", "the lower frequency first", key="frequency_range")
        if "tolerance" in self.model_fields_set and not self.symmetrise:
            reject("'tolerance' with symmetrise = false", "one of them: nothing is repaired", key="tolerance")
        if self.compute is not None:
            self._check_computed()
        for key, formats in _READER_KEYS.items():
            if getattr(self, key) is not None and self.file_format not in formats:
                what = f"format {self.file_format!r}" if self.file is not None else "'compute'"
                reject(f"{key!r} with {what}", f"format {' or '.join(map(repr, formats))}", key=key)
        if len(set(self.hulls)) != len(self.hulls):
            reject(f"{list(self.hulls)}", "every hull once", key="hulls")
        if self.reference_points is not None and len(self.reference_points) != len(self.hulls):
            reject(
                f"{len(self.reference_points)} points for {len(self.hulls)} hulls",
                "one a hull",
                key="reference_points",
            )
        return self

    def _check_computed(self) -> None:
        """Frequencies are left, and those that are left out are there."""
        assert self.compute is not None
        steps = self.compute.frequencies
        every = linspace(steps.first, steps.last, steps.count)
        for omega in self.leave_out:
            try:
                refuse_between(omega, every)
            except InputError as error:
                reject(error.problem, error.expected, key="leave_out")
        if len(self.frequencies) < FEWEST:
            key = "leave_out" if self.leave_out else "frequency_range"
            reject(f"{len(self.frequencies)} frequencies are left", f"{FEWEST} or more", key=key)
