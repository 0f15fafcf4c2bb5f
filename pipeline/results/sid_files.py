"""Standard input data of flexible bodies as a text file ``.SID_FEM``, as SIMPACK's FEMBS writes it.

The first line has the numbers of nodes and of modes. Then objects lie in each other, from their name to ``end NAME``;
numbers have Fortran's exponent D; rows, modal coordinates and columns count from 1: ``m1( row, coordinate, column)``.
Of symmetric matrices only the lower triangle is there.
"""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

from heavylift.modal.standard_input import SYMMETRIC
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from heavylift.modal.standard_input import NodeData, Series, StandardInput

__all__ = ["write_sid"]

_MATRICES = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
"""In the order of the file; ksigma, the forces of initial stress, are none."""


def write_sid(path: Path, data: StandardInput, name: str) -> None:
    """Write standard input data of a body with a name; the file is replaced in one step."""
    with replacing(path) as temporary, temporary.open("w", encoding="ascii", newline="\n") as stream:
        stream.writelines(f"{line}\n" for line in _lines(data, name))


def _lines(data: StandardInput, name: str) -> Iterator[str]:
    modes = len(data.frequencies)
    version = metadata.version("heavylift")
    named = ", ".join(node.name for node in data.nodes if node.name)
    words = f"body {name}, SI units, by heavylift {version}" + (f"; nodes: {named}" if named else "")
    yield f"{len(data.nodes):6d} {modes:6d} Geo_Stiff= {'yes' if data.geometric else 'no'}  {words}"
    yield "part"
    yield "new modal"
    yield "  refmod"
    yield f"    mass           = {_number(data.mass)}"
    yield f"    nelastq        = {modes:d}"
    for number, frequency in enumerate(data.frequencies, start=1):
        yield f"    ielastq ({number:4d}) = Eigen Mode {number:4d} : {frequency:14.6f} Hz"
    yield "  end refmod"
    yield "  frame"
    for number, node in enumerate(data.nodes, start=1):
        yield from _node(node, number, modes)
    yield "  end frame"
    for key in _MATRICES:
        if key == "ksigma":
            yield from _header("ksigma", (0, modes, 1, modes, 0), "  ")
            yield "  end ksigma"
        else:
            yield from _series(key, getattr(data, key), modes, "  ")
    yield "end modal"
    yield "end part"


def _node(node: NodeData, number: int, modes: int) -> Iterator[str]:
    yield f"    new node = {number:d}"
    yield "      rframe = body ref"
    for key, series in (
        ("origin", node.origin),
        ("phi", node.phi),
        ("psi", node.psi),
        ("AP", node.orientation),
    ):
        yield from _series(key, series, modes, "      ")
    yield "    end node"


def _series(key: str, series: Series, modes: int, indent: str) -> Iterator[str]:
    """A matrix with its derivatives by modal coordinates; entries that are zero are left out."""
    rows, columns = series.m0.shape
    order = 0 if series.m1 is None else 1
    yield from _header(key, (order, rows, columns, modes, series.structure), indent)
    symmetric = series.structure == SYMMETRIC
    for row in range(rows):
        for column in range(row + 1 if symmetric else columns):
            value = float(series.m0[row, column])
            if value:
                yield f"{indent}  m0({row + 1:3d},{column + 1:3d})     = {_number(value)}"
    if series.m1 is not None:
        for row in range(rows):
            for mode in range(modes):
                for column in range(row + 1 if symmetric else columns):
                    value = float(series.m1[row, mode, column])
                    if value:
                        yield f"{indent}  m1({row + 1:3d},{mode + 1:3d},{column + 1:3d}) = {_number(value)}"
    yield f"{indent}end {key}"


def _header(key: str, numbers: tuple[int, int, int, int, int], indent: str) -> Iterator[str]:
    """Name, order, shape and structure of a matrix."""
    order, rows, columns, modes, structure = numbers
    yield f"{indent}{key}"
    for word, value in (
        ("order", order),
        ("nrow", rows),
        ("ncol", columns),
        ("nq", modes),
        ("nqn", 0),
        ("structure", structure),
    ):
        yield f"{indent}  {word:14s} = {value:d}"


def _number(value: float) -> str:
    """All digits of a number, with the exponent of Fortran's double precision."""
    return f"{value:.16e}".replace("e", "D")
