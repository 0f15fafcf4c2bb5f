"""A step of contact on the triangles of a flexible body, beside the same triangles on a rigid one.

    python benchmarks/flexible_collision.py            # slabs of 2 x 40 to 2 x 160 elements a side, 10 to 100 modes

A slab lies on four blocks of a stiffness, sixteen contacts or more without friction. Columns: nodes of its surface; CPU
time of a step at rest of the rigid body, of one with modes, and of the same modes without contact; and, of a slab that
swings on its blocks, that step with all of its lists of near triangles.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from heavylift.contours.triangles.body_surface import body_surface
from heavylift.modal.bases import eigenmode_basis
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduction import reduce_body
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import placed
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import LinearLaw
from heavylift.solver.scene.scene import FlexibleBody, Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G = 9.80665
STEP = 2e-3
SIZE = (8.0, 6.0, 0.5)


def reduced_slab(cells: int, modes: int) -> Any:
    """A slab of bricks, free."""
    half = [0.5 * side for side in SIZE]
    mesh = mesh_blocks(
        [Box("slab", tuple(-x for x in half), tuple(half))],
        element_type="hex8",
        divisions={"x": [cells], "y": [3 * cells // 4], "z": [1]},
    )
    model = assemble(mesh, Material(30e9, 0.2, 2400.0))
    flexibility = Flexibility(model, np.empty(0, dtype=np.int64))
    basis = eigenmode_basis(eigenmodes(model, modes, flexibility=flexibility))
    return reduce_body(model, basis.vectors, basis.labels, mean_axis=True)


def cost(body: Any, surface: CollisionSurface | None) -> float:
    """CPU time of a step [us]."""
    stand = box_surface((0.6, 0.6, 1.0))
    places = [(x, y) for x in (-3.0, 3.0) for y in (-2.0, 2.0)]
    stands = [
        CollisionSurface(name=f"stand {i}", body="ground", surface=placed(stand, position=[x, y, -0.5]))
        for i, (x, y) in enumerate(places)
    ]
    pairs = [] if surface is None else [(one.name, surface.name) for one in stands]
    law = LinearLaw(1e8, 1e6)
    scene = Scene(
        bodies=(body,),
        forces=(Gravity(np.array([0.0, 0.0, -G])),) if surface is not None else (),
        surfaces=() if surface is None else (*stands, surface),
        collisions=tuple(
            Collision(name=f"on {a}", surfaces=(a, b), law=law, patch_size=2.0) for a, b in pairs
        ),
    )
    simulation = Simulation(scene, STEP, record_every=100)
    simulation.advance(200)
    best = np.inf
    for _ in range(5):
        begin = time.thread_time()
        simulation.advance(200)
        best = min(best, (time.thread_time() - begin) / 200)
    return 1e6 * best


def main() -> None:
    """Print the table."""
    print("surface nodes  modes     rigid  flexible  without contact  swinging   [us a step]")
    for cells, modes in ((40, 10), (40, 40), (80, 40), (116, 40), (116, 100)):
        reduced = reduced_slab(cells, modes)
        made = body_surface(reduced, "skin")
        start = {"position": np.array([0.0, 0.0, 0.5 * SIZE[2]])}
        damped = np.full(modes, 0.1)
        flexible = FlexibleBody("slab", reduced, damping_ratio=damped, **start)
        mass, inertia = reduced.integrals.mass, reduced.integrals.inertia_kl
        rigid = RigidBody("slab", mass, np.trace(inertia) * np.eye(3) - inertia, **start)
        swings = FlexibleBody("slab", reduced, modal_velocity=np.full(modes, 0.02 * np.sqrt(mass)), **start)
        own = CollisionSurface(name="skin", body="slab", surface=made.surface, nodes=made.nodes)
        plain = CollisionSurface(name="skin", body="slab", surface=made.surface)
        times = cost(rigid, plain), cost(flexible, own), cost(flexible, None), cost(swings, own)
        print(
            f"{len(made.nodes):13d} {modes:6d} {times[0]:9.0f} {times[1]:9.0f} {times[2]:16.1f} {times[3]:9.0f}"
        )


if __name__ == "__main__":
    main()
