"""What is in use of the room for contacts, of which a scene has more than ever touch at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.contact.kind import ContactRows

__all__ = ["words_in_use"]


def words_in_use(
    contacts: ContactRows, arrays: dict[str, NDArray[Any]]
) -> dict[str, tuple[NDArray[Any], int]]:
    """Views of the contacts that there are.

    Parameters
    ----------
    contacts
        The contacts of a scene.
    arrays
        What is carried of them, as flat arrays of numbers, by kind and field.

    Returns
    -------
    dict
        By the names of those that have a row for each contact: the rows in use, and the numbers in a row.
    """
    used, found = int(contacts.counts.total), {}
    for field in ("rows", "state"):
        name = f"{type(contacts).__name__}.{field}"
        words = arrays[name].size // len(getattr(contacts, field))
        found[name] = (arrays[name][: used * words], words)
    return found
