"""Node matrices in files: what is read, and one clear error for everything else."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.splines.node_matrix import node_matrix, read_node_matrix, read_node_row
from heavylift.numerics.outcome import InputError


def write(folder, text: str):
    path = folder / "contour.txt"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "text",
    [
        "[1,2,3;4,5,6]",
        "[1,2,3;4,5,6]\n",
        "1 2 3; 4 5 6",
        "[1, 2, 3;\n 4, 5, 6;]",
        "% top face\n1,2,3\n4,5,6 # second row\n",
        "[1, 2,\n3; 4, 5, 6]",
    ],
)
def test_ways_to_write_a_matrix(tmp_path, text: str) -> None:
    matrix = read_node_matrix(write(tmp_path, text), 6)
    assert matrix.dtype == np.int64
    assert matrix.tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize("text", ["[7;5;6]", "[7,5,6]", "7\n5\n6\n"])
def test_a_curve_is_a_row_or_a_column(tmp_path, text: str) -> None:
    assert read_node_row(write(tmp_path, text), 7).tolist() == [6, 4, 5]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[1,2,3;4,5]", "top: row 2: 2 nodes; expected 3 nodes as in the first row"),
        ("[1,2;3,1]", "row 2, column 2: node 1 stands here again, first in row 1, column 1"),
        ("[1,,3]", "row 1, column 2: a node is missing"),
        ("[1,2;;3,4]", "row 2, column 1: a node is missing"),
        ("[1,2;3,]", "row 2, column 2: a node is missing"),
        ("[1,2;3,10]", "row 2, column 2: node 10; expected a node of the body, 1 to 9"),
        ("[0,2]", "row 1, column 1: node 0; expected a node of the body"),
        ("[-1,2]", "row 1, column 1: node -1"),
        ("[1.5,2]", "'1.5' is not the number of a node"),
        ("[1,two]", "row 1, column 2: 'two' is not"),
        ("[1,2", "one bracket"),
        ("[]", "holds no node"),
        ("% nothing\n", "holds no node"),
        ("[99999999999999999999,2]", "is not the number of a node|node 99999999999999999999"),
    ],
)
def test_one_clear_error(tmp_path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_node_matrix(write(tmp_path, text), 9, "top")


def test_a_surface_is_no_curve(tmp_path) -> None:
    with pytest.raises(InputError, match=r"2 rows of 2 nodes"):
        read_node_row(write(tmp_path, "[1,2;3,4]"), 4)


def test_a_file_that_cannot_be_read(tmp_path) -> None:
    with pytest.raises(InputError, match=r"cannot be read: No such file"):
        read_node_matrix(tmp_path / "absent.txt", 4)
    (tmp_path / "binary").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(InputError, match=r"is no text"):
        read_node_matrix(tmp_path / "binary", 4)


def test_lists_of_a_case_are_checked_alike() -> None:
    assert node_matrix([[2, 1]], 2).tolist() == [[1, 0]]
    with pytest.raises(InputError, match=r"row 2: 1 nodes"):
        node_matrix([[1, 2], [3]], 3)
    with pytest.raises(InputError, match=r"holds no node"):
        node_matrix([], 3)


def test_published_files(mbsim_data) -> None:
    """Contour of the complex beam, 5 rows of 7 of its 374 nodes; line of 61 of the 549 nodes of the sliding beam."""
    surface = read_node_matrix(mbsim_data / "complex_beam" / "Example_Contour.txt", 374)
    assert surface.shape == (5, 7)
    assert surface[0, 0] == 115
    assert surface[4, 6] == 136
    line = read_node_row(mbsim_data / "sliding_beam" / "NeutralPhase.txt", 549)
    assert line.shape == (61,)
    assert (line[0], line[-1]) == (547, 7)
