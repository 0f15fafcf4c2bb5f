"""Contacts as the solver sees them: kinds, parameters and rows.

Contact c has the rows 3c, 3c + 1, 3c + 2: w is the rate of the gap along the normal (opening is positive) and the two
rates of slip, p the impulses on these rows. S, b and o are parameters of the rows::

    0 <= p_n + o_n  _|_  w_n + S_n p_n - b_n >= 0
    p_t + o_t = Proj_{|.| <= mu (p_n + o_n)} ( o_t + (b_t - w_t) / S_t )

with the softness S, the target b and the offset o, an impulse that the contact has got already. For ``CURVE`` the
first two rows are equations (the normals of the curve) and the third one is friction along it.

Friction with elastic slip: a spring k_t [N/m] with a damper c_t [N s/m], stretched by s at the start of a step h, gives
half of the step's impulse ``p_t = -h/2 ( k_t (s + h/2 w_t) + c_t w_t )`` at the rate w_t in the middle, which is a
row with ``S_t = 1 / ( h/2 (h/2 k_t + c_t) )`` and ``b_t = -S_t h/2 k_t s``. Members of a patch share its stiffness and
damping. After the step s has grown by ``h w_t``, cut to ``2 mu p_n / (h k_t)`` where the contact has slipped.
"""

from __future__ import annotations

from heavylift.numerics.records import Record, Vector

__all__ = [
    "BILATERAL",
    "COMPLIANT",
    "CURVE",
    "HERTZ",
    "HUNT_CROSSLEY",
    "INACTIVE",
    "LINEAR",
    "NORMAL_GIVEN",
    "UNILATERAL",
    "RowKind",
    "RowParameters",
    "Solution",
]

INACTIVE, UNILATERAL, BILATERAL, CURVE, COMPLIANT, NORMAL_GIVEN = range(6)
"""Kinds of contact. Normal rows:

- INACTIVE: no impulse on any row,
- UNILATERAL: complementarity as above,
- BILATERAL: an equation, with friction bounded by ``mu |p_n + o_n|``,
- CURVE: two equations, with friction bounded by ``mu hypot(p_0 + o_0, p_1 + o_1)``,
- COMPLIANT: half of the step times the mean force from the depth at its start to that at its end, ``d_0 - h w_n``;
  softness and target of the normal row are not read,
- NORMAL_GIVEN: no further impulse; friction bounded by ``mu o_n``.
"""

LINEAR, HERTZ, HUNT_CROSSLEY = range(3)
"""Laws of ``COMPLIANT``."""


class RowKind(Record):
    """What laws a contact has: one of the kinds above, and the law of a compliant one."""

    kind: int
    law: int


class RowParameters(Record):
    """Parameters of the rows of a contact.

    Attributes
    ----------
    friction
        Coulomb's coefficient.
    softness, target, offset
        Of the three rows: S [m/(s Ns)], above zero, b [m/s] and o [N s].
    stiffness, exponent, damping
        Of the law of a compliant normal.
    depth, step
        Its depth at the start of the step [m], and the step [s].
    wanted
        Target of the normal row that the law asks for [m/s]; not read by the solver.
    """

    friction: float
    softness: Vector
    target: Vector
    offset: Vector
    stiffness: float
    exponent: float
    damping: float
    depth: float
    step: float
    wanted: float


class Solution(Record):
    """How a solution ended: see `solve_contacts`; its residual is relative to the rates."""

    status: int
    iterations: int
    residual: float
