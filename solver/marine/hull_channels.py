"""Channels of a hull beside those of a rigid body."""

from __future__ import annotations

from heavylift.solver.channels import XYZ

__all__ = ["HULL_CHANNELS", "record_width"]

HULL_CHANNELS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("displaced_volume", "m^3", ("displaced_volume",)),
    ("buoyancy_centre", "m", XYZ),
    ("ballast", "kg", ("ballast",)),
    ("wave_elevation", "m", ("wave_elevation",)),
    ("wave_force", "N", XYZ),
    ("wave_moment", "N m", XYZ),
    ("radiation_force", "N", XYZ),
    ("radiation_moment", "N m", XYZ),
)
"""Name, unit and components, in the order of a record: forces in heading axes, moments about the reference point;
the wave elevation is that of the undisturbed waves at the low-passed place of the reference point."""


def record_width() -> int:
    """Columns of a hull in a record: those of a free rigid body, then its own."""
    return 13 + sum(len(components) for _, _, components in HULL_CHANNELS)
