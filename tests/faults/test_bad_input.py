"""Bad input ends as one clear message and exit code 2, before anything is written."""

from __future__ import annotations

import json

import numpy as np
import pytest

BLOCKS = 'type = "blocks"\nadd = [{ name = "bar", from = [0, 0, 0], to = ["200 mm", "20 mm", "10 mm"] }]'
BRICK = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float
)


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        (
            "poisson_ratio",
            "poison_ratio",
            "bodies.beam.material.poison_ratio",
            "did you mean 'poisson_ratio'",
        ),
        ('"7800 kg/m^3"', '"steel"', "bodies.beam.material.density", "'steel' is not a number"),
        ("count = 3", "count = -3", "bodies.beam.modes.count", "-3 is too small"),
        ("count = 3", "count = true", "bodies.beam.modes.count", "True is not an integer"),
        ('point = ["200 mm"', 'point = ["2 V"', "sensors.0.point.0", "measured in"),
        ("relative = 1e-4", "relative = 2", "check.1.tolerance.relative", "2 is too large"),
        ('motion = "fixed"', 'motion = "free"', "bodies.beam.modes.clamp", "holds nodes"),
        ('to = ["200 mm"', 'to = ["200 s"', "bodies.beam.geometry.add.0.to.0", "'200 s' is a time"),
        ('"210 GPa"', "inf", "bodies.beam.material.young_modulus", "not finite"),
        ('"7800 kg/m^3"', "-7800", "bodies.beam.material.density", "too small"),
    ],
)
@pytest.mark.parametrize("command", ["run", "verify", "converge"])
def test_a_wrong_value_is_one_line_with_file_key_and_expectation(
    heavylift, small_case, edit, command, old, new, key, words
):
    edit(small_case, (old, new))
    result = heavylift(command, small_case, "--quiet")
    assert result.code == 2
    text = result.error + result.out
    (line,) = [line for line in text.splitlines() if words in line]
    assert f"{small_case / 'case.toml'}: {key}: " in line
    assert "expected" in line
    assert text.count("case.toml: ") == 1  # nothing that only follows from the mistake
    assert not (small_case / "out").exists()


def test_with_json_the_error_is_a_document(heavylift, small_case, edit):
    edit(small_case, ('"7800 kg/m^3"', '"steel"'))
    result = heavylift("simulate", small_case, "--json")
    assert result.code == 2
    document = json.loads(result.out)
    assert document["outcome"] == "bad_input"
    assert document["details"][0]["key"] == "bodies.beam.material.density"
    assert "'steel'" in document["error"]
    assert "'steel'" in result.error


def test_a_missing_geometry_file(heavylift, small_case, edit):
    edit(
        small_case, (BLOCKS, 'type = "step"\nfile = "beam.step"'), ('"hex8"', '"tet10"'), ("divisions", "# ")
    )
    result = heavylift("mesh", small_case)
    assert result.code == 2
    assert "bodies.beam.geometry.file: file 'beam.step' does not exist" in result.error
    assert len(result.error.splitlines()) == 1


@pytest.mark.parametrize("how", ["absolute", "parent", "link", "folder link"])
def test_a_path_outside_the_case(heavylift, small_case, edit, how):
    outside = small_case.parent / "secret"
    outside.mkdir()
    (outside / "beam.step").write_text("")
    name = {"absolute": str(outside / "beam.step"), "parent": "../secret/beam.step", "link": "link.step"}.get(
        how, "inside/beam.step"
    )
    if how == "link":
        (small_case / "link.step").symlink_to(outside / "beam.step")
    if how == "folder link":
        (small_case / "inside").symlink_to(outside)
    edit(small_case, (BLOCKS, f'type = "step"\nfile = "{name}"'), ('"hex8"', '"tet10"'), ("divisions", "# "))
    result = heavylift("mesh", small_case)
    assert result.code == 2
    assert f"{name!r} leaves the case folder" in result.error


def test_a_sensor_off_the_body(heavylift, small_case, edit):
    edit(small_case, ('point = ["200 mm"', 'point = ["200 cm"'))
    result = heavylift("simulate", small_case)
    assert result.code == 2
    assert f"{small_case / 'case.toml'}: sensors.0.point: point (2000, 20, 10) mm is not on" in result.error
    assert len(result.error.splitlines()) == 1


def mesh_case(folder, edit, nodes, cells):
    """Make the geometry of a case a mesh file."""
    import meshio

    meshio.Mesh(nodes, [("hexahedron", cells)]).write(folder / "beam.vtu")
    edit(
        folder,
        (BLOCKS, 'type = "mesh"\nfile = "beam.vtu"'),
        ("divisions = { x = [8], y = [1], z = [1] }", ""),
    )


def test_a_mesh_with_an_inverted_element(heavylift, small_case, edit):
    nodes = np.vstack([BRICK, BRICK[[1, 2, 5, 6]] + [1, 0, 0]])
    inverted = [1, 8, 9, 2, 5, 10, 11, 6]
    inverted = inverted[4:] + inverted[:4]
    mesh_case(small_case, edit, nodes, np.array([range(8), inverted]))
    result = heavylift("mesh", small_case)
    assert result.code == 2
    assert "beam.vtu" in result.error
    assert "element" in result.error
    assert len(result.error.splitlines()) == 1


def test_a_mesh_with_a_disconnected_element(heavylift, small_case, edit):
    mesh_case(small_case, edit, np.vstack([BRICK, BRICK + np.array([3, 0, 0])]), np.arange(16).reshape(2, 8))
    result = heavylift("mesh", small_case)
    assert result.code == 2
    assert "beam.vtu" in result.error
    assert len(result.error.splitlines()) == 1


def test_more_modes_than_degrees_of_freedom(heavylift, small_case):
    result = heavylift("modes", small_case, "--set", "bodies.beam.modes.count=97")
    assert result.code == 2
    assert "97 modes requested" in result.error
    assert "1 to 96" in result.error
    assert "bodies.beam.modes.count: 97" in result.error
    assert len(result.error.splitlines()) == 1


def four_files(folder, edit, entry):
    """Make the geometry of a case four files of a body of one cube, with one more stiffness entry."""
    data = folder / "fe"
    data.mkdir()
    np.savetxt(data / "u0.dat", BRICK)
    np.savetxt(data / "mij.dat", np.full(8, 1000.0))
    np.savetxt(data / "modeShapeMatrix.dat", np.ones((24, 1)))
    rows = [f"{node} {k} {node} {k} 1e9" for node in range(1, 9) for k in (1, 2, 3)] + [entry]
    (data / "stiffnessMatrix.dat").write_text("\n".join(rows) + "\n")
    text = (folder / "case.toml").read_text()
    start, end = text.index("[bodies.beam.material]"), text.index("[bodies.beam.geometry]")
    text = text[:start] + text[end:]
    start, end = text.index("[bodies.beam.mesh]"), text.index("[bodies.beam.modes]")
    (folder / "case.toml").write_text(text[:start] + text[end:])
    edit(folder, (BLOCKS, 'type = "four_files"\nfolder = "fe"'))


def test_a_stiffness_entry_beyond_the_node_count(heavylift, small_case, edit):
    four_files(small_case, edit, "9 1 3 1 1.0")
    result = heavylift("mesh", small_case)
    assert result.code == 2
    assert "stiffnessMatrix.dat" in result.error
    assert "line 25" in result.error
    assert "9" in result.error.partition("line 25")[2]
    assert len(result.error.splitlines()) == 1


def test_a_truncated_result_file_names_the_remedy(heavylift, small_case):
    from heavylift.numerics.outcome import InputError
    from heavylift.pipeline import load_results

    short = ("--set", "simulate.duration=1 ms")
    assert heavylift("simulate", small_case, *short, "--quiet").code == 0
    file = small_case / "out" / "simulate" / "results.h5"
    file.write_bytes(file.read_bytes()[:2000])
    with pytest.raises(InputError, match=r"results\.h5: is damaged.*simulate CASE --force"):
        load_results(small_case)
    result = heavylift("simulate", small_case, *short)
    assert result.code == 0
    assert "damaged" in result.out
    load_results(small_case)


def test_an_unknown_option_and_a_missing_case_end_with_two(small_case):
    import subprocess
    import sys

    for tokens in (["run", str(small_case), "--fast"], ["run", str(small_case / "nowhere")], ["rum"]):
        code = "from heavylift.pipeline.commands.start import main; main()"
        result = subprocess.run(
            [sys.executable, "-c", code, *tokens], capture_output=True, text=True, check=False
        )
        assert result.returncode == 2, tokens
        assert "Traceback" not in result.stderr


def test_verify_goes_on_after_a_bad_case(heavylift, small_case, edit, tmp_path):
    import shutil

    good = tmp_path / "good_beam"
    shutil.copytree(small_case, good)
    edit(small_case, ('"7800 kg/m^3"', '"steel"'))
    result = heavylift("verify", small_case, good, "--json")
    assert result.code == 2
    document = json.loads(result.out)
    assert [row["outcome"] for row in document["cases"]] == ["bad_input", "completed"]
    assert "'steel'" in document["cases"][0]["message"]
    assert [check["passed"] for check in document["cases"][1]["checks"]] == [True, True]


def test_an_output_folder_that_cannot_be_made(heavylift, small_case):
    (small_case / "file").write_text("")
    result = heavylift("mesh", small_case, "--out", small_case / "file")
    assert result.code == 2
    assert len(result.error.splitlines()) == 1
