"""Files that decks include: in chains, in circles, as bombs; and sets of sets."""

from __future__ import annotations

import time

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements import deck as deck_module
from heavylift.preprocess.finite_elements.geometry import read_deck
from heavylift.preprocess.finite_elements.named_files import mesh_files

WORDS = {"inp": "*INCLUDE, INPUT={}\n", "bdf": "INCLUDE '{}'\n"}
CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]


def cube(ending):
    """A brick of 1 m."""
    if ending == "inp":
        nodes = "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(CUBE, 1))
        return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
    nodes = "".join(f"GRID,{n},,{x}.,{y}.,{z}.\n" for n, (x, y, z) in enumerate(CUBE, 1))
    return f"{nodes}CHEXA,1,1,1,2,3,4,5,6\n,7,8\n"


def written(folder, ending, texts):
    for name, text in texts.items():
        (folder / f"{name}.{ending}").write_text(text)
    return folder / f"a.{ending}"


@pytest.mark.parametrize("ending", WORDS)
def test_a_chain_of_files_is_as_long_as_it_likes(tmp_path, ending):
    word = WORDS[ending]
    texts = {f"n{k}": word.format(f"n{k + 1}.{ending}") for k in range(1100)}
    path = written(tmp_path, ending, texts | {"n1100": cube(ending), "a": word.format(f"n0.{ending}")})
    assert read_deck(path).body().mesh.element_volumes().sum() == pytest.approx(1.0, rel=1e-12)
    assert len(mesh_files(path, tmp_path)) == 1102


@pytest.mark.parametrize("ending", WORDS)
def test_a_bomb_of_files_is_refused_at_once(tmp_path, ending, monkeypatch):
    monkeypatch.setattr(deck_module, "MOST_INCLUDES", 500)
    word = WORDS[ending]
    texts = {f"n{k}": 2 * word.format(f"n{k + 1}.{ending}") for k in range(40)}
    path = written(tmp_path, ending, texts | {"n40": cube(ending), "a": word.format(f"n0.{ending}")})
    with pytest.raises(InputError, match=r"n\d+\.\w+: line [12]: includes .* the file number 501 in all"):
        read_deck(path)


def test_a_large_file_again_and_again_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(deck_module, "MOST_AGAIN", 10_000)
    path = written(tmp_path, "inp", {"n": cube("inp"), "a": 200 * "*INCLUDE, INPUT=n.inp\n"})
    with pytest.raises(InputError, match=r"includes 'n\.inp' again"):
        read_deck(path)


def test_a_file_may_be_included_twice(tmp_path):
    parts = "".join(f"*PART, NAME=P{k}\n*INCLUDE, INPUT=n.inp\n*END PART\n" for k in range(2))
    places = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I0, PART=P0\n*END INSTANCE\n*INSTANCE, NAME=I1, PART=P1\n5., 0., 0.\n"
    path = written(
        tmp_path, "inp", {"n": cube("inp"), "a": parts + places + "*END INSTANCE\n*END ASSEMBLY\n"}
    )
    deck = read_deck(path)
    assert len(deck.points) == 16
    assert deck.points[:, 0].max() == 6.0


@pytest.mark.parametrize("ending", WORDS)
def test_a_circle_is_told_where_it_closes(tmp_path, ending):
    word = WORDS[ending]
    texts = {"a": word.format(f"b.{ending}"), "b": "\n" + word.format(f"a.{ending}")}
    with pytest.raises(InputError, match=rf"b\.{ending}: line 2: 'a\.{ending}' includes itself"):
        read_deck(written(tmp_path, ending, texts))


@pytest.mark.parametrize(
    "card", ["*SUBMODEL, TYPE=NODE, INPUT=global.frd", "*AMPLITUDE, NAME=A, INPUT=global.frd"]
)
def test_files_that_other_programs_read_are_not_touched(tmp_path, card):
    """``INPUT`` of what is no mesh names results of another run, or tables; they need not be there."""
    path = written(tmp_path, "inp", {"a": f"{cube('inp')}{card}\nALL\n"})
    assert len(read_deck(path).body().mesh.elements) == 1
    (tmp_path / "global.frd").write_bytes(b"\0" * 100)
    assert len(read_deck(path).body().mesh.elements) == 1
    assert mesh_files(path, tmp_path) == [path]


def test_sets_of_sets_have_each_member_once(tmp_path):
    """A set that names another one twice, forty times over, has 2^40 members if they are counted."""
    sets = "*NSET, NSET=S0\n1, 2\n" + "".join(f"*NSET, NSET=S{k + 1}\nS{k}, S{k}\n" for k in range(40))
    chain = "".join(f"*NSET, NSET=C{k}\nC{k + 1}\n" for k in range(1500)) + "*NSET, NSET=C1500\n3\n"
    circle = "*NSET, NSET=X\nY, 4\n*NSET, NSET=Y\nX, 5\n*NSET, NSET=E, ELSET=ALL\n*NSET, NSET=F\nE\n"
    path = written(tmp_path, "inp", {"a": cube("inp") + sets + chain + circle})
    begin = time.process_time()
    found = read_deck(path).node_sets
    assert time.process_time() - begin < 2.0
    assert {name: found[name].tolist() for name in ("S40", "C0", "X", "Y")} == {
        "S40": [0, 1],
        "C0": [2],
        "X": [3, 4],
        "Y": [3, 4],
    }
    assert found["F"].tolist() == list(range(8))  # nodes of elements, through another set


def test_instances_count_together(tmp_path, monkeypatch):
    from heavylift.preprocess.finite_elements import abaqus_deck

    monkeypatch.setattr(abaqus_deck, "MOST_PLACED", 50)
    places = "".join(f"*INSTANCE, NAME=I{k}, PART=P\n{k}., 0., 0.\n*END INSTANCE\n" for k in range(6))
    text = f"*PART, NAME=P\n{cube('inp')}*END PART\n*ASSEMBLY, NAME=A\n{places}*END ASSEMBLY\n"
    with pytest.raises(InputError, match="6 instances have 54 nodes and elements"):
        read_deck(written(tmp_path, "inp", {"a": text}))


def test_blank_lines_are_read_once(tmp_path):
    path = written(tmp_path, "inp", {"a": cube("inp") + "\n" * 300_000})
    begin = time.process_time()
    mesh_files(path, tmp_path)
    assert time.process_time() - begin < 5.0
    assert np.ptp(read_deck(path).points) == 1.0
