"""Joints along edges of shells in case files: where they arrive, what is recorded and told of them."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.schema import case_schema
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.report.connections import connection_tables
from heavylift.pipeline.report.document import Document, to_markdown
from heavylift.pipeline.report.meshes import edge_sections
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.joints.edges import EdgeClamp, EdgeHinge


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "edges"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "edges.toml", folder / "case.toml")
    return folder


def scene_of(folder, *overrides):
    return assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))


def test_nodes_of_two_edges_are_at_the_same_places(folder):
    scene = scene_of(folder)
    base, seam, rim = scene.joints
    assert isinstance(base, EdgeClamp)
    assert isinstance(seam, EdgeClamp)
    assert isinstance(rim, EdgeHinge)
    left, right = scene.bodies[:2]
    # turned by -90 degrees about z, x of the body is -y of the world, and y is x
    turned = right.nodes[seam.nodes_b] @ np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        left.nodes[seam.nodes_a] + [0, 0, 3], turned + np.array([2.0, 1.0, 3.0]), atol=1e-14
    )
    assert len(seam.nodes_a) == 3
    np.testing.assert_allclose(left.nodes[base.nodes_a, 0], 0.0)
    np.testing.assert_allclose(right.nodes[rim.nodes_a, 1], 2.0)


def test_lists_of_nodes_are_the_edges_they_name(folder):
    named = scene_of(folder).joints
    a, b = ("[" + ", ".join(map(str, nodes)) + "]" for nodes in (named[1].nodes_a, named[1].nodes_b))
    given = scene_of(
        folder,
        "joints.0.edge=",
        f"joints.0.nodes={named[0].nodes_a.tolist()}",
        "joints.1.edges=",
        f"joints.1.nodes=[{a}, {b}]",
    ).joints
    for one, other in zip(named, given, strict=True):
        np.testing.assert_array_equal(one.nodes_a, other.nodes_a)
        np.testing.assert_array_equal(one.nodes_b, other.nodes_b)


def test_compliance_of_an_edge_arrives(folder):
    seam = scene_of(folder, "joints.1.compliance=1 mm/kN", "joints.1.relaxation=1 ms").joints[1]
    assert (seam.compliance, seam.relaxation) == (1e-6, 1e-3)


CHECK = 'check=[{{id="a", quantity="{}", reference=1, tolerance={{absolute=1}}, source="b"}}]'


def test_a_quantity_names_a_node_of_an_edge(folder):
    case = load_case(folder, [CHECK.format("channel.seam.2.reaction_force.z.end")])
    name = case.quantity("channel.seam.2.reaction_moment.z.max")
    assert (name.owner, name.item, name.component) == ("seam", "seam.2.reaction_moment", "z")
    assert (name.statistic, name.kind.unit) == ("max", "N m")
    for wrong, problem in (
        ("channel.seam.reaction_force.z.end", "names no node"),
        ("channel.seam.2.tension.end", "is unknown"),
        ("channel.left.2.reaction_force.z.end", "is unknown"),
    ):
        with pytest.raises(InputError, match=problem) as caught:
            load_case(folder, [CHECK.format(wrong)])
        assert len(str(caught.value).splitlines()) == 1


@pytest.fixture
def recorded(tmp_path):
    """Records of the forces and moments of three nodes."""
    forces = np.zeros((3, 2, 3))
    forces[:, 0, 2] = [1.0, -5.0, 1.0]
    forces[:, 1, 2] = [2.0, 2.0, 3.0]
    channels, columns = {}, {}
    for node in range(3):
        for kind, unit, size in (("reaction_force", "N", 1e3), ("reaction_moment", "N m", 1.0)):
            name = f"seam.{node}.{kind}"
            channels[name] = ChannelInfo(name, unit, ("x", "y", "z"), 3 * len(channels))
            columns[name] = size * forces[node]
    return Results(tmp_path, np.array([0.0, 1.0]), channels, columns, {})


def test_the_report_has_one_row_for_an_edge(folder, recorded):
    case = load_case(folder)
    text = to_markdown(Document("t", "s", tuple(edge_sections(case, recorded))))
    row = next(line for line in text.splitlines() if line.startswith("| seam"))
    assert row == ("| seam | 3 | 5 kN (node 1), 0 s | 5 N m (node 1), 0 s | (0, 0, 7) kN, 1 s |")
    assert "| base" not in text
    (table,) = connection_tables(case)
    places = [entry[3] for entry in table.rows]
    assert places == ["x_min", "x_max and y_min", "y_max"]
    quantities = Quantities(case, folder / "out")
    quantities.results = recorded
    assert quantities.number("channel.seam.1.reaction_force.z.min") == -5e3
    assert edge_sections(case, None) == []


@pytest.mark.slow
def test_edges_fit_the_schema(folder):
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(case_schema())
    document = load_case(folder).document
    assert [error.message for error in validator.iter_errors(document)] == []
    seam = document["joints"][1]
    for good in ({"nodes": [0, 1, 2]}, {"nodes": [[0, 1], [2, 3]]}):
        joint = {key: value for key, value in seam.items() if key != "edges"} | good
        assert validator.is_valid({**document, "joints": [joint]})
    for bad in ({"edge": "all"}, {"edges": ["x_min"]}, {"nodes": [-1, 2]}, {"at": [0, 0, 0]}):
        assert not validator.is_valid({**document, "joints": [{**seam, **bad}]})


@pytest.mark.slow
def test_edges_carry_what_hangs_on_them(folder):
    """Equilibrium of each part: forces along an edge add up to the weight beyond it."""
    case = load_case(folder)
    report = run_case(case)
    assert report.message == ""
    results = load_results(case)
    weight = 9.81 * 7850.0 * 0.02 * 2.0  # of one plate of 2 m2
    carried = {"base": -(2.0 * weight + 98.1), "seam": weight + 98.1, "rim": 98.1}
    for name, force in carried.items():
        total = sum(results[f"{name}.{node}.reaction_force"][0] for node in range(3))
        np.testing.assert_allclose(total, [0.0, 0.0, force], atol=1e-5 * weight)
    tip = results["right.position"].reshape(-1, 3)[-1]
    assert tip[2] < 2.99
    text = (report.folder.stage("report") / "report.md").read_text()
    assert "## Reactions along edges" in text
    assert report.stage("simulate").cpu_s > 0.0
