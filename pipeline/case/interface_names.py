"""Names of interfaces in place of points: the reference point of the interface is put there before all else is read."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["POINTS", "put_interface_points"]

POINTS = {"point": "body", "point_a": "body_a", "point_b": "body_b"}
"""Keys of points, and those of the bodies that these are on; where two are named together, ``between`` has them."""

_UNREAD = ("bodies", "repeat")
"""Tables without such points, or that have been written out."""


def put_interface_points(document: dict[str, Any], file: Path) -> tuple[dict[str, Any], list[InputError]]:
    """Put reference points of interfaces where their names stand for points of a body.

    Parameters
    ----------
    document
        As read from TOML, blocks written out; it is not changed.
    file
        Its file, for the messages.

    Returns
    -------
    tuple
        The document, and an error for each name that is not one. Points of such names are the origin, so that nothing
        else is said of them.
    """
    reader = _Reader(document.get("bodies"), file)
    found = {key: value if key in _UNREAD else reader.read(value, key) for key, value in document.items()}
    return found, reader.errors


class _Reader:
    """Walks through the tables of a document."""

    def __init__(self, bodies: Any, file: Path) -> None:
        self._bodies = bodies if isinstance(bodies, dict) else {}
        self._file = file
        self.errors: list[InputError] = []

    def read(self, node: Any, key: str) -> Any:
        if isinstance(node, list):
            return [self.read(value, f"{key}.{index}") for index, value in enumerate(node)]
        if not isinstance(node, dict):
            return node
        return {name: self._entry(node, name, value, f"{key}.{name}") for name, value in node.items()}

    def _entry(self, table: dict[str, Any], name: str, value: Any, key: str) -> Any:
        between = table.get("between")
        sides = between if isinstance(between, list) and len(between) == 2 else [table.get("body")] * 2
        if name in POINTS and isinstance(value, str):
            body = table.get(POINTS[name], sides[name == "point_b"])
            return self._point(body, value, key)
        if name == "points" and isinstance(value, list):
            bodies = sides if sides is between else [table.get("body")] * len(value)
            return [
                self._point(bodies[i], one, f"{key}.{i}")
                if isinstance(one, str) and i < len(bodies)
                else self.read(one, f"{key}.{i}")
                for i, one in enumerate(value)
            ]
        return self.read(value, key)

    def _point(self, body: Any, name: str, key: str) -> Any:
        """Reference point of an interface of a body."""
        if not isinstance(body, str):
            return name
        table = self._bodies.get(body)
        interfaces = table.get("interfaces") if isinstance(table, dict) else None
        known = interfaces if isinstance(interfaces, dict) else {}
        interface = known.get(name)
        if isinstance(interface, dict) and "at" in interface:
            return interface["at"]
        if isinstance(interface, dict):
            problem = (
                f"interface {name!r} of {body!r} has no reference point that is known before its group is"
            )
            expected = f"'at' in [bodies.{body}.interfaces.{name}], where its name is used"
        else:
            near = get_close_matches(name, known, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            problem = f"{body!r} has no interface {name!r}{hint}"
            names = f", or one of {', '.join(sorted(known))}" if known else ""
            expected = f"a point of three lengths{names}"
        self.errors.append(InputError(problem, source=self._file, key=key, expected=expected))
        return [0.0, 0.0, 0.0]
