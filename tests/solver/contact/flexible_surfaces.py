"""Bars of bricks with modes that touch with their outer surface, and an independent beam on springs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from mesh_contact_scenes import DOWN
from numpy.typing import NDArray

from heavylift.contours.triangles.body_surface import body_surface
from heavylift.modal.bases import Basis, Loads, eigenmode_basis, place_loads, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduced import ReducedBody
from heavylift.modal.reduction import reduce_body
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.structure import Shells, Structure
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.scene import FlexibleBody, Gravity, Scene

LENGTH, WIDTH, HEIGHT = 4.0, 0.4, 0.2
YOUNG, DENSITY = 2e9, 2000.0
MASS = DENSITY * LENGTH * WIDTH * HEIGHT


@cache
def bar(
    modes: int = 6,
    under: tuple[tuple[float, float], ...] = (),
    young: float = YOUNG,
    divisions: tuple[int, ...] = (16, 2, 2),
    size: tuple[float, float, float] = (LENGTH, WIDTH, HEIGHT),
    element: str = "hex8",
) -> ReducedBody:
    """Free, about the origin; with static vectors of forces along z at points of its underside."""
    half = [0.5 * side for side in size]
    mesh = mesh_blocks(
        [Box("bar", (-half[0], -half[1], -half[2]), (half[0], half[1], half[2]))],
        element_type=element,
        **(
            {"divisions": {a: [n] for a, n in zip("xyz", divisions, strict=True)}}
            if divisions
            else {"size": 0.4}
        ),
    )
    formulation = {"formulation": "incompatible"} if element == "hex8" else {}
    model = assemble(mesh, Material(young, 0.0, DENSITY), **formulation)
    flexibility = Flexibility(model, np.empty(0, dtype=np.int64))
    basis: Basis = eigenmode_basis(eigenmodes(model, modes, flexibility=flexibility))
    if under:
        places = [(x, y, -half[2]) for x, y in under]
        basis += static_vectors(flexibility, place_loads(model, places, "z"))
    return reduce_body(model, basis.vectors, basis.labels, mean_axis=True)


def skin(name: str, reduced: ReducedBody) -> CollisionSurface:
    """The outer surface of a body, called as it is."""
    made = body_surface(reduced, name)
    return CollisionSurface(name=f"skin of {name}", body=name, surface=made.surface, nodes=made.nodes)


def flexible(
    name: str, reduced: ReducedBody, position: Any, damping: float = 0.0, **more: Any
) -> FlexibleBody:
    """A body of it."""
    return FlexibleBody(
        name,
        reduced,
        position=np.array(position, dtype=float),
        damping_ratio=np.full(reduced.mode_count, damping),
        **more,
    )


def touching(
    bodies: tuple[Any, ...],
    surfaces: dict[str, tuple[str, TriangleSurface]],
    law: Any,
    *,
    gravity: Any = DOWN,
    **more: Any,
) -> Scene:
    """All flexible bodies touch each other and all surfaces: these have names, and are on bodies or the ground."""
    skins = [skin(body.name, body.reduced) for body in bodies if isinstance(body, FlexibleBody)]
    others = [
        CollisionSurface(name=name, body=body, surface=surface) for name, (body, surface) in surfaces.items()
    ]
    pairs = [(other.name, own.name) for own in skins for other in others]
    pairs += [(a.name, b.name) for i, a in enumerate(skins) for b in skins[i + 1 :]]
    return Scene(
        bodies=bodies,
        forces=(Gravity(np.asarray(gravity, dtype=float)),),
        surfaces=(*others, *skins),
        collisions=tuple(
            Collision(name=f"touch_{n}", surfaces=pair, law=law, **more) for n, pair in enumerate(pairs, 1)
        ),
    )


def beam_on_springs(
    places: NDArray[np.float64],
    stiffness: float,
    load: float,
    elements: int = 160,
    force: float = 0.0,
    height: float = HEIGHT,
) -> NDArray[np.float64]:
    """Forces of springs that push only under a free Timoshenko beam.

    It has a line load [N/m] and a force in its middle [N]. Two-node elements with exact static shape functions
    (Przemieniecki 1968); springs that would pull are taken away.
    """
    E, A, I = YOUNG, WIDTH * height, WIDTH * height**3 / 12.0
    L = LENGTH / elements
    phi = 12.0 * E * I / (0.5 * E * 5.0 / 6.0 * A * L**2)  # nu = 0: G = E/2
    one = np.array(
        [
            [12.0, 6.0 * L, -12.0, 6.0 * L],
            [6.0 * L, (4.0 + phi) * L**2, -6.0 * L, (2.0 - phi) * L**2],
            [-12.0, -6.0 * L, 12.0, -6.0 * L],
            [6.0 * L, (2.0 - phi) * L**2, -6.0 * L, (4.0 + phi) * L**2],
        ]
    ) * (E * I / (L**3 * (1.0 + phi)))
    count = 2 * (elements + 1)
    K, f = np.zeros((count, count)), np.zeros(count)
    for e in range(elements):
        own = slice(2 * e, 2 * e + 4)
        K[own, own] += one
        f[own] -= load * L * np.array([0.5, L / 12.0, 0.5, -L / 12.0])
    f[elements] -= force
    at = 2 * np.rint((np.asarray(places) + 0.5 * LENGTH) / L).astype(int)
    pushes = np.ones(len(at), dtype=bool)
    while True:
        held = K.copy()
        held[at[pushes], at[pushes]] += stiffness
        found = -stiffness * np.linalg.solve(held, f)[at]
        if np.array_equal(found > 0.0, pushes):
            return np.where(pushes, found, 0.0)
        pushes = found > 0.0


@cache
def plate(
    thickness: float = 0.05,
    offset: float = 0.0,
    modes: int = 8,
    under: tuple[float, ...] = (),
) -> ReducedBody:
    """As long and wide as the bar, of shell elements; with static vectors of line forces across it along z."""
    x, y = np.linspace(-0.5 * LENGTH, 0.5 * LENGTH, 33), np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, 5)
    nodes = np.stack([*(one.ravel() for one in np.meshgrid(x, y, indexing="ij")), np.zeros(165)], axis=1)
    a = (np.arange(32)[:, np.newaxis] * 5 + np.arange(4)).ravel()
    elements = np.stack([a, a + 5, a + 6, a + 1], axis=1)
    structure = Structure(
        nodes, (Shells("plate", elements, Material(YOUNG, 0.0, DENSITY), thickness, offset),)
    )
    model = assemble_structure(structure)
    flexibility = Flexibility(model, np.empty(0, dtype=np.int64))
    basis: Basis = eigenmode_basis(eigenmodes(model, modes, flexibility=flexibility))
    if under:
        forces = np.zeros((model.dof_count, len(under)))
        for k, place in enumerate(under):
            forces[3 * np.flatnonzero(np.abs(nodes[:, 0] - place) < 1e-9) + 2, k] = 0.2
        basis += static_vectors(flexibility, Loads(forces, tuple(f"line {k}" for k in range(len(under)))))
    return reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
