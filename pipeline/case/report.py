"""Tables of a case file that say what its report shows."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Literal

from pydantic import Field

from heavylift.pipeline.case.fields import (
    Positive,
    Quantity,
    RecordedChannels,
    Section,
)
from heavylift.solver.scene.meshes import ShellSide

__all__ = ["AnimationSection", "ReportSection"]

Index = Annotated[int, Field(ge=1, strict=True)]
Time = Annotated[float, Quantity("time", minimum=0.0, closed=True)]


class AnimationSection(Section):
    """A moving picture of a run: its bodies, and what is attached to them."""

    enabled: bool = True
    """Whether it is made."""
    frames: Annotated[int, Field(ge=2, le=600, strict=True)] = 100
    """Pictures at most; fewer if there are fewer records."""
    duration: Annotated[float, Positive("time")] | None = None
    """How long it is shown [s]; as long as the run, but 4 s to 15 s, if absent."""
    format: Literal["auto", "gif", "mp4"] = "auto"
    """``auto``: MP4 where an encoder is installed, else GIF."""


class ReportSection(Section):
    """Pictures and plots of the report."""

    modes: tuple[Index, ...] = (1, 2, 3, 4, 5)
    """Mode shapes that are pictured; those that the body does not have are left out."""
    stress_modes: tuple[Index, ...] = (1,)
    """Modes whose von Mises stress is pictured."""
    stress_times: tuple[Time, ...] = ()
    """Times [s] whose stress is pictured; if empty that of largest elastic energy, of frames and shells the end of the
    run and the time of largest recorded stress."""
    shell_side: ShellSide = "largest"
    """Side of shells whose von Mises stress is pictured; the largest of the three by default."""
    animation: AnimationSection | None = None
    """Moving picture; none if absent."""
    collision_times: tuple[Time, ...] = ()
    """Times [s] at which colliding surfaces are pictured; if empty each collision at its largest force or impulse."""
    deformation: Annotated[float, Positive("number")] = 0.1
    """Largest displacement drawn in pictures of mode shapes, relative to the size of the body."""
    channels: RecordedChannels = ()
    """Channels plotted over time, patterns as in ``"sling_*.tension"`` and combinations of channels; a choice is made
    if empty."""
    spectra: RecordedChannels = ()
    """Channels whose amplitude spectra are plotted, named likewise; the modal positions if empty."""
