"""A link below an output folder leads to what belongs to someone: no command writes through it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.commands import statistics
from heavylift.pipeline.results.storage import OutputFolder

if TYPE_CHECKING:
    from collections.abc import Callable

MINE = "my own words"


@pytest.mark.parametrize(
    "names", [("statistics",), ("export",), ("seeds", "seed_1"), ("converge", "series_0", "1")]
)
def test_no_part_of_an_output_folder_is_a_link(tmp_path: Path, names: tuple[str, ...]) -> None:
    root, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    elsewhere.mkdir()
    for level in range(len(names)):
        shutil.rmtree(root, ignore_errors=True)
        link = root.joinpath(*names[: level + 1])
        link.parent.mkdir(parents=True)
        assert OutputFolder(root).stage(*names) == root.joinpath(*names)
        link.symlink_to(elsewhere)
        with pytest.raises(InputError, match="is a link") as told:
            OutputFolder(root).stage(*names)
        assert told.value.source == str(link)
        link.unlink()
        link.write_text(MINE)
        with pytest.raises(InputError, match="is no folder"):
            OutputFolder(root).stage(*names)


def test_the_output_folder_itself_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "out").symlink_to(tmp_path / "disk")
    assert OutputFolder(tmp_path / "out").stage("statistics") == tmp_path / "out" / "statistics"


def test_files_of_seeds_do_not_follow_links(tmp_path: Path) -> None:
    source, target, mine = tmp_path / "mesh", tmp_path / "seed", tmp_path / "mine"
    source.mkdir()
    target.mkdir()
    (source / "beam.h5").write_text("mesh")
    (target / "beam.h5").symlink_to(mine)  # leads to nothing yet
    statistics._link(source, target)
    assert not mine.exists()
    assert (target / "beam.h5").read_text() == "mesh"


COMMANDS = {
    "mesh": (),
    "modes": (),
    "simulate": (),
    "report": (),
    "draw": (),
    "export": ("--glb",),
    "statistics": ("--channels", "beam.position"),
}
"""With which a small case writes."""


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_writes_through_a_link(
    heavylift: Callable[..., Any], small_case: Path, tmp_path: Path, command: str
) -> None:
    tokens = (small_case, *COMMANDS[command])
    assert heavylift("run", small_case, "--quiet").code == 0
    made = heavylift(command, *tokens)
    assert made.code == 0, made.error
    out = small_case / "out"
    folders = sorted(path for path in out.rglob("*") if path.is_dir())
    files = sorted(path for path in out.rglob("*") if path.is_file() and not path.name.startswith("."))
    assert folders
    for folder in folders:  # each in turn a link to a folder with files of the same names
        mine, kept = tmp_path / "mine", tmp_path / "kept"
        shutil.copytree(folder, mine)
        for file in mine.rglob("*"):
            if file.is_file():
                file.write_text(MINE)
        before = sorted(mine.rglob("*"))
        folder.rename(kept)
        folder.symlink_to(mine)
        heavylift(
            command, *tokens, *(("--force",) if command in {"mesh", "modes", "simulate", "report"} else ())
        )
        assert sorted(mine.rglob("*")) == before, folder
        assert all(file.read_text() == MINE for file in before if file.is_file()), folder
        folder.unlink()
        kept.rename(folder)
        shutil.rmtree(mine)
    for file in files:  # and each file a link to one
        mine = tmp_path / "mine"
        mine.write_text(MINE)
        kept = file.read_bytes()
        file.unlink()
        file.symlink_to(mine)
        heavylift(command, *tokens)
        assert mine.read_text() == MINE, file
        file.unlink(missing_ok=True)
        file.write_bytes(kept)


def test_a_word_to_a_run_is_not_added_to_a_file_of_someone(tmp_path: Path) -> None:
    from heavylift.pipeline.stages import operator_commands
    from heavylift.pipeline.stages.lock import locked

    mine = tmp_path / "mine"
    mine.write_text(MINE)
    out = tmp_path / "out"
    out.mkdir()
    words = out / operator_commands.WORDS_FILE
    for plant in (words.symlink_to, words.hardlink_to):
        with locked(out):
            plant(mine)
            with pytest.raises(InputError, match="link"):
                operator_commands.send(out, "hold")
        assert mine.read_text() == MINE
        words.unlink()
    with locked(out):
        operator_commands.send(out, "hold")
    assert words.read_text() == "hold\n"
