"""A part of a double bottom as a deck of plates, bars, rigid elements and masses; writes block.bdf and steel.bdf.

    python make_deck.py

Axes: x forward, y to port, z up, origin in the middle of the aft lower edge; mm, t, s, N. All three kinds of fields
occur.
"""

from __future__ import annotations

from pathlib import Path

HERE = Path(__file__).resolve().parent

LENGTH, WIDTH, HEIGHT, SIZE = 6000.0, 4000.0, 1000.0, 500.0
GIRDERS, FLOORS = (-2000.0, 0.0, 2000.0), (0.0, 2000.0, 4000.0, 6000.0)
STIFFENERS = (-1500.0, -1000.0, -500.0, 500.0, 1000.0, 1500.0)
BOTTOM, TOP = 1, 2  # properties, and those of girders and floors
GIRDER, FLOOR = 3, 4
THICKNESS = {BOTTOM: 12.0, TOP: 10.0, GIRDER: 10.0, FLOOR: 10.0}
LUGS = {11: (0, -1), 12: (3, -1), 13: (3, 1), 14: (0, 1)}  # sets of nodes: number of the floor, side


def steps(first: float, last: float) -> list[float]:
    """Coordinates of nodes from one to another [mm]."""
    return [first + SIZE * k for k in range(round((last - first) / SIZE) + 1)]


class Deck:
    """Nodes by position, and entries of elements."""

    def __init__(self) -> None:
        self.nodes: dict[tuple[float, float, float], int] = {}
        self.elements: list[str] = []

    def node(self, x: float, y: float, z: float) -> int:
        """Number of the node at a place."""
        return self.nodes.setdefault((x, y, z), len(self.nodes) + 1)

    def plate(self, property_id: int, corners: list[tuple[float, float, float]]) -> None:
        """Add a CQUAD4."""
        nodes = "".join(f"{self.node(*corner):8d}" for corner in corners)
        self.elements.append(f"CQUAD4  {len(self.elements) + 1:8d}{property_id:8d}{nodes}")

    def bar(
        self, property_id: int, a: tuple[float, ...], b: tuple[float, ...], up: float, offset: float
    ) -> None:
        """Add a CBAR whose web stands up or down, off its nodes by an offset along z."""
        ends = f"{self.node(*a)},{self.node(*b)}"
        number = len(self.elements) + 1
        self.elements.append(
            f"CBAR,{number},{property_id},{ends},0.,0.,{up:.1f}\n,,,0.,0.,{offset:.1f},0.,0.,{offset:.1f}"
        )


def block() -> Deck:
    """Plates, girders, floors and stiffeners."""
    deck = Deck()
    xs, ys, zs = steps(0.0, LENGTH), steps(-WIDTH / 2, WIDTH / 2), steps(0.0, HEIGHT)
    for z, property_id in ((0.0, BOTTOM), (HEIGHT, TOP)):
        for x in xs[:-1]:
            for y in ys[:-1]:
                square = [(x, y, z), (x + SIZE, y, z), (x + SIZE, y + SIZE, z), (x, y + SIZE, z)]
                deck.plate(property_id, square)
    for y in GIRDERS:
        for x in xs[:-1]:
            for z in zs[:-1]:
                deck.plate(GIRDER, [(x, y, z), (x + SIZE, y, z), (x + SIZE, y, z + SIZE), (x, y, z + SIZE)])
    for x in FLOORS:
        for y in ys[:-1]:
            for z in zs[:-1]:
                deck.plate(FLOOR, [(x, y, z), (x, y + SIZE, z), (x, y + SIZE, z + SIZE), (x, y, z + SIZE)])
    for y in STIFFENERS:  # flat bars 120 x 12 inside, their feet on the plates
        for x in xs[:-1]:
            deck.bar(5, (x, y, 0.0), (x + SIZE, y, 0.0), 1.0, (THICKNESS[BOTTOM] + 120.0) / 2)
            deck.bar(5, (x, y, HEIGHT), (x + SIZE, y, HEIGHT), -1.0, -(THICKNESS[TOP] + 120.0) / 2)
    return deck


def main() -> None:
    """Write both files."""
    deck = block()
    lugs = {
        number: [deck.node(FLOORS[i] + dx, 2000.0 * side, HEIGHT) for dx in lug_line(i)]
        for number, (i, side) in LUGS.items()
    }
    pump = [deck.node(x, y, HEIGHT) for x in (1500.0, 2000.0, 2500.0) for y in (-500.0, 0.0, 500.0)]
    tank = [deck.node(x, y, HEIGHT) for x in (4500.0, 5500.0) for y in (500.0, 1500.0)]
    count = len(deck.nodes)
    text = "SOL 103\nCEND\nTITLE = part of a double bottom\nBEGIN BULK\nINCLUDE 'steel.bdf'\n"
    for (x, y, z), number in deck.nodes.items():
        text += f"GRID    {number:8d}        {x:8.1f}{y:8.1f}{z:8.1f}\n"
    text += "$ a pump of 2.5 t, 0.6 m above its seat of 1 x 1 m\n"
    text += f"GRID,{count + 1},,2000.,0.,1600.\n"
    text += rbe2(9001, count + 1, pump)
    text += f"CONM2,9002,{count + 1},,2.5\n,3.+5,,4.+5,,,5.+5\n"
    text += "$ a tank of 1.5 t that does not stiffen what it stands on; its centre is beside the node\n"
    text += f"GRID*   {count + 2:16d}                {5000.0:16.4f}{1000.0:16.4f}\n*       {HEIGHT:16.4f}\n"
    text += f"RBE3,9003,,{count + 2},123456,1.,123,{','.join(map(str, tank[:2]))}\n,{','.join(map(str, tank[2:]))}\n"
    text += f"CONM2,9004,{count + 2},,1.5,0.,0.,800.\n"
    text += "\n".join(deck.elements) + "\n"
    for number, nodes in lugs.items():
        text += f"SET1,{number},{','.join(map(str, nodes))}\n"
    text += "SPC1,1,123456,1\nPLOTEL,9005,1,2\nENDDATA\n"
    (HERE / "block.bdf").write_text(text)
    (HERE / "steel.bdf").write_text(steel())


def lug_line(floor: int) -> tuple[float, ...]:
    """A line of 1 m along the girder from the end of the block [mm]."""
    return (0.0, SIZE, 2 * SIZE) if floor == 0 else (-2 * SIZE, -SIZE, 0.0)


def rbe2(number: int, node: int, others: list[int]) -> str:
    """RBE2 over as many lines as it needs."""
    words = ["RBE2", str(number), str(node), "123456", *map(str, others)]
    lines = [words[:9], *(["", *words[k : k + 8]] for k in range(9, len(words), 8))]
    return "\n".join(",".join(line) for line in lines) + "\n"


def steel() -> str:
    """Material and properties."""
    text = "MAT1*   1               206000.                         .3\n*       7.85-9\n"
    for number, thickness in THICKNESS.items():
        outfit = ",3.-8" if number == TOP else ""  # 30 kg/m2
        text += f"PSHELL,{number},1,{thickness},1,,1,{outfit}\n"
    return text + "PBARL,5,1,,BAR\n,12.,120.\n"


if __name__ == "__main__":
    main()
