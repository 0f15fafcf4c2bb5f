"""An equilibrium is found once: the next simulation of the scene takes it, with the same bits, and no other does."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.results.kept_start import KeptStart
from heavylift.pipeline.stages import advance, simulate
from heavylift.pipeline.stages.advance import StopRequest

SEARCH = "heavylift.solver.statics.equilibrium.find_equilibrium"
CASE = """
title = "A weight on two ropes, not where it hangs at rest"
gravity.acceleration = [0, 0, "-9.81 m/s^2"]
[bodies.weight]
type = "rigid"
mass = "2 t"
inertia = ["2 t m^2", "2 t m^2", "2 t m^2"]
frame = { motion = "free" }
[[ropes]]
name = "left"
axial_stiffness = "1 MN"
path = [{ body = "ground", point = [-3, 0, 5] }, { body = "weight", point = [-1, 0, "0.5 m"] }]
[[ropes]]
name = "right"
axial_stiffness = "1 MN"
path = [{ body = "ground", point = [4, 0, 6] }, { body = "weight", point = [1, 0, "0.5 m"] }]
[simulate]
step = "10 ms"
output_interval = "50 ms"
duration = "1 s"
start = "equilibrium"
"""


class SearchedError(Exception):
    """A search was made."""


@pytest.fixture
def found(tmp_path):
    """A case that has been simulated."""
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path)
    run_case(case, stages=("simulate",))
    return case


def no_search(monkeypatch):
    def search(_rows):
        raise SearchedError

    monkeypatch.setattr(SEARCH, search)


def histories(case):
    results = load_results(case)
    return {name: results[name].copy() for name in results}


def same(one, other):
    return all(one[name].tobytes() == other[name].tobytes() for name in one)


def test_the_same_scene_starts_where_it_was_found_to_rest(found, monkeypatch):
    before = histories(found)
    no_search(monkeypatch)
    report = run_case(found, stages=("simulate",), force=("simulate",))
    assert same(before, histories(found))
    assert "equilibrium after" in report.stage("simulate").details["start"]
    # how long it runs is no matter of its rest
    case = load_case(found.folder, ["simulate.duration=0.5 s"])
    run_case(case, stages=("simulate",))
    assert same({name: values[:11] for name, values in before.items()}, histories(case))


def test_a_stopped_run_goes_on_from_the_same_rest(found, monkeypatch):
    before = histories(found)

    class Later(StopRequest):
        asked = 0

        def __bool__(self):
            Later.asked += 1
            return Later.asked > 2

    with monkeypatch.context() as patched:
        patched.setattr(advance, "FIRST_PIECE", 10)
        patched.setattr(advance, "next_piece", lambda _piece, _seconds, _growth: 10)
        patched.setattr(simulate, "stop_requests", lambda: contextlib.nullcontext(Later("SIGTERM")))
        report = run_case(found, stages=("simulate",), force=("simulate",))
    assert report.outcome is Outcome.INTERRUPTED
    no_search(monkeypatch)
    assert run_case(found, stages=("simulate",)).outcome is Outcome.COMPLETED
    assert same(before, histories(found))


@pytest.mark.parametrize(
    "change", ["bodies.weight.mass=2.0000001 t", "ropes.0.axial_stiffness=1.1 MN", "simulate.start=relax"]
)
def test_another_scene_is_searched(found, monkeypatch, change):
    no_search(monkeypatch)
    case = load_case(found.folder, [change])
    if change.endswith("relax"):
        run_case(case, stages=("simulate",))
        assert "relaxed" in load_results(case).metadata["start"]
        return
    with pytest.raises(SearchedError):
        run_case(case, stages=("simulate",))


def test_a_file_with_other_bits_is_not_taken(found, monkeypatch):
    before = histories(found)
    file = found.output_folder / "simulate" / "start.npz"
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    with monkeypatch.context() as patched:
        no_search(patched)
        with pytest.raises(SearchedError):
            run_case(found, stages=("simulate",), force=("simulate",))
    run_case(found, stages=("simulate",), force=("simulate",))
    assert same(before, histories(found))


def test_what_leaves_another_residual_is_searched_and_leaves_nothing(found, monkeypatch):
    before, read = histories(found), KeptStart.read
    asked = []

    def moved(self, digest):
        kept = read(self, digest)
        asked.append(kept)
        arrays = {
            name: (1.001 * array.view(np.float64)).view(np.uint8) for name, array in kept.arrays.items()
        }
        return kept._replace(arrays=arrays)

    monkeypatch.setattr(KeptStart, "read", moved)
    with monkeypatch.context() as patched:
        no_search(patched)
        with pytest.raises(SearchedError):
            run_case(found, stages=("simulate",), force=("simulate",))
    run_case(found, stages=("simulate",), force=("simulate",))
    assert all(kept is not None for kept in asked)
    assert same(before, histories(found))


ON_THE_FLOOR = """
title = "A box near the floor, which comes to rest on it"
gravity.acceleration = [0, 0, "-9.81 m/s^2"]
[bodies.box]
type = "rigid"
mass = "2 t"
inertia = ["2 t m^2", "2 t m^2", "2 t m^2"]
frame = { motion = "free" }
initial.position = [0, 0, "0.51 m"]
[[surfaces]]
name = "floor"
body = "ground"
shape = { type = "plane", size = ["10 m", "10 m"] }
[[surfaces]]
name = "skin"
body = "box"
shape = { type = "box", size = ["1 m", "1 m", "1 m"] }
[[collisions]]
name = "landing"
between = ["floor", "skin"]
law = "rigid"
friction = 0.3
[simulate]
step = "10 ms"
output_interval = "50 ms"
duration = "0.2 s"
start = "equilibrium"
"""


@pytest.mark.slow
def test_what_lies_on_the_ground_is_found_to_rest_once(tmp_path, monkeypatch):
    (tmp_path / "case.toml").write_text(ON_THE_FLOOR)
    case = load_case(tmp_path)
    report = run_case(case, stages=("simulate",))
    before = histories(case)
    np.testing.assert_allclose(before["box.position"][:, 2], 0.5, atol=1e-6)

    def search(*_arguments, **_keys):
        raise SearchedError

    monkeypatch.setattr("heavylift.solver.statics.contact_rest.settle_contacts", search)
    again = run_case(case, stages=("simulate",), force=("simulate",))
    assert same(before, histories(case))
    for key in ("start", "warning"):
        assert again.stage("simulate").details[key] == report.stage("simulate").details[key]
    with pytest.raises(SearchedError):
        run_case(load_case(tmp_path, ["bodies.box.mass=3 t"]), stages=("simulate",))
