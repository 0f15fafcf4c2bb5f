"""One quiet, repeatable gmsh session, and its second-order tetrahedra as arrays."""

from __future__ import annotations

import contextlib
import logging
import signal
import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.memory import refuse_beyond_memory
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.refinement import refine_near

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.refinement import CurveSize

__all__ = ["gmsh_session", "mesh_tetrahedra"]

_LOGGER = logging.getLogger(__name__)
_TET10 = 11  # gmsh's number of the 10-node tetrahedron
# gmsh lists the middle nodes of the edges 01, 12, 02, 03, 23, 13: the last two are swapped
_TO_VTK = np.array([0, 1, 2, 3, 4, 5, 6, 7, 9, 8])


@contextlib.contextmanager
def gmsh_session(source: str) -> Iterator[Any]:
    """Start gmsh, quiet, on one thread and with a fixed seed; what gmsh complains of becomes an `InputError`.

    No user's configuration file is read: the same input gives the same mesh everywhere.

    Raises
    ------
    InputError
        Whatever error gmsh stops with, named after `source`.
    """
    import gmsh

    if gmsh.isInitialized():
        raise RuntimeError("gmsh is in use in this process; sessions do not nest")
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    _keep_broken_pipes_errors()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for option in ("General.NumThreads", "Mesh.MaxNumThreads1D", "Mesh.MaxNumThreads2D"):
            gmsh.option.setNumber(option, 1)
        gmsh.option.setNumber("Mesh.MaxNumThreads3D", 1)
        gmsh.option.setNumber("Mesh.RandomSeed", 1)
        gmsh.model.add("body")
        gmsh.logger.start()
        yield gmsh
    except InputError:
        raise
    except Exception as error:
        # gmsh raises plain Exception; its log says more than the exception
        errors = [line for line in gmsh.logger.get() if line.startswith("Error")]
        text = "; ".join(errors) or str(error)
        raise InputError(f"gmsh failed: {text}", source=source, expected="a valid solid geometry") from error
    finally:
        for line in gmsh.logger.get():
            _LOGGER.debug("gmsh: %s", line)
        gmsh.finalize()


def _keep_broken_pipes_errors() -> None:
    """Undo that gmsh lets the system end a process that writes to what nobody reads any more: to Python it is an error.

    Python does not know of it, so what it believes to be set is set again; that is for the main thread alone.
    """
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, signal.getsignal(signal.SIGPIPE))


TETRAHEDRA = 4.7
"""Elements that gmsh makes of the volume of a cube of their edge length."""

ALONG_CURVE = 15.0
"""Elements around a curve for each edge length on it, at a growth of 1."""

TINY = 1e-60
"""Of lengths that are divided by: far below what anybody has memory for."""

TETRAHEDRON_BYTES, TETRAHEDRON_SECONDS = 14e3, 60e-6
"""Of a quadratic tetrahedron, meshed and assembled; measured on cubes of 8,000 and 37,000 of them."""


def _estimate_tetrahedra(gmsh: Any, size: float, refine: Sequence[CurveSize], source: str) -> None:
    """Refuse a mesh for which there is no memory.

    Where the edge length grows with the distance d from a curve as s + g d, the elements of the volume 2 pi d L dd
    around it add up to pi L / (g^2 s) cubes.
    """
    volume = sum(gmsh.model.occ.getMass(3, tag) for _, tag in gmsh.model.getEntities(3))
    size = max(size, TINY)
    wanted = [(TETRAHEDRA * volume / size**3, "size", "a larger size")]
    for wish in refine:
        length, own = sum(gmsh.model.occ.getMass(1, tag) for tag in wish.curves), max(wish.size, TINY)
        # no more than elements of this size in all of the body
        near = min(ALONG_CURVE * length / max(wish.growth, TINY) ** 2 / own, TETRAHEDRA * volume / own**3)
        wanted.append((near + length / own, "refine", "a larger size or growth"))
    count, key, remedy = max(wanted)
    refuse_beyond_memory(
        count,
        "tetrahedra",
        bytes_each=TETRAHEDRON_BYTES,
        seconds_each=TETRAHEDRON_SECONDS,
        source=source,
        key=key,
        remedy=remedy,
    )


def mesh_tetrahedra(
    gmsh: Any, size: float, *, source: str, curved: bool = False, refine: Sequence[CurveSize] = ()
) -> tuple[NDArray[np.float64], NDArray[np.int64], dict[int, NDArray[np.int64]]]:
    """Mesh the solids of the current model with second-order tetrahedra.

    Parameters
    ----------
    gmsh
        From `gmsh_session`.
    size
        Target edge length, in units of the model.
    source
        What is meshed, for errors.
    curved
        Whether middle nodes follow curved faces; straight edges otherwise.
    refine
        Smaller sizes along curves.

    Returns
    -------
    tuple
        Node positions (n, 3); elements (ne, 10), zero-based, order of VTK; nodes of every face by gmsh's tag.

    Raises
    ------
    InputError
        There is no memory for so many elements.
    """
    _estimate_tetrahedra(gmsh, size, refine, source)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.0)
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal Delaunay in the plane
    gmsh.option.setNumber("Mesh.Algorithm3D", 1)  # Delaunay
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderLinear", 0 if curved else 1)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 2 if curved else 0)
    gmsh.option.setNumber("Mesh.Optimize", 1)
    if refine:
        refine_near(gmsh, refine, size)
    gmsh.model.mesh.generate(3)

    tags, positions, _ = gmsh.model.mesh.getNodes()
    _, connectivity = gmsh.model.mesh.getElementsByType(_TET10)
    elements = connectivity.astype(np.int64).reshape(-1, 10)[:, _TO_VTK]
    used = np.unique(elements)  # gmsh also lists nodes of geometry that carries no solid
    new_index = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    new_index[used] = np.arange(used.size)
    place = np.empty(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(tags.size)
    nodes = positions.reshape(-1, 3)[place[used]]

    faces = {}
    for _, tag in gmsh.model.getEntities(2):
        on_face = gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)[0].astype(np.int64)
        members = new_index[on_face]
        faces[tag] = np.unique(members[members >= 0])
    return nodes, new_index[elements], faces
