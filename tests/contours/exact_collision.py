"""Exact answers to "do they touch during the motion?" for corners with integer coordinates, moving linearly.

Everything follows from polynomials in time with integer coefficients: features touch where they lie in a plane, at
a root of one polynomial, and overlap there, by the signs of others. Signs at a root are exact: the root is isolated
by Sturm sequences, common factors are split off, the interval is halved until the other polynomial has no root in
it. Most pairs are decided before that, in floating point, by Bernstein coefficients on halved intervals whose signs
are certain because they exceed a hundred times any rounding error. Neither shares anything with the project.

Polynomials are arrays with the powers of time along the first axis; other axes are pairs.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import comb, gcd
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
Polynomial = list[int]

DEPTH = 12
SAFETY = 1e-13


# --- polynomials of many pairs at once, in integers (object arrays) or in floating point -----------------------


class Ring:
    """Sums and products; with ``magnitudes`` of the terms, so that differences become sums."""

    def __init__(self, magnitudes: bool = False) -> None:
        self.sign = 1 if magnitudes else -1

    def sum(self, p: Array, q: Array, sign: int = 1) -> Array:
        out = np.zeros((max(len(p), len(q)), *p.shape[1:]), dtype=p.dtype)
        out[: len(p)] += p
        out[: len(q)] += sign * q
        return out

    def difference(self, p: Array, q: Array) -> Array:
        return self.sum(p, q, self.sign)

    def product(self, p: Array, q: Array) -> Array:
        out = np.zeros((len(p) + len(q) - 1, *p.shape[1:]), dtype=p.dtype)
        for i in range(len(p)):
            for j in range(len(q)):
                out[i + j] += p[i] * q[j]
        return out

    def dot(self, p: list[Array], q: list[Array]) -> Array:
        x, y, z = (self.product(a, b) for a, b in zip(p, q, strict=True))
        return self.sum(self.sum(x, y), z)

    def cross(self, p: list[Array], q: list[Array]) -> list[Array]:
        return [
            self.difference(self.product(p[i], q[j]), self.product(p[j], q[i]))
            for i, j in ((1, 2), (2, 0), (0, 1))
        ]

    def vector(self, begin: Array, end: Array, linear: bool = True) -> list[Array]:
        """Components of a point that moves from begin to end, each of shape (n, 3)."""
        if not linear:
            return [np.array([begin[:, k]]) for k in range(3)]
        return [np.array([begin[:, k], end[:, k]]) for k in range(3)]

    def minus(self, p: list[Array], q: list[Array]) -> list[Array]:
        return [self.difference(a, b) for a, b in zip(p, q, strict=True)]

    def plus(self, p: list[Array], q: list[Array]) -> list[Array]:
        return [self.sum(a, b) for a, b in zip(p, q, strict=True)]


def displacements(points: Array) -> Array:
    """Coefficients of time: (n, k, 2, 3) positions at both times to start and displacement."""
    return np.stack((points[:, :, 0], points[:, :, 1] - points[:, :, 0]), axis=2)


def triangle_polynomials(motion: Array, ring: Ring) -> dict[str, Any]:
    """Origin against a moving triangle: motion (n, 3 corners, start and displacement, 3)."""
    a, b, c = (ring.vector(motion[:, k, 0], motion[:, k, 1]) for k in range(3))
    ab, bc, ca = ring.cross(a, b), ring.cross(b, c), ring.cross(c, a)
    normal = ring.plus(ring.plus(ab, bc), ca)
    return {
        "plane": ring.dot(a, bc),
        "inside": [ring.dot(normal, one) for one in (ab, bc, ca)],
        "normal": normal,
        "ends": [(a, b), (b, c), (c, a)],  # the origin on one of these segments
    }


def edge_polynomials(motion: Array, ring: Ring) -> dict[str, Any]:
    """Edge from the origin to a fixed point against a moving edge: motion (n, [fixed, p, q], ..., 3)."""
    d = ring.vector(motion[:, 0, 0], motion[:, 0, 1], linear=False)
    p, q = (ring.vector(motion[:, k, 0], motion[:, k, 1]) for k in (1, 2))
    e = ring.minus(q, p)
    normal = ring.cross(d, e)
    square = ring.dot(normal, normal)
    along_d = ring.dot(ring.cross(p, e), normal)
    along_e = ring.dot(ring.cross(p, d), normal)
    zero = [np.zeros_like(one[:1]) for one in p]
    return {
        "plane": ring.dot(normal, p),
        "inside": [along_d, ring.difference(square, along_d), along_e, ring.difference(square, along_e)],
        "normal": normal,
        "ends": [
            (p, ring.minus(p, d)),
            (q, ring.minus(q, d)),
            (p, q),
            (ring.minus(p, d), ring.minus(q, d)),
        ],
        "zero": zero,
    }


# --- one polynomial with integer coefficients, lowest power first ------------------------------------------------


def trimmed(p: Polynomial) -> Polynomial:
    """Without leading zeros and without the common divisor of the coefficients."""
    end = len(p)
    while end and p[end - 1] == 0:
        end -= 1
    content = gcd(*p[:end]) if end else 1
    return [c // content for c in p[:end]]


def remainder(p: Polynomial, q: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder, both up to a positive factor each (of the quotient: any)."""
    rest = list(p)
    lead = abs(q[-1])
    sign = 1 if q[-1] > 0 else -1
    quotient = [0] * max(1, len(p) - len(q) + 1)
    while len(rest) >= len(q):
        factor = sign * rest[-1]
        shift = len(rest) - len(q)
        quotient = [lead * c for c in quotient]
        quotient[shift] += factor
        rest = [lead * c for c in rest]
        for k, c in enumerate(q):
            rest[k + shift] -= factor * c
        assert rest[-1] == 0
        rest.pop()
        while rest and rest[-1] == 0:
            rest.pop()
    return trimmed(quotient), trimmed(rest)


def common_divisor(*polynomials: Polynomial) -> Polynomial:
    """Greatest common divisor; of zeros only: empty, the zero polynomial."""
    result: Polynomial = []
    for one in polynomials:
        p, q = result, trimmed(one)
        while q:
            p, q = q, (remainder(p, q)[1] if len(p) >= len(q) else trimmed(p))
        result = p
    return result


def derivative(p: Polynomial) -> Polynomial:
    return trimmed([k * c for k, c in enumerate(p)][1:])


def without(p: Polynomial, factor: Polynomial) -> Polynomial:
    """Quotient by a divisor."""
    return trimmed(p) if len(factor) <= 1 else remainder(trimmed(p), factor)[0]


def square_free(p: Polynomial) -> Polynomial:
    p = trimmed(p)
    return without(p, common_divisor(p, derivative(p))) if len(p) > 2 else p


def sign_at(p: Polynomial, t: Fraction) -> int:
    value = 0
    power = 1
    for c in reversed(p):
        value = value * t.numerator + c * power
        power *= t.denominator
    return (value > 0) - (value < 0)


def sturm_sequence(p: Polynomial) -> list[Polynomial]:
    sequence = [trimmed(p), derivative(p)]
    while sequence[-1]:
        rest = remainder(sequence[-2], sequence[-1])[1]
        sequence.append([-c for c in rest])
    return sequence[:-1]


def variations(sequence: list[Polynomial], t: Fraction) -> int:
    signs = [s for s in (sign_at(p, t) for p in sequence) if s]
    return sum(a != b for a, b in pairwise(signs))


def roots(p: Polynomial) -> list[tuple[Fraction, Fraction]]:
    """All roots in [0, 1] of a square-free polynomial: exact ones twice, others between signs."""
    if len(p) < 2:
        return []
    sequence = sturm_sequence(p)
    found = [(Fraction(0), Fraction(0))] if sign_at(p, Fraction(0)) == 0 else []
    work = [(Fraction(0), Fraction(1))]
    while work:
        low, high = work.pop()
        count = variations(sequence, low) - variations(sequence, high)  # in (low, high]
        if count == 1 and sign_at(p, high) == 0:
            found.append((high, high))
        elif count == 1 and sign_at(p, low) != 0:
            found.append((low, high))
        elif count:
            middle = (low + high) / 2
            work += [(low, middle), (middle, high)]
    return found


def sign_at_root(q: Polynomial, p: Polynomial, low: Fraction, high: Fraction) -> int:
    """Sign of q at the root of the square-free p in an interval of `roots`."""
    q = trimmed(q)
    if low == high or len(q) < 2:
        return sign_at(q, low)
    shared = common_divisor(p, q)
    if len(shared) > 1 and sign_at(shared, low) * sign_at(shared, high) < 0:
        return 0
    sequence = sturm_sequence(square_free(q))
    while sign_at(q, low) == 0 or variations(sequence, low) != variations(sequence, high):
        middle = (low + high) / 2
        at_middle = sign_at(p, middle)
        if at_middle == 0:
            return sign_at(q, middle)
        low, high = (middle, high) if at_middle == sign_at(p, low) else (low, middle)
    return sign_at(q, low)


def root_with(p: Polynomial, conditions: list[Polynomial]) -> bool:
    """Whether p (not zero) has a root in [0, 1] at which no condition is negative."""
    p = square_free(p)
    return any(all(sign_at_root(q, p, *root) >= 0 for q in conditions) for root in roots(p))


def point_on_segment(u: list[Array], v: list[Array], place: int, within: Polynomial) -> bool:
    """Whether a point lies between two others at some root of a polynomial (empty: at any time).

    ``u`` and ``v`` lead from the point to the ends.
    """
    ring = Ring()
    u = [np.array([c[place] for c in one], dtype=object) for one in u]
    v = [np.array([c[place] for c in one], dtype=object) for one in v]
    line = common_divisor(*(list(one) for one in ring.cross(u, v)), within)
    between = [-c for c in ring.dot(u, v)]
    if line:
        return root_with(line, [between])
    if sign_at(between, Fraction(0)) >= 0 or sign_at(between, Fraction(1)) >= 0:
        return True
    return bool(roots(square_free(between)))


def exact_contact(parts: dict[str, Any], place: int) -> bool:
    """Decide one pair from its polynomials, object arrays."""

    def one(p: Array) -> Polynomial:
        return [int(c[place]) for c in p]

    plane = trimmed(one(parts["plane"]))
    inside = [one(p) for p in parts["inside"]]
    normal = [one(p) for p in parts["normal"]]
    if not plane:
        # always in a plane: in contact at the start, or first where an end or corner meets an edge
        start = Fraction(0)
        regular = any(sign_at(p, start) for p in normal)
        if regular and all(sign_at(p, start) >= 0 for p in inside):
            return True
        return any(point_on_segment(u, v, place, []) for u, v in parts["ends"])
    flat = common_divisor(
        plane, *normal
    )  # times at which the triangle is a segment, or the edges are parallel
    if len(flat) > 1 and any(point_on_segment(u, v, place, flat) for u, v in parts["ends"]):
        return True
    plane = square_free(plane)
    return root_with(without(plane, common_divisor(plane, flat)), inside)


# --- many pairs -------------------------------------------------------------------------------------------------


def bernstein(p: Array, degree: int) -> Array:
    """Coefficients in the Bernstein basis of [0, 1]."""
    weights = np.array(
        [[comb(j, i) / comb(degree, i) if i <= j else 0.0 for i in range(len(p))] for j in range(degree + 1)]
    )
    return weights @ p


def halves(coefficients: Array) -> tuple[Array, Array]:
    """Bernstein coefficients, along the first axis, on both halves of the interval."""
    row = coefficients
    left = [row[0]]
    right = [row[-1]]
    while len(row) > 1:
        row = 0.5 * (row[:-1] + row[1:])
        left.append(row[0])
        right.append(row[-1])
    return np.array(left), np.array(right[::-1])


def decide(points: Array, polynomials: Any) -> tuple[Array, int]:
    """Contacts of many pairs, and how many of them needed exact arithmetic."""
    motion = displacements(points)
    value = polynomials(motion.astype(float), Ring())
    terms = polynomials(np.abs(motion).astype(float), Ring(magnitudes=True))
    plane = bernstein(value["plane"], 3)
    plane_error = SAFETY * terms["plane"].sum(axis=0)
    inside = np.stack([bernstein(p, 4) for p in value["inside"]], axis=1)  # (5, conditions, n)
    inside_error = np.stack([SAFETY * p.sum(axis=0) for p in terms["inside"]])
    count = len(points)
    contact = np.zeros(count, dtype=bool)
    pair = np.arange(count)
    for _ in range(DEPTH):
        error = plane_error[pair]
        errors = inside_error[:, pair]
        above = (plane > error).all(axis=0) | (plane < -error).all(axis=0)
        outside = (inside < -errors).all(axis=0).any(axis=0)
        through = ((plane[0] > error) & (plane[-1] < -error)) | ((plane[0] < -error) & (plane[-1] > error))
        contact[pair[through & (inside > errors).all(axis=(0, 1))]] = True
        keep = ~(above | outside | contact[pair])
        pair = np.repeat(pair[keep], 2)
        plane = np.stack(halves(plane[:, keep]), axis=-1).reshape(4, -1)
        inside = np.stack(halves(inside[:, :, keep]), axis=-1).reshape(5, inside.shape[1], -1)
    open_pairs = np.unique(pair[~contact[pair]])
    if len(open_pairs):
        exact = polynomials(motion[open_pairs].astype(object), Ring())
        for place, one in enumerate(open_pairs):
            contact[one] = exact_contact(exact, place)
    return contact, len(open_pairs)


def origin_meets_triangle(corners: Array) -> tuple[Array, int]:
    """Whether a triangle comes to the origin.

    Parameters
    ----------
    corners
        int64, shape (n, 3, 2, 3): corner, time, coordinate; magnitudes below 2^24.
    """
    return decide(corners, triangle_polynomials)


def edges_meet(ends: Array) -> tuple[Array, int]:
    """Whether a moving edge comes to the edge from the origin to a fixed point.

    Parameters
    ----------
    ends
        int64, shape (n, 3, 2, 3): fixed point (the same at both times), two ends of the moving edge.
    """
    return decide(ends, edge_polynomials)
