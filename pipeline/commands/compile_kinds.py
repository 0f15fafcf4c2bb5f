"""Compile kernels ahead of the first run."""

from __future__ import annotations

import difflib
import time
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from heavylift.pipeline.log import Log

__all__ = ["compile_kinds"]


def compile_kinds(kinds: tuple[str, ...], log: Log, *, force: bool = False) -> int:
    """Make the object files of some kinds, or of all, on all cores; returns the exit code.

    Parameters
    ----------
    kinds
        Names of kinds and loops; all of them if empty.
    force
        Compile what is compiled already as well.

    Raises
    ------
    InputError
        If there is no such kind.
    """
    from heavylift.solver.compiling import all_units, compile_units, missing_units

    known = all_units()
    for name in kinds:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
            raise InputError(
                f"{name!r}{f', perhaps {near[0]!r}' if near else ''}",
                source="compile",
                key="kind",
                expected="one of " + ", ".join(known),
            )
    wanted = [unit for name in kinds or known for unit in known[name]]
    units = wanted if force else missing_units(wanted)
    if not units:
        log.say(f"compile: all {len(wanted)} parts are compiled")
        return 0
    log.say(f"compile: {len(units)} of {len(wanted)} parts")
    begin, spent = time.perf_counter(), dict[str, float]()
    with log.progress("compile", len(units)) as progress:

        def tell(name: str, seconds: float) -> None:
            spent[name] = seconds
            progress(len(spent), name)

        compile_units(units, tell)
    longest = sorted(spent, key=lambda name: spent[name], reverse=True)[:5]
    log.say(
        f"compile: done in {time.perf_counter() - begin:.0f} s, {sum(spent.values()):.0f} s of CPU; longest: "
        + ", ".join(f"{name} {spent[name]:.1f} s" for name in longest)
    )
    return 0
