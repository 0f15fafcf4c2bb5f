"""Results are arrays by name and unit, from a merged file or from the segments of a stopped run."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_results
from heavylift.pipeline.results.histories import ChannelInfo, merge_segments
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.advance import Advancer, StopRequest


@pytest.fixture
def out(tmp_path, fake_simulation):
    """Output folder with the segments of a run, and the simulation that made them."""
    folder = OutputFolder(tmp_path / "out")
    simulation = fake_simulation()
    Advancer(simulation, folder.segments, "digest", 400).run(StopRequest(), lambda _a, _b: None)
    return folder


def merge(folder, channels):
    infos = [ChannelInfo(c.name, c.unit, c.components, c.column) for c in channels]
    metadata = {
        "title": "a run",
        "outcome": "completed",
        "step": 0.5,
        "sources": ["a", "b"],
        "versions": {"x": "1"},
    }
    sentences = {"a.position": "where it is", "energy.balance": "what is left"}
    merge_segments(folder.segments, folder.results, infos, sentences, metadata)


def test_an_unfinished_run_can_be_read(out):
    results = load_results(out.root)
    assert results.outcome == "unfinished"
    assert results.names == ("a.position", "energy.balance")
    assert results["a.position"].shape == (41, 2)
    assert results["energy.balance"].shape == (41,)
    assert results.unit("a.position") == "m"
    assert results.components("a.position") == ("x", "y")
    assert np.array_equal(results.time, 5.0 * np.arange(41))


def test_merging_changes_no_bit_and_describes_itself(out, fake_simulation):
    before = load_results(out.root)
    merge(out, fake_simulation.channels)
    after = load_results(out.root)
    assert after.names == before.names
    for name in before:
        assert np.array_equal(after[name], before[name])
    assert np.array_equal(after.time, before.time)
    assert after.outcome == "completed"
    assert after.metadata["sources"] == ["a", "b"]
    assert after.unit("energy.balance") == "J"
    with h5py.File(out.results) as file:
        assert file["channels"]["a.position"].attrs["unit"] == "m"
        assert file["channels"]["a.position"].attrs["description"] == "where it is"
        assert file["time"].attrs["unit"] == "s"


def test_an_unknown_channel_names_those_that_exist(out):
    with pytest.raises(InputError, match=r"'a.positoin' does not exist.*a\.position"):
        load_results(out.root)["a.positoin"]


def test_no_results_says_how_to_make_them(tmp_path):
    with pytest.raises(InputError, match="heavylift simulate"):
        load_results(tmp_path)


@pytest.mark.parametrize("part", [0.0, 0.02, 0.3, 0.7, 0.999])
def test_a_truncated_file_is_an_input_error_with_a_remedy(out, fake_simulation, part):
    merge(out, fake_simulation.channels)
    data = out.results.read_bytes()
    out.results.write_bytes(data[: int(part * len(data))])
    with pytest.raises(InputError, match=r"damaged.*--force"):
        load_results(out.root)
