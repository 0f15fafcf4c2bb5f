"""Bicubic shell elements with strains of Green-Lagrange: forces, stiffness, energy and stresses.

"Integrated simulation ... (2018)", section 2.3, with two corrections: forces are the gradient of an energy
(eq. 131 mixes strain measures), and covariant components of strain serve elements that are not rectangular.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, cross, dot, scaled
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
    measure_drift,
    measure_strain_energy,
    record_elements,
)
from heavylift.solver.bodies.ancf.kind import ShellMeshes
from heavylift.solver.bodies.ancf.record import write_nodes
from heavylift.solver.bodies.ancf.shell_data import (
    LANES,
    STRAINS_PER_LINE,
    STRESS_PLACES,
    shell_data,
    shell_line,
    shell_tables,
)
from heavylift.solver.bodies.ancf.shell_lanes import (
    add_element_forces,
    add_element_pressure,
    add_element_rates,
    put_element_strains,
)
from heavylift.solver.bodies.ancf.shell_lanes_stiffness import BLOCK_ORDER, add_element_stiffness
from heavylift.solver.kinds import implement
from heavylift.solver.recording import part

__all__: list[str] = []

Four = tuple[int, int, int, int]


@kernel(inline=True, internal=True)
def node_places(kind: ShellMeshes, element: int) -> Four:
    """Where the nodes of an element begin in a nodal vector."""
    nodes = kind.elements[element].nodes
    return nodes[0], nodes[1], nodes[2], nodes[3]


@implement(find_strains, ShellMeshes)
@kernel(internal=True)
def find_shell_strains(kind: ShellMeshes, body: int, q: Floats1, strain: Floats1) -> None:
    """``E_ab = (r_a.r_b - X_a.X_b)/2``."""
    tables, first = kind.table[body].constants, kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        n0, n1, n2, n3 = node_places(kind, e)
        data, at = kind.elements[e].data, kind.elements[e].strain
        put_element_strains(kind.constants, tables, kind.constants, data, q, n0, n1, n2, n3, strain, at)


@implement(add_strain_rates, ShellMeshes)
@kernel(internal=True)
def add_shell_rates(
    kind: ShellMeshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float
) -> None:
    """``B v``: ``(r_a.v_b + v_a.r_b)/2``."""
    tables, first = kind.table[body].constants, kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        n0, n1, n2, n3 = node_places(kind, e)
        data, at = kind.elements[e].data, kind.elements[e].strain
        add_element_rates(
            kind.constants, tables, kind.constants, data,
            q, n0, n1, n2, n3, v, n0, n1, n2, n3,
            strain, at, factor,
        )  # fmt: skip


@implement(add_stress_forces, ShellMeshes)
@kernel(internal=True)
def add_shell_forces(
    kind: ShellMeshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    """``int N_ab r_a.dr_b``, N by strain."""
    tables, first = kind.table[body].constants, kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        n0, n1, n2, n3 = node_places(kind, e)
        data, at = kind.elements[e].data, kind.elements[e].strain
        add_element_forces(
            kind.constants, tables, kind.constants, data,
            q, n0, n1, n2, n3, strain, at,
            force, n0, n1, n2, n3, factor,
        )  # fmt: skip


@implement(add_stiffness, ShellMeshes)
@kernel(internal=True)
def add_shell_stiffness(
    kind: ShellMeshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    """Forces, and stiffness into the blocks, element by element while its numbers are at hand."""
    tables, first = kind.table[body].constants, kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        n0, n1, n2, n3 = node_places(kind, e)
        data, at = kind.elements[e].data, kind.elements[e].strain
        add_element_forces(
            kind.constants, tables, kind.constants, data,
            q, n0, n1, n2, n3, strain, at,
            force, n0, n1, n2, n3, factor,
        )  # fmt: skip
        add_element_stiffness(
            kind.constants, tables, kind.constants, data,
            q, n0, n1, n2, n3, strain, at,
            kind.elements[e].blocks, 0, kind.blocks, 0, BLOCK_ORDER, 0, scale, geometric,
        )  # fmt: skip


@implement(measure_strain_energy, ShellMeshes)
@kernel(internal=True, reassociate=True)
def measure_shell_energy(kind: ShellMeshes, body: int, strain: Floats1) -> None:
    """``e^T D e / 2`` over all Gauss points."""
    count = shell_tables(kind.constants, kind.table[body].constants).count
    first, total = kind.table[body].first_element, 0.0
    for element in range(first, first + kind.table[body].element_count):
        for line in range(count):
            at = kind.elements[element].strain + line * STRAINS_PER_LINE
            D = shell_line(kind.constants, kind.elements[element].data, line).moduli
            for g in range(LANES):
                x, y, z = strain[at + g], strain[at + 8 + g], strain[at + 16 + g]
                squares = D[0, g] * x * x + D[1, g] * y * y + D[2, g] * z * z
                mixed = D[3, g] * x * y + (D[4, g] * x + D[5, g] * y) * z
                total += 0.5 * squares + mixed
    kind.body[body].elastic_energy += total


@implement(measure_drift, ShellMeshes)
@kernel(internal=True)
def measure_shell_drift(kind: ShellMeshes, body: int, first: Floats1, second: Floats1) -> None:
    """Differences per length squared of the mesh lines they belong to, which makes them strains."""
    count = shell_tables(kind.constants, kind.table[body].constants).count
    begin, largest, found, lost, strained = kind.table[body].first_element, -1.0, 0, 0.0, 0.0
    for element in range(begin, begin + kind.table[body].element_count):
        before = largest
        for line in range(count):
            at = kind.elements[element].strain + line * STRAINS_PER_LINE
            metric = shell_line(kind.constants, kind.elements[element].data, line).metric
            for g in range(count):
                xx, yy = 2.0 * metric[0, g], 2.0 * metric[1, g]
                d1 = abs(first[at + g] - second[at + g]) / xx
                d2 = abs(first[at + 8 + g] - second[at + 8 + g]) / yy
                d3 = abs(first[at + 16 + g] - second[at + 16 + g])
                largest = max(largest, d1, d2, d3 / math.sqrt(xx * yy))
                s1, s2, s3 = abs(second[at + g]), abs(second[at + 8 + g]), abs(second[at + 16 + g])
                strained = max(strained, s1 / xx, s2 / yy, s3 / math.sqrt(xx * yy))
                lost += 0.0 * (d1 + d2 + d3)  # NaN, which `max` passes over
        if largest > before:
            found = element - begin
    kind.body[body].drift, kind.body[body].strained = max(largest, 0.0) + lost, strained
    kind.body[body].drift_element = found


@implement(add_follower_load, ShellMeshes)
@kernel(internal=True)
def add_shell_pressure(
    kind: ShellMeshes, body: int, q: Floats1, element: int, load: Floats1, data: int, factor: float
) -> None:
    """Pressure along ``r_xi x r_eta`` on the present area."""
    n0, n1, n2, n3 = node_places(kind, element)
    add_element_pressure(
        kind.constants, kind.table[body].constants, kind.constants, kind.elements[element].data,
        q, n0, n1, n2, n3, load, n0, n1, n2, n3, factor * kind.constants[data],
    )  # fmt: skip


@kernel(inline=True, internal=True)
def centre_vector(kind: ShellMeshes, element: int, row: NDArray[np.float64]) -> Vector:
    """A row of the centre of an element times its carried coordinates."""
    x = y = z = 0.0
    for node in range(4):
        at = kind.elements[element].nodes[node]
        for vector in range(4):
            value, first = row[4 * node + vector], at + 3 * vector
            x += value * kind.position[first]
            y += value * kind.position[first + 1]
            z += value * kind.position[first + 2]
    return x, y, z


@kernel(internal=True)
def _across(kind: ShellMeshes, element: int, lengths: Floats1, along_x: Floats1, function: int) -> Vector:
    """What multiplies a function of eta on a line along it: four functions of xi times the carried coordinates.

    A derivative by xi comes from derivatives in `along_x`; all are those on a unit square.
    """
    side, slope = function // 2, function % 2
    x = y = z = 0.0
    for end in range(2):
        first = kind.elements[element].nodes[end if side == 0 else 3 - end] + 6 * slope
        scale = lengths[1] if slope == 1 else 1.0
        value, rate = scale * along_x[2 * end], scale * lengths[0] * along_x[2 * end + 1]
        x += value * kind.position[first] + rate * kind.position[first + 3]
        y += value * kind.position[first + 1] + rate * kind.position[first + 4]
        z += value * kind.position[first + 2] + rate * kind.position[first + 5]
    return x, y, z


@kernel(inline=True, internal=True)
def _sum(h: Floats1, a: Vector, b: Vector, c: Vector, d: Vector) -> Vector:
    return add_scaled(add_scaled(add_scaled(scaled(h[0], a), h[1], b), h[2], c), h[3], d)


@kernel(inline=True, internal=True)
def _square(xx: float, yy: float, xy: float) -> float:
    """Square of the von Mises stress of plane stress."""
    return xx * xx - xx * yy + yy * yy + 3.0 * xy * xy


@kernel(internal=True)
def largest_stresses(kind: ShellMeshes, body: int, element: int) -> Vector:
    """Von Mises stress of top, middle and bottom, each the largest of the places of an element.

    Covariant strains ``(r_a.r_b - X_a.X_b)/2`` and curvatures ``n.r_ab``, turned into orthonormal axes by the inverse
    of ``[[p, 0], [q, s]]`` from both sides, with ``X_1 = p t_1`` and ``X_2 = q t_1 + s t_2``. A fibre at the height z
    has the strain of the middle less z times the curvature.
    """
    own = shell_data(kind.constants, kind.elements[element].data)
    places = shell_tables(kind.constants, kind.table[body].constants).places
    lengths, nu, half = own.lengths, own.poissons_ratio, 0.5 * own.thickness
    plane = own.stretching / own.thickness
    top = middle = bottom = lost = 0.0
    for i in range(STRESS_PLACES):
        h, dh, ddh = places[i, 0], places[i, 1], places[i, 2]
        a0, a1 = _across(kind, element, lengths, h, 0), _across(kind, element, lengths, h, 1)
        a2, a3 = _across(kind, element, lengths, h, 2), _across(kind, element, lengths, h, 3)
        b0, b1 = _across(kind, element, lengths, dh, 0), _across(kind, element, lengths, dh, 1)
        b2, b3 = _across(kind, element, lengths, dh, 2), _across(kind, element, lengths, dh, 3)
        c0, c1 = _across(kind, element, lengths, ddh, 0), _across(kind, element, lengths, ddh, 1)
        c2, c3 = _across(kind, element, lengths, ddh, 2), _across(kind, element, lengths, ddh, 3)
        for j in range(STRESS_PLACES):
            g, dg, ddg = places[j, 0], places[j, 1], places[j, 2]
            r1, r2 = _sum(g, b0, b1, b2, b3), _sum(dg, a0, a1, a2, a3)
            n = cross(r1, r2)
            inverse = 1.0 / math.sqrt(dot(n, n))
            p, q, s = own.axes[i, j, 0], own.axes[i, j, 1], own.axes[i, j, 2]
            e11, e12 = 0.5 * (dot(r1, r1) - p * p), 0.5 * (dot(r1, r2) - p * q)
            e22 = 0.5 * (dot(r2, r2) - q * q - s * s)
            k11 = -half * inverse * dot(n, _sum(g, c0, c1, c2, c3))
            k22 = -half * inverse * dot(n, _sum(ddg, a0, a1, a2, a3))
            k12 = -half * inverse * dot(n, _sum(dg, b0, b1, b2, b3))
            skew, xx_, yy_, xy_ = q / p, 1.0 / (p * p), 1.0 / (s * s), 1.0 / (p * s)
            ex, kx = xx_ * e11, xx_ * k11
            ey = yy_ * (e22 - skew * (2.0 * e12 - skew * e11))
            ky = yy_ * (k22 - skew * (2.0 * k12 - skew * k11))
            mx, my = plane * (ex + nu * ey), plane * (ey + nu * ex)
            bx, by = plane * (kx + nu * ky), plane * (ky + nu * kx)
            shear = plane * (1.0 - nu) * xy_
            mxy, bxy = shear * (e12 - skew * e11), shear * (k12 - skew * k11)
            top = max(top, _square(mx + bx, my + by, mxy + bxy))
            middle = max(middle, _square(mx, my, mxy))
            bottom = max(bottom, _square(mx - bx, my - by, mxy - bxy))
            lost += 0.0 * (mx + my + mxy + bx + by + bxy)  # NaN, which `max` passes over
    return math.sqrt(top) + lost, math.sqrt(middle) + lost, math.sqrt(bottom) + lost


@implement(record_elements, ShellMeshes)
@kernel(internal=True)
def record_shell(kind: ShellMeshes, body: int, row: Floats1) -> None:
    """Vectors and velocities of nodes; forces and moments at the centres of elements, largest equivalent stresses.

    Axes are those of the surface, the first along ``X_xi`` of the unloaded shape. Curvatures are ``n.r_ab`` with
    ``n`` along ``r_1 x r_2``; a fibre at the height z along n has the strain of the middle less z times the curvature.
    """
    entry, parts, begin = kind.table[body], kind.table[body].parts, kind.table[body].first_element
    write_nodes(kind, body, kind.position, 0, 1.0, part(row, parts.position))
    write_nodes(kind, body, kind.position, 1, 0.0, part(row, parts.slope_x))
    write_nodes(kind, body, kind.position, 2, 0.0, part(row, parts.slope_y))
    write_nodes(kind, body, kind.position, 3, 0.0, part(row, parts.twist))
    write_nodes(kind, body, kind.velocity, 0, 0.0, part(row, parts.velocity))
    forces, moments = part(row, parts.membrane_force), part(row, parts.bending_moment)
    stresses = part(row, parts.von_mises)
    for e in range(entry.element_count):
        own = shell_data(kind.constants, kind.elements[begin + e].data)
        stretch, nu, bend = own.stretching, own.poissons_ratio, own.plate_stiffness
        a = centre_vector(kind, begin + e, own.centre[0])
        b = centre_vector(kind, begin + e, own.centre[1])
        xx, yy, xy = 0.5 * (dot(a, a) - 1.0), 0.5 * (dot(b, b) - 1.0), 0.5 * dot(a, b)
        Nx, Ny, Nxy = stretch * (xx + nu * yy), stretch * (yy + nu * xx), stretch * (1.0 - nu) * xy
        n = cross(a, b)
        length = math.sqrt(dot(n, n))
        kx = dot(n, centre_vector(kind, begin + e, own.centre[2])) / length
        ky = dot(n, centre_vector(kind, begin + e, own.centre[3])) / length
        kxy = dot(n, centre_vector(kind, begin + e, own.centre[4])) / length
        Mx, My, Mxy = bend * (kx + nu * ky), bend * (ky + nu * kx), bend * (1.0 - nu) * kxy
        at = 3 * e
        forces[at], forces[at + 1], forces[at + 2] = Nx, Ny, Nxy
        moments[at], moments[at + 1], moments[at + 2] = Mx, My, Mxy
        stresses[at], stresses[at + 1], stresses[at + 2] = largest_stresses(kind, body, begin + e)
