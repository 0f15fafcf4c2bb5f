"""How a run ended, as data, and the one error type for bad input."""

from __future__ import annotations

import re
from enum import IntEnum

__all__ = ["InputError", "InputErrors", "Outcome", "in_one_line", "visible"]


class Outcome(IntEnum):
    """How a simulation or a stage ended; stored with the results.

    The value is also the exit code of the command that ran it: 0 success, 1 a
    check failed, 2 bad input, larger values name a run that stopped by itself; the
    last two end a command of any kind.
    """

    COMPLETED = 0
    CHECK_FAILED = 1
    BAD_INPUT = 2
    NOT_FINITE = 3
    STEP_TOO_LARGE = 4
    INTERRUPTED = 5
    DISK_FULL = 6
    LOCKED = 7
    NOT_CONVERGED = 8
    NOT_CLOSED = 9
    STEP_TOO_SMALL = 10
    STRAINS_LOST = 11
    TOO_MANY_CONTACTS = 12
    LINE_OVERSTRETCHED = 13
    OUTSIDE_DATABASE = 14
    ENERGY_NOT_KEPT = 15
    LIMIT_REACHED = 16
    TIMED_OUT = 17
    PHASES_LEFT = 18
    OFF_ROAD = 19
    MODES_LEFT = 20
    FAULT = 70
    OUT_OF_MEMORY = 71

    @property
    def text(self) -> str:
        """Words for a person, e.g. ``"stopped: a value is not finite"``."""
        return _TEXTS[self]


_TEXTS = {
    Outcome.COMPLETED: "completed",
    Outcome.CHECK_FAILED: "a check failed",
    Outcome.BAD_INPUT: "bad input",
    Outcome.NOT_FINITE: "stopped: a value is not finite",
    Outcome.STEP_TOO_LARGE: "stopped: the step is too large",
    Outcome.INTERRUPTED: "interrupted",
    Outcome.DISK_FULL: "stopped: the disk is full",
    Outcome.LOCKED: "another run works in this folder",
    Outcome.NOT_CONVERGED: "stopped: an iteration did not converge",
    Outcome.NOT_CLOSED: "stopped: a joint or rope came apart",
    Outcome.STRAINS_LOST: "stopped: integrated strains have left those of the shape",
    Outcome.TOO_MANY_CONTACTS: "stopped: more contacts at once than there is room for",
    Outcome.LINE_OVERSTRETCHED: "stopped: a mooring line is stretched beyond its limit, or has no equilibrium",
    Outcome.OUTSIDE_DATABASE: "stopped: a hull has left what its hydrodynamic database covers",
    Outcome.ENERGY_NOT_KEPT: "energy balance not kept: steps created or lost as much energy as there is",
    Outcome.LIMIT_REACHED: "stopped: a limit of the scenario is reached",
    Outcome.TIMED_OUT: "stopped: a phase of the scenario takes too long",
    Outcome.PHASES_LEFT: "phases of the scenario are left",
    Outcome.OFF_ROAD: "stopped: a wheel has left the road",
    Outcome.MODES_LEFT: "stopped: a body has left the range of its modes",
    Outcome.FAULT: "stopped by an internal error",
    Outcome.OUT_OF_MEMORY: "stopped: there is not enough memory",
    Outcome.STEP_TOO_SMALL: "stopped: no step is small enough for the tolerance",
}


LONGEST = 400
"""Characters of a part of a message; of a longer one the middle is left out."""
LONGEST_LIST = 20_000
"""Of what was expected, which may be a list of all that there is."""


def in_one_line(text: str, longest: int = LONGEST) -> str:
    """A text without line breaks and other controls, and not longer than a person reads."""
    if len(text) > longest:
        text = f"{text[: longest // 2]} ... ({len(text):,} characters) ... {text[-longest // 4 :]}"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


# what a terminal obeys, or what hides or reorders letters: C0 and C1 but for tabs and line ends, marks of direction,
# letters without width, separators of lines, tags
_OBEYED = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb"
    "\U000e0000-\U000e007f]"
)


def visible(text: str) -> str:
    """A text for a terminal, with escapes in place of what the terminal would obey; lines and tabs stay.

    Names, notes and messages come from files, and files from anyone: such a text could clear the screen, show another
    result than there is, or type into the shell.
    """
    return _OBEYED.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


class InputError(ValueError):
    """Bad input: one message that names where, what was found and what was expected.

    What comes from a file, problem and key, is shown in one line, however long it is and whatever it contains.

    Parameters
    ----------
    problem
        What is wrong, with the value, e.g. ``"'steel' is not a number"``.
    source
        File (or object) in which it stands.
    key
        Key path, row or line within the source.
    expected
        What would have been right, and the remedy if there is one.
    """

    def __init__(self, problem: str, *, source: object = "", key: str = "", expected: str = "") -> None:
        self.problem = problem = in_one_line(problem)
        self.source = in_one_line(str(source))
        self.key = key = in_one_line(key)
        self.expected = expected = in_one_line(expected, LONGEST_LIST)
        place = ": ".join(part for part in (self.source, key) if part)
        message = f"{place}: {problem}" if place else problem
        super().__init__(f"{message}; expected {expected}" if expected else message)


class InputErrors(InputError):
    """Several errors found in one pass over an input, reported together."""

    def __init__(self, errors: list[InputError]) -> None:
        super().__init__("")
        self.errors = errors
        self.problem = "\n".join(str(error) for error in errors)
        self.args = (self.problem,)
