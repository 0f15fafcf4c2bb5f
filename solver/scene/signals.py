"""Numbers that a scenario looks at: combinations of channels."""

from __future__ import annotations

from typing import Literal

from heavylift.numerics.classes import dataclass

__all__ = ["Signal", "Term"]


@dataclass(frozen=True)
class Term:
    """A component of a channel, times a weight.

    Attributes
    ----------
    channel, component
        Such as ``"hook.position"`` and ``"z"``; no component of a channel with one, or for all of them.
    weight
        What it is multiplied by.
    """

    channel: str
    component: str = ""
    weight: float = 1.0


@dataclass(frozen=True)
class Signal:
    """A number that is looked at after each step.

    Attributes
    ----------
    terms
        Of which it is made.
    function
        Sum of the terms; the norm of a vector with these components; the largest or the smallest of them. `arrived`:
        time since the last actuator with a name of the terms came to rest at its commanded position; `told`, of
        no terms: 1 since the operator sent "continue" in a phase, else 0.
    text
        Its name in messages; made from the terms if empty.
    """

    terms: tuple[Term, ...]
    function: Literal["sum", "norm", "largest", "smallest", "arrived", "told"] = "sum"
    text: str = ""

    @property
    def name(self) -> str:
        """Words for it."""
        if self.function == "told":
            return "'continue' from the operator"
        names = [f"{term.channel}.{term.component}".rstrip(".") for term in self.terms]
        return self.text or (names[0] if len(names) == 1 else f"{self.function}({', '.join(names)})")
