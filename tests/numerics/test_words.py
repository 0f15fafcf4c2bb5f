"""Words that somebody may have meant."""

from __future__ import annotations

import pytest

from heavylift.numerics.foreign_files import converter_words
from heavylift.numerics.words import nearest

MOTION = ("position", "orientation", "velocity", "angular_velocity")


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("linear_velocity", "velocity"),  # a part too many
        ("velocty", "velocity"),
        ("angular_velocty", "angular_velocity"),
        ("anglar_velocity", "angular_velocity"),
        ("angularvelocity", "angular_velocity"),
        ("initial_position", "position"),
        ("linear_acceleration", ""),
        ("tension", ""),
    ],
)
def test_a_word_is_taken_for_another_only_if_its_parts_are_slips(word, meant):
    assert nearest(word, MOTION) == meant


def test_words_that_share_their_last_part_alone_are_others():
    assert nearest("linear_velocity", ["angular_velocity"]) == ""
    assert nearest("linear_velocity", []) == ""


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("hull.LIS", "BEMRosetta"),
        ("block.sldprt", "STEP"),
        ("module.skp", "trimesh"),
        ("a/b.odb", ".inp"),
        ("m.cgns", "gmsh"),
        ("m.exo", "meshio convert"),
    ],
)
def test_files_of_other_programs_name_what_converts_them(file, words):
    assert words in converter_words(file)


def test_an_ending_that_nobody_knows_has_no_converter():
    assert converter_words("module.unheard") == ""
