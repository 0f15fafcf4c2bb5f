"""Bad joints along edges of shells: one clear error each, before anything runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder


@pytest.fixture
def edges(tmp_path):
    folder = tmp_path / "edges"
    folder.mkdir()
    text = (Path(__file__).parents[1] / "pipeline" / "edges.toml").read_text()
    (folder / "case.toml").write_text(text + ROD)
    return folder


ROD = """
[bodies.rod]
type = "frame"
geometry = { type = "line", start = [0, 0, 0], end = [1, 0, 0], elements = 2 }
section = { density = 1, young_modulus = 1, diameter = 1 }
"""
BENT = "[0, 0, 0], [1, 0, 0], [2, 0, 0], [0.3, 0.5, 0], [1, 0.5, 0], [2, 0.5, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]"


@pytest.mark.parametrize(
    ("overrides", "key", "problem", "expected"),
    [
        (["0.edge=left"], "0.edge", "'left'", "'x_min', 'x_max', 'y_min' or 'y_max'"),
        (["0.edge=all"], "0.edge", "'all'", "'x_min', 'x_max', 'y_min' or 'y_max'"),
        (["0.edge="], "0", "no edge", "one of edge, edges, nodes"),
        (["0.nodes=[0, 1]"], "0", "both 'edge' and 'nodes'", "one of edge, edges, nodes"),
        (["0.at=[0, 0, 0]"], "0.at", "unknown key", "one of: between"),
        (['0.between=["ground", "left"]'], "0.between", "'ground' is no shell", '["left", "ground"]'),
        (['0.between=["bar", "ground"]'], "0.between", "'bar' is no shell", "a shell first"),
        (['0.between=["ground", "ground"]'], "0.between", "both sides are the ground", "at least one body"),
        (['0.between=["left", "rod"]'], "0.between", "'rod' is a frame", "a shell, and 'ground'"),
        (['1.between=["left", "left"]'], "1.between", "both sides are 'left'", "two different bodies"),
        (['1.between=["left", "ground"]'], "1.edges", "'ground' is none", "'edge', or one list"),
        (['0.between=["left", "right"]'], "0.edge", "and none of 'right'", "one a shell"),
        (['1.edges=["x_max"]'], "1.edges", "1 entries", "at least 2"),
        (['1.edges=["x_max", "z_min"]'], "1.edges.1", "'z_min'", "'x_min', 'x_max', 'y_min' or 'y_max'"),
        (['1.edges=["x_max", "x_min"]'], "1.edges", "3 nodes of 'left' and 4 of 'right'", "same elements"),
        (
            ['1.edges=["x_max", "y_max"]'],
            "1.edges",
            "do not coincide: node 0 along them is 2000 mm",
            "one place",
        ),
        (
            ["bodies.right.initial.position.0=2.01 m"],
            "1.edges",
            "is 10 mm from the other",
            "'initial' places",
        ),
        (["bodies.right.geometry.elements=[3, 3]"], "1.edges", "3 nodes of 'left' and 4 of", "same elements"),
        (["0.edge=", "0.nodes=[0, -1]"], "0.nodes.1", "-1 is too small", ">= 0"),
        (["0.edge=", "0.nodes=[0]"], "0.nodes", "1 entries", "at least 2"),
        (["0.edge=", "0.nodes=[0, 12]"], "0.nodes", "no node 12 in 'left'", "from 0 to 11"),
        (["0.edge=", "0.nodes=[0, 2]"], "0.nodes", "not the ends of a side", "along an edge, in order"),
        (["0.edge=", "0.nodes=[1, 0, 3]"], "0.nodes", "go round a corner", "one joint for each edge"),
        (["0.edge=", "0.nodes=[[0, 1], [0, 1]]"], "0.nodes", "'ground' is none", "one list of nodes"),
        (["1.edges=", "1.nodes=[[9, 10], [0, 44]]"], "1.nodes.1", "no node 44 in 'right'", "from 0 to 11"),
        (
            [
                "0.type=edge_hinge",
                f'bodies.left.geometry={{type="grid", elements=[2, 2], points=[{BENT}]}}',
            ],
            "0.edge",
            "the edge is bent",
            "a straight edge",
        ),
        (["2.compliance=1 kg"], "2.compliance", "'1 kg' is a mass", "a compliance"),
        (
            ['forces=[{type="joint_spring", name="spring", joint="rim", stiffness=1}]'],
            "forces.0.joint",
            "joint 'rim' of type 'edge_hinge' has neither",
            "a hinge or a slider",
        ),
    ],
)
def test_one_mistake_is_one_line_with_key_problem_and_expectation(edges, overrides, key, problem, expected):
    changes = [text if text[0] in "bf" else f"joints.{text}" for text in overrides]
    with pytest.raises(InputError) as caught:
        assemble_scene(load_case(edges, changes), OutputFolder(edges / "out"))
    (line,) = str(caught.value).splitlines()
    assert f": {key if key[0] == 'f' else f'joints.{key}'}: " in line
    assert problem in line
    assert expected in line.partition("; expected ")[2]
