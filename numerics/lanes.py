"""Small dense blocks in vector registers: the arithmetic of the joint solver.

A *panel* is a matrix whose rows are the coordinates of a body and whose columns, the *lanes*, are the
rows of a joint, stored row by row and padded to a power of two. A *block* has as many rows as a joint
and the same lanes. LLVM does not find vector instructions in loops of this size (it cannot prove that
the arrays differ, and five iterations are too few), so these functions say them: each becomes straight
vector code for whatever the machine has. All arrays are flat and contiguous; places are offsets.

A block shape is given as two tuples, whose *lengths* count: they are types, so the compiler knows them.
The factorisation is ``A = L D L^T`` with unit triangles: G. H. Golub and C. F. Van Loan, "Matrix
Computations", 4th edition, section 4.1.2. It has no square root, serves positive and negative definite
pivots alike, and the reciprocals of D take the place of the ones on the diagonal of L.
"""

# ruff: noqa: ARG001  an intrinsic must take a typing context

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

__all__ = [
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
    "scale_block",
    "solve_off_diagonal",
    "subtract_backward",
    "subtract_forward",
    "subtract_product",
    "subtract_rigid_rows",
]

FLAGS = ("contract", "nsz", "arcp")
"""The rounding flags of `heavylift.numerics.jit.kernel`."""

Shape = tuple[tuple[int, ...], tuple[int, ...]]


def block_shape(rows: int) -> Shape:
    """Shape of blocks with this many rows: the rows, and the next power of two as lanes."""
    lanes = 1
    while lanes < rows:
        lanes *= 2
    return (0,) * rows, (0,) * lanes


class _Code:
    """Writes vector instructions: `rows` and `lanes` of the block shape, and a few words for IR."""

    def __init__(self, context: Any, builder: ir.IRBuilder, shape: Any) -> None:
        self.context, self.builder = context, builder
        self.rows, self.lanes = shape.types[0].count, shape.types[1].count
        self.vector = ir.VectorType(ir.DoubleType(), self.lanes)

    def pointer(self, array_type: Any, array: Any, offset: Any) -> Any:
        """Address of the double at an offset of a flat array."""
        data = self.context.make_array(array_type)(self.context, self.builder, array).data
        return self.builder.gep(data, [offset], source_etype=ir.DoubleType())

    def at(self, pointer: Any, index: int) -> Any:
        return self.builder.gep(pointer, [ir.Constant(ir.IntType(64), index)], source_etype=ir.DoubleType())

    def load(self, pointer: Any, row: int) -> Any:
        place = self.builder.bitcast(self.at(pointer, row * self.lanes), self.vector.as_pointer())
        return self.builder.load(place, align=8, typ=self.vector)

    def store(self, value: Any, pointer: Any, row: int) -> None:
        place = self.builder.bitcast(self.at(pointer, row * self.lanes), self.vector.as_pointer())
        self.builder.store(value, place, align=8)

    def number(self, pointer: Any, index: int) -> Any:
        return self.builder.load(self.at(pointer, index), typ=ir.DoubleType())

    def put(self, value: Any, pointer: Any, index: int) -> None:
        self.builder.store(value, self.at(pointer, index))

    def lane(self, vector: Any, index: int) -> Any:
        return self.builder.extract_element(vector, ir.Constant(ir.IntType(32), index))

    def spread(self, number: Any) -> Any:
        """The same number in all lanes."""
        one = self.builder.insert_element(
            ir.Constant(self.vector, ir.Undefined), number, ir.Constant(ir.IntType(32), 0)
        )
        mask = ir.Constant(ir.VectorType(ir.IntType(32), self.lanes), [0] * self.lanes)
        return self.builder.shuffle_vector(one, ir.Constant(self.vector, ir.Undefined), mask)

    def choose(self, a: Any, b: Any, mask: list[int]) -> Any:
        """Lanes of two vectors: numbers from `lanes` on mean the second."""
        return self.builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(ir.IntType(32), self.lanes), mask))

    def multiply(self, a: Any, b: Any) -> Any:
        return self.builder.fmul(a, b, flags=FLAGS)

    def add(self, a: Any, b: Any) -> Any:
        return self.builder.fadd(a, b, flags=FLAGS)

    def subtract(self, a: Any, b: Any) -> Any:
        return self.builder.fsub(a, b, flags=FLAGS)

    def reciprocal(self, a: Any) -> Any:
        return self.builder.fdiv(ir.Constant(ir.DoubleType(), 1.0), a, flags=FLAGS)

    def dot(self, a: Any, b: Any) -> Any:
        """Sum over the rows that are in use."""
        product = self.multiply(a, b)
        terms = [self.lane(product, i) for i in range(self.rows)]
        while len(terms) > 1:
            pairs = zip(terms[::2], terms[1::2], strict=False)
            terms = [self.add(x, y) for x, y in pairs] + terms[len(terms) // 2 * 2 :]
        return terms[0]


def _vector_code(shape: Any, places: tuple[Any, ...], write: Callable[..., None]) -> Any:
    """Signature and generator of an intrinsic; `write` gets a pointer for every pair of array and offset."""
    signature = types.void(shape, *places)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        code = _Code(context, builder, signature.args[0])
        pointers = [
            code.pointer(signature.args[i], values[i], values[i + 1]) for i in range(1, len(values), 2)
        ]
        write(code, *pointers)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def factor_pivot(typingctx, shape, block, at):  # type: ignore[no-untyped-def]
    """Factor a symmetric block in place: ``L`` by columns along the lanes, ``1/D`` on its diagonal."""

    def write(code: _Code, A: Any) -> None:
        columns = [code.load(A, c) for c in range(code.rows)]
        for c in range(code.rows):
            inverse = code.reciprocal(code.lane(columns[c], c))
            scaled = code.multiply(columns[c], code.spread(inverse))
            for d in range(c + 1, code.rows):
                step = code.multiply(scaled, code.spread(code.lane(columns[c], d)))
                columns[d] = code.subtract(columns[d], step)
            code.store(scaled, A, c)
            code.put(inverse, A, c * code.lanes + c)

    return _vector_code(shape, (block, at), write)


@intrinsic
def solve_off_diagonal(typingctx, shape, block, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """Replace a block ``B`` by ``Y = B L^-T``, one column a vector, ``L`` from `factor_pivot`."""

    def write(code: _Code, B: Any, L: Any) -> None:
        columns = [code.load(B, c) for c in range(code.rows)]
        for c in range(code.rows):
            code.store(columns[c], B, c)
            for d in range(c + 1, code.rows):
                factor = code.spread(code.number(L, c * code.lanes + d))
                columns[d] = code.subtract(columns[d], code.multiply(columns[c], factor))

    return _vector_code(shape, (block, at, pivot, pivot_at), write)


@intrinsic
def scale_block(typingctx, shape, out, out_at, block, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """``W = Y D^-1``."""

    def write(code: _Code, W: Any, Y: Any, L: Any) -> None:
        for c in range(code.rows):
            inverse = code.spread(code.number(L, c * code.lanes + c))
            code.store(code.multiply(code.load(Y, c), inverse), W, c)

    return _vector_code(shape, (out, out_at, block, at, pivot, pivot_at), write)


@intrinsic
def subtract_product(typingctx, shape, target, target_at, left, left_at, right, right_at):  # type: ignore[no-untyped-def]
    """``T -= Y W^T``: of `left` W every number, of `right` Y every column as a vector."""

    def write(code: _Code, T: Any, W: Any, Y: Any) -> None:
        columns = [code.load(Y, d) for d in range(code.rows)]
        for c in range(code.rows):
            total = code.load(T, c)
            for d in range(code.rows):
                factor = code.spread(code.number(W, d * code.lanes + c))
                total = code.subtract(total, code.multiply(columns[d], factor))
            code.store(total, T, c)

    return _vector_code(shape, (target, target_at, left, left_at, right, right_at), write)


@intrinsic
def put_rigid_product(  # type: ignore[no-untyped-def]
    typingctx, shape, target, target_at, left, left_at, right, right_at, factors, first
):
    """``T := F^T D G`` over the six coordinates of a rigid body, D diagonal: its inverse masses."""
    return _vector_code(
        shape, (target, target_at, left, left_at, right, right_at, factors, first), _rigid_product(add=False)
    )


@intrinsic
def add_rigid_product(  # type: ignore[no-untyped-def]
    typingctx, shape, target, target_at, left, left_at, right, right_at, factors, first
):
    """``T += F^T D G`` over the six coordinates of a rigid body, D diagonal: its inverse masses."""
    return _vector_code(
        shape, (target, target_at, left, left_at, right, right_at, factors, first), _rigid_product(add=True)
    )


def _rigid_product(*, add: bool) -> Callable[..., None]:
    def write(code: _Code, T: Any, F: Any, G: Any, D: Any) -> None:
        rows = [code.multiply(code.load(G, k), code.spread(code.number(D, k))) for k in range(6)]
        for c in range(code.rows):
            total = code.load(T, c) if add else None
            for k in range(6):
                term = code.multiply(rows[k], code.spread(code.number(F, k * code.lanes + c)))
                total = term if total is None else code.add(total, term)
            code.store(total, T, c)

    return write


@intrinsic
def add_outer_product(typingctx, shape, target, target_at, left, left_at, right, right_at):  # type: ignore[no-untyped-def]
    """``T += x^T g`` for one coordinate: a row x of a panel X and a row g of a panel G."""

    def write(code: _Code, T: Any, X: Any, G: Any) -> None:
        row = code.load(G, 0)
        for c in range(code.rows):
            factor = code.spread(code.number(X, c))
            code.store(code.add(code.load(T, c), code.multiply(row, factor)), T, c)

    return _vector_code(shape, (target, target_at, left, left_at, right, right_at), write)


@intrinsic
def add_multiple(typingctx, shape, out, out_at, row, row_at, factors, factor_at):  # type: ignore[no-untyped-def]
    """``out += factor row`` along the lanes."""

    def write(code: _Code, y: Any, x: Any, factor: Any) -> None:
        code.store(
            code.add(code.load(y, 0), code.multiply(code.load(x, 0), code.spread(code.number(factor, 0)))),
            y,
            0,
        )

    return _vector_code(shape, (out, out_at, row, row_at, factors, factor_at), write)


@intrinsic
def subtract_rigid_rows(typingctx, shape, out, out_at, panel, at, velocity, dof):  # type: ignore[no-untyped-def]
    """``out -= G^T u`` over the six velocities of a rigid body."""

    def write(code: _Code, y: Any, G: Any, u: Any) -> None:
        total = code.load(y, 0)
        for k in range(6):
            total = code.subtract(total, code.multiply(code.load(G, k), code.spread(code.number(u, k))))
        code.store(total, y, 0)

    return _vector_code(shape, (out, out_at, panel, at, velocity, dof), write)


@intrinsic
def add_dot(typingctx, shape, out, out_at, panel, at, lanes, lanes_at):  # type: ignore[no-untyped-def]
    """Add the inner product of one row of a panel with the lanes of a vector to one number."""

    def write(code: _Code, u: Any, X: Any, P: Any) -> None:
        code.put(code.add(code.number(u, 0), code.dot(code.load(X, 0), code.load(P, 0))), u, 0)

    return _vector_code(shape, (out, out_at, panel, at, lanes, lanes_at), write)


@intrinsic
def forward_pivot(typingctx, shape, vector, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """``z := D^-1 L^-1 z``."""

    def write(code: _Code, z: Any, L: Any) -> None:
        value = code.load(z, 0)
        for c in range(code.rows - 1):
            column = code.load(L, c)
            one = code.lane(value, c)
            # the lanes up to c of the column hold no part of L: keep those of z
            mask = [i if i <= c else code.lanes + i for i in range(code.lanes)]
            reduced = code.subtract(value, code.multiply(column, code.spread(one)))
            value = code.choose(value, reduced, mask)
        code.store(value, z, 0)
        for c in range(code.rows):
            inverse = code.number(L, c * code.lanes + c)
            code.put(code.multiply(code.lane(value, c), inverse), z, c)

    return _vector_code(shape, (vector, at, pivot, pivot_at), write)


@intrinsic
def subtract_forward(typingctx, shape, vector, at, block, block_at, solved, solved_at):  # type: ignore[no-untyped-def]
    """``z_i -= Y z_j`` with the result of `forward_pivot`."""

    def write(code: _Code, z: Any, Y: Any, x: Any) -> None:
        value = code.load(z, 0)
        for c in range(code.rows):
            value = code.subtract(value, code.multiply(code.load(Y, c), code.spread(code.number(x, c))))
        code.store(value, z, 0)

    return _vector_code(shape, (vector, at, block, block_at, solved, solved_at), write)


@intrinsic
def subtract_backward(typingctx, shape, vector, at, block, block_at, pivot, pivot_at, solved, solved_at):  # type: ignore[no-untyped-def]
    """``z_j -= D^-1 Y^T x_i``."""

    def write(code: _Code, z: Any, Y: Any, L: Any, x: Any) -> None:
        other = code.load(x, 0)
        for c in range(code.rows):
            inverse = code.number(L, c * code.lanes + c)
            change = code.multiply(code.dot(code.load(Y, c), other), inverse)
            code.put(code.subtract(code.number(z, c), change), z, c)

    return _vector_code(shape, (vector, at, block, block_at, pivot, pivot_at, solved, solved_at), write)


@intrinsic
def backward_pivot(typingctx, shape, vector, at, pivot, pivot_at):  # type: ignore[no-untyped-def]
    """``x := L^-T x``."""

    def write(code: _Code, x: Any, L: Any) -> None:
        values = [code.number(x, c) for c in range(code.rows)]
        for c in range(code.rows - 2, -1, -1):
            for d in range(c + 1, code.rows):
                factor = code.number(L, c * code.lanes + d)
                values[c] = code.subtract(values[c], code.multiply(factor, values[d]))
            code.put(values[c], x, c)

    return _vector_code(shape, (vector, at, pivot, pivot_at), write)


@intrinsic
def add_rigid_dots(typingctx, shape, out, out_at, panel, at, lanes, lanes_at, factors, first):  # type: ignore[no-untyped-def]
    """``u += D G P`` over the six velocities of a rigid body, D diagonal: its inverse masses."""

    def write(code: _Code, u: Any, G: Any, P: Any, D: Any) -> None:
        weights = code.load(P, 0)
        for k in range(6):
            change = code.multiply(code.number(D, k), code.dot(code.load(G, k), weights))
            code.put(code.add(code.number(u, k), change), u, k)

    return _vector_code(shape, (out, out_at, panel, at, lanes, lanes_at, factors, first), write)
