"""Decks of CalculiX's own tests: read, or refused for a reason of mechanics; five against independent solutions."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import material_of
from heavylift.preprocess.finite_elements.geometry import read_deck

ROOT = Path(__file__).resolve().parents[2]
UNITS = {"length_unit": 1e-3, "mass_unit": 1e3}  # mm, t, N
STATIC = {"density": 7850.0}  # for decks without one

PARTS = r"falls into 2 parts with no node in common: .*choose with 'part'"
ORTHOTROPIC = r"material 'EL' is orthotropic"

READ = {
    "beam10p": ("tet10", 31),
    "beam8f": ("hex8", 256),
    "beam8pjc": ("hex8", 256),
    "beam_sens_freq_coord2": ("hex8", 30),
    "beam_sens_stress_coord1": ("hex8", 32),
    "beam_sens_stress_coord2": ("hex8", 32),
    "beamnldyems": ("hex8", 32),
    "circ10pcent": ("tet10", 31),
    "cycliccontact": ("hex8", 624),
    "dyncube": ("hex8", 1),
    "mohr1": ("hex8", 1),
    "segmenttetsms": ("tet10", 1489),
    "sens_freq_disp_cyc_implicit": ("hex8", 624),
    "sensitivity_I": ("hex8", 2),
    "sensitivity_VII": ("hex8", 2),
    "transition": ("hex8", 32),
}
# elements of each part
IN_PARTS = {
    "changecontacttype1": (1, 1),
    "changesurfbeh": (1, 1),
    "contact1": (1, 1),
    "contact16": (1, 1),
    "contact19": (1, 1),
    "contact7": (1, 1),
    "contactdeleteelement": (5, 5),
    "equrem2": (1, 1),
    "friction1": (64, 64),
    "scheibe2n2f": (256, 256),
}
REFUSED = {
    "anipla_nl_dy_exp": ORTHOTROPIC,
    "sens_disp_orien": ORTHOTROPIC,
    "patch_c3d8i": r"element 4 \(C3D8I\) at .*distorted beyond use: .*\(1 of 7 elements\)",
    "segmentsmooth2": r"element 363 \(C3D10\) at .*distorted beyond use: .*\(2 of 1489 elements\)",
}


def deck(name):
    folder = Path(os.environ.get("HEAVYLIFT_CALCULIX_DATA", ROOT.parent / "shared" / "data" / "calculix"))
    if not folder.is_dir():
        pytest.skip(f"no decks of CalculiX at {folder}; set HEAVYLIFT_CALCULIX_DATA")
    return read_deck(folder / f"{name}.inp")


def material(body):
    """In SI; of decks without density with one of steel."""
    given = {} if body.material.density else STATIC
    return material_of(body.material, given, source="body", **UNITS)


@pytest.mark.parametrize("name", READ)
def test_decks_of_one_body_are_read(name):
    body = deck(name).body()
    assert (body.mesh.element_type, body.mesh.element_count) == READ[name]
    assert 70e9 < material(body).young_modulus < 220e9


@pytest.mark.parametrize("name", IN_PARTS)
def test_of_decks_with_parts_one_is_chosen(name):
    whole = deck(name)
    with pytest.raises(InputError, match=PARTS):
        whole.body()
    parts = [whole.body(part=number) for number in (1, 2)]
    assert tuple(part.mesh.element_count for part in parts) == IN_PARTS[name]
    assert all(70e9 < material(part).young_modulus < 220e9 for part in parts)


@pytest.mark.parametrize("name", REFUSED)
def test_decks_that_are_refused(name):
    whole = deck(name)
    with pytest.raises(InputError, match=REFUSED[name]):
        material(whole.body())
