"""A transporter on a barge, from its case file: trim, energy, what is refused, and where a run stops."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.stages.work import StageReport
from tests.pipeline.judged import judged_checks

TEXT = (Path(__file__).resolve().parents[1] / "transport.toml").read_text(encoding="utf-8")


def run(folder: Path, *changes: tuple[str, str]) -> StageReport:
    """The case with some of its text changed."""
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return run_case(load_case(folder))


@pytest.mark.slow
def test_a_barge_trims_under_a_vehicle(tmp_path) -> None:
    """At rest at x = -10 m: moment over ``g (M (KB + BM) - sum m KG)``; the vehicle leans by ``1/(1 - W h/K)`` more."""
    at_rest = (("speed = 0.25", "speed = 0"), ("velocity = [0.25, 0, 0]", "velocity = [0, 0, 0]"))
    run(tmp_path, *at_rest, ("[simulate]", '[simulate]\nstart = "equilibrium"'))
    results = load_results(tmp_path)
    trim = -2.0 * results["barge.orientation"][:, 2]
    total, load, length, beam = 2673.0, 173.0, 50.0, 20.0
    volume = total / 1.025
    draft = volume / (length * beam)
    metacentre = 0.5 * draft + beam * length**3 / 12.0 / volume
    oil = 1.0 / (1.0 / 9.7e6 + 1.0 / 3.0e6)
    lean = 1.0 / (1.0 - load * 9810.0 * 3.579190751 / (12.0 * 2.1**2 * oil))
    expected = 10.0 * load / (total * metacentre - 2500.0 * 2.5 - load * (5.0 + 3.579190751 * lean))
    np.testing.assert_allclose(trim, expected, rtol=2e-3)
    np.testing.assert_allclose(results["spmt.wheel_load"], 173e3 * 9.81 / 12, rtol=0.02)


@pytest.mark.slow
def test_energy_of_barge_vehicle_and_water_is_kept(tmp_path) -> None:
    """With the work of the guide; the barge rocks as the vehicle goes."""
    assert run(tmp_path).outcome is Outcome.COMPLETED
    results = load_results(tmp_path)
    np.testing.assert_allclose(results["path.travel"], 0.25 * results.time, atol=1e-6)
    parts = [results[f"energy.{name}"] for name in ("kinetic", "potential", "elastic", "dissipated")]
    total = np.sum(parts, axis=0) - results["energy.drive_work"] - results["energy.external_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-5 * np.abs(parts[1]).max())


@pytest.mark.slow
def test_a_path_on_a_floating_deck_from_rest(tmp_path) -> None:
    """In equilibrium at first, then a corner: on the plan of the barge, which is pushed back."""
    begin, end = TEXT.index("[[joints]]"), TEXT.index("[[transporters]]")
    legs = """
[[transporters.legs]]
points = [[12, 0], [12, 5.2]]
radius = 4.5
transition = 1
speed = 0.5

[[transporters.groups]]
name="fl" """
    changes = [
        (TEXT[begin:end], ""),
        ("velocity = [0.25, 0, 0]", "velocity = [0, 0, 0]"),
        ("[simulate]", '[simulate]\nstart = "equilibrium"'),
        ('\n[[transporters.groups]]\nname="fl"', legs),
    ]
    assert run(tmp_path, *changes).outcome is Outcome.COMPLETED
    results = load_results(tmp_path)
    assert results["spmt.off_path"].max() < 1e-6
    assert np.abs(results["spmt.off_heading"]).max() < 1e-8
    assert results["spmt.path_way"][-1] > 12.0
    q = results["block.orientation"][-1]
    assert 2.0 * np.arctan2(q[3], q[0]) > 1.5
    assert np.abs(results["barge.velocity"][:, :2]).max() > 5e-3
    parts = [results[f"energy.{name}"] for name in ("kinetic", "potential", "elastic", "dissipated")]
    total = np.sum(parts, axis=0) - results["energy.drive_work"] - results["energy.external_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-5 * np.abs(parts[1]).max())


FLEXIBLE = """[bodies.block]
type = "flexible"
material = { young_modulus = "30 GPa", poisson_ratio = 0.2, density = "2400 kg/m^3" }
frame = { motion = "free", origin = "centre_of_mass" }
initial = { position = [-10, 0, 5] }

[bodies.block.geometry]
type = "blocks"
add = [{ name = "slab", from = [-4.2, -1.8, 1.5], to = [4.2, 1.8, 3.5] }]

[bodies.block.mesh]
element = "hex8"
divisions = { x = [6], y = [2], z = [2] }

[bodies.block.modes]
count = 3
"""


@pytest.mark.slow
def test_a_flexible_body_on_a_path_has_its_report(tmp_path) -> None:
    """Its frame is at its centre of mass, which nobody told: 145.2 t on twelve bogies, path and wheels are drawn."""
    begin, end = TEXT.index("[bodies.block]"), TEXT.index("[[surfaces]]")
    joint, transporter = TEXT.index("[[joints]]"), TEXT.index("[[transporters]]")
    report = run(
        tmp_path,
        (TEXT[begin:end], FLEXIBLE + "\n"),
        (TEXT[joint:transporter], ""),
        ("wheel_radius = 0.37", 'wheel_radius = 0.37\nlegs = [{ points = [[2, 0]], speed = "0.2 m/s" }]'),
        ('duration = "40 s"', 'duration = "4 s"'),
    )
    assert report.outcome is Outcome.COMPLETED
    assert (tmp_path / "out" / "report" / "path_spmt.png").is_file()
    load = 2400.0 * 8.4 * 3.6 * 2.0 * 9.81 / 12
    np.testing.assert_allclose(load_results(tmp_path)["spmt.wheel_load"][0], load, rtol=1e-6)


@pytest.mark.slow
def test_a_vehicle_that_drives_off_its_deck_ends_the_run(tmp_path) -> None:
    """With the bogie, the station and the time."""
    faster = (("speed = 0.25", "speed = 2"), ("velocity = [0.25, 0, 0]", "velocity = [2, 0, 0]"))
    report = run(tmp_path, *faster)
    assert report.outcome is Outcome.OFF_ROAD


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "wheel_radius = 0.37",
            "wheel_radius = 0.37\nload_limit = 1e5",
            "load_limit: 141428 N on each bogie of group 'fl'",
        ),
        ("stations = [-25, 25]", "stations = [-5, 25]", "transporters.0.*no deck is below bogie 1"),
        (
            "[[decks]]",
            '[[tanks]]\nname = "peak"\nhull = "barge"\nfloor = [40, 0, -2]\nsize = [8, 8, 4]\nmass = 0\n\n[[decks]]',
            r"tanks\.0\.floor: the middle of its floor is before or behind the hull: x of that is -25 to 25 m",
        ),
        (
            "wheel_radius = 0.37",
            "wheel_radius = 0.37\nbogie_mass = 108",
            "bogie_mass.*a deck on body 'barge'",
        ),
        (
            "oil_stiffness=9.7e6",
            "oil_stiffness=9.7e6\ngas_length = 0.5",
            "'oil_stiffness' and 'gas_length'; expected one of 'oil_stiffness' and 'gas_length'",
        ),
        ("oil_stiffness=9.7e6", "", "no 'oil_stiffness' and no 'gas_length'; expected one of"),
        ('name="fr"', 'name="fl"', "two groups 'fl'"),
        ("tyre_stiffness = 3e6", "tyre_stiffness = 0", "transporters.0.tyre_stiffness: 0 is too small"),
        ('body = "block"', 'body = "blok"', "transporters.0.body.*blok"),
    ],
)
def test_bad_input_is_one_clear_error(tmp_path, old, new, words) -> None:
    """File, key, value, and what was expected."""
    with pytest.raises(InputError, match=words):
        run(tmp_path, (old, new))


@pytest.mark.slow
def test_a_check_of_an_unknown_group_names_those_that_there_are(tmp_path) -> None:
    """Known when the run is done, as nodes of a frame are."""
    check = (
        '[[check]]\nid = "c"\nquantity = "channel.spmt.group_force.middle.max"\nmaximum = "1 N"\n\n[simulate]'
    )
    run(tmp_path, ("[simulate]", check), ('duration = "40 s"', 'duration = "1 s"'))
    case = load_case(tmp_path)
    with pytest.raises(InputError, match="expected a component: fl, fr, rl, rr"):
        judged_checks(case, case.output_folder)
