"""Mesh of the ring, eight-node bricks, and matrices of the nodes of its inner face.

Writes ring.inp, and inner.txt and inner_seam_up.txt, which begin at the bottom and at the top.

    python make_mesh.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
INNER, OUTER, WIDTH = 0.5, 0.53, 0.06  # m
AROUND, ACROSS, THROUGH = 96, 6, 2  # bricks


def main():
    """Nodes in the order around, across, through, from the bottom on."""
    angle = -0.5 * np.pi + 2.0 * np.pi * np.arange(AROUND) / AROUND
    z = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, ACROSS + 1)
    r = np.linspace(INNER, OUTER, THROUGH + 1)
    a, b, c = (grid.ravel() for grid in np.meshgrid(angle, z, r, indexing="ij"))
    nodes = np.column_stack([c * np.cos(a), c * np.sin(a), b])
    number = np.arange(len(nodes)).reshape(AROUND, ACROSS + 1, THROUGH + 1)
    lines = ["*NODE", *(f"{n + 1}, {x:.15g}, {y:.15g}, {w:.15g}" for n, (x, y, w) in enumerate(nodes))]
    lines.append("*ELEMENT, TYPE=C3D8")
    element = 0
    for i in range(AROUND):
        j = (i + 1) % AROUND
        for k in range(ACROSS):
            for m in range(THROUGH):
                # right-handed: along r, along the angle, along z
                ring = [(i, k, m), (i, k, m + 1), (j, k, m + 1), (j, k, m)]
                corners = ring + [(p, q + 1, s) for p, q, s in ring]
                element += 1
                lines.append(", ".join(map(str, [element, *(number[corner] + 1 for corner in corners)])))
    (HERE / "ring.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")
    # rows around; normal (along the angle) x (along z) is outwards, so columns go down to point to the axis
    rows = [",".join(str(n + 1) for n in number[i, ::-1, 0]) for i in range(AROUND)]
    for name, first in (("inner.txt", 0), ("inner_seam_up.txt", AROUND // 2)):
        text = ";".join(rows[first:] + rows[:first])
        (HERE / name).write_text(f"[{text}]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
