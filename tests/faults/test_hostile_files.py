"""Files that are cut, flipped, looped, huge or of other types: one line with the file, and the process lives."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time

import h5py
import numpy as np
import pytest

from heavylift.numerics import hdf5_files, objects
from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_results
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf, write_netcdf


@pytest.fixture
def database_file(tmp_path):
    """A database of one hull: five frequencies, three headings."""
    omega = np.linspace(0.5, 2.5, 5)
    mass = np.diag([1e6, 1.2e6, 2e6, 3e7, 8e7, 9e7])
    damping = np.exp(-omega)[:, None, None] * 0.1 * mass
    path = tmp_path / "hull.nc"
    write_netcdf(
        path,
        HydrodynamicDatabase(
            bodies=("hull",),
            omega=omega,
            headings=np.linspace(0.0, np.pi, 3),
            added_mass=np.repeat(mass[None], 5, axis=0),
            damping=damping,
            added_mass_infinite=mass,
            excitation=np.zeros((5, 3, 6), dtype=complex),
            reference_points=np.zeros((1, 3)),
            density=1025.0,
            gravity=9.81,
            depth=np.inf,
            source="made for tests",
        ),
        checked=False,
    )
    assert read_netcdf(path, checked=False).bodies == ("hull",)
    return path


def replaced(name, **made):
    def change(file):
        del file[name]
        file.create_dataset(name, **made)

    return change


def linked(name, link):
    def change(file):
        del file[name]
        file[name] = link

    return change


def group(file):
    del file["added_mass"]
    file.create_group("added_mass")


CHANGES = {
    "text": replaced("added_mass", data="none"),
    "compound": replaced("added_mass", data=np.zeros((5, 6, 6), dtype=[("x", "f8")])),
    "complex": replaced("added_mass", data=np.zeros((5, 6, 6), dtype=complex)),
    "empty": replaced("added_mass", data=h5py.Empty("f8")),
    "without axes": replaced("added_mass", data=np.zeros((5, 6, 6))),
    "8 TB": replaced("added_mass", shape=(10**6, 10**6), dtype="f8", chunks=(100, 100)),
    "axis of 8 TB": replaced("omega", shape=(10**12,), dtype="f8", chunks=(1000,)),
    "axis of text": replaced("omega", data=np.array([b"a"] * 5)),
    "group": group,
    "loop": linked("added_mass", h5py.SoftLink("/added_mass")),
    "external": linked("added_mass", h5py.ExternalLink("/dev/zero", "/x")),
    "one fewer": replaced("radiation_damping", data=np.zeros((4, 6, 6))),
}


@pytest.mark.slow
@pytest.mark.parametrize("how", CHANGES)
def test_a_database_with_variables_of_other_types(database_file, how):
    with h5py.File(database_file, "r+") as file:
        CHANGES[how](file)
    begin = time.monotonic()
    with pytest.raises(InputError) as caught:
        read_netcdf(database_file, checked=False)
    assert time.monotonic() - begin < 10.0
    assert str(database_file) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.expected


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.9, 0.999])
def test_a_database_that_is_cut(database_file, share):
    content = database_file.read_bytes()
    database_file.write_bytes(content[: int(share * len(content))])
    with pytest.raises(InputError, match=r"hull\.nc"):
        read_netcdf(database_file, checked=False)


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "crashes"),
        ("import time; time.sleep(60)", "within 1 s"),
        ("raise SystemExit('no library')", "no library"),
    ],
)
def test_a_library_that_crashes_or_hangs_ends_no_process_of_ours(monkeypatch, database_file, program, words):
    monkeypatch.setattr(hdf5_files, "SURVEY", program)
    monkeypatch.setattr(hdf5_files, "SECONDS", 1.0)
    hdf5_files._survey.cache_clear()
    with pytest.raises(InputError, match=words):
        read_netcdf(database_file)


def test_what_is_read_first_in_another_process_costs_little(database_file):
    """A file is looked through once as long as it does not change."""
    hdf5_files.check_hdf5(database_file, "a file")
    begin = time.monotonic()
    hdf5_files.check_hdf5(database_file, "a file")
    assert time.monotonic() - begin < 0.05


@pytest.mark.slow
def test_flipped_bits_of_a_database_never_end_the_process(database_file):
    """Whatever the library makes of them."""
    content, rng = database_file.read_bytes(), np.random.default_rng(1)
    refused = 0
    for _ in range(25):
        damaged = bytearray(content)
        for at in rng.integers(0, len(content), 8):
            damaged[at] ^= 1 << int(rng.integers(8))
        database_file.write_bytes(damaged)
        try:
            read_netcdf(database_file, checked=False)
        except InputError as error:
            assert "\n" not in str(error)  # noqa: PT017
            refused += 1
    assert refused > 5


@pytest.mark.parametrize("share", [0.0, 0.05, 0.5, 0.95])
def test_files_of_ours_that_are_cut(heavylift, small_case, share):
    assert heavylift("simulate", small_case, "--set", "simulate.duration=1 ms", "--quiet").code == 0
    out = small_case / "out"
    for file, read in (
        (out / "mesh" / "beam.h5", read_model),
        (out / "modes" / "beam.h5", read_reduced),
        (out / "simulate" / "results.h5", load_results),
    ):
        content = file.read_bytes()
        file.write_bytes(content[: int(share * len(content))])
        with pytest.raises(InputError, match=r"heavylift .* CASE --force") as caught:
            read(file)
        assert str(file) in str(caught.value)
        with h5py.File(file, "w") as empty:
            empty.attrs["format"] = read.__name__
        with pytest.raises(InputError):
            read(file)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "7",
        "null",
        '{"digest": []}',
        "[" * 100000,
        '{"items": 3}',
        '{"items": {"beam": []}}',
        "\x00",
    ],
)
@pytest.mark.parametrize("stage", ["mesh", "modes", "simulate", "check"])
def test_manifests_of_other_types_are_no_manifests(heavylift, small_case, stage, text):
    short = ("simulate", small_case, "--set", "simulate.duration=1 ms", "--quiet")
    assert heavylift(*short).code == 0
    (small_case / "out" / stage / "manifest.json").write_text(text)
    assert heavylift(*short).code == 0


@pytest.mark.parametrize("key", ["details", "outcome", "message", "size", "digest", "finished"])
@pytest.mark.parametrize("value", [None, [], {}, "x", 3])
def test_a_manifest_of_a_run_with_values_of_other_types(heavylift, small_case, key, value):
    short = ("simulate", small_case, "--set", "simulate.duration=1 ms", "--quiet")
    assert heavylift(*short).code == 0
    file = small_case / "out" / "simulate" / "manifest.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), key: value}))
    assert heavylift(*short).code == 0
    assert load_results(small_case).outcome == "completed"


UNIT_BYTES = b"x" * 1000


@pytest.mark.parametrize("how", ["cut", "flipped", "empty", "folder", "pipe", "loop", "other", "huge"])
def test_garbled_kernel_objects_are_compiled_anew(tmp_path, how):
    """What is not whole is as good as not there; nothing waits for a pipe, and no terabyte is read."""
    import hashlib

    path = tmp_path / "Unit-0.o"
    whole = objects.MAGIC + hashlib.blake2b(UNIT_BYTES, digest_size=32).digest() + UNIT_BYTES
    path.write_bytes(whole)
    assert objects._read(path) == UNIT_BYTES
    path.unlink()
    match how:
        case "cut":
            path.write_bytes(whole[:500])
        case "flipped":
            path.write_bytes(whole[:600] + b"y" + whole[601:])
        case "empty":
            path.write_bytes(b"")
        case "folder":
            path.mkdir()
        case "pipe":
            os.mkfifo(path)
        case "loop":
            path.symlink_to(path)
        case "other":
            shutil.copyfile(objects.__file__, path)
        case "huge":
            with path.open("wb") as file:
                file.truncate(2**43)
    signal.alarm(20)
    try:
        assert objects._read(path) is None
    finally:
        signal.alarm(0)
