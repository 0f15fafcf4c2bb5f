"""Results of a run in a program: tables, plots, the page; a run that stops has what it has done and says so."""

from __future__ import annotations

import html
import os
import re
import sys
import tempfile

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline.stages.lock import locked

GRAVITY = 9.81


def falling() -> hl.Model:
    """A ball is thrown: x = t, z = -g t^2 / 2; a spring of no force records a tension."""
    model = hl.Model("A ball is thrown & falls")
    model.add(
        hl.Gravity(acceleration=[0, 0, -GRAVITY]),
        hl.RigidBody(
            "ball", mass=2.0, inertia=[1, 1, 1], frame={"motion": "free"}, initial={"velocity": [1.0, 0, 0]}
        ),
        hl.Simulate(step="10 ms", duration="1 s", output_interval="0.1 s"),
        hl.Check(
            "range",
            quantity="channel.ball.position.x.end",
            reference=1.0,
            tolerance={"absolute": 1e-9},
            source="1 m/s for 1 s",
        ),
        hl.LimitCriterion("depth", quantity="channel.ball.position.z.min", minimum=-4.0, source="none"),
    )
    return model


@pytest.fixture(scope="module")
def run():
    return falling().run()


def test_checks_and_criteria_are_judged(run):
    assert run.completed
    assert not run.passed
    assert run.verdict == "Failed: 1 of 1 criteria (depth)."
    assert run.checks["range"].passed
    assert run.checks["range"].value == pytest.approx(1.0)
    (depth,) = run.criteria["depth"]
    assert not depth.passed
    assert depth.value == pytest.approx(-0.5 * GRAVITY, rel=1e-3)
    assert (run.message, run.warning, dict(run.open)) == ("", "", {})
    assert repr(run) == "<Run of 'A ball is thrown & falls': completed, 11 records>"


def test_records_as_tables_of_xarray(run):
    pytest.importorskip("xarray")
    data = run.to_xarray("ball.position", "energy.kinetic", "sum(ball.position.x, ball.position.z)")
    np.testing.assert_array_equal(data["ball.position"].sel(xyz="z"), run["ball.position"][:, 2])
    assert data["ball.position"].dims == ("time", "xyz")
    assert data["energy.kinetic"].dims == ("time",)
    assert {name: one.attrs["units"] for name, one in data.variables.items() if name != "xyz"} == {
        "time": "s",
        "ball.position": "m",
        "energy.kinetic": "J",
        "sum(ball.position.x, ball.position.z)": "m",
    }
    assert set(run.to_xarray().data_vars) == set(run.names)
    np.testing.assert_allclose(data["ball.position"].sel(time=1.0, method="nearest").values[0], 1.0)


def test_records_as_tables_of_pandas(run):
    pytest.importorskip("pandas")
    frame = run.to_pandas("ball.position", "energy.kinetic")
    assert list(frame.columns) == ["ball.position.x", "ball.position.y", "ball.position.z", "energy.kinetic"]
    np.testing.assert_array_equal(frame["ball.position.z"], run["ball.position"][:, 2])
    np.testing.assert_array_equal(frame.index, run.time)
    assert frame.attrs["units"]["energy.kinetic"] == "J"
    assert frame.index.name == "time"


def test_a_library_that_is_missing_is_named(run, monkeypatch):
    for name, call in (("xarray", run.to_xarray), ("pandas", run.to_pandas)):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(
            hl.InputError, match=rf'{name} is not installed; expected it: `pip install "heavylift\[data\]"`'
        ):
            call()


def test_a_plot_has_the_records_with_their_units(run):
    figure = run.plot("ball.position", "energy.kinetic", "*.velocity.z")
    first, second, third = figure.axes
    z = first.lines[2]
    assert z.get_label() == "ball.position.z"
    np.testing.assert_allclose(z.get_ydata()[-1], run["ball.position"][-1, 2])
    assert "m" in first.get_ylabel()
    assert second.get_ylabel().startswith("energy.kinetic\n[")
    assert third.get_ylabel().startswith("ball.velocity.z\n[m/s")
    assert figure._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"
    with pytest.raises(
        hl.InputError,
        match=r"Run of '.*': channel 'ball.positio' does not exist; did you mean 'ball.position'",
    ):
        run.plot("ball.positio")
    with pytest.raises(hl.InputError, match="the name of a channel"):
        run.plot()


def test_a_cell_of_a_notebook_shows_the_page(run):
    page = run.page()
    assert page.startswith("<!DOCTYPE html>")
    assert "A ball is thrown &amp; falls" in page
    shown = run._repr_html_()
    (inner,) = re.findall(
        r'^<iframe srcdoc="([^"]*)" sandbox="allow-scripts allow-downloads" style="[^"<>]*"></iframe>$', shown
    )
    assert html.unescape(inner) == page


def test_a_model_in_a_cell_shows_its_scene_before_the_run(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    model = falling()
    page = model.page()
    assert "The scene before its run" in page
    assert html.escape(page) in model._repr_html_()
    model.add(hl.Sensor("tip", body="none", point=[0, 0, 0]))
    with pytest.raises(
        hl.InputError, match=r"test_results.py:\d+: Sensor\('tip'\).body: body 'none' does not exist"
    ):
        model.page()
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_stops_by_itself_has_its_records_and_says_so():
    model = falling()
    model.add(
        hl.Scenario(
            phases=[
                {
                    "name": "fall",
                    "until": {"time": "1 s"},
                    "limits": [{"quantity": "ball.position.z", "above": "-1 m"}],
                }
            ]
        )
    )
    stopped = model.run()
    assert not stopped.completed
    assert not stopped.passed
    assert stopped.outcome == "limit_reached"
    assert "ball.position.z" in stopped.message
    assert stopped.time[-1] == pytest.approx(0.5)  # the record after sqrt(2 m / g) = 0.452 s
    assert "stopped" in repr(stopped)


def test_nothing_is_left_behind(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    model = falling()
    found = model.run()
    assert len(list(tmp_path.iterdir())) == 1
    del found
    assert list(tmp_path.iterdir()) == []
    model.add(hl.Rope("none", path=[{"body": "ball", "point": [0, 0, 0]}] * 2, axial_stiffness=1.0))
    with pytest.raises(hl.InputError, match=r"test_results.py:\d+: Rope\('none'\)"):
        model.run()
    assert list(tmp_path.iterdir()) == []


def test_a_forked_process_leaves_the_folder_of_a_run_alone():
    found = falling().run()
    child = os.fork()
    if child == 0:
        del found
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
    assert found.out.is_dir()
    assert found["ball.velocity"].shape == (11, 3)  # read from there when it is first asked for


def test_a_folder_in_which_another_run_works_is_told(tmp_path):
    model = falling()
    with locked(tmp_path / "out"), pytest.raises(hl.StopError) as caught:
        model.run(out=tmp_path / "out")
    assert caught.value.outcome is hl.Outcome.LOCKED


def test_another_run_takes_the_modes_that_are_there(small_case, capsys):
    model = hl.load(small_case)
    first = model.run(quiet=False)
    assert "unchanged" not in capsys.readouterr().out
    twin = model.copy()
    twin.set("simulate.duration", "2 ms")
    second = twin.run(quiet=False)
    told = capsys.readouterr().out
    for stage in ("mesh", "modes"):
        assert f"{stage}: beam: unchanged, taken from {first.out}" in told
    name = "beam.modal_position"
    assert second[name][1].tobytes() == first[name][1].tobytes()
