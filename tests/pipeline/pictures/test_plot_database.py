"""Plots of a hydrodynamic database."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.pictures.hull_plots import (
    added_mass_plot,
    damping_plot,
    database_plots,
    excitation_plot,
)
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

CASES = Path(__file__).parents[3] / "cases"


@pytest.fixture(scope="module")
def pair():
    return read_netcdf(CASES / "two_barges" / "two_barges.nc")


def panels_with_ink(png, colour):
    """Which of 2 x 3 parts of the picture have the colour of a curve."""
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    hit = np.abs(pixels - np.array(colour)).sum(axis=2) < 30
    height, width = hit.shape
    parts = hit[: int(0.92 * height)]
    return [
        bool(part.sum() > 20)
        for row in np.array_split(parts, 2, axis=0)
        for part in np.array_split(row, 3, axis=1)
    ], (height, width)


@pytest.mark.slow
def test_every_hull_has_three_plots(pair):
    plots = database_plots(pair)
    kinds = ("added_mass", "damping", "excitation")
    assert sorted(plots) == sorted(f"{body}_{kind}" for body in ("aft", "fore") for kind in kinds)
    for png in plots.values():
        assert png.startswith(b"\x89PNG")


@pytest.mark.slow
def test_own_and_coupled_entries_are_drawn_in_all_panels(pair):
    for png in (added_mass_plot(pair, "aft"), damping_plot(pair, "aft")):
        own, size = panels_with_ink(png, (0x1F, 0x5F, 0xA8))
        coupled, _ = panels_with_ink(png, (0x2E, 0x8B, 0x57))
        assert all(own)
        assert all(coupled)
        assert size == (616, 1100)


@pytest.mark.slow
def test_headings_are_the_nearest_of_the_database(pair):
    """One curve for each heading that differs: 44 and 45 degrees are the same column."""
    one = excitation_plot(pair, "fore", np.deg2rad([40.0]))
    same = excitation_plot(pair, "fore", np.deg2rad([40.0, 41.0]))
    two = excitation_plot(pair, "fore", np.deg2rad([40.0, 50.0]))
    assert one == same
    assert one != two


def test_a_hull_that_is_not_there(pair):
    with pytest.raises(InputError, match="no hull 'crane'"):
        damping_plot(pair, "crane")
