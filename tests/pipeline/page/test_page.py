"""Data of the interactive page: numbers as they were, names as text, extremes kept, what is left out said."""

from __future__ import annotations

import base64
import json
import re
import subprocess
import sys
import zlib
from html.parser import HTMLParser

import numpy as np
import pytest
from made_pages import (
    TIMES,
    lift_case,
    lift_motion,
    lifted,
    made_content,
    made_results,
)

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.drawn.build import PAGE, case_scene
from heavylift.pipeline.drawn.moments import Moment
from heavylift.pipeline.page.channels import pack_channels
from heavylift.pipeline.page.packing import Block, header_text
from heavylift.pipeline.page.page import page_content, page_html
from heavylift.solver.scene.drawn import Solid


@pytest.fixture(scope="module")
def lift(tmp_path_factory):
    return lift_motion(tmp_path_factory.mktemp("lift") / "lift")


def values_of(reference, content):
    """Array of a reference in the bytes of a block."""
    kind = np.dtype(f"<{reference['t']}")
    found = np.frombuffer(content, kind, reference["n"], reference["o"]).reshape(reference["s"])
    if "step" in reference:
        return np.array(reference["low"]) + np.array(reference["step"]) * found
    return found


def test_quantised_numbers_are_within_half_a_level_of_their_range():
    values = np.random.default_rng(3).normal(size=(50, 7, 3)) * [1.0, 100.0, 1e-6]
    block = Block()
    block.add([1, 2, 3], "u1")  # whatever lies before
    found = values_of(block.quantised(values), zlib.decompress(block.packed()))
    level = np.ptp(values.reshape(-1, 3), axis=0) / 65535
    assert np.all(np.abs(found - values) <= 0.5000001 * level + 1e-12)


def test_what_single_precision_does_not_hold_is_no_number():
    block = Block()
    found = values_of(block.add([1.0, 1e300, -np.inf, np.nan]), b"".join(block.parts))
    assert found[0] == 1.0
    assert np.isnan(found[1:]).all()


def test_a_header_ends_no_script_and_has_numbers_that_json_knows():
    header = {
        "a": "</script><script>alert(1)</script><!--",
        "b": float("nan"),
        "c": [np.float64(2.0), np.inf],
    }
    text = header_text(header)
    assert not set(text) & set("<>&")
    assert json.loads(text) == {"a": header["a"], "b": None, "c": [2.0, None]}


class Scripts(HTMLParser):
    """Scripts of a page, and whether there are tags that a name brought."""

    def __init__(self):
        super().__init__()
        self.count, self.alien = 0, []

    def handle_starttag(self, tag, attributes):
        self.count += tag == "script"
        if tag in {"img", "iframe"} or any(key.startswith("on") for key, _ in attributes):
            self.alien.append(tag)


def test_names_are_text_and_no_place_of_the_page(lift):
    """Four scripts, whatever a title says; and a name that looks like a place of the template stays a name."""
    case, results, motion = lift
    evil = "</script><img src=x onerror=alert(1)>[SCRIPT][BLOCK]"
    content = made_content(case.model_copy(update={"title": evil}), motion, results, notes=[evil])
    text = page_html(content)
    found = Scripts()
    found.feed(text)
    assert found.count == 4
    assert not found.alien
    header = json.loads(re.search(r'id="hl-header">(.*?)</script>', text)[1])
    assert header["title"] == evil
    packed = re.search(r'id="hl-block">(.*?)</script>', text)[1]
    assert len(zlib.decompress(base64.b64decode(packed))) == content.block.size
    assert "http://" not in re.sub(r'id="hl-(library|block)">.*?</script>', "", text)


def test_bodies_and_ropes_are_where_the_records_say(lift):
    """A lug at (5, 3, 2) m of a module that turns by 0.1 rad/s, at a time between two records."""
    _, _, motion = lift
    time = 4.04
    angle, height = 0.1 * time, 2.0 + 0.5 * time
    lug = [5 * np.cos(angle) - 3 * np.sin(angle), 5 * np.sin(angle) + 3 * np.cos(angle), height + 2.0]
    sling = next(line for line in motion.lines if line.name == "sling_1")
    np.testing.assert_allclose(Moment(motion, time).line(sling), [[0.0, 0.0, height + 12.0], lug], atol=1e-5)
    box = next(surface for surface in motion.surfaces if surface.name == "module")
    points = Moment(motion, time).surface(box)
    np.testing.assert_allclose(points.mean(axis=0), [0.0, 0.0, height], atol=1e-9)
    corner = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ [6.0, 4.0]
    assert np.linalg.norm(points[:, :2] - corner, axis=1).min() < 1e-5


def test_the_block_holds_the_poses_of_the_records(lift):
    case, results, motion = lift
    content = made_content(case, motion, results)
    block = zlib.decompress(content.block.packed())
    body = next(one for one in content.header["bodies"] if one["name"] == "module")
    np.testing.assert_allclose(
        values_of(body["position"], block), results["module.position"], rtol=1e-6, atol=1e-6
    )
    timeline = values_of(content.header["timelines"][body["timeline"]], block)
    np.testing.assert_array_equal(timeline, TIMES)
    channel = next(one for one in content.header["channels"] if one["name"] == "hoist.tension")
    np.testing.assert_allclose(values_of(channel["values"], block)[:, 0], results["hoist.tension"], rtol=1e-6)


def test_a_check_leads_to_its_channel_time_and_place(lift):
    case, results, motion = lift
    header = made_content(case, motion, results).header
    (row,) = header["checks"]
    assert row["series"] == ["module.position", 2]
    assert (row["time"], row["places"]) == (3.0, ["module"])
    assert header["limits"] == [
        {"series": "module.position.z", "value": 6.0, "side": "maximum", "name": "height"}
    ]


def test_a_body_that_leaves_is_told_and_the_others_stay_in_view(tmp_path):
    arrays = lifted()
    arrays["hook.position"][40:] = 1e30
    case, results, motion = lift_motion(tmp_path / "lift", arrays)
    assert any("hook has left: from t = 4 s on" in note for note in motion.notes)
    assert motion.size < 100.0
    content = made_content(case, motion, results)
    position = next(one for one in content.header["bodies"] if one["name"] == "hook")["position"]
    found = values_of(position, zlib.decompress(content.block.packed()))
    assert np.isfinite(found[:40]).all()
    assert np.isnan(found[40:]).all()


def test_bodies_that_are_small_beside_their_distances_have_labels_at_once(tmp_path, lift):
    """A module of 14 m beside a hook that is 800 m away; the same beside a near one has none."""
    arrays = lifted()
    arrays["hook.position"][:, 0] = 800.0
    case, results, motion = lift_motion(tmp_path / "lift", arrays)
    assert made_content(case, motion, results).header["labelled"] is True
    assert made_content(*(lift[k] for k in (0, 2, 1))).header["labelled"] is False


def test_a_tension_without_data_colours_nothing(tmp_path):
    """The scale of the tensions is that of the ropes that have some."""
    arrays = lifted()
    arrays["sling_1.tension"] = np.full(81, np.nan)
    case, results, motion = lift_motion(tmp_path / "lift", arrays)
    largest = made_content(case, motion, results).header["tension"]["largest"]
    assert largest == pytest.approx(results["hoist.tension"].max())
    none = {name: np.full(81, np.nan) if name.endswith("tension") else one for name, one in arrays.items()}
    case, results, motion = lift_motion(tmp_path / "none", none)
    assert made_content(case, motion, results).header["tension"] is None


def test_a_million_triangles_are_thinned_and_it_is_said(tmp_path, monkeypatch):
    """A plate of 1.01 million triangles: few enough remain, its corners are there, and a sentence says how many."""
    case, stages = lift_case(tmp_path / "lift")
    side = 711
    x, y = np.meshgrid(np.linspace(-6, 6, side), np.linspace(-4, 4, side), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), 0.1 * np.sin(x.ravel())])
    number = np.arange(side * side).reshape(side, side)
    a, b, c, d = (
        part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    assert len(triangles) > 1_000_000
    monkeypatch.setattr(
        "heavylift.pipeline.drawn.build.elements",
        lambda _scene: [Solid(name="plate", role="body", body="module", points=points, triangles=triangles)],
    )
    motion = case_scene(case, stages, assemble_scene(case, stages), made_results(lifted()))
    assert sum(len(one.triangles) for one in motion.surfaces) <= PAGE.triangles
    plate = next(one for one in motion.surfaces if one.name == "module")
    assert len(plate.triangles) > 0.2 * PAGE.triangles
    assert plate.coarse is not None
    assert plate.coarse.max() < len(plate.points)
    np.testing.assert_allclose(np.ptp(plate.points[:, :2], axis=0), [12.0, 8.0], rtol=0.02)
    assert any(f"of its {len(triangles):,} triangles" in note for note in motion.notes)


def test_thinned_channels_keep_every_extreme():
    """A spike of one record among 100,000 is the largest value of its interval."""
    times = np.linspace(0.0, 1000.0, 100_001)
    wave = np.sin(times)
    wave[51_234], wave[7] = 40.0, -30.0
    results = made_results({f"a_{k}.force": wave for k in range(10)}, times)
    block = Block()
    channels, timelines, notes = pack_channels(results, block, {}, budget=400_000)
    content = b"".join(block.parts)
    assert len(content) < 500_000
    found = values_of(channels[3]["values"], content)
    assert (found[..., 1].max(), found[..., 0].min()) == (40.0, -30.0)
    at = values_of(timelines[0], content)
    assert at[found[:, 0, 1].argmax()] == pytest.approx(times[51_234], abs=1.0)
    assert "smallest and the largest value" in notes[0]


def test_nodes_of_a_mesh_are_plotted_by_their_range():
    values = np.random.default_rng(1).normal(size=(81, 300))
    results = made_results({"beam.position": values, "beam.empty": np.full(81, np.nan)})
    block = Block()
    channels, _, notes = pack_channels(results, block, {})
    found = values_of(channels[0]["values"], b"".join(block.parts))
    np.testing.assert_allclose(found, np.column_stack([values.min(axis=1), values.max(axis=1)]), rtol=1e-6)
    assert channels[0]["components"] == ["smallest", "largest"]
    assert notes


def test_ten_minutes_fit_into_the_size_of_a_page(tmp_path):
    """12,001 records of a lift: every one is placed, and the page is far below 20 MB."""
    times = np.linspace(0.0, 600.0, 12_001)
    case, results, motion = lift_motion(tmp_path / "lift", lifted(times), times)
    assert len(motion.times[0]) == min(PAGE.poses, 12_001)
    assert len(page_html(made_content(case, motion, results))) < 8_000_000


def test_a_page_before_a_run_has_names_and_no_time(tmp_path):
    case, stages = lift_case(tmp_path / "lift")
    motion = case_scene(case, stages, assemble_scene(case, stages), None, marked=True)
    header = page_content(case, motion, None, labelled=True).header
    assert (header["begin"], header["end"], header["channels"]) == (0.0, 0.0, [])
    texts = [label["text"] for label in header["labels"]]
    assert {"module", "hook", "sling_1", "hoist, 2"} <= set(texts)
    assert all("fixed" in body for body in header["bodies"])


@pytest.mark.slow
def test_neither_the_command_line_nor_a_simulation_imports_it():
    """Of the modules of a process that has what `simulate` needs, none is of the page or of k3d."""
    code = (
        "import sys, heavylift.pipeline.commands.cli, heavylift.pipeline.stages.stages, "
        "heavylift.pipeline.stages.simulate, heavylift.pipeline.stages.report\n"
        "print([m for m in sys.modules if 'pipeline.page' in m or m.partition('.')[0] in {'k3d', 'http'}])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
