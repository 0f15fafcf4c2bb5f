"""Stress of a flexible body over a run: that of statics and theory, the same in checks, criteria, pictures and page."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.flexibility import Flexibility
from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.checks import body_stress as body_stress_module
from heavylift.pipeline.checks.body_stress import body_stress
from heavylift.pipeline.checks.criteria import evaluate_criterion
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.checks.stresses import nodal_stresses
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case

E, RHO, G = 2.1e11, 7850.0, 9.81
LENGTH, SIDE, SPIN = 2.0, 0.05, 20.0

BAR = f"""
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0, density = {RHO} }}
mesh = {{ element = "hex8", divisions = {{ x = [40], y = [2], z = [2] }} }}
"""
GEOMETRY = f"""
type = "blocks"
add = [{{ name = "bar", from = [0, 0, 0], to = [{LENGTH}, {SIDE}, {SIDE}] }}]
groups = {{ root = {{ plane = "x", at = 0 }}, half = {{ plane = "x", at = {LENGTH / 2} }} }}
"""

RESTING = f"""
title = "Bars and a stiffened plate under their weight"
gravity = {{ acceleration = [0, 0, -{G}] }}

[bodies.held]
{BAR}
modes = {{ count = 3, clamp = ["root"] }}
frame = {{ motion = "fixed" }}
static = [{{ name = "weight", loads = [{{ acceleration = [0, 0, -{G}] }}] }}]

[bodies.held.geometry]
{GEOMETRY}
[bodies.held.stress]
gamma_M = 1.1
groups = [
    {{ name = "root", grade = "S235", thickness = "50 mm" }},
    {{ name = "half", yield_strength = "300 MPa" }},
]
hot_spots = [{{ name = "toe", toe = [0.1, {SIDE / 2}, {SIDE}], direction = [1, 0, 0], thickness = "50 mm" }}]

[bodies.modes_only]
{BAR}
modes = {{ count = 3, clamp = ["root"] }}
frame = {{ motion = "fixed" }}
stress = {{ correction = false }}

[bodies.modes_only.geometry]
{GEOMETRY}
[bodies.deck]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0.3, density = {RHO} }}
mesh = {{ size = 0.05 }}
modes = {{ count = 4, clamp = ["root"] }}
frame = {{ motion = "fixed" }}
static = [{{ name = "weight", loads = [{{ acceleration = [0, 0, -{G}] }}] }}]

[bodies.deck.geometry]
type = "panels"
groups = {{ root = {{ plane = "x", at = 0 }} }}
plates = {{ plate = {{ thickness = "10 mm", corners = [[0, -0.1, 0], [2, -0.1, 0], [2, 0.1, 0], [0, 0.1, 0]] }} }}

[bodies.deck.geometry.stiffeners.bar]
line = [[0, 0, 0], [2, 0, 0]]
section = {{ shape = "flat", height = "80 mm", thickness = "10 mm" }}
plate = "plate"
web = [0, 0, -1]

[bodies.deck.stress]
panels = true
grade = "S355"
thickness = "10 mm"
hot_spots = [
    {{ name = "toe", toe = [0.9, 0.05, 0], direction = [1, 0, 0], thickness = "50 mm", side = "top" }},
    {{ name = "below", toe = [0.9, 0.05, 0], direction = [1, 0, 0], thickness = "50 mm", side = "bottom" }},
]

[simulate]
start = "equilibrium"
duration = 0

[[criteria]]
type = "yield"
name = "bar"
body = "held"

[[criteria]]
type = "yield"
name = "plates"
body = "deck"
groups = ["plate"]
stress = "centre"
"""

MOVING = f"""
title = "A bar that is shaken along its axis, and one that spins"

[bodies.shaken]
{BAR}
modes = {{ count = 3, clamp = ["root"] }}
initial = {{ position = [0, 2, 0] }}
stress = {{}}

[bodies.shaken.geometry]
{GEOMETRY}
[bodies.shaken.frame]
motion = "driven"
x = {{ harmonics = [{{ amplitude = 0.1, frequency = 5 }}] }}

[bodies.ringing]
{BAR}
modes = {{ count = 6, clamp = ["root"] }}
frame = {{ motion = "fixed" }}
initial = {{ position = [0, 6, 0], modal_velocity = [0, 0, 0, 0, "0.1 m/s"] }}
stress = {{}}

[bodies.ringing.geometry]
{GEOMETRY}
[bodies.spinning]
{BAR}
modes = {{ count = 2 }}
frame = {{ motion = "free", origin = "centre_of_mass" }}
initial = {{ position = [0, 4, 0], orientation = {{ axis = [0, 0, 1], angle = 0 }}, angular_velocity = [0, 0, {SPIN}] }}
stress = {{ groups = [{{ name = "half" }}] }}

[bodies.spinning.geometry]
{GEOMETRY}
[bodies.ringing.interfaces.END]
at = [{LENGTH}, {SIDE / 2}, {SIDE / 2}]
radius = 0.04

[[forces]]
name = "push"
type = "point"
body = "ringing"
point = [1.5, {SIDE / 2}, {SIDE}]
force = [0, 0, 1e-6]

[[joints]]
name = "pin"
type = "ball"
between = ["ground", "spinning"]
at = [0, 4, 0]

[[forces]]
name = "pull"
type = "point"
body = "ringing"
point = "END"
force = [0, 0, 1e-6]

[simulate]
step = "50 us"
output_interval = "2 ms"
duration = 0.05
"""


def made(tmp_path_factory, text):
    folder = tmp_path_factory.mktemp("bars")
    (folder / "case.toml").write_text(text)
    case = load_case(folder)
    assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
    return case


@pytest.fixture(scope="module")
def resting(tmp_path_factory):
    return made(tmp_path_factory, RESTING)


@pytest.fixture(scope="module")
def rested(resting):
    return Quantities(resting, resting.output_folder)


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    case = made(tmp_path_factory, MOVING)
    return Quantities(case, case.output_folder)


def bending_stress(x):
    """6 M / t^3 of a bar under its weight."""
    return 6.0 * RHO * G * SIDE**2 * 0.5 * (LENGTH - x) ** 2 / SIDE**3


def test_three_modes_and_the_correction_have_the_stress_of_the_full_model(rested):
    static = rested.number("static.held.weight.von_mises")
    assert rested.number("stress.held.root.von_mises.max") == pytest.approx(static, rel=1e-6)
    assert rested.number("stress.held.von_mises.max") == pytest.approx(static, rel=1e-6)
    assert rested.number("stress.held.half.von_mises.end") == pytest.approx(bending_stress(1.0), rel=0.01)
    # modes alone are far from it
    assert abs(rested.number("stress.modes_only.all.von_mises.max") / static - 1.0) > 0.05
    # 50 mm of S235: 215 MPa
    used = rested.number("stress.held.root.utilisation.max")
    assert used == pytest.approx(static * 1.1 / 215e6, rel=1e-6)
    assert rested.number("stress.held.half.utilisation.max") == pytest.approx(
        rested.number("stress.held.half.von_mises.max") * 1.1 / 300e6, rel=1e-6
    )
    # extrapolated over 25 mm of a stress that is nearly linear
    assert rested.number("stress.held.toe.hot_spot.max") == pytest.approx(bending_stress(0.1), rel=0.01)


def test_a_stiffened_plate_has_the_stress_of_the_full_model_and_m_y_over_i(rested):
    static = rested.number("static.deck.weight.von_mises")
    assert rested.number("stress.deck.bar.von_mises.max") == pytest.approx(static, rel=1e-6)
    assert rested.number("stress.deck.von_mises.max") == pytest.approx(static, rel=1e-6)
    b, t, h, w = 0.2, 0.01, 0.08, 0.01
    area = b * t + w * h
    below = -0.5 * (t + h)
    centroid = w * h * below / area
    second = b * t**3 / 12.0 + b * t * centroid**2 + w * h**3 / 12.0 + w * h * (below - centroid) ** 2
    moment = RHO * area * G * 0.5 * (LENGTH - 0.9) ** 2
    for spot, z in (("toe", 0.5 * t), ("below", -0.5 * t)):
        assert rested.number(f"stress.deck.{spot}.hot_spot.end") == pytest.approx(
            moment * (z - centroid) / second, rel=0.03
        )
    top, bottom = (rested.number(f"stress.deck.plate.{side}.von_mises.max") for side in ("top", "bottom"))
    assert rested.number("stress.deck.plate.von_mises.max") == max(top, bottom)
    assert rested.number("stress.deck.plate.membrane.von_mises.max") < max(top, bottom)


def test_criteria_checks_pictures_and_page_have_one_number(resting, rested):
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.drawn.build import case_scene
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.report.stress import stress_of_run

    lines = [line for one in resting.criteria for line in evaluate_criterion(resting, rested, one)]
    assert [line.value for line in lines] == [
        rested.number("stress.held.root.utilisation.max"),
        rested.number("stress.deck.plate.centre.utilisation.max"),
    ]
    assert lines[0].where.startswith("root at (0, ")
    assert lines[0].clauses[0].source.startswith("EN 10025-2")
    folder, results = OutputFolder(resting.output_folder), load_results(resting)
    shown = {}

    class Recorder:
        def stress(self, _displacement, stress, *, title):
            shown[title] = np.nanmax(stress)
            return b""

    album = Album(resting.output_folder / "report")
    album.folder.mkdir(exist_ok=True)
    _, items = stress_of_run(resting, "deck", folder, results, Recorder(), album)
    largest = rested.number("stress.deck.von_mises.max")
    np.testing.assert_allclose(list(shown.values()), largest, rtol=1e-6)
    assert f"{1e-6 * largest:.4g}" in [row[2] for row in items[0].rows]
    drawn = case_scene(resting, folder, assemble_scene(resting, folder), results)
    found = {one.name: float(np.nanmax(one.stress)) for one in drawn.surfaces if one.stress is not None}
    assert found["deck"] == pytest.approx(largest, rel=1e-6)
    assert found["held"] == pytest.approx(rested.number("stress.held.von_mises.max"), rel=1e-6)
    model = read_model(folder.model("deck"))
    state = rested.number("static.deck.weight.von_mises")
    reduced = read_reduced(folder.reduced("deck"))
    modes = np.tensordot(results["deck.modal_position"][0], reduced.mode_shapes, axes=1)
    turns = np.tensordot(results["deck.modal_position"][0], reduced.mode_rotations, axes=1)
    assert np.nanmax(nodal_stresses(model, [modes], [turns])) != pytest.approx(state, rel=1e-3)


@pytest.mark.slow
def test_the_report_has_tables_and_pictures_of_it(tmp_path_factory):
    case = made(tmp_path_factory, RESTING + "[report]\nmodes = []\nstress_modes = []\n")
    report = run_case(case, stages=("report",))
    assert report.outcome is Outcome.COMPLETED
    folder = case.output_folder / "report"
    text = (folder / "report.md").read_text(encoding="utf-8")
    for name in ("held", "deck"):
        assert f"## Stress of {name} over the run" in text
        assert (folder / f"{name}_stress_largest.png").is_file()
        assert (folder / f"{name}_stress_envelope.png").is_file()
    value = Quantities(case, case.output_folder).number("stress.deck.bar.von_mises.max")
    assert f"| bar | whole stress | {1e-6 * value:.4g} |" in text
    assert "160 plates, 40 beams, 205 nodes" in text
    # nothing changed: nothing is made again
    assert run_case(case, stages=("report",)).stages[0].skipped


def test_it_is_computed_once_and_again_when_what_it_was_made_from_has_changed(resting):
    folder, results = OutputFolder(resting.output_folder), load_results(resting)
    body_stress(resting, "held", folder, results)
    path = folder.stress("held")
    before = path.stat().st_mtime_ns
    assert body_stress(resting, "held", folder, results).groups.keys() == {"root", "half"}
    assert path.stat().st_mtime_ns == before
    path.write_bytes(b"damaged")
    body_stress(resting, "held", folder, results)
    assert path.stat().st_mtime_ns != before
    before = path.stat().st_mtime_ns
    results.time[:] += 1.0
    body_stress(resting, "held", folder, results)
    assert path.stat().st_mtime_ns != before


def test_a_bar_shaken_along_its_axis_bears_its_inertia(moved):
    # the first axial mode is at 650 Hz, beyond the three of bending: at 5 Hz the bar follows statically
    acceleration = 0.1 * (2.0 * np.pi * 5.0) ** 2
    history = moved.history("stress.shaken.all.von_mises.end")
    # differences of velocities at 2 ms: their error is (omega h)^2 / 6
    assert history.max() == pytest.approx(RHO * LENGTH * acceleration, rel=0.03)
    assert history[0] < 0.02 * history.max()


def test_records_too_far_apart_for_a_mode_that_vibrates_are_told(moved):
    place, note = moved.body_stress("ringing").notes
    # mode 5 at 183 Hz: 5.5 ms
    assert note.startswith("Records are 0.002 s apart: 5 a period of vector 5 (18")
    assert not any("Records are" in text for text in moved.body_stress("shaken").notes)
    # of two places where forces act one has static vectors
    assert place.startswith("forces.0.point: the modes miss ")
    assert any(text.startswith("joints.0.at: the modes miss") for text in moved.body_stress("spinning").notes)
    # without weight and motion of its frame there is nothing to correct
    assert moved.body_stress("ringing").correction.shape[1] == 0


def test_a_spinning_bar_bears_its_centrifugal_force_and_nothing_else(moved):
    assert moved.number("stress.spinning.half.von_mises.max") == pytest.approx(
        RHO * SPIN**2 * LENGTH**2 / 8.0, rel=0.01
    )


def test_plate_panels_are_told_with_their_buckling(resting, rested):
    stress = body_stress(resting, "deck", OutputFolder(resting.output_folder), load_results(resting))
    panels = stress.panels
    assert panels.group == ("plate", "plate")
    np.testing.assert_allclose(panels.length, 2.0)
    np.testing.assert_allclose(panels.width, 0.1)
    # in tension above its stiffener, by the mean moment q L^2 / 6 and the centroid of its section
    area, below = 0.2 * 0.01 + 0.08 * 0.01, -0.045
    centroid = 0.08 * 0.01 * below / area
    second = 0.2 * 0.01**3 / 12.0 + 0.002 * centroid**2
    second += 0.01 * 0.08**3 / 12.0 + 0.0008 * (below - centroid) ** 2
    mean = RHO * area * G * LENGTH**2 / 6.0 * -centroid / second
    np.testing.assert_allclose(panels.stress[0, :, 0], mean, rtol=0.03)
    assert rested.number("stress.deck.plate.buckling.max") == pytest.approx(panels.use.max(), rel=1e-6)
    # what is in tension is hardly used
    assert 0.0 <= panels.use.max() < 1e-3


REFUSED = {
    "stress.held.root.buckling.max": "'panels = true'",
    "stress.held.nothing.von_mises.max": "a group of the stress of 'held': root, half",
    "stress.held.nothing.hot_spot.max": "a hot spot of the stress of 'held': toe",
    "stress.held.root.upper.von_mises.max": "GROUP.SIDE.von_mises",
    "stress.held.root.utilization.max": "did you mean 'utilisation'",
}


@pytest.mark.parametrize("quantity", REFUSED)
def test_quantities_that_the_table_does_not_have_are_refused(tmp_path, quantity):
    check = f'[[check]]\nid = "a"\nquantity = "{quantity}"\nmaximum = 1\n'
    (tmp_path / "case.toml").write_text(RESTING + check)
    with pytest.raises(InputErrors, match=REFUSED[quantity]):
        load_case(tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"S235"', '"S234"', "did you mean 'S235'"),
        ('"S235", thickness = "50 mm"', '"S235"', "groups.0.thickness: is missing: the strength of S235"),
        ('"50 mm" }},'.replace("}}", "}"), '"300 mm" },', "up to 250 mm"),
        ("gamma_M = 1.1", "gamma_M = 0.9", "too small"),
        ('name = "half", yield_strength', 'name = "root", yield_strength', "'root' is used before"),
        (
            '[simulate]\nstart = "equilibrium"\nduration = 0\n',
            "",
            r"bodies\.deck\.stress: needs a \[simulate\]",
        ),
        ('body = "held"', 'body = "modes_only"', "'modes_only'.*yield strength|it has no yield strength"),
    ],
)
def test_tables_that_make_no_sense_are_refused(tmp_path, old, new, message):
    assert old in RESTING
    (tmp_path / "case.toml").write_text(RESTING.replace(old, new, 1))
    with pytest.raises(InputErrors, match=message):
        load_case(tmp_path)


def test_a_group_that_the_mesh_does_not_have_is_refused_with_those_it_has(tmp_path, resting):
    (tmp_path / "case.toml").write_text(RESTING.replace('name = "half", yield', 'name = "tip", yield'))
    changed = load_case(tmp_path)
    with pytest.raises(InputError, match=r"group 'tip' does not exist.*half, root"):
        body_stress(changed, "held", OutputFolder(resting.output_folder), load_results(resting))


def test_records_that_are_not_finite_have_no_stress(resting):
    results = load_results(resting)
    results._columns["held.modal_position"][-1] = np.nan
    with pytest.raises(InputError, match="modal coordinates of 'held' are not finite from 0 s on"):
        body_stress(resting, "held", OutputFolder(resting.output_folder), results)


def test_plates_have_their_own_thickness_by_which_a_grade_counts(tmp_path, resting):
    (tmp_path / "case.toml").write_text(RESTING.replace('grade = "S355"', 'grade = "S450"'))
    changed, folder = load_case(tmp_path), OutputFolder(resting.output_folder)
    stress = body_stress(changed, "deck", folder, load_results(resting))
    assert stress.group("plate").strength == pytest.approx([450e6, 450e6])
    text = RESTING.replace('grade = "S355"\nthickness = "10 mm"', 'grade = "S355"')
    (tmp_path / "case.toml").write_text(text)
    with pytest.raises(InputError, match=r"stress\.thickness: group 'bar' has parts without a thickness"):
        body_stress(load_case(tmp_path), "deck", folder, load_results(resting))


def test_interfaces_hold_a_free_plate_with_the_stress_of_the_full_model(tmp_path_factory):
    """A plate that hangs on one lug: modes with the vectors of the lug are the static solution by inertia relief."""
    text = f"""
title = "A plate that is held at one place"
gravity = {{ acceleration = [0, 0, -{G}] }}
[bodies.plate]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0.3, density = {RHO} }}
mesh = {{ size = 0.1 }}
modes = {{ count = 3 }}
frame = {{ motion = "free", origin = "centre_of_mass" }}
stress = {{}}
[bodies.plate.geometry]
type = "panels"
plates = {{ deck = {{ thickness = "10 mm", corners = [[0, 0, 0], [1, 0, 0], [1, 0.6, 0], [0, 0.6, 0]] }} }}
groups = {{ patch = {{ from = [0.15, 0.15, 0], to = [0.45, 0.45, 0] }} }}
[bodies.plate.interfaces.lug]
at = [0.3, 0.3, 0]
group = "patch"
[[joints]]
name = "grip"
type = "fixed"
between = ["ground", "plate"]
at = [0.3, 0.3, 0]
[simulate]
start = "equilibrium"
duration = 0
"""
    case = made(tmp_path_factory, text)
    folder = OutputFolder(case.output_folder)
    quantities = Quantities(case, case.output_folder)
    model, reduced = read_model(folder.model("plate")), read_reduced(folder.reduced("plate"))
    lug = reduced.interfaces["lug"]
    down = np.zeros((model.node_count + len(model.rotating), 3))
    mass = model.mass @ np.concatenate(
        [np.tile([0.0, 0.0, -G], model.node_count), np.zeros(3 * len(model.rotating))]
    )
    total = model.total_mass
    centre = model.points.masses @ model.points.positions / total
    force = np.array([0.0, 0.0, total * G])
    # the lug bears the moment of the weight about it
    moment = np.cross(centre - np.array([0.3, 0.3, 0.0]), force)
    load = np.concatenate([force, moment])
    down[lug.nodes] += lug.forces @ load
    turned = model.node_count + np.searchsorted(model.rotating, lug.nodes)
    down[turned] += lug.moments @ load
    u = Flexibility(model).solve(mass + down.ravel())
    n = 3 * model.node_count
    turns = np.zeros((model.node_count, 3))
    turns[model.rotating] = u[n:].reshape(-1, 3)
    expected = np.nanmax(nodal_stresses(model, [u[:n].reshape(-1, 3)], [turns]))
    assert quantities.number("stress.plate.deck.von_mises.max") == pytest.approx(expected, rel=1e-4)


def test_the_buckling_factor_of_a_column_under_its_weight_is_that_of_greenhill(tmp_path):
    (tmp_path / "case.toml").write_text(
        f"""
title = "A column that stands in its own weight"
gravity = {{ acceleration = [0, 0, -{G}] }}

[bodies.column]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0, density = {RHO} }}
mesh = {{ size = 0.1 }}
modes = {{ count = 6, clamp = ["root"] }}
frame = {{ motion = "fixed" }}
stress = {{ buckling = true }}

[bodies.column.geometry]
type = "panels"
plates.web = {{ thickness = "5 mm", corners = [[0, 0, 0], [0.1, 0, 0], [0.1, 0, 3], [0, 0, 3]] }}
groups.root = {{ plane = "z", at = 0 }}

[simulate]
start = "equilibrium"
duration = 0
"""
    )
    case = load_case(tmp_path)
    assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
    stress = body_stress(case, "column", OutputFolder(case.output_folder), load_results(case))
    (note,) = [note for note in stress.notes if note.startswith("Buckling")]
    factor = float(note.partition("by a factor of ")[2].partition(" ")[0])
    greenhill = 7.8373 * E * 0.005**2 / 12.0 / (RHO * G * 3.0**3)
    assert factor == pytest.approx(greenhill, rel=5e-3)


def test_the_correction_knows_that_a_rigid_interface_does_not_deform(tmp_path):
    """A beam between two clamps whose middle is rigid: its few modes and the correction, beside many modes alone."""
    found = []
    for count, correction in ((3, "true"), (150, "false")):
        folder = tmp_path / str(count)
        folder.mkdir()
        (folder / "case.toml").write_text(
            f"""
title = "A beam with a rigid middle"
gravity = {{ acceleration = [0, 0, -{G}] }}

[bodies.beam]
{BAR}
modes = {{ count = {count}, clamp = ["root", "end"] }}
frame = {{ motion = "fixed" }}
stress = {{ correction = {correction} }}

[bodies.beam.geometry]
type = "blocks"
add = [{{ name = "bar", from = [0, 0, 0], to = [{LENGTH}, {SIDE}, {SIDE}] }}]

[bodies.beam.geometry.groups]
root = {{ plane = "x", at = 0 }}
end = {{ plane = "x", at = {LENGTH} }}
middle = {{ from = [0.4, 0, 0], to = [1.6, {SIDE}, {SIDE}] }}

[bodies.beam.interfaces.middle]
at = [1, 0, 0]
group = "middle"
kind = "rigid"

[simulate]
start = "equilibrium"
duration = 0
"""
        )
        case = load_case(folder)
        assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
        stress = body_stress(case, "beam", OutputFolder(case.output_folder), load_results(case))
        found.append(stress.group("all").history()[-1])
    assert found[0] == pytest.approx(found[1], rel=0.02)


def test_what_a_table_of_stress_lacks_is_said_before_a_run(tmp_path):
    text = RESTING.replace('name = "half", yield_strength', 'name = "hlaf", yield_strength')
    (tmp_path / "case.toml").write_text(text)
    case = load_case(tmp_path)
    run_case(case, stages=("mesh", "modes"))
    with pytest.raises(
        InputError, match=r"bodies\.held\.stress\.groups\.1\.name: group 'hlaf' does not exist"
    ):
        run_case(case, stages=("simulate",))


def test_what_was_found_sound_is_not_looked_at_again(tmp_path, monkeypatch):
    (tmp_path / "case.toml").write_text(RESTING)
    run_case(load_case(tmp_path), stages=("mesh", "modes", "simulate"))
    looked: list[str] = []
    parts = body_stress_module._parts
    monkeypatch.setattr(
        body_stress_module, "_parts", lambda *given: (looked.append(given[1]), parts(*given))[1]
    )
    run_case(load_case(tmp_path), stages=("simulate",), force=("simulate",))
    assert looked == []
    text = RESTING.replace('name = "half", yield_strength', 'name = "hlaf", yield_strength')
    (tmp_path / "case.toml").write_text(text)
    for _ in range(2):
        with pytest.raises(InputError, match="group 'hlaf' does not exist"):
            run_case(load_case(tmp_path), stages=("simulate",), force=("simulate",))
    assert len(looked) == 2
