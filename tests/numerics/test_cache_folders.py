"""Compiled code is loaded only from where no other user can have put it."""

from __future__ import annotations

import grp
import os
import pwd
import stat
from pathlib import Path

import pytest
from numba import config

from heavylift.numerics import objects, sources
from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit_code import cache_folder
from heavylift.numerics.objects import entry, is_compiled, load_unit
from heavylift.numerics.sources import distrusted, made_folder

compiled_only = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="nothing is compiled")
STRANGER = 54321


@entry
def first_of(values: Floats1) -> float:
    return values[0]


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder, made as the program makes it."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(folder))
    made_folder(folder / "objects")
    return folder


def belongs_to_a_stranger(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root gives the folder away; another user becomes another one."""
    if os.geteuid() == 0:
        os.chown(place, STRANGER, -1)
    else:
        monkeypatch.setattr(sources.os, "geteuid", lambda: STRANGER)


@pytest.mark.parametrize("mask", [0o002, 0o000, 0o077])
def test_folders_are_ours_alone_whatever_the_umask(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mask: int
) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path / "a" / "cache"))
    before = os.umask(mask)
    try:
        made = made_folder(tmp_path / "a" / "cache" / "objects")
    finally:
        os.umask(before)
    for place in (made, made.parent):
        assert not place.stat().st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    assert distrusted(made) == ""


def test_what_is_not_there_is_not_distrusted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path / "none"))
    assert distrusted(tmp_path / "none" / "objects") == ""


@pytest.mark.parametrize("part", ["", "objects"])
def test_a_folder_of_another_user(root: Path, part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    belongs_to_a_stranger(root / part, monkeypatch)
    reason = distrusted(root / "objects")
    assert str(root / part) in reason
    assert "HEAVYLIFT_CACHE_DIR" in reason


@pytest.mark.skipif(os.geteuid() != 0, reason="needs to give a folder away")
def test_a_folder_that_root_has_filled_serves_all(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in an image of a container, in which root compiles and another user runs."""
    monkeypatch.setattr(sources.os, "geteuid", lambda: STRANGER)
    assert distrusted(root / "objects") == ""


@pytest.mark.parametrize("part", ["", "objects", "objects/unit.o"])
def test_what_anybody_may_write_to(root: Path, part: str) -> None:
    (root / "objects" / "unit.o").write_bytes(b"")
    place = root / part
    place.chmod(0o777)
    assert str(place) in distrusted(root / "objects", root / "objects" / "unit.o")


def test_a_group_of_others_and_one_of_our_own(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    me = pwd.getpwuid(os.geteuid()).pw_name
    groups = {"mine": (me, []), "with me": (me, [me]), "shared": (me, ["other"]), "users": ("users", [])}
    (root / "objects").chmod(0o775)
    for word, (name, members) in groups.items():
        found = grp.struct_group((name, "x", 1, members))
        monkeypatch.setattr(grp, "getgrgid", lambda _number, found=found: found)
        sources._is_own_group.cache_clear()
        reason = distrusted(root / "objects")
        assert bool(reason) is (word in {"shared", "users"}), word
    monkeypatch.undo()
    sources._is_own_group.cache_clear()


def test_a_folder_as_that_of_temporary_files_may_hold_ours(root: Path) -> None:
    """Where nobody can rename what is not his own."""
    root.chmod(0o1777)
    assert distrusted(root / "objects") == ""
    (root / "objects").chmod(0o1777)
    assert distrusted(root / "objects")


@compiled_only
def test_code_of_a_distrusted_folder_is_not_loaded_and_that_is_told_once(
    root: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def forget() -> None:
        monkeypatch.setattr(objects, "_LOADED", {})
        monkeypatch.setattr(objects, "_SPARE", [])

    forget()
    assert load_unit(first_of.unit).seconds > 0.0
    forget()
    assert is_compiled(first_of.unit)
    (root / "objects").chmod(0o777)
    assert not is_compiled(first_of.unit)
    assert load_unit(first_of.unit).seconds > 0.0
    spec = capfd.readouterr().err
    assert spec.count("\n") == 1
    assert f"other users may write to {root / 'objects'}" in spec
    assert "HEAVYLIFT_CACHE_DIR" in spec
    (root / "objects").chmod(0o755)
    forget()
    assert is_compiled(first_of.unit)


def test_folders_of_the_compiler_are_closed_to_others(root: Path) -> None:
    """It makes folders and files in them by the umask, and loads pickles."""
    before = os.umask(0o002)
    try:
        made = cache_folder.__wrapped__("heavylift.numerics.small")
    finally:
        os.umask(before)
    assert made.parent == root
    assert stat.S_IMODE(made.stat().st_mode) == 0o700
