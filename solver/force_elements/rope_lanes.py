"""Straight parts of a rope side by side in vector registers: a fall of 24 parts has 23 pulleys, all with one formula.

A *group* is `LANES` parts, from each of `LANES` places to the one behind it. Its numbers lie in a room by quantity:
that of place or part k in lane k. What they solve is in `heavylift.solver.force_elements.rope_path`, in three steps:
`begin_parts` has the tangents of pulleys in one plane, `turn_parts` is a step of Newton's method, `end_parts` gives
lengths and derivatives. Turns are ``(1 - x^2) e + 2 x t`` over ``1 + x^2`` with x half of the angle: unit vectors
however long a step is, and its angle but for its cube. An eye is a pulley of radius 0 whose unit vector is zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from llvmlite import ir

from heavylift.numerics.jit import intrinsic, when_compiling
from heavylift.numerics.vector_code import FLAGS, INTEGER, VectorCode, vector_code

__all__ = [
    "ALONG",
    "ARRIVING",
    "AXIS",
    "BY_AXIS",
    "BY_NEXT_AXIS",
    "CENTRE",
    "LANES",
    "LEAVING",
    "LENGTH",
    "NEARLY_PARALLEL",
    "RADIUS",
    "ROW",
    "WRAP",
    "begin_parts",
    "begin_tilted_parts",
    "end_parts",
    "room",
    "turn_parts",
]

when_compiling("heavylift.numerics.arrays_code")

LANES = 8
"""Parts of a group."""

ROW = 2 * LANES
"""Numbers from one quantity to the next: places are one more than parts."""

CENTRE, AXIS, RADIUS = 0, 3 * ROW, 6 * ROW
"""Of the places, where vectors have three rows."""

LEAVING, ARRIVING = 7 * ROW, 10 * ROW
"""Of the places, unit vectors to the tangent points where the rope leaves, and arrives; zero at eyes."""

WRAP = 13 * ROW
"""Of the places: angle between the two, nearest to that which is there before [rad]."""

ALONG, BY_AXIS, BY_NEXT_AXIS, LENGTH = 14 * ROW, 17 * ROW, 20 * ROW, 23 * ROW
"""Derivatives of the length by the place behind, minus those by the place; by both axes, with those of the arcs; the
length."""

IN_ONE_PLANE = 24 * ROW
"""1 of parts between pulleys that are nearly in one plane, and of those to eyes; else 0."""

SIZE = 25 * ROW

NEARLY_PARALLEL = 0.9
"""Cosine between the axes of two pulleys above which their tangent is sought from that of parallel axes."""

SMALL = 0.66
ATAN_OVER = (
    -6.485021904942025371773e1,
    -1.228866684490136173410e2,
    -7.500855792314704667340e1,
    -1.615753718733365076637e1,
    -8.750608600031904122785e-1,
)
ATAN_UNDER = (
    1.945506571482613964425e2,
    4.853903996359136964868e2,
    4.328810604912902668951e2,
    1.650270098316988542046e2,
    2.485846490142306297962e1,
    1.0,
)
"""``atan x = x + x^3 P(x^2)/Q(x^2)`` up to `SMALL`, lowest power first: S. L. Moshier, "Methods and Programs for
Mathematical Functions", 1989 (Cephes)."""

REST_OF_QUARTER = 6.123233995736765886130e-17
"""Of pi/2, what a number has not."""

Vectors = list[Any]
"""Three vectors of lanes: the components along x, y and z."""


class _Group:
    """The quantities of a group, as vectors of lanes, and the formulas of vectors in space."""

    def __init__(self, code: VectorCode, numbers: Any) -> None:
        self.code, self.numbers = code, numbers
        self.zero, self.one = code.constant(0.0), code.constant(1.0)
        self.n1, self.n2 = self.vectors(AXIS), self.vectors(AXIS + 1)
        self.r1, self.r2 = self.value(RADIUS), self.value(RADIUS + 1)
        self.c1, self.c2 = self.vectors(CENTRE), self.vectors(CENTRE + 1)
        self.wraps_1, self.wraps_2 = self.is_greater(self.r1, self.zero), self.is_greater(self.r2, self.zero)

    def value(self, place: int) -> Any:
        return self.code.load(self.numbers, place)

    def vectors(self, place: int) -> Vectors:
        return [self.value(place + k * ROW) for k in range(3)]

    def put(self, place: int, value: Any) -> None:
        self.code.store(value, self.numbers, place)

    def put_vectors(self, place: int, values: Vectors) -> None:
        for k, value in enumerate(values):
            self.put(place + k * ROW, value)

    def is_greater(self, a: Any, b: Any) -> Any:
        return self.code.builder.fcmp_ordered(">", a, b)

    def both(self, *conditions: Any) -> Any:
        found = conditions[0]
        for condition in conditions[1:]:
            found = self.code.builder.and_(found, condition)
        return found

    def where(self, condition: Any, a: Any, b: Any) -> Any:
        return self.code.builder.select(condition, a, b)

    def vectors_where(self, condition: Any, a: Vectors, b: Vectors) -> Vectors:
        return [self.where(condition, x, y) for x, y in zip(a, b, strict=True)]

    def divide(self, a: Any, b: Any) -> Any:
        return self.code.builder.fdiv(a, b, flags=FLAGS)

    def lane_by_lane(self, name: str, a: Any) -> Any:
        """An instruction of LLVM with one argument."""
        from numba.core import cgutils

        kind = ir.FunctionType(self.code.vector, [self.code.vector])
        function = cgutils.get_or_insert_function(
            self.code.builder.module, kind, f"llvm.{name}.v{self.code.lanes}f64"
        )
        return self.code.builder.call(function, [a])

    def root(self, a: Any) -> Any:
        return self.lane_by_lane("sqrt", a)

    def polynomial(self, x: Any, numbers: tuple[float, ...]) -> Any:
        total = self.code.constant(numbers[-1])
        for number in reversed(numbers[:-1]):
            total = self.code.multiply_add(self.code.constant(number), total, x)
        return total

    def angle(self, s: Any, c: Any) -> Any:
        """Whose sine and cosine are in the ratio s to c [rad], in [-pi, pi]."""
        code, zero, one = self.code, self.zero, self.one
        up, along = self.lane_by_lane("fabs", s), self.lane_by_lane("fabs", c)
        steep = self.is_greater(up, along)
        tangent = self.divide(self.where(steep, along, up), self.where(steep, up, along))
        far = self.is_greater(tangent, code.constant(SMALL))
        near = self.divide(code.subtract(tangent, one), code.add(tangent, one))
        x = self.where(far, near, tangent)
        square = code.multiply(x, x)
        ratio = self.divide(self.polynomial(square, ATAN_OVER), self.polynomial(square, ATAN_UNDER))
        angle = code.multiply_add(x, code.multiply(x, square), ratio)
        eighth = code.add(angle, code.constant(0.5 * REST_OF_QUARTER))
        angle = self.where(far, code.add(eighth, code.constant(0.25 * math.pi)), angle)
        beyond = code.add(code.subtract(code.constant(0.5 * math.pi), angle), code.constant(REST_OF_QUARTER))
        angle = self.where(steep, beyond, angle)
        behind = code.add(code.subtract(code.constant(math.pi), angle), code.constant(2.0 * REST_OF_QUARTER))
        angle = self.where(self.is_greater(zero, c), behind, angle)
        return self.where(self.is_greater(zero, s), self.minus(angle), angle)

    def nearest(self, angle: Any, before: Any) -> Any:
        """The angle plus the whole turns that bring it nearest to one before."""
        code, turn = self.code, 2.0 * math.pi
        turns = code.multiply(code.subtract(before, angle), code.constant(1.0 / turn))
        turns = self.lane_by_lane("floor", code.add(turns, code.constant(0.5)))
        return code.multiply_add(angle, turns, code.constant(turn))

    def minus(self, a: Any) -> Any:
        return self.code.subtract(self.zero, a)

    def dot(self, a: Vectors, b: Vectors) -> Any:
        return self.code.sum(*zip(a, b, strict=True))

    def cross(self, a: Vectors, b: Vectors) -> Vectors:
        code = self.code
        return [
            code.multiply_subtract(code.multiply(a[i], b[j]), a[j], b[i]) for i, j in ((1, 2), (2, 0), (0, 1))
        ]

    def times(self, s: Any, a: Vectors) -> Vectors:
        return [self.code.multiply(s, x) for x in a]

    def plus(self, a: Vectors, s: Any, b: Vectors) -> Vectors:
        """``a + s b``."""
        return [self.code.multiply_add(x, s, y) for x, y in zip(a, b, strict=True)]

    def less(self, a: Vectors, s: Any, b: Vectors) -> Vectors:
        """``a - s b``."""
        return [self.code.multiply_subtract(x, s, y) for x, y in zip(a, b, strict=True)]

    def between(self, e1: Vectors, e2: Vectors) -> Vectors:
        """D, from tangent to tangent."""
        centres = [self.code.subtract(b, a) for a, b in zip(self.c1, self.c2, strict=True)]
        return self.less(self.plus(centres, self.r2, e2), self.r1, e1)

    def tangent(self, n: Vectors, d: Vectors, c: Any, sense: float) -> Vectors:
        """``C u - S v``: u along d, square to the axis, ``v = n x u``, C = c over |d|, S is its sine."""
        code = self.code
        inverse = self.divide(self.one, self.root(self.dot(d, d)))
        u = self.times(inverse, d)
        c = code.multiply(c, inverse)
        s = self.root(code.multiply_subtract(self.one, c, c))
        along, aside = self.times(c, u), self.cross(n, u)
        return self.less(along, s, aside) if sense > 0.0 else self.plus(along, s, aside)

    def square_to(self, n: Vectors, d: Vectors) -> Vectors:
        return self.less(d, self.dot(d, n), n)

    def equations(
        self, e1: Vectors, e2: Vectors
    ) -> tuple[Vectors, Vectors, Vectors, tuple[Any, Any, Any, Any]]:
        """D, both tangents, and the derivatives of ``D . e1`` and ``D . e2`` by the angles of e1 and e2."""
        code = self.code
        D, t1, t2 = self.between(e1, e2), self.cross(self.n1, e1), self.cross(self.n2, e2)
        a11 = self.where(self.wraps_1, self.dot(D, t1), self.one)
        a22 = self.where(self.wraps_2, self.dot(D, t2), self.one)
        a12 = code.multiply(self.r2, self.dot(t2, e1))
        a21 = self.minus(code.multiply(self.r1, self.dot(t1, e2)))
        return D, t1, t2, (a11, a12, a21, a22)

    def over_determinant(self, a: tuple[Any, Any, Any, Any]) -> Any:
        determinant = self.code.multiply_subtract(self.code.multiply(a[0], a[3]), a[1], a[2])
        return self.divide(self.one, determinant)

    def turned(self, e: Vectors, t: Vectors, angle: Any) -> Vectors:
        code = self.code
        x = code.multiply(code.constant(0.5), angle)
        inverse = self.divide(self.one, code.multiply_add(self.one, x, x))
        c = code.multiply(code.multiply_subtract(self.one, x, x), inverse)
        s = code.multiply(angle, inverse)
        return self.plus(self.times(c, e), s, t)


def _on_group(numbers: Any, write: Callable[[_Group], Any], *, tells: bool = False) -> Any:
    """Signature and generator of an intrinsic on the numbers of a group, which tells a number or nothing."""

    def with_group(code: VectorCode, place: Any) -> list[Any] | None:
        found = write(_Group(code, place))
        return [found] if tells else None

    return vector_code((numbers,), (0,), with_group, lanes=LANES, returns=1 if tells else 0)


@intrinsic
def room(typingctx):  # type: ignore[no-untyped-def]
    """Array for the numbers of one group, on the stack of the function that asks for it."""
    from numba.core import types

    from heavylift.numerics.arrays_code import rebuild_array

    floats = types.Array(types.float64, 1, "C")

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        place = VectorCode(context, builder, LANES).memory(SIZE // LANES)
        words = [builder.ptrtoint(place, INTEGER), ir.Constant(INTEGER, SIZE)]
        return rebuild_array(context, builder, floats, words)

    return floats(), generate


@intrinsic
def begin_parts(typingctx, numbers):  # type: ignore[no-untyped-def]
    """Unit vectors to both ends of each part, of pulleys whose axes are parallel; tells how many are far from that.

    Notes
    -----
    With parallel axes both are the same or, of pulleys that turn against each other, opposite: the rope leaves the
    line of centres by the angle of the cosine ``(r1 - sense r2)/d``. With an eye it is the tangent to its point.
    """

    def write(group: _Group) -> Any:
        code, r1, r2 = group.code, group.r1, group.r2
        pulleys = group.both(group.wraps_1, group.wraps_2)
        cosine = group.dot(group.n1, group.n2)
        alike = group.is_greater(cosine, group.zero)
        sense = group.where(pulleys, group.where(alike, group.one, code.constant(-1.0)), group.one)
        n = group.vectors_where(group.wraps_1, group.n1, group.n2)
        d = group.square_to(n, [code.subtract(b, a) for a, b in zip(group.c1, group.c2, strict=True)])
        gap = code.multiply_subtract(r1, sense, r2)
        e = group.tangent(n, d, gap, 1.0)
        other = group.square_to(group.n2, e)
        size = group.divide(sense, group.root(group.dot(other, other)))
        nothing = [group.zero] * 3
        group.put_vectors(LEAVING, group.vectors_where(group.wraps_1, e, nothing))
        group.put_vectors(ARRIVING + 1, group.vectors_where(group.wraps_2, group.times(size, other), nothing))
        square = group.dot(d, d)
        squares = code.sum((r1, r1), (r2, r2))
        nearly = code.constant(NEARLY_PARALLEL**2)
        in_plane = group.both(
            group.is_greater(code.multiply(cosine, cosine), nearly),
            group.is_greater(square, squares),
            group.is_greater(square, code.multiply(gap, gap)),
        )
        fits = group.where(pulleys, group.where(in_plane, group.one, group.zero), group.one)
        group.put(IN_ONE_PLANE, fits)
        return code.total(code.subtract(group.one, fits))

    return _on_group(numbers, write, tells=True)


@intrinsic
def begin_tilted_parts(typingctx, numbers):  # type: ignore[no-untyped-def]
    """The same of pulleys that are not in one plane: to the centre of the other one, then back to the tangent point."""

    def write(group: _Group) -> None:
        code = group.code
        keeps = group.is_greater(group.value(IN_ONE_PLANE), group.zero)
        d = [code.subtract(b, a) for a, b in zip(group.c1, group.c2, strict=True)]
        e1 = group.tangent(group.n1, group.square_to(group.n1, d), group.r1, 1.0)
        back = [group.minus(x) for x in group.less(d, group.r1, e1)]
        e2 = group.tangent(group.n2, group.square_to(group.n2, back), group.r2, -1.0)
        group.put_vectors(LEAVING, group.vectors_where(keeps, group.vectors(LEAVING), e1))
        group.put_vectors(ARRIVING + 1, group.vectors_where(keeps, group.vectors(ARRIVING + 1), e2))

    return _on_group(numbers, write)


@intrinsic
def turn_parts(typingctx, numbers):  # type: ignore[no-untyped-def]
    """Newton's method for ``D . e1 = D . e2 = 0``: turn the unit vectors; tells the sum of the squared angles."""

    def write(group: _Group) -> Any:
        code = group.code
        e1, e2 = group.vectors(LEAVING), group.vectors(ARRIVING + 1)
        D, t1, t2, a = group.equations(e1, e2)
        a11, a12, a21, a22 = a
        f1, f2 = group.dot(D, e1), group.dot(D, e2)
        inverse = group.over_determinant(a)
        by_1 = code.multiply(code.multiply_subtract(code.multiply(a12, f2), a22, f1), inverse)
        by_2 = code.multiply(code.multiply_subtract(code.multiply(a21, f1), a11, f2), inverse)
        group.put_vectors(LEAVING, group.turned(e1, t1, by_1))
        group.put_vectors(ARRIVING + 1, group.turned(e2, t2, by_2))
        return code.total(code.sum((by_1, by_1), (by_2, by_2)))

    return _on_group(numbers, write, tells=True)


@intrinsic
def end_parts(typingctx, numbers):  # type: ignore[no-untyped-def]
    """Lengths of the parts, and their derivatives with those of the arcs at their ends; wraps where they begin.

    Notes
    -----
    The tangents move by angles that follow from ``D . e = 0``. Out of the plane they count: the length of the
    part then changes by less than that of the arc. Their part is eliminated with the transposed equations.
    """

    def write(group: _Group) -> None:
        code, r1, r2, n1, n2 = group.code, group.r1, group.r2, group.n1, group.n2
        e1, e2 = group.vectors(LEAVING), group.vectors(ARRIVING + 1)
        D, t1, t2, a = group.equations(e1, e2)
        a11, a12, a21, a22 = a
        square = group.dot(D, D)
        length = group.root(square)
        m = group.times(group.divide(group.one, length), D)
        w1 = code.multiply_subtract(r1, r1, group.dot(m, t1))
        w2 = code.multiply_subtract(code.multiply(r2, group.dot(m, t2)), r2, group.one)
        inverse = group.over_determinant(a)
        y1 = code.multiply(code.multiply_subtract(code.multiply(w1, a22), a21, w2), inverse)
        y2 = code.multiply(code.multiply_subtract(code.multiply(a11, w2), a12, w1), inverse)
        group.put_vectors(ALONG, group.less(group.less(m, y1, e1), y2, e2))
        own = code.sum((r1, group.dot(m, n1)), (y1, group.dot(D, n1)))
        own = code.multiply_subtract(own, code.multiply(y2, r1), group.dot(n1, e2))
        group.put_vectors(BY_AXIS, group.times(own, e1))
        other = code.sum((y2, group.dot(D, n2)), (code.multiply(y1, r2), group.dot(n2, e1)))
        other = code.multiply_subtract(other, r2, group.dot(m, n2))
        group.put_vectors(BY_NEXT_AXIS, group.times(other, e2))
        group.put(LENGTH, length)
        arrival = group.vectors(ARRIVING)
        turn = group.angle(group.dot(n1, group.cross(arrival, e1)), group.dot(arrival, e1))
        group.put(WRAP, group.nearest(turn, group.value(WRAP)))

    return _on_group(numbers, write)
