"""What the stages of a run share, and how each of them ends."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from heavylift.numerics.outcome import Outcome
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["StageReport", "Work"]


@dataclass(frozen=True)
class StageReport:
    """How one stage ended.

    Attributes
    ----------
    stage
        One of `heavylift.pipeline.stages.stages.STAGES`.
    outcome, message
        How it ended, and why if it did not complete.
    skipped
        Whether everything was there already.
    cpu_s
        CPU time that making the outputs took, now or before [s].
    details
        Numbers that the stage reports, as in its manifest.
    """

    stage: str
    outcome: Outcome
    skipped: bool
    cpu_s: float
    message: str = ""
    details: dict[str, Any] = field(default_factory=dict)


@dataclass
class Work:
    """What the stages of one run share.

    Attributes
    ----------
    case, folder, log
        The case, where its outputs go, and its log.
    force
        Stages that are made again even if they are current.
    reuse
        Other output folders whose meshes and modes are taken if their inputs are the same.
    models
        Finite-element models that are in memory already.
    """

    case: Case
    folder: OutputFolder
    log: Log
    force: frozenset[str] = frozenset()
    reuse: tuple[OutputFolder, ...] = ()
    models: dict[str, Any] = field(default_factory=dict)

    @property
    def flexible(self) -> dict[str, FlexibleBodySection]:
        """The bodies that have meshes and modes."""
        return {name: body for name, body in self.case.bodies.items() if body.BODY.MODAL}
