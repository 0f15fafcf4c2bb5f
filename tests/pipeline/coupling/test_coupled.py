"""Cases with FMUs: a controller that is a spring and a damper, against the closed form; restart; bad ends."""

import math
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from made_fmus import library, make_fmu

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.coupling.master import Master
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.stages import advance
from heavylift.pipeline.stages.stages import run_case

CASE = """
title = "A mass that a controller holds"

[bodies.mass]
type = "rigid"
mass = "1 t"
inertia = [1e3, 1e3, 1e3]
frame = { motion = "free" }
initial = { position = [0.5, 0, 0] }

[[inputs]]
name = "push"
type = "force"
body = "mass"
point = [0, 0, 0]
direction = [1, 0, 0]

[[fmus]]
name = "hold"
file = "pd.fmu"
sample_time = "20 ms"
reads = { x = "mass.position.x", v = "mass.velocity.x" }
writes = { force = "push" }
parameters = { stiffness = 4e4, damping = 2e3, limit = 1e6 }

[simulate]
integrator = "dele2"
step = "1 ms"
output_interval = "20 ms"
duration = "2 s"
"""
STIFFNESS, DAMPING, MASS = 4e4, 2e3, 1e3


def exact(times):
    """Position of the mass [m]: a damped oscillator that is let go."""
    decay = DAMPING / (2.0 * MASS)
    omega = math.sqrt(STIFFNESS / MASS - decay**2)
    return 0.5 * np.exp(-decay * times) * (np.cos(omega * times) + decay / omega * np.sin(omega * times))


@pytest.fixture(scope="module")
def binaries(tmp_path_factory):
    folder = tmp_path_factory.mktemp("binaries")
    return lambda version, *flags: library(folder, version, *flags)


@pytest.fixture
def write(tmp_path, binaries):
    """Writes the case with changes, and its FMU."""

    def write(*changes, version=2, name="case", **described):
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        make_fmu(folder / "pd.fmu", version, binaries(version), **described)
        text = CASE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (folder / "case.toml").write_text(text)
        return folder

    return write


def error(folder, *overrides):
    case = load_case(folder, overrides)
    report = run_case(case, stages=("simulate",), force=("simulate",))
    assert report.outcome is Outcome.COMPLETED, report.message
    results = load_results(case)
    return float(np.abs(results["mass.position"][:, 0] - exact(results.time)).max())


ITERATED = ('writes = { force = "push" }', 'writes = { force = "push" }\ncoupling = "iterated"')
INTERVALS = ("40 ms", "20 ms", "10 ms")


@pytest.mark.parametrize(("version", "changes", "order"), [(2, (), 1), (3, (ITERATED,), 2)])
def test_a_coupled_run_has_the_order_of_its_coupling(write, version, changes, order):
    folder = write(*changes, version=version)
    errors = [
        error(folder, f"fmus.0.sample_time={each}", "simulate.output_interval=40 ms") for each in INTERVALS
    ]
    found = [math.log2(a / b) for a, b in pairwise(errors)]
    assert found == pytest.approx([order, order], abs=0.2), errors


def test_a_linear_force_begins_with_what_the_unit_gives(write):
    """20 kN at the start: from 0 on, the first interval would lose an impulse, and with it an order."""
    linear = ('name = "push"', 'name = "push"\ninterpolation = "linear"')
    folder = write(ITERATED, linear, version=3)
    errors = [
        error(folder, f"fmus.0.sample_time={each}", "simulate.output_interval=40 ms") for each in INTERVALS
    ]
    assert [math.log2(a / b) for a, b in pairwise(errors)] == pytest.approx([2, 2], abs=0.2), errors


@pytest.mark.parametrize("changes", [(), (ITERATED,)])
def test_a_run_that_was_stopped_goes_on_with_the_same_bits(write, monkeypatch, changes):
    whole = load_case(write(*changes, name="whole"))
    assert run_case(whole, stages=("simulate",)).outcome is Outcome.COMPLETED
    case = load_case(write(*changes, name="parts"))
    monkeypatch.setattr(advance, "FIRST_PIECE", 7)
    monkeypatch.setattr(advance, "PIECE_SECONDS", 1e-9)
    run = advance.Advancer.run

    def short(self, stop, progress):
        def end(done, text):
            progress(done, text)
            if done >= self.step_count // 3 + 5:
                stop.signal_name = "SIGTERM"

        return run(self, stop, end)

    monkeypatch.setattr(advance.Advancer, "run", short)
    assert run_case(case, stages=("simulate",)).outcome is Outcome.INTERRUPTED
    monkeypatch.setattr(advance.Advancer, "run", run)
    assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
    a, b = load_results(whole), load_results(case)
    assert {name for name in a if not np.array_equal(a[name], b[name], equal_nan=True)} == set()


def test_an_fmu_that_cannot_write_its_state_begins_again(write, monkeypatch):
    folder = write(state=False)
    case, lines = load_case(folder), []
    run = advance.Advancer.run

    def short(self, stop, progress):
        stop.signal_name = "SIGTERM" if self.simulation.step_index else ""
        return run(
            self, stop, lambda done, text: [progress(done, text), setattr(stop, "signal_name", "SIGTERM")]
        )

    monkeypatch.setattr(advance.Advancer, "run", short)
    report = run_case(case, stages=("simulate",))
    assert report.message.endswith(
        "the same command begins again at t = 0: FMU 'hold' cannot write its state"
    )
    monkeypatch.setattr(advance.Advancer, "run", run)
    log = Log(quiet=True)
    monkeypatch.setattr(log, "say", lines.append)
    assert run_case(case, stages=("simulate",), log=log).outcome is Outcome.COMPLETED
    assert "simulate: restarted from t = 0: FMU 'hold' cannot write its state" in lines
    times = load_results(case).time
    assert len(times) == 101


def test_a_run_ends_where_its_fmu_does_and_keeps_what_it_has(write):
    case = load_case(write(("limit = 1e6", "limit = 1e6, fault = 1")))
    report = run_case(case)
    assert report.outcome is Outcome.BAD_INPUT
    words = r"t = 0.04 s: FMU 'hold' \(pd.fmu\): crashed with SIGSEGV when asked to make a step"
    assert re.match(words, report.message)
    results = load_results(case)
    assert results.time[-1] == 0.04
    text = (case.output_folder / "report" / "report.md").read_text()
    assert "crashed with SIGSEGV" in text
    assert "| hold | reads x | mass.position.x |" in text


def test_a_state_goes_on_in_another_instance(write):
    import heavylift as hl

    folder = write()
    first, second = hl.Simulation(folder), hl.Simulation(folder)
    first.step(0.327)
    state = hl.State.from_bytes(first.save().to_bytes())
    second.restore(state)
    third = second.copy()
    rows = []
    for each in (first, second, third):
        each.step(0.1)
        each.step(0.213)
        rows.append(each.row)
    assert np.array_equal(rows[0], rows[1])
    assert np.array_equal(rows[0], rows[2])
    assert first["push.value"] != 0.0
    first.restore(state)
    first.step(0.313)
    assert np.array_equal(rows[0], first.row)
    without = {name: array for name, array in state.arrays.items() if name != "fmus"}
    with pytest.raises(InputError, match=r"fmus: has no state of the FMUs; expected that of hold"):
        first._solver.restore(without)
    slower = hl.Simulation(load_case(folder, ["fmus.0.sample_time=40 ms"]))
    with pytest.raises(InputError, match="fmus: is the state of other FMUs or sample times"):
        slower._solver.restore(state.arrays)
    with pytest.raises(InputError, match="the state does not fit this case"):
        slower.restore(state)


def test_two_units_do_what_one_does(write):
    """One is the spring, the other one the damper, each with an input of its own; or that one half as often."""
    second = (
        CASE[CASE.index("[[inputs]]") : CASE.index("[simulate]")]
        .replace('"push"', '"brake"')
        .replace('"hold"', '"slow"')
    )
    spring, damper = "stiffness = 4e4, damping = 0.0", "stiffness = 0.0, damping = 2e3"
    law = "stiffness = 4e4, damping = 2e3"
    both = ("[simulate]", second.replace(law, damper) + "[simulate]")
    one = load_case(write(name="one"))
    two = load_case(write((law, spring), both, name="two"))
    mixed = load_case(write((law, spring), (both[0], both[1].replace("20 ms", "40 ms")), name="mixed"))
    found = []
    for case in (one, two, mixed):
        assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
        found.append(load_results(case))
    position = [each["mass.position"][:, 0] for each in found]
    assert position[1] == pytest.approx(position[0], abs=1e-12)
    braking = found[2]["brake.value"]
    assert np.array_equal(braking[1:-1:2], braking[2::2])  # set every second time
    speeds = found[2]["mass.velocity"][:, 0]
    assert braking[1:-1:2] == pytest.approx(-2e3 * speeds[0:-1:2], rel=1e-12)


WRONG = {
    "no multiple of the step": (
        ('"20 ms"\nreads', '"20.5 ms"\nreads'),
        "fmus.0.sample_time: 0.0205 s is 20.5 times step = 0.001 s",
    ),
    "the run is no multiple": (
        ('"20 ms"\nreads', '"30 ms"\nreads'),
        "fmus.0.sample_time: duration: 2 s is 66.6666667 times",
    ),
    "no such input": (
        ('"push" }', '"pull" }'),
        "fmus.0.writes.force: there is no input 'pull'; expected one of: push",
    ),
    "no such channel": (
        ("mass.velocity.x", "mass.speed.x"),
        "fmus.0.reads.v: .*'mass.speed.x' is unknown; expected a channel of 'mass': position",
    ),
    "several numbers": (
        ("mass.velocity.x", "mass.velocity"),
        "fmus.0.reads.v: .*3 components; expected one of its",
    ),
    "another quantity": (
        ("mass.velocity.x", "mass.position.y"),
        "fmus.0.reads.v: 'v' is in m/s, a velocity; expected a length",
    ),
    "no such variable": (("reads = { x", "reads = { y"), r"fmus.0.reads.y: pd.fmu has no variable 'y'"),
    "another type": (
        ("limit = 1e6", "limit = true"),
        r"fmus.0.parameters.limit: True for 'limit' of type Real",
    ),
    "no such file": (("pd.fmu", "pid.fmu"), r"fmus.0.file: file 'pid.fmu' does not exist"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_does_not_fit_is_refused_before_the_run(write, what):
    change, words = WRONG[what]
    folder = write(change)
    with pytest.raises(InputError, match=rf"case.toml: {words}"):
        run_case(load_case(folder), stages=("simulate",))
    assert not (folder / "out" / "simulate" / "results.h5").exists()


def test_a_value_beyond_the_limits_of_an_input_ends_the_run(write):
    case = load_case(write(("direction = [1, 0, 0]", 'direction = [1, 0, 0]\nsmallest = "-10 kN"')))
    report = run_case(case, stages=("simulate",))
    assert report.outcome is Outcome.BAD_INPUT
    assert re.match(r"t = 0 s: .*push", report.message), report.message


def test_an_exchange_that_does_not_settle_ends_the_run(write, monkeypatch):
    """One repetition is never enough: the force at the end is not the first guess."""
    monkeypatch.setitem(Master.__init__.__kwdefaults__, "most", 1)
    case = load_case(write(ITERATED))
    report = run_case(case, stages=("simulate",))
    assert report.outcome is Outcome.NOT_CONVERGED
    assert re.match(
        r"t = 0 s: what '.*' gives to '.*' \(.* to .*\) still changes by \S*\d of", report.message
    ), report.message
    assert len(load_results(case).time) == 1


def test_an_input_of_an_fmu_is_not_set_by_others(write):
    import heavylift as hl

    sim = hl.Simulation(write())
    sim.step(0.1)
    with pytest.raises(
        InputError, match="'push' is written by FMU 'hold'; expected an input that no FMU writes"
    ):
        sim.step(0.1, {"push": 1.0})
    assert sim.time == pytest.approx(0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("coupling", "order"), [("sequential", 1), ("iterated", 2)])
def test_a_case_is_a_unit_in_another_case(tmp_path, coupling, order):
    """The two coupled masses, the second one as a unit, against the closed form of both."""
    from scipy.linalg import expm

    from heavylift.pipeline.exchange.fmu_export import export_fmu

    pytest.importorskip("msgpack")
    masses = Path(__file__).parents[3] / "cases" / "coupled_masses"
    text = (
        (masses / "first" / "case.toml")
        .read_text(encoding="utf-8")
        .replace("direction = [1,", "direction = [-1,")
    )
    text += f"""
[[fmus]]
name = "second"
file = "second.fmu"
sample_time = "12.5 ms"
reads = {{ speed = "m1.velocity.x" }}
writes = {{ "end.reaction_force.x" = "push" }}
coupling = "{coupling}"
"""
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    export_fmu(masses / "second", 2, out=tmp_path / "second.fmu")
    m, n, k, j, b, c = 1e3, 500.0, 40e3, 20e3, 60e3, 400.0
    both = np.array(
        [
            [0, 1, 0, 0],
            [-(k + b) / m, -c / m, b / m, c / m],
            [0, 0, 0, 1],
            [b / n, c / n, -(j + b) / n, -c / n],
        ]
    )
    errors = []
    for interval in ("12.5 ms", "6.25 ms", "2.5 ms"):
        changes = [f"fmus.0.sample_time={interval}", "simulate.output_interval=12.5 ms"]
        case = load_case(tmp_path, changes)
        report = run_case(case, stages=("simulate",), force=("simulate",))
        assert report.outcome is Outcome.COMPLETED, report.message
        results = load_results(case)
        exact = np.array([(expm(both * t) @ [0.1, 0, 0, 0])[0] for t in results.time])
        errors.append(float(np.abs(results["m1.position"][:, 0] - exact).max()))
    found = [math.log2(errors[0] / errors[1]), math.log(errors[1] / errors[2], 2.5)]
    assert found == pytest.approx([order, order], abs=0.2), errors
