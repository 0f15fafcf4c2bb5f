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

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.records import Record, Records, Vector

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
    "Marks",
    "Problem",
    "ProblemSize",
    "RowKind",
    "RowParameters",
    "Solution",
    "Work",
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


class ProblemSize(Record):
    """Contacts, and touched velocities or rows.

    Attributes
    ----------
    number, size
        How many there are.
    least_rate
        The rate by which residuals are measured at least [m/s].
    free_rate
        Largest rate that a whole step without impulses gives to what touches [m/s].
    first, last, low, high
        Contacts from one on up to another one that are solved at present, and places of their velocities: an island, on
        which no other contact acts.
    """

    number: int
    size: int
    least_rate: float
    free_rate: float
    first: int
    last: int
    low: int
    high: int


class Marks(Record):
    """Marks of a problem.

    Attributes
    ----------
    unit_mass
        Whether masses are in the rows.
    near_diagonal
        Whether the factors are those without exchange of rows.
    in_order
        Whether islands can be solved one by one.
    scale, free
        Largest rate without impulses or by what the step has given before [m/s], and largest rate without impulses.
    """

    unit_mass: bool
    near_diagonal: bool
    in_order: bool
    scale: float
    free: float


class Work(Arrays):
    """What the solver works on; of each array the first part, for as many contacts and velocities as there are.

    Attributes
    ----------
    diagonal
        W of the normal, mean of the tangents; 2 a contact.
    inverse
        r of the laws; 2 a contact.
    rows, records
        Softness and target of the rows, and linearised laws; see `contact_rows`.
    held
        D of the contacts that is in K, and scratch behind it.
    w, w0, dw, best, kept, begin, rough
        Rates, rates without impulses, and impulses; 3 a contact. The last ones are those with the smallest residual of
        attempts without a solution.
    z, y, x, pivots, active
        Of velocities.
    K, A
        Square matrices of velocities, row by row.
    N
        Rows in twelve columns, see `end_blocks`.
    place, reach
        Places of velocities in z, y, x, K and A, and how far entries reach from the diagonal.
    y0
        Velocities without impulses, in their places, of a unit mass if that is in N.
    pair, sums
        Velocities of the ends of a contact, and what acts on them: zeros between calls.
    marks
        What is known of the problem.
    """

    diagonal: Floats1
    inverse: Floats1
    rows: Floats1
    records: Floats1
    held: Floats1
    w: Floats1
    w0: Floats1
    dw: Floats1
    best: Floats1
    kept: Floats1
    begin: Floats1
    rough: Floats1
    z: Floats1
    y: Floats1
    x: Floats1
    pivots: Floats1
    active: Floats1
    K: Floats1
    A: Floats1
    N: Floats1
    place: Floats1
    reach: Floats1
    y0: Floats1
    pair: Floats1
    sums: Floats1
    marks: Marks


class Problem(Arrays):
    """Contacts on bodies: ``w = N y``, ``y = start + B N^T p``. Of larger arrays the first part is meant.

    Attributes
    ----------
    counts
        How many contacts there are on how many velocities, and which rates matter; one who asks for a solution
        writes it.
    kinds, parameters
        Laws, see above.
    ends
        Per contact first velocity and number of velocities, up to 6, of its first and of its second end, shape
        (contacts, 4); number 0: no such end. Of length 0: N is the identity, and velocities are the rates of the rows.
    blocks
        Rows of N per contact, shape (contacts, 36): three rows of stride 6 of the first end, then of the second.
    start, B
        Velocities without impulses, (size,), and their symmetric positive semidefinite inverse mass, (size, size).
    head, past
        Per velocity the first one that a row of B couples it with, and that behind the last one; entries outside are
        not read. Of length 0: B is full.
    p
        In: impulses to begin with, those of the step before or zeros. Out: the solution, 3 a contact.
    y
        Out: velocities, (size,).
    work, solution
        What the solver works on, and how it ended.
    """

    counts: ProblemSize
    kinds: Records[RowKind]
    parameters: Records[RowParameters]
    ends: Ints2
    blocks: Floats2
    start: Floats1
    B: Floats2
    head: Ints1
    past: Ints1
    p: Floats1
    y: Floats1
    work: Work
    solution: Solution
