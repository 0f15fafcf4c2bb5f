"""Unrequested ends of commands, with a line for each; nothing that takes time is imported here."""

from __future__ import annotations

__all__ = ["Terminated", "interruption", "out_of_memory"]


class Terminated(KeyboardInterrupt):
    """SIGTERM, outside the time loop."""


def interruption(error: KeyboardInterrupt) -> str:
    """A line about Ctrl-C or SIGTERM outside the time loop."""
    name = "SIGTERM: stopped" if isinstance(error, Terminated) else "interrupted"
    return f"{name}; results so far are kept"


def out_of_memory(error: MemoryError) -> str:
    """A line about memory that the machine does not have."""
    return f"not enough memory{f': {error}' if str(error) else ''}"
