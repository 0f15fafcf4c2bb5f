"""Joints on hulls: ``X = A^-1 G^T`` with the matrix of their group, velocities at the end of the step."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.small import cholesky_factor
from heavylift.solver.bodies.frames.motion import check_frames
from heavylift.solver.interface import Workspace, apply_inverse, check
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.water.hulls.kind import (
    Hulls,
)
from heavylift.solver.water.hulls.matrix import assemble_mass
from heavylift.solver.water.hulls.step import put_end

__all__: list[str] = []

OUTSIDE_DATABASE = int(Outcome.OUTSIDE_DATABASE)


@implement(check, Hulls)
@kernel(internal=True)
def check_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """As rigid bodies; and whether waves and water plane are still those of the database."""
    check_frames(kind, step, work)
    for hull in range(kind.table.shape[0]):
        total = 0.0
        for i in range(6 * hull, 6 * hull + 6):
            total += kind.vectors.wave[i]
        least = kind.hulls[hull].least_volume
        clip = kind.stage[hull].clip
        left = least > 0.0 and (clip.volume < least or not clip.plane_area > 0.0)
        if left or math.isnan(total):
            work.status.outcome = OUTSIDE_DATABASE
            work.status.body = kind.table[hull].number


@implement(apply_inverse, Hulls)
@kernel(internal=True)
def apply_inverse_of_hulls(kind: Hulls, at_midpoint: bool, system: RowArrays) -> None:
    """Of the attachments on these bodies; at the end of the step by the mass alone, which is factored here."""
    last = kind.table[kind.table.shape[0] - 1].dof
    if not at_midpoint:
        for hull in range(kind.table.shape[0]):
            put_end(kind, hull, kind.stage[hull].heading)
        for group in range(kind.groups.shape[0]):
            n = 6 * kind.groups[group].count
            base = kind.groups[group].matrix + n * n
            assemble_mass(kind, group, base, True, 0.0)
            cholesky_factor(kind.matrices[base : base + n * n], n)
    for i in range(system.attachments.shape[0]):
        dof = system.attachments[i].dof
        if dof < kind.table[0].dof or dof > last:
            continue
        for group in range(kind.groups.shape[0]):
            if kind.groups[group].dof == dof:
                n = 6 * kind.groups[group].count
                base = kind.groups[group].matrix + (0 if at_midpoint else n * n)
                _solve_panel(kind, base, n, system, system.attachments[i].panel)


@kernel(internal=True)
def _solve_panel(kind: Hulls, base: int, n: int, system: RowArrays, panel: int) -> None:
    """``L L^T X = G^T``, all rows of a joint at once."""
    lanes = system.lanes
    G, factor = system.panels, kind.matrices
    out = G.shape[0] // 2 + panel
    for i in range(n):
        for r in range(lanes):
            G[out + i * lanes + r] = G[panel + i * lanes + r]
        for k in range(i):
            a = factor[base + i * n + k]
            for r in range(lanes):
                G[out + i * lanes + r] -= a * G[out + k * lanes + r]
        inverse = factor[base + i * n + i]
        for r in range(lanes):
            G[out + i * lanes + r] *= inverse
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            a = factor[base + k * n + i]
            for r in range(lanes):
                G[out + i * lanes + r] -= a * G[out + k * lanes + r]
        inverse = factor[base + i * n + i]
        for r in range(lanes):
            G[out + i * lanes + r] *= inverse
