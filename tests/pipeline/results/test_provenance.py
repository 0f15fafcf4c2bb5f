"""What makes results stale: sources that a stage runs."""

import inspect
from pathlib import Path

import pytest

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.coupling.coupled import CoupledSimulation
from heavylift.pipeline.results import provenance
from heavylift.pipeline.results.provenance import PACKAGE, STAGE_SOURCES, files_of_case, simulate_digest
from heavylift.pipeline.stages.advance import Advancer
from heavylift.pipeline.stages.prepared import new_simulation
from heavylift.solver.simulation import Simulation

CASE = """
title = "A mass that is pushed"
bodies.mass = { type = "rigid", mass = 1, inertia = [1, 1, 1], frame = { motion = "free" } }
inputs = [{ name = "push", type = "force", body = "mass", point = [0, 0, 0] }]
simulate = { integrator = "dele2", step = 0.01, output_interval = 0.1, duration = 1 }
"""
FMUS = """
[[fmus]]
name = "hold"
file = "hold.fmu"
sample_time = 0.1
writes = { force = "push" }
"""


@pytest.mark.parametrize(
    ("part", "stage"),
    [
        (assemble_scene, "simulate"),
        (new_simulation, "simulate"),
        (Advancer, "simulate"),
        (Simulation, "simulate"),
        (CoupledSimulation, "fmus"),
    ],
)
def test_results_depend_on_all_that_makes_them(part, stage):
    file = Path(inspect.getfile(part)).resolve()
    assert any(file.is_relative_to((PACKAGE / name).resolve()) for name in STAGE_SOURCES[stage])


def test_the_exchange_with_fmus_counts_where_there_are_some(tmp_path, monkeypatch):
    (tmp_path / "hold.fmu").touch()
    texts = {"with": CASE + FMUS, "without": CASE}
    own = provenance.source_digest

    def digests():
        found = {}
        for name, text in texts.items():
            (tmp_path / "case.toml").write_text(text)
            found[name] = simulate_digest(load_case(tmp_path))
        return found

    before = digests()
    monkeypatch.setattr(provenance, "source_digest", lambda stage: own(stage) + "x" * (stage == "fmus"))
    after = digests()
    assert before["with"] != after["with"]
    assert before["without"] == after["without"]


def test_an_unpacked_fmu_is_all_of_its_folder(tmp_path):
    """Its sources are compiled: a case that is saved elsewhere takes them along, and results depend on them."""
    source = tmp_path / "hold" / "sources" / "hold.c"
    source.parent.mkdir(parents=True)
    source.write_text("int hold;")
    (tmp_path / "hold" / "modelDescription.xml").touch()
    (tmp_path / "case.toml").write_text((CASE + FMUS).replace("hold.fmu", "hold/modelDescription.xml"))
    case = load_case(tmp_path)
    assert files_of_case(case) == {"hold/modelDescription.xml", "hold/sources/hold.c"}
    before = simulate_digest(case)
    source.write_text("int held;")
    assert simulate_digest(load_case(tmp_path)) != before
