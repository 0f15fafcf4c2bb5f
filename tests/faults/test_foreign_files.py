"""Links, pipes and devices in place of files, inputs that lead out of the case folder: refused, left as they are."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.storage import OutputFolder

SHORT = ("--set", "simulate.duration=1 ms")


def refused(result, *words):
    """Bad input, said in one line with some words."""
    assert result.code == Outcome.BAD_INPUT, (result.out, result.error)
    (line,) = result.error.splitlines()
    for word in words:
        assert str(word) in line, line


# ---- the output folder ----


@pytest.mark.parametrize("kind", ["link", "name", "pipe", "folder", "content"])
def test_a_lock_that_is_none(heavylift, small_case, tmp_path, kind):
    mine = tmp_path / "mine.txt"
    mine.write_text("years of work")
    lock = small_case / "out" / ".lock"
    lock.parent.mkdir()
    if kind == "link":
        lock.symlink_to(mine)
    elif kind == "name":
        lock.hardlink_to(mine)
    elif kind == "pipe":
        os.mkfifo(lock)
    elif kind == "folder":
        lock.mkdir()
    else:
        lock.write_text("years of work")
    refused(heavylift("mesh", small_case), lock)
    assert mine.read_text() == "years of work"
    assert kind != "content" or lock.read_text() == "years of work"
    assert [path.name for path in lock.parent.iterdir()] == [".lock"]


@pytest.mark.parametrize("place", ["simulate/segments", "simulate", "mesh", "modes", "report", "check"])
def test_a_folder_below_the_output_folder_is_no_link(heavylift, small_case, tmp_path, place):
    mine = tmp_path / "mine"
    mine.mkdir()
    names = ["segment_000000.npz", "segment_000001.npz", ".beam.h5.99999999.tmp", "beam.h5", "manifest.json"]
    for name in names:
        (mine / name).write_text("years of work")
    link = small_case / "out" / place
    link.parent.mkdir(parents=True)
    link.symlink_to(mine)
    for command in ("mesh", "simulate", "run"):
        for force in ((), ("--force",)):
            refused(heavylift(command, small_case, *SHORT, *force), link, "is a link")
    assert sorted(path.name for path in mine.iterdir()) == sorted(names)
    assert {path.read_text() for path in mine.iterdir()} == {"years of work"}


def test_the_output_folder_itself_may_be_a_link(heavylift, small_case, tmp_path):
    (tmp_path / "large_disk").mkdir()
    (small_case / "out").symlink_to(tmp_path / "large_disk")
    assert heavylift("simulate", small_case, *SHORT).code == 0
    assert (tmp_path / "large_disk" / "simulate" / "results.h5").is_file()


def test_links_of_the_names_of_temporary_files_are_not_followed(heavylift, small_case, tmp_path):
    mine = tmp_path / "mine.txt"
    mine.write_text("years of work")
    folder = small_case / "out" / "mesh"
    folder.mkdir(parents=True)
    (folder / f".beam.h5.{os.getpid()}.tmp").symlink_to(mine)
    assert heavylift("mesh", small_case).code == 0
    assert mine.read_text() == "years of work"
    assert not (folder / "beam.h5").is_symlink()


def test_pipes_in_the_place_of_stored_files_do_not_stop_a_run(heavylift, small_case):
    folder = OutputFolder(small_case / "out")
    folder.segments.mkdir(parents=True)
    folder.stage("mesh").mkdir()
    for path in (folder.manifest("mesh"), folder.manifest("simulate"), folder.model("beam"), folder.results):
        os.mkfifo(path)
    os.mkfifo(folder.segments / "segment_000000.npz")
    assert heavylift("simulate", small_case, *SHORT).code == 0
    assert folder.results.is_file()


def test_what_is_no_segment_stays_in_the_folder_of_segments(heavylift, small_case):
    folder = OutputFolder(small_case / "out").segments
    folder.mkdir(parents=True)
    names = {"segment_of_mine.npz", "notes.txt"}
    for name in names:
        (folder / name).write_text("years of work")
    assert heavylift("simulate", small_case, *SHORT).code == 0
    assert {path.name for path in folder.iterdir()} == names


# ---- the case file ----


@pytest.mark.timeout(60)
@pytest.mark.parametrize("command", ["run", "verify", "mesh"])
def test_a_case_file_that_is_a_pipe_or_device(heavylift, tmp_path, command):
    os.mkfifo(tmp_path / "case.toml")
    result = heavylift(command, tmp_path)
    assert result.code == Outcome.BAD_INPUT
    assert (
        f"{tmp_path / 'case.toml'}: is no regular file" in result.out + result.error
    )  # verify has it in its table
    (tmp_path / "case.toml").unlink()
    (tmp_path / "case.toml").symlink_to("/dev/zero")
    result = heavylift(command, tmp_path)
    assert result.code == Outcome.BAD_INPUT
    assert "is no regular file" in result.out + result.error


def test_a_case_file_that_is_far_too_large(heavylift, tmp_path):
    with (tmp_path / "case.toml").open("wb") as stream:
        stream.truncate(2**40)
    refused(heavylift("run", tmp_path), "case.toml", "1,099,511,627,776 bytes", "at most 67,108,864")


# ---- inputs ----


REFERENCE = """
[[reference]]
channel = "beam.modal_position"
file = "history.csv"
source = "made for tests"
tolerance = "1 m"
"""


@pytest.fixture
def with_mesh(small_case):
    """The bar as an Abaqus deck, and a function that writes its case file with another geometry."""
    nodes = [(x, y, z) for z in (0, 10) for y in (0, 20) for x in range(0, 201, 25)]
    rows = [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(nodes, start=1)]
    bricks = [
        f"{i}, {i}, {i + 1}, {i + 10}, {i + 9}, {i + 18}, {i + 19}, {i + 28}, {i + 27}" for i in range(1, 9)
    ]
    parts = {
        "nodes.inc": ["*NODE", *rows],
        "bar.inp": ["*INCLUDE, INPUT=nodes.inc", "*ELEMENT, TYPE=C3D8I", *bricks],
    }
    for name, lines in parts.items():
        (small_case / name).write_text("\n".join(lines) + "\n")
    text = (small_case / "case.toml").read_text()
    begin, end = text.index("[bodies.beam.geometry]"), text.index("[bodies.beam.modes]")

    def write(name, keys='length_unit = "1 mm"'):
        section = (
            f'[bodies.beam.geometry]\ntype = "mesh"\nfile = "{name}"\n{keys}\n'
            '[bodies.beam.geometry.groups]\nroot = { plane = "x", at = "0 mm" }\n'
        )
        (small_case / "case.toml").write_text(text[:begin] + section + text[end:])

    return small_case, np.array(nodes, dtype=float), write


def cube_xdmf(folder, data, nodes):
    """The bar as an XDMF file whose numbers are in an HDF5 file of any name."""
    bricks = [[i, i + 1, i + 10, i + 9, i + 18, i + 19, i + 28, i + 27] for i in range(8)]
    target = (folder / data).resolve()
    with h5py.File(target, "w") as file:
        file["points"] = nodes
        file["cells"] = np.array(bricks)
    (folder / "bar.xdmf").write_text(
        '<Xdmf Version="3.0"><Domain><Grid Name="Grid"><Geometry GeometryType="XYZ">'
        f'<DataItem DataType="Float" Dimensions="36 3" Format="HDF" Precision="8">{data}:/points</DataItem>'
        '</Geometry><Topology TopologyType="Hexahedron" NumberOfElements="8" NodesPerElement="8">'
        f'<DataItem DataType="Int" Dimensions="8 8" Format="HDF" Precision="8">{data}:/cells</DataItem>'
        "</Topology></Grid></Domain></Xdmf>"
    )
    return target


def test_the_digest_of_an_xdmf_file_covers_its_data(heavylift, with_mesh):
    folder, nodes, write = with_mesh
    write("bar.xdmf")
    data = cube_xdmf(folder, "bar.h5", nodes)
    result = heavylift("mesh", folder)
    assert result.code == 0, result.error
    assert "unchanged, skipped" in heavylift("mesh", folder).out
    with h5py.File(data, "r+") as file:
        file["points"][:, 2] *= 2.0  # twice as high, the file as large as before
    result = heavylift("mesh", folder)
    assert result.code == 0, result.error
    assert "unchanged" not in result.out
    assert "mass 0.624" in result.out  # 0.2 m x 0.02 m x 0.02 m x 7800 kg/m3


@pytest.mark.parametrize("how", ["path", "link"])
def test_an_xdmf_file_that_leads_out_of_the_case_folder(heavylift, with_mesh, how):
    folder, nodes, write = with_mesh
    write("bar.xdmf")
    if how == "path":
        cube_xdmf(folder, "../outside.h5", nodes)
    else:
        (folder / "data.h5").symlink_to(folder.parent / "outside.h5")
        cube_xdmf(folder, "data.h5", nodes)
    refused(
        heavylift("mesh", folder),
        "geometry.file",
        "leaves the case folder",
        "outside.h5" if how == "path" else "data.h5",
    )


def test_raw_data_of_an_xdmf_file(heavylift, with_mesh):
    folder, nodes, write = with_mesh
    write("bar.xdmf")
    cube_xdmf(folder, "bar.h5", nodes)
    file = folder / "bar.xdmf"
    file.write_text(
        file.read_text().replace('Format="HDF"', 'Format="Binary"').replace("bar.h5:/points", "/dev/zero")
    )
    refused(heavylift("mesh", folder), "geometry.file", "raw file '/dev/zero'")


@pytest.mark.parametrize("how", ["external link", "raw storage", "virtual", "deep"])
def test_an_hdf5_file_that_leads_out_of_itself(heavylift, with_mesh, how):
    folder, nodes, write = with_mesh
    write("bar.xdmf")
    data = cube_xdmf(folder, "bar.h5", nodes)
    outside = folder.parent / "outside.h5"
    with h5py.File(outside, "w") as file:
        file["points"] = nodes
    with h5py.File(data, "r+") as file:
        group = file.create_group("a/b") if how == "deep" else file
        if how in {"external link", "deep"}:
            group["other"] = h5py.ExternalLink(str(outside), "/points")
        elif how == "raw storage":
            file.create_dataset("other", (3,), "f8", external=[(str(outside), 0, 24)])
        else:
            layout = h5py.VirtualLayout(nodes.shape, "f8")
            layout[:] = h5py.VirtualSource(str(outside), "points", shape=nodes.shape)
            file.create_virtual_dataset("other", layout)
    refused(heavylift("mesh", folder), "geometry.file", "other", "outside.h5")


@pytest.mark.parametrize("how", ["path", "link", "absolute"])
def test_a_deck_that_includes_what_is_not_in_the_case_folder(heavylift, with_mesh, how):
    folder, _, write = with_mesh
    write("bar.inp")
    assert heavylift("mesh", folder).code == 0
    outside = folder.parent / "outside.inc"
    shutil.move(folder / "nodes.inc", outside)
    name = {"path": "../outside.inc", "link": "nodes.inc", "absolute": str(outside)}[how]
    if how == "link":
        (folder / "nodes.inc").symlink_to(outside)
    deck = folder / "bar.inp"
    deck.write_text(deck.read_text().replace("nodes.inc", name))
    refused(heavylift("mesh", folder), "line 1", name, "leaves the folder")


def test_a_folder_of_four_files_with_one_from_elsewhere(heavylift, small_case, tmp_path):
    folder = small_case / "body"
    folder.mkdir()
    for name in ("u0", "mij", "stiffnessMatrix", "modeShapeMatrix"):
        (folder / f"{name}.dat").write_text("0 0 0\n")
    text = (small_case / "case.toml").read_text()
    begin, end = text.index("[bodies.beam.geometry]"), text.index("[bodies.beam.modes]")
    section = '[bodies.beam.geometry]\ntype = "four_files"\nfolder = "body"\n'
    (small_case / "case.toml").write_text(text[:begin] + section + text[end:])
    shutil.move(folder / "mij.dat", tmp_path / "mij.dat")
    (folder / "mij.dat").symlink_to(tmp_path / "mij.dat")
    result = heavylift("mesh", small_case)
    assert result.code == Outcome.BAD_INPUT
    assert "geometry.folder: 'body with mij.dat' leaves the case folder" in result.error
    (folder / "mij.dat").unlink()
    os.mkfifo(folder / "mij.dat")
    assert "'body with mij.dat' is no file" in heavylift("mesh", small_case).error


@pytest.mark.parametrize("ending", [".3", ".hst"])
def test_neighbours_of_a_hydrodynamic_database_from_elsewhere(heavylift, tmp_path, ending):
    folder = tmp_path / "barge"
    folder.mkdir()
    text = (Path(__file__).parents[1] / "pipeline" / "sea.toml").read_text()
    assert '"still.nc"' in text
    (folder / "case.toml").write_text(text.replace('"still.nc"', '"still.1"'))
    (folder / "still.1").write_text("1.0 1 1 1.0 1.0\n")
    (tmp_path / "secret").write_text("years of work")
    (folder / f"still{ending}").symlink_to(tmp_path / "secret")
    result = heavylift("mesh", folder)
    assert result.code == Outcome.BAD_INPUT
    assert f"databases.still.file: 'still.1 with still{ending}' leaves the case folder" in result.error


def test_matrices_beside_a_deck_from_elsewhere(heavylift, with_mesh):
    folder, _, write = with_mesh
    write("bar.inp")
    (folder.parent / "secret").write_text("years of work")
    (folder / "bar.sti").symlink_to(folder.parent / "secret")
    refused(heavylift("mesh", folder), "'bar.inp with bar.sti' leaves the case folder")


@pytest.mark.timeout(60)
def test_inputs_that_have_no_end(heavylift, with_mesh):
    folder, _, write = with_mesh
    write("bar.inp")
    (folder / "bar.inp").unlink()
    os.mkfifo(folder / "bar.inp")
    refused(heavylift("mesh", folder), "geometry.file", "'bar.inp' is no file")
    (folder / "bar.inp").unlink()
    with (folder / "bar.inp").open("wb") as stream:
        stream.truncate(2**40)
    refused(heavylift("mesh", folder), "geometry.file", "'bar.inp' has 1024.0 GiB", "at most 4 GiB")
