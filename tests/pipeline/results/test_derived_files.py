"""Files of what follows from inputs alone: whole or absent, in any folder, never through a link, of bounded size."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from heavylift.numerics.derived import derived, keeping
from heavylift.pipeline.results import derived_files
from heavylift.pipeline.results.derived_files import DerivedFiles
from heavylift.pipeline.results.storage import OutputFolder


class Made(NamedTuple):
    values: np.ndarray


CALLS: list[int] = []


def make(number: int) -> Made:
    CALLS.append(number)
    return Made(np.full(1000, float(number)))


def get(store: DerivedFiles, number: int) -> None:
    with keeping(store):
        assert derived(Made, make, number).values.tolist() == [float(number)] * 1000


@pytest.fixture
def folder(tmp_path: Path) -> OutputFolder:
    CALLS.clear()
    return OutputFolder(tmp_path / "out")


def test_the_next_run_finds_it_also_where_the_folder_is_now(folder: OutputFolder):
    get(DerivedFiles(folder), 1)
    get(DerivedFiles(folder), 1)
    moved = folder.root.with_name("moved")
    folder.root.rename(moved)
    get(DerivedFiles(OutputFolder(moved)), 1)
    shutil.copytree(moved, folder.root)
    get(DerivedFiles(folder), 1)
    assert CALLS == [1]
    (file,) = folder.derived.iterdir()
    file.write_bytes(file.read_bytes()[:-1])
    get(DerivedFiles(folder), 1)
    get(DerivedFiles(folder), 1)
    assert CALLS == [1, 1]


def test_a_folder_from_another_machine_gives_results_of_this_one(
    folder: OutputFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    get(DerivedFiles(folder), 1)
    monkeypatch.setattr(derived_files, "processor_type", lambda: "another processor")
    get(DerivedFiles(folder), 1)
    assert CALLS == [1, 1]


def test_forced_all_is_computed_again_once(folder: OutputFolder):
    get(DerivedFiles(folder), 1)
    store = DerivedFiles(folder, anew=True)
    get(store, 1)
    get(store, 1)
    assert CALLS == [1, 1]


def test_taken_from_another_folder_of_the_case(folder: OutputFolder):
    get(DerivedFiles(folder), 1)
    other = OutputFolder(folder.root.with_name("other"))
    get(DerivedFiles(other, [folder]), 1)
    get(DerivedFiles(other), 1)
    assert CALLS == [1]


def test_a_folder_that_cannot_be_written_is_read(folder: OutputFolder, monkeypatch: pytest.MonkeyPatch):
    get(DerivedFiles(folder), 1)

    def closed(*_: object, **__: object) -> None:
        raise PermissionError

    # whoever tests may be root, to whom nothing is closed
    monkeypatch.setattr(derived_files, "replacing", closed)
    monkeypatch.setattr(os, "utime", closed)
    monkeypatch.setattr(Path, "unlink", closed)
    store = DerivedFiles(folder)
    get(store, 1)
    get(store, 2)
    store.clean()
    assert CALLS == [1, 2]
    assert len(list(folder.derived.iterdir())) == 1


def test_a_place_that_cannot_be_a_folder_is_no_error(folder: OutputFolder):
    folder.root.mkdir()
    folder.derived.write_text("a file")
    store = DerivedFiles(folder)
    get(store, 1)
    get(store, 1)
    store.clean()
    assert CALLS == [1, 1]
    assert folder.derived.read_text() == "a file"


def test_nothing_is_written_or_removed_through_a_link(folder: OutputFolder, tmp_path: Path):
    foreign = tmp_path / "foreign"
    get(DerivedFiles(OutputFolder(foreign)), 1)
    (file,) = (foreign / "derived").iterdir()
    whole = file.read_bytes()
    folder.root.mkdir()
    folder.derived.symlink_to(foreign / "derived")
    store = DerivedFiles(folder)
    get(store, 2)
    file.write_bytes(b"damaged")
    get(store, 1)
    store.clean()
    assert [one.read_bytes() for one in (foreign / "derived").iterdir()] == [b"damaged"]
    folder.derived.unlink()
    folder.derived.mkdir()
    (folder.derived / file.name).symlink_to(file)
    get(store, 1)  # the link is replaced, what it leads to stays
    assert file.read_bytes() == b"damaged"
    assert (folder.derived / file.name).read_bytes() == whole


def test_what_was_not_used_for_longest_goes(folder: OutputFolder, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(derived_files, "SPARE", 0)
    for number in range(5):
        get(DerivedFiles(folder), number)
    files = sorted(folder.derived.iterdir(), key=lambda file: np.frombuffer(file.read_bytes()[-64:-56])[0])
    assert len(files) == 5
    for age, file in enumerate(files):
        os.utime(file, (1000 - age, 1000 - age))
    foreign = folder.derived / "notes.txt"
    foreign.write_text("of someone")
    DerivedFiles(folder).clean()  # without use nothing is known
    assert len(list(folder.derived.iterdir())) == 6
    store = DerivedFiles(folder)
    get(store, 3)
    store.clean()
    left = set(folder.derived.iterdir())
    assert {files[3], foreign} < left
    assert len(left) == 3  # as much again as was used
    assert files[0] in left
