"""Small dense blocks in vector registers: the arithmetic of symmetric block factors, for joints and for meshes.

A *panel* is a matrix whose rows are the coordinates of a body and whose columns, the *lanes*, are the
rows of a joint, stored row by row and padded to a power of two. A *block* has as many rows as a joint
and the same lanes. Each function becomes straight vector code for whatever the machine has
(`heavylift.numerics.vector_code`). All arrays are flat and contiguous; places are offsets.

A block shape is given as two tuples, whose *lengths* count: they are types, so the compiler knows them.
The factorisation is ``A = L D L^T`` with unit triangles: G. H. Golub and C. F. Van Loan, "Matrix
Computations", 4th edition, section 4.1.2. It has no square root, serves positive and negative definite
pivots alike, and the reciprocals of D take the place of the ones on the diagonal of L.

Bodies do not know when they are compiled how many lanes a system has: `LANES_1` ... `LANES_8` are what there is.

`subtract_products` and `subtract_backward_sum` are for factors with many blocks. Blocks that stand one after another
are one matrix with a long inner dimension there: the sum stays in registers, and its target is read and written once. A
tile of the target is as many columns as there are registers for; of the lanes only those in use.
"""

# ruff: noqa: ARG001  an intrinsic must take a typing context

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from llvmlite import ir

from heavylift.numerics.jit import intrinsic
from heavylift.numerics.vector_code import INTEGER, VectorCode, vector_code

__all__ = [
    "LANES_1",
    "LANES_2",
    "LANES_4",
    "LANES_8",
    "add_dot",
    "add_multiple",
    "add_outer_product",
    "add_rigid_dots",
    "add_rigid_product",
    "backward_pivot",
    "block_shape",
    "factor_pivot",
    "forward_pivot",
    "put_rigid_product",
    "put_six_rows",
    "scale_block",
    "solve_off_diagonal",
    "subtract_backward",
    "subtract_backward_sum",
    "subtract_forward",
    "subtract_multiples",
    "subtract_products",
    "subtract_rigid_rows",
]

Shape = tuple[tuple[int, ...], tuple[int, ...]]


def block_shape(rows: int) -> Shape:
    """Shape of blocks with this many rows: the rows, and the next power of two as lanes."""
    lanes = 1
    while lanes < rows:
        lanes *= 2
    return (0,) * rows, (0,) * lanes


LANES_1, LANES_2, LANES_4, LANES_8 = (block_shape(lanes) for lanes in (1, 2, 4, 8))
"""Block shapes by their lanes: what bodies do with panels is compiled for each of them."""


def _block_code(
    shape: Any, arguments: Sequence[Any], write: Callable[..., None], places: Sequence[int | None] = ()
) -> Any:
    """Signature and generator of an intrinsic on blocks: `vector_code`, which see, of arrays with one offset each."""
    rows, lanes = shape.types[0].count, shape.types[1].count
    places = (None, *(places or [1] * (len(arguments) // 2)))

    def without_shape(code: VectorCode, _: Any, *given: Any) -> None:
        write(code, *given)

    return vector_code((shape, *arguments), places, without_shape, lanes=lanes, used=rows)


@intrinsic
def factor_pivot(typingctx, shape, block, at):  # type: ignore[no-untyped-def]
    """Factor a symmetric block in place: ``L`` by columns along the lanes, ``1/D`` on its diagonal."""

    def write(code: VectorCode, A: Any) -> None:
        columns = [code.row(A, c) for c in range(code.used)]
        for c in range(code.used):
            inverse = code.reciprocal(code.lane(columns[c], c))
            scaled = code.multiply(columns[c], code.spread(inverse))
            for d in range(c + 1, code.used):
                factor = code.spread(code.lane(columns[c], d))
                columns[d] = code.multiply_subtract(columns[d], scaled, factor)
            code.put_row(scaled, A, c)
            code.store(inverse, A, c * code.lanes + c)

    return _block_code(shape, (block, at), write)


@intrinsic
def solve_off_diagonal(typingctx, shape, block, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """Replace a block ``B`` by ``Y = B L^-T``, one column a vector, ``L`` from `factor_pivot`."""

    def write(code: VectorCode, B: Any, L: Any) -> None:
        columns = [code.row(B, c) for c in range(code.used)]
        for c in range(code.used):
            code.put_row(columns[c], B, c)
            for d in range(c + 1, code.used):
                factor = code.spread(code.number(L, c * code.lanes + d))
                columns[d] = code.multiply_subtract(columns[d], columns[c], factor)

    return _block_code(shape, (block, at, pivot, pivot_at), write)


@intrinsic
def scale_block(typingctx, shape, out, out_at, block, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """``W = Y D^-1``."""

    def write(code: VectorCode, W: Any, Y: Any, L: Any) -> None:
        for c in range(code.used):
            inverse = code.spread(code.number(L, c * code.lanes + c))
            code.put_row(code.multiply(code.row(Y, c), inverse), W, c)

    return _block_code(shape, (out, out_at, block, at, pivot, pivot_at), write)


@intrinsic
def put_rigid_product(  # type: ignore[no-untyped-def]
    typingctx, shape, target, target_at, left, left_at, right, right_at, factors, first
):
    """``T := F^T D G`` over the six coordinates of a rigid body, D diagonal: its inverse masses."""
    return _block_code(
        shape, (target, target_at, left, left_at, right, right_at, factors, first), _rigid_product(add=False)
    )


@intrinsic
def add_rigid_product(  # type: ignore[no-untyped-def]
    typingctx, shape, target, target_at, left, left_at, right, right_at, factors, first
):
    """``T += F^T D G`` over the six coordinates of a rigid body, D diagonal: its inverse masses."""
    return _block_code(
        shape, (target, target_at, left, left_at, right, right_at, factors, first), _rigid_product(add=True)
    )


def _rigid_product(*, add: bool) -> Callable[..., None]:
    def write(code: VectorCode, T: Any, F: Any, G: Any, D: Any) -> None:
        rows = [code.multiply(code.row(G, k), code.spread(code.number(D, k))) for k in range(6)]
        for c in range(code.used):
            factors = [code.spread(code.number(F, k * code.lanes + c)) for k in range(6)]
            start = code.row(T, c) if add else None
            code.put_row(code.sum(*zip(rows, factors, strict=True), start=start), T, c)

    return write


@intrinsic
def put_six_rows(typingctx, shape, out, out_at, matrix, matrix_at, panel, at, size):  # type: ignore[no-untyped-def]
    """``X_i := sum_k B_ki G_k``: six rows of a product, from as many numbers of each of the `size` lines of B."""

    def write(code: VectorCode, X: Any, B: Any, G: Any, size: Any) -> None:
        sums = {i: code.constant(0.0) for i in range(6)}
        with code.loop(size, sums) as (k, present):
            row, line = code.load(code.line(G, 0, k, code.lanes), 0), code.at(B, code.builder.mul(k, size))
            for i in range(6):
                present[i] = code.multiply_add(present[i], row, code.spread(code.number(line, i)))
        for i, total in sums.items():
            code.put_row(total, X, i)

    return _block_code(shape, (out, out_at, matrix, matrix_at, panel, at, size), write, places=(1, 1, 1))


@intrinsic
def add_outer_product(typingctx, shape, target, target_at, left, left_at, right, right_at):  # type: ignore[no-untyped-def]
    """``T += x^T g`` for one coordinate: a row x of a panel X and a row g of a panel G."""

    def write(code: VectorCode, T: Any, X: Any, G: Any) -> None:
        row = code.row(G, 0)
        for c in range(code.used):
            factor = code.spread(code.number(X, c))
            code.put_row(code.multiply_add(code.row(T, c), row, factor), T, c)

    return _block_code(shape, (target, target_at, left, left_at, right, right_at), write)


@intrinsic
def add_multiple(typingctx, shape, out, out_at, row, row_at, factors, factor_at):  # type: ignore[no-untyped-def]
    """``out += factor row`` along the lanes."""

    def write(code: VectorCode, y: Any, x: Any, factor: Any) -> None:
        total = code.multiply_add(code.row(y, 0), code.row(x, 0), code.spread(code.number(factor, 0)))
        code.put_row(total, y, 0)

    return _block_code(shape, (out, out_at, row, row_at, factors, factor_at), write)


@intrinsic
def subtract_rigid_rows(typingctx, shape, out, out_at, panel, at, velocity, dof):  # type: ignore[no-untyped-def]
    """``out -= G^T u`` over the six velocities of a rigid body."""

    def write(code: VectorCode, y: Any, G: Any, u: Any) -> None:
        products = [(code.row(G, k), code.spread(code.number(u, k))) for k in range(6)]
        code.put_row(code.subtract_sum(code.row(y, 0), *products), y, 0)

    return _block_code(shape, (out, out_at, panel, at, velocity, dof), write)


@intrinsic
def add_dot(typingctx, shape, out, out_at, panel, at, lanes, lanes_at):  # type: ignore[no-untyped-def]
    """Add the inner product of one row of a panel with the lanes of a vector to one number."""

    def write(code: VectorCode, u: Any, X: Any, P: Any) -> None:
        code.store(code.add(code.number(u, 0), code.dot(code.row(X, 0), code.row(P, 0))), u, 0)

    return _block_code(shape, (out, out_at, panel, at, lanes, lanes_at), write)


@intrinsic
def forward_pivot(typingctx, shape, vector, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """``z := D^-1 L^-1 z``."""

    def write(code: VectorCode, z: Any, L: Any) -> None:
        value = code.row(z, 0)
        for c in range(code.used - 1):
            one = code.spread(code.lane(value, c))
            # the lanes up to c of the column hold no part of L: keep those of z
            mask = [i if i <= c else code.lanes + i for i in range(code.lanes)]
            reduced = code.multiply_subtract(value, code.row(L, c), one)
            value = code.choose(value, reduced, mask)
        code.put_row(value, z, 0)
        for c in range(code.used):
            inverse = code.number(L, c * code.lanes + c)
            code.store(code.multiply(code.lane(value, c), inverse), z, c)

    return _block_code(shape, (vector, at, pivot, pivot_at), write)


@intrinsic
def subtract_forward(typingctx, shape, vector, at, block, block_at, solved, solved_at):  # type: ignore[no-untyped-def]
    """``z_i -= Y z_j`` with the result of `forward_pivot`."""

    def write(code: VectorCode, z: Any, Y: Any, x: Any) -> None:
        products = [(code.row(Y, c), code.spread(code.number(x, c))) for c in range(code.used)]
        code.put_row(code.subtract_sum(code.row(z, 0), *products), z, 0)

    return _block_code(shape, (vector, at, block, block_at, solved, solved_at), write)


@intrinsic
def subtract_backward(typingctx, shape, vector, at, block, block_at, pivot, pivot_at, solved, solved_at):  # type: ignore[no-untyped-def]
    """``z_j -= D^-1 Y^T x_i``."""

    def write(code: VectorCode, z: Any, Y: Any, L: Any, x: Any) -> None:
        other = code.row(x, 0)
        for c in range(code.used):
            inverse = code.number(L, c * code.lanes + c)
            change = code.dot(code.row(Y, c), other)
            code.store(code.multiply_subtract(code.number(z, c), change, inverse), z, c)

    return _block_code(shape, (vector, at, block, block_at, pivot, pivot_at, solved, solved_at), write)


@intrinsic
def backward_pivot(typingctx, shape, vector, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """``x := L^-T x``."""

    def write(code: VectorCode, x: Any, L: Any) -> None:
        values = [code.number(x, c) for c in range(code.used)]
        for c in range(code.used - 2, -1, -1):
            for d in range(c + 1, code.used):
                factor = code.number(L, c * code.lanes + d)
                values[c] = code.multiply_subtract(values[c], factor, values[d])
            code.store(values[c], x, c)

    return _block_code(shape, (vector, at, pivot, pivot_at), write)


@intrinsic
def add_rigid_dots(typingctx, shape, out, out_at, panel, at, lanes, lanes_at, factors, first):  # type: ignore[no-untyped-def]
    """``u += D G P`` over the six velocities of a rigid body, D diagonal: its inverse masses."""

    def write(code: VectorCode, u: Any, G: Any, P: Any, D: Any) -> None:
        weights = code.row(P, 0)
        for k in range(6):
            change = code.dot(code.row(G, k), weights)
            code.store(code.multiply_add(code.number(u, k), code.number(D, k), change), u, k)

    return _block_code(shape, (out, out_at, panel, at, lanes, lanes_at, factors, first), write)


def _registers(context: Any) -> tuple[int, int]:
    """Number of vector registers of the machine that code is made for, and how many doubles one holds."""
    features = context.codegen().magic_tuple()[2].split(",")
    if "+avx512f" in features:
        return 32, 8
    if "+avx" in features:
        return 16, 4
    return (32 if "+neon" in features else 16), 2


def _pieces(rows: int, width: int) -> list[tuple[int, int]]:
    """First lane and length of the vectors that cover the rows: powers of two, none wider than a register."""
    pieces = []
    first = 0
    while first < rows:
        length = width
        while length > 1 and length // 2 >= rows - first:
            length //= 2
        pieces.append((first, length))
        first += length
    return pieces


def _exact_pieces(rows: int, width: int) -> list[tuple[int, int]]:
    """As `_pieces`, without reading any lane that is not in use."""
    pieces = []
    first = 0
    while first < rows:
        length = width
        while length > rows - first:
            length //= 2
        pieces.append((first, length))
        first += length
    return pieces


def _tiles(rows: int, pieces: int, registers: int) -> Iterator[range]:
    """Columns in groups whose sums fit into the registers, beside one operand and one factor."""
    most = max(1, (registers - 2) // pieces - 1)
    count = -(-rows // most)
    for i in range(count):
        yield range(rows * i // count, rows * (i + 1) // count)


@intrinsic
def subtract_products(  # type: ignore[no-untyped-def]
    typingctx, shape, target, target_at, left, left_at, right, right_at, count
):
    """``T -= Y_1 W_1^T + Y_2 W_2^T + ...`` with `count` blocks W of `left` and Y of `right`, each side by side.

    The lanes of T that are not in use may or may not change.
    """

    def write(code: VectorCode, T: Any, W: Any, Y: Any, count: Any) -> None:
        registers, width = _registers(code.context)
        pieces = _pieces(code.used, width)
        steps = code.builder.mul(count, ir.Constant(INTEGER, code.used))
        for columns in _tiles(code.used, len(pieces), registers):
            places = {(c, p): c * code.lanes + pieces[p][0] for c in columns for p in range(len(pieces))}
            sums = {key: code.load(T, place, pieces[key[1]][1]) for key, place in places.items()}
            with code.loop(steps, sums) as (d, present):
                w, y = code.line(W, 0, d, code.lanes), code.line(Y, 0, d, code.lanes)
                operands = [code.load(y, first, length) for first, length in pieces]
                for c in columns:
                    factor = code.number(w, c)
                    for p, operand in enumerate(operands):
                        value = code.spread(factor, operand.type.count)
                        present[c, p] = code.multiply_subtract(present[c, p], operand, value)
            for key, place in places.items():
                code.store(sums[key], T, place)

    return _block_code(shape, (target, target_at, left, left_at, right, right_at, count), write)


@intrinsic
def subtract_multiples(  # type: ignore[no-untyped-def]
    typingctx, shape, out, out_at, panel, at, factors, factor_at, spacing, count
):
    """``out -= c_0 g_0 + c_1 g_1 + ...`` along the lanes, with `count` rows g of a panel and factors c at a spacing."""

    def write(code: VectorCode, y: Any, G: Any, c: Any, spacing: Any, count: Any) -> None:
        sums = {0: code.row(y, 0)}
        with code.loop(count, sums) as (k, present):
            factor = code.spread(code.number(code.at(c, code.builder.mul(k, spacing)), 0))
            present[0] = code.multiply_subtract(
                present[0], code.row(code.line(G, 0, k, code.lanes), 0), factor
            )
        code.put_row(sums[0], y, 0)

    arguments = (out, out_at, panel, at, factors, factor_at, spacing, count)
    return _block_code(shape, arguments, write, places=(1, 1, 1))


@intrinsic
def subtract_backward_sum(  # type: ignore[no-untyped-def]
    typingctx, shape, vectors, vectors_at, node, blocks, base, pivot, lower, first, count
):
    """``z_j -= D^-1 sum_i Y_i^T x_i`` over rows `first` to `first + count` of `lower`: their nodes and places.

    `node` is that of z, and `pivot` the place of its block; places count from `base` of `blocks`, vectors
    of nodes from `vectors_at`.
    """

    def write(
        code: VectorCode, X: Any, node: Any, B: Any, pivot: Any, lower: Any, first: Any, count: Any
    ) -> None:
        z, D = code.line(X, 0, node, code.lanes), code.at(B, pivot)
        table = code.line(lower, 0, first, 2)
        registers, width = _registers(code.context)
        pieces = _exact_pieces(code.used, width)
        for columns in _tiles(code.used, len(pieces), registers):
            sums = {
                (c, p): code.constant(0.0, length) for c in columns for p, (_, length) in enumerate(pieces)
            }
            with code.loop(count, sums) as (i, present):
                entry = code.line(table, 0, i, 2)
                later = code.line(X, 0, code.number(entry, 0, INTEGER), code.lanes)
                Y = code.at(B, code.number(entry, 1, INTEGER))
                operands = [code.load(later, start, length) for start, length in pieces]
                for c in columns:
                    for p, (start, length) in enumerate(pieces):
                        column = code.load(Y, c * code.lanes + start, length)
                        present[c, p] = code.multiply_add(present[c, p], column, operands[p])
            for c in columns:
                change = code.total(sums[c, 0])
                for p in range(1, len(pieces)):
                    change = code.add(change, code.total(sums[c, p]))
                inverse = code.number(D, c * (code.lanes + 1))
                code.store(code.multiply_subtract(code.number(z, c), change, inverse), z, c)

    arguments = (vectors, vectors_at, node, blocks, base, pivot, lower, first, count)
    return _block_code(shape, arguments, write, places=(1, None, 1, None, 0))
