"""What ropes do to the places of their paths: shared by ropes and by what watches them.

A rope with the tensions T_p of its parts pulls the body at its place p with ``-(T_(p-1) dL_(p-1) + T_p dL_p)``, dL_p
the derivative of the length of part p by that place. Ropes leave it at the end of every step and where a record is
written, if something watches them.
"""

from __future__ import annotations

from heavylift.numerics.records import Record
from heavylift.numerics.records import Vector as VectorField

__all__ = ["LineForce"]


class LineForce(Record):
    """What a rope does at a place.

    Attributes
    ----------
    force
        On what carries the place, world axes [N].
    tension
        Of the part that begins there [N]; 0 at the last place.
    """

    force: VectorField
    tension: float
