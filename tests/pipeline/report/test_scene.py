"""The report of frames and shells: which instants are pictured, animations, and what is said if there are none."""

import json

import h5py
import numpy as np
import pytest

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands import cli
from heavylift.pipeline.drawn.build import mesh_run
from heavylift.pipeline.pictures.render import RenderingUnavailableError, rendering_backend
from heavylift.pipeline.report.document import Document, Figure, Section, to_html, to_markdown
from heavylift.pipeline.report.report import write_report
from heavylift.pipeline.results.histories import FORMAT, load_results
from heavylift.pipeline.results.mesh_results import mesh_body, mesh_shape, write_meshes
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.bodies.ancf.stress import frame_stresses

LENGTH, ELEMENTS, RECORDS = 2.0, 6, 9
CASE = """
title = "Bent bar"
[bodies.bar]
type = "frame"
model = "exact"
geometry = { type = "line", start = [0, 0, 0], end = ["2 m", 0, 0], elements = 6 }
section = { density = "7850 kg/m^3", young_modulus = "210 GPa", diameter = "50 mm" }
axial_strain = 1e-4
initial = { position = [0, 0, "1 m"] }
[bodies.block]
type = "rigid"
mass = "1 kg"
inertia = ["1 kg m^2", "1 kg m^2", "1 kg m^2"]
frame = { motion = "free" }
initial = { position = [0, 0, "1 m"] }
[[joints]]
name = "pin"
type = "ball"
between = ["bar", "block"]
at = [0, 0, "1 m"]
[simulate]
step = "10 ms"
output_interval = "10 ms"
duration = "80 ms"
"""


def arc(angle):
    s = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    if angle == 0.0:
        return np.column_stack([s, 0 * s, 0 * s + 1.0]), np.tile([1.0, 0.0, 0.0], (len(s), 1))
    t, radius = s * angle / LENGTH, LENGTH / angle
    places = np.column_stack([radius * np.sin(t), 0 * t, 1.0 + radius * (1.0 - np.cos(t))])
    return places, np.column_stack([np.cos(t), 0 * t, np.sin(t)])


@pytest.fixture
def case(tmp_path):
    folder = tmp_path / "bar_case"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE)
    return load_case(folder)


@pytest.fixture
def out(case, tmp_path):
    """Results of a bar that is bent and half straightened again: record 4 bears most."""
    out = tmp_path / "out"
    folder = OutputFolder(out)
    bar = next(body for body in assemble_scene(case, folder).bodies if body.name == "bar")
    angles = 0.5 - np.abs(np.arange(RECORDS) - 4) * 0.1
    states = [arc(angle) for angle in angles]
    nodes = [f"{n}.{c}" for n in range(ELEMENTS + 1) for c in "xyz"]
    channels = {
        "bar.position": ("m", nodes, np.array([places.ravel() for places, _ in states])),
        "bar.tangent": ("", nodes, np.array([tangents.ravel() for _, tangents in states])),
        "bar.axial_stress": ("Pa", [str(e) for e in range(ELEMENTS)], np.outer(angles, [1e9] * ELEMENTS)),
        "block.position": ("m", list("xyz"), np.tile([0.0, 0.0, 1.0], (RECORDS, 1))),
        "block.orientation": ("", list("wxyz"), np.tile([1.0, 0.0, 0.0, 0.0], (RECORDS, 1))),
    }
    folder.results.parent.mkdir(parents=True)
    with h5py.File(folder.results, "w") as file:
        file.attrs.update(
            {"format": FORMAT, "outcome": "completed", "channel_order": json.dumps(list(channels))}
        )
        file["time"] = 0.01 * np.arange(RECORDS)
        for name, (unit, components, data) in channels.items():
            dataset = file.create_dataset(f"channels/{name}", data=data)
            dataset.attrs.update({"unit": unit, "components": json.dumps(components), "column": 0})
        write_meshes(file, [mesh_shape(bar)])
    return out


@pytest.fixture
def drawing():
    try:
        rendering_backend()
    except RenderingUnavailableError as error:
        pytest.skip(str(error))


def with_report(case, **keys):
    return case.model_copy(update={"report": type(case.report).model_validate(keys)})


def test_stored_frame_has_the_stress_of_the_one_that_was_simulated(case, out):
    results = load_results(case, out)
    run = mesh_run(results.meshes["bar"], results)
    found = frame_stresses(run.body, run.coordinates(4), [0.5], lengths=run.lengths)
    np.testing.assert_allclose(found.fibre_stress, 2.1e11 * 0.025 * 0.5 / LENGTH, rtol=2e-3)
    rest = run.rest
    np.testing.assert_allclose(rest[:, 0, 2], 1.0, atol=1e-15)
    start = frame_stresses(mesh_body(results.meshes["bar"]), rest, [0.0, 0.5])
    np.testing.assert_allclose(start.axial_stress, 2.1e7, rtol=1e-9)  # pre-stressed by 1e-4


@pytest.mark.slow
def test_end_and_largest_recorded_stress_are_pictured_or_the_times_asked_for(case, out, drawing, tmp_path):
    files = write_report(case, tmp_path / "report", out)
    assert {"scene_1.png", "scene_2.png"} <= {path.name for path in files}
    assert not [path for path in files if path.suffix in {".gif", ".mp4"}]
    text = (tmp_path / "report" / "report.md").read_text()
    assert "Shape at t = 40 ms, largest recorded stress" in text
    assert "Shape at t = 80 ms, end of the run" in text
    assert "axial stress of each fibre" in text
    asked = with_report(case, stress_times=("21 ms",), animation={"frames": 4, "format": "gif"})
    files = write_report(asked, tmp_path / "report", out)
    assert (tmp_path / "report" / "scene_animation.gif") in files
    assert not (tmp_path / "report" / "scene_2.png").exists()  # of the earlier report
    text = (tmp_path / "report" / "report.md").read_text()
    assert "Shape at t = 20 ms." in text
    assert "80 ms of simulated time in 4 s, 4 frames" in text
    assert "data:image/gif;base64," in (tmp_path / "report" / "report.html").read_text()


def test_animation_that_cannot_be_made_is_said(case, tmp_path):
    wanted = with_report(case, animation={})
    write_report(wanted, tmp_path / "report", tmp_path / "nothing")
    text = (tmp_path / "report" / "report.md").read_text()
    assert "No animation: there is no history of anything that could be drawn" in text
    off = with_report(case, animation={"enabled": False})
    write_report(off, tmp_path / "report", tmp_path / "nothing")
    assert "No animation" not in (tmp_path / "report" / "report.md").read_text()


def test_films_are_embedded_as_video_and_linked_in_markdown():
    document = Document("t", "s", (Section("a", (Figure("run.mp4", "Film"),)),))
    page = to_html(document, {"run.mp4": b"film"})
    assert '<video src="data:video/mp4;base64,ZmlsbQ=="' in page
    assert "[Film](run.mp4)" in to_markdown(document)


def test_animate_switches_the_animation_on_and_keeps_its_settings(case, monkeypatch):
    asked = []
    monkeypatch.setattr(cli, "_stages", lambda *arguments, **_options: asked.append(arguments) or 0)
    cli.app(["report", str(case.folder), "--animate"], result_action="return_value")
    (_, _, path, _, changes), *_ = asked
    changed = load_case(path, (*changes, "report.animation.frames=7"))
    assert changed.report.animation.enabled
    assert changed.report.animation.frames == 7
    assert load_case(path).report.animation is None
