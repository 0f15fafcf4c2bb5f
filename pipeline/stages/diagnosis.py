"""What a simulation says of itself before it starts: integrator, degrees of freedom, redundant joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["diagnosis", "diagnosis_lines", "steps_taken"]

_SHOWN = 5  # sentences of a kind at most


def diagnosis(simulation: Any) -> dict[str, Any]:
    """Plain values for the manifest.

    Parameters
    ----------
    simulation
        A `heavylift.solver.simulation.Simulation`; its attributes ``integrator``, ``choice`` and ``diagnosis``
        are used as far as it has them.

    Returns
    -------
    dict
        ``integrator``, ``choice`` (why, if it was chosen), ``start`` (what was done to it), and of a scene
        with joints ``degrees_of_freedom``, ``redundant`` and ``free_motions`` (sentences that name joints).
    """
    found: dict[str, Any] = {
        "integrator": str(getattr(simulation, "integrator", "")),
        "choice": str(getattr(simulation, "choice", "") or ""),
        "start": str(getattr(simulation, "start_text", "") or ""),
    }
    about = getattr(simulation, "diagnosis", None)
    if about is not None:
        found |= {
            "degrees_of_freedom": int(about.degrees_of_freedom),
            "redundant": [str(text) for text in about.redundant],
            "free_motions": [str(text) for text in about.free_motions],
        }
    return found


def diagnosis_lines(found: Mapping[str, Any]) -> list[str]:
    """Lines for a person; none for a scene without joints whose integrator is the one asked for."""
    lines = [found[key] for key in ("choice", "start") if found.get(key)]
    if "degrees_of_freedom" in found:
        count = found["degrees_of_freedom"]
        words = [f"{count} degree{'' if count == 1 else 's'} of freedom"]
        if found["redundant"]:
            words.append(f"redundant: {_listed(found['redundant'])}")
        if found["free_motions"]:
            words.append(f"free: {_listed(found['free_motions'])}")
        lines.append("; ".join(words))
    return lines


def _listed(sentences: Sequence[str]) -> str:
    more = f" and {len(sentences) - _SHOWN} more" if len(sentences) > _SHOWN else ""
    return ", ".join(text.rstrip(".") for text in sentences[:_SHOWN]) + more


def steps_taken(simulation: Any) -> int:
    """Steps the integrator made; with a tolerance more or fewer than it recorded states."""
    return int(getattr(simulation, "solver_steps", simulation.step_index))
