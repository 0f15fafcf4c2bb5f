"""What a tree of boxes and exclusion boxes are worth: the published comparisons, as ratios on this machine.

    python benchmarks/collision_tables.py

One step of detection, medians of CPU time after compilation, against the times printed in *Integrated simulation ...
ships and offshore structures* (2018), Tables 2-3 to 2-5: theirs are of another machine, so what compares are the ratios
of a column. *All pairs* tests every triangle of one surface against every one of the other; *tree* searches both trees
anew; *list* finds the pairs of the step before still valid. Contacts are those found in the step, the same in every row
of a table, unless triangles that touch are left out.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "contours"))

from collision_kernels import contacts_kernel
from collision_scenes import models, query

from heavylift.contours.triangles.feature_pairs import SWEPT, contacts_of_pairs
from heavylift.contours.triangles.feature_report import make_contact_list
from heavylift.contours.triangles.pair_list import make_pair_lists
from heavylift.contours.triangles.surface_layout import RelativeMotion
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import record_at
from heavylift.preprocess.surfaces.exclusion import ExclusionBox, exclude

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

CAPACITY = 8192
REACH = 0.0  # m
WIDE = np.inf


motion_at = record_at(RelativeMotion)


@kernel
def all_pairs_kernel(surfaces, pairs, motion, reach, out):
    return contacts_of_pairs(surfaces, 0, 1, pairs, motion_at(motion, 0), reach, 0.0, SWEPT, True, out)


class Step:
    """One step of two surfaces: number of contacts, and time [ms] of finding them.

    Parameters
    ----------
    a, b, motion
        Surfaces, and the motion of B in the axes of A.
    """

    def __init__(self, a: TriangleSurface, b: TriangleSurface, motion: NDArray[np.float64]) -> None:
        self._surfaces = pack_surfaces([a, b])
        self._lists = make_pair_lists(self._surfaces, [(0, 1)])
        self._counts = len(a.triangles), len(b.triangles)
        self._motion = motion
        self._found = make_contact_list(CAPACITY)
        self.contacts = self._on_list()

    def _on_list(self) -> int:
        return int(
            contacts_kernel(self._surfaces, self._lists, 0, self._motion, REACH, SWEPT, True, self._found)
        )

    def _fresh(self) -> int:
        self._lists.table[0].count = -1
        return self._on_list()

    def tree(self) -> float:
        """With trees that are searched anew."""
        return median(self._fresh, 31)

    def list(self) -> float:
        """With pairs that are known."""
        return median(self._on_list, 31)

    def all_pairs(self) -> float:
        """Every triangle against every one."""
        grid = np.meshgrid(*(np.arange(n) for n in self._counts[::-1]), indexing="ij")  # first triangles of A
        pairs = np.ascontiguousarray(np.column_stack([grid[1].ravel(), self._counts[0] + grid[0].ravel()]))

        def ask() -> int:
            return int(all_pairs_kernel(self._surfaces, pairs, self._motion, REACH, self._found))

        found = ask()
        if found != self.contacts:
            raise RuntimeError(f"{found} contacts of all pairs, {self.contacts} with trees")
        return median(ask, 5)


def median(function: Callable[[], int], repeats: int) -> float:
    """CPU time [ms]."""
    function()
    times = []
    for _ in range(repeats):
        begin = time.thread_time()
        function()
        times.append(time.thread_time() - begin)
    return 1e3 * float(np.median(times))


def show(title: str, rows: list[tuple[str, int, int, float, float | None]]) -> None:
    """A table: what, triangles, contacts, time, published time; ratios are those to the first row."""
    print(f"\n{title}")
    print(
        f"{'':34s}{'triangles':>10s}{'contacts':>9s}{'ms':>10s}{'ratio':>8s}{'published ms':>14s}{'ratio':>8s}"
    )
    first, published = rows[0][3], rows[0][4]
    for text, triangles, contacts, ms, theirs in rows:
        line = f"{text:34s}{triangles:10d}{contacts:9d}{ms:10.4f}{100.0 * ms / first:7.1f}%"
        if theirs is not None and published is not None:
            line += f"{theirs:14.0f}{100.0 * theirs / published:7.1f}%"
        print(line)


def bunnies() -> None:
    """Tables 2-3 and 2-4."""
    a, b, motion = query("bunny_bunny")
    step = Step(a, b, motion)
    n = len(b.triangles)
    show(
        "Table 2-3: bunny against bunny",
        [
            ("all pairs", n, step.contacts, step.all_pairs(), 94.0),
            ("tree", n, step.contacts, step.tree(), 5.0),
            ("list", n, step.contacts, step.list(), None),
        ],
    )
    plane, bunny, motion = query("bunny_plane")
    half, _ = exclude(bunny, [ExclusionBox(np.array([0.0, 0.0, 1.003]), np.array([2.0, 2.0, 2.0]))])
    whole, less = Step(plane, bunny, motion), Step(plane, half, motion)
    rows = []
    for text, step, surface, theirs in (
        ("all pairs", whole, bunny, 7.0),
        ("all pairs, exclusion box", less, half, 3.0),
    ):
        rows.append((text, len(surface.triangles), step.contacts, step.all_pairs(), theirs))
    for text, step, surface in (("tree", whole, bunny), ("tree, exclusion box", less, half)):
        rows.append((text, len(surface.triangles), step.contacts, step.tree(), None))
    show("Table 2-4: bunny on a plane", rows)


def tank() -> None:
    """Table 2-5."""
    plane, whole, motion = query("tank_plane")
    bottom = -8.0
    boxes = (
        ("out: z > 3.6 m", [0.0, 0.0, 13.6], [WIDE, WIDE, 20.0], True, 200.0),
        ("out: z > -2.5 m", [0.0, 0.0, 7.5], [WIDE, WIDE, 20.0], True, 100.0),
        ("stay: 18 x 18 m of the bottom", [0.0, 0.0, bottom], [18.0, 18.0, 0.1], False, 30.0),
        ("stay: 6 x 16 m of the bottom", [0.0, 0.0, bottom], [6.0, 16.0, 0.1], False, 15.0),
    )
    step = Step(plane, whole, motion)
    n = len(whole.triangles)
    tables = {
        "all pairs": [("all triangles", n, step.contacts, step.all_pairs(), 800.0)],
        "tree": [("all triangles", n, step.contacts, step.tree(), 300.0)],
        "list": [("all triangles", n, step.contacts, step.list(), None)],
    }
    for text, centre, size, inside, theirs in boxes:
        part, _ = exclude(whole, [ExclusionBox(np.array(centre), np.array(size), inside=inside)])
        step = Step(plane, part, motion)
        n = len(part.triangles)
        tables["all pairs"].append((text, n, step.contacts, step.all_pairs(), None))
        tables["tree"].append((text, n, step.contacts, step.tree(), theirs))
        tables["list"].append((text, n, step.contacts, step.list(), None))
    for name, rows in tables.items():
        show(f"Table 2-5: tank on a plane, {name}", rows)
    faster = tables["all pairs"][0][3] / tables["tree"][0][3], tables["tree"][0][3] / tables["list"][0][3]
    print(
        f"tree over all pairs: {faster[0]:.1f} times as fast (published 2.7); list over tree: {faster[1]:.2f}"
    )


def hold() -> None:
    """The tank in its hold, where no table is published: exclusion boxes leave what is at chocks and guides."""
    sizes = models("tank_in_hull")
    boxes = [
        ExclusionBox(np.array([x, y, sizes.SUPPORT_LEVEL]), np.array([0.56, 0.86, 0.02]), inside=False)
        for x, y in sizes.CHOCKS
    ] + [
        ExclusionBox(np.array([x, side * sizes.GUIDE_FACE, -1.0]), np.array([0.62, 0.02, 0.82]), inside=False)
        for x, side in sizes.GUIDES
    ]
    for name, title in (
        ("tank_hull", "Tank in hull"),
        ("tank_hull_tilted", "Tank in hull, tilted by 20 deg"),
    ):
        hull, tank, motion = query(name)
        step = Step(hull, tank, motion)
        rows = [
            ("tree", len(tank.triangles), step.contacts, step.tree(), None),
            ("list", len(tank.triangles), step.contacts, step.list(), None),
        ]
        if name == "tank_hull":
            part, _ = exclude(tank, boxes)
            step = Step(exclude(hull, boxes)[0], part, motion)
            rows += [
                ("tree, exclusion boxes", len(part.triangles), step.contacts, step.tree(), None),
                ("list, exclusion boxes", len(part.triangles), step.contacts, step.list(), None),
            ]
        show(title, rows)


def main() -> None:
    """Print the tables."""
    bunnies()
    tank()
    hold()


if __name__ == "__main__":
    main()
