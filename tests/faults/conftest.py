"""A small case to break, and the command line to break it with."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pytest

from heavylift.pipeline.commands.cli import app

if TYPE_CHECKING:
    from collections.abc import Callable


class Result(NamedTuple):
    """What a command did."""

    code: int
    out: str
    error: str


@pytest.fixture
def small_case(tmp_path: Path) -> Path:
    """Folder with a case of a clamped bar, eight bricks, three modes."""
    folder = tmp_path / "small_beam"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "pipeline" / "small_beam.toml", folder / "case.toml")
    return folder


@pytest.fixture
def heavylift(capsys: pytest.CaptureFixture[str]) -> Callable[..., Result]:
    """Run a command of the command line in this process."""

    def run(*tokens: object) -> Result:
        capsys.readouterr()
        code = app([str(token) for token in tokens], result_action="return_value")
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err
        return Result(code, captured.out, captured.err)

    return run


@pytest.fixture
def edit() -> Callable[..., None]:
    """Replace texts in the case file of a folder."""

    def replace(folder: Path, *changes: tuple[str, str]) -> None:
        file = folder / "case.toml"
        text = file.read_text()
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        file.write_text(text)

    return replace
