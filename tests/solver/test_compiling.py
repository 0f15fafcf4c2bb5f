"""Which process compiles which unit."""

from __future__ import annotations

from heavylift.numerics.objects import Unit
from heavylift.solver.compiling import WaitingUnits


def unit(kind: str, group: str, entries: int) -> Unit:
    return Unit(f"{kind}.{group}", dict.fromkeys(map(str, range(entries))), (), ("module", kind, group))  # type: ignore[arg-type]


def test_units_of_a_kind_are_compiled_by_one_process_until_another_is_idle():
    waiting = WaitingUnits(
        unit(kind, group, entries)
        for kind, group, entries in (
            ("Frames", "record", 2),
            ("Frames", "step", 9),
            ("Frames", "static", 3),
            ("Hulls", "step", 7),
            ("Hulls", "record", 1),
            ("Ropes", "step", 4),
        )
    )
    taken = [(process, waiting.take(process)) for process in (0, 1, 0, 1, 1, 1, 0, 1)]
    assert [(process, one.name if one else None) for process, one in taken] == [
        (0, "Frames.step"),  # the largest
        (1, "Hulls.step"),  # that of another kind
        (0, "Frames.static"),  # as it knows the kind
        (1, "Hulls.record"),
        (1, "Ropes.step"),  # that nobody has begun
        (1, "Frames.record"),  # before it is idle
        (0, None),
        (1, None),
    ]
