"""Case files: everything that is wrong is said at once, and what is right arrives in SI."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline import load_case, load_results

CASES = Path(__file__).parents[3] / "cases"


def edit(folder: Path, *changes: tuple[str, str]) -> Path:
    """Replace texts in a case file."""
    file = folder / "case.toml"
    text = file.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    file.write_text(text)
    return folder


def add_rigid(folder: Path, name: str, inertia: object) -> None:
    """Add a free rigid body of 1 kg to a case."""
    lines = [
        f"[bodies.{name}]",
        'type = "rigid"',
        "mass = 1",
        f"inertia = {inertia}",
        'frame = { motion = "free" }',
    ]
    edit(folder, ("[[sensors]]", "\n".join([*lines, "", "[[sensors]]"])))


def messages(folder: Path, *overrides: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        load_case(folder, overrides)
    return str(caught.value).splitlines()


@pytest.mark.parametrize("name", sorted(path.parent.name for path in CASES.glob("*/case.toml")))
def test_every_case_of_the_project_is_valid(name):
    case = load_case(CASES / name)
    assert case.name == name
    assert case.title
    assert case.sources
    assert (CASES / name / "README.md").is_file()


@pytest.mark.parametrize("number", range(1, 7))
def test_case_files_beside_each_other_have_names_and_results_of_their_own(number):
    case = load_case(CASES / "tank_erection" / f"wave_{number}.toml")
    assert case.name == f"tank_erection_wave_{number}"
    assert case.output_folder == CASES / "tank_erection" / "out" / f"wave_{number}"
    assert case.title
    assert case.sources


def test_the_results_of_a_case_file_are_found_by_its_name(small_case):
    (small_case / "other.toml").write_text((small_case / "case.toml").read_text())
    for file, folder in (("case.toml", "out"), ("other.toml", "out/other")):
        with pytest.raises(InputError, match="no results") as caught:
            load_results(small_case / file)
        assert str(small_case / folder / "simulate") in str(caught.value)
        assert load_case(small_case / file).output_folder == small_case / folder


def test_values_are_si(small_case):
    case = load_case(small_case / "case.toml")
    beam = case.bodies["beam"]
    assert beam.material.young_modulus == 210e9
    assert beam.geometry.add[0].upper == (0.2, 0.02, 0.01)
    assert case.simulate.step == 1e-6
    assert case.simulate.record_every == 20
    assert case.simulate.interval_count == 1000
    assert beam.initial.modal_velocity == (0.1, 0.05)


def test_a_case_does_not_change(small_case):
    case = load_case(small_case)
    with pytest.raises(ValueError, match="frozen"):
        case.title = "other"


def test_all_errors_at_once(small_case):
    edit(
        small_case,
        ('density = "7800 kg/m^3"', "density = -1"),
        ("poisson_ratio = 0.3", "poisson_ratio = 0.5"),
        ('clamp = ["root"]', 'clamp = ["rooot"]'),
        ('body = "beam"', 'body = "beem"'),
        ('step = "1 us"', 'stepp = "1 us"'),
        ('quantity = "mesh.beam.mass"', 'quantity = "mesh.beam.mas"'),
    )
    lines = messages(small_case)
    file = str(small_case / "case.toml")
    assert all(line.startswith(file) for line in lines)
    expected = {
        "bodies.beam.material.density": ["-1", "> 0"],
        "bodies.beam.material.poisson_ratio": ["0.5", "< 0.5"],
        "bodies.beam.modes.clamp.0": ["'rooot'", "did you mean 'root'"],
        "sensors.0.body": ["'beem'", "did you mean 'beam'"],
        "simulate.stepp": ["unknown key", "did you mean 'step'"],
        "check.0.quantity": ["'mesh.beam.mas'", "did you mean 'mass'"],
    }
    assert len(lines) == len(expected)
    for key, words in expected.items():
        (line,) = [line for line in lines if f": {key}: " in line]
        for word in words:
            assert word in line


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("bodies.beam.material.young_modulus=0", ["too small"]),
        ("bodies.beam.material.young_modulus=nan", ["not finite"]),
        ("bodies.beam.material.poisson_ratio=-1", ["too small"]),
        ("bodies.beam.modes.count=0", ["count"]),
        ("bodies.beam.modes.count=2.5", ["integer"]),
        ("bodies.beam.modes.select=[1, 4]", ["mode 4", "count = 3"]),
        ("bodies.beam.modes.damping_ratio=[0.1, 0.2]", ["2 values", "1 or 3"]),
        ("bodies.beam.initial.modal_velocity=[1, 2, 3, 4]", ["4 values", "at most 3"]),
        ("bodies.beam.initial.modal_velocity=['1 s']", ["is a time", "velocity"]),
        ("bodies.beam.initial.velocity=[1, 0, 0]", ["fixed frame", "free"]),
        ("bodies.beam.initial.position=[1]", ["1 entries", "at least 3"]),
        ("bodies.beam.geometry.add.0.to=[0, 1, 1]", ["larger than"]),
        ("bodies.beam.geometry.groups.root.plane=w", ["'x', 'y' or 'z'"]),
        ("bodies.beam.geometry.type=blobs", ["'blobs'", "'blocks'"]),
        ("bodies.beam.mesh.refine=[{at='root', size='1 mm'}]", ["tet10"]),
        ("simulate.output_interval=3.5e-6", ["3.5 times step", "multiple"]),
        ("simulate.duration=0.02001", ["output_interval", "multiple"]),
        ("simulate.integrator=euler", ["'dele2', 'accurate', 'thesis' or 'auto'"]),
        ("check.1.id=mass", ["occurs 2 times"]),
        ("check.0.tolerance={}", ["exactly one"]),
        ("check.0.tolerance={relative=0.1, absolute=1}", ["exactly one"]),
        ("check.0.tolerance={absolute='1 m'}", ["is a length", "mass"]),
        ("check.0.reference=3 s", ["is a time", "mass"]),
        ("check.0.reference=0", ["relative tolerance"]),
        ("check.1.quantity=ringdown.beam.4", ["vector 4 of 3"]),
        ("check.1.quantity=channel.tip.positon.x.end", ["did you mean 'position'"]),
        ("sensors.0.name=beam", ["occurs 2 times"]),
        ("sensors.0.name=energy", ["channel of the whole scene"]),
        ("converge.values=[1]", ["at least 2"]),
        ("gravity.acceleration=[0, 0, '1 m']", ["is a length", "acceleration"]),
        ("title=3", ["string"]),
        ("simulate=3", ["not a table"]),
    ],
)
def test_values_out_of_range_are_refused(small_case, override, words):
    text = "\n".join(messages(small_case, override))
    for word in words:
        assert word in text, text
    assert override.partition("=")[0].partition(".")[0] in text


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        ([1.0, 1.0, 2.5], "exceeds the sum"),
        ([1.0, -1.0, 1.0], "not positive definite"),
        ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "not positive definite"),
        ([[1, 0.1, 0], [0.2, 1, 0], [0, 0, 1]], "differ"),
        ([1.0, 2.0], "3 numbers on the diagonal"),
    ],
)
def test_inertia_of_no_body_is_refused(small_case, inertia, words):
    add_rigid(small_case, "box", inertia)
    (line,) = messages(small_case)
    assert "bodies.box.inertia" in line
    assert words in line


def test_inertia_of_a_rod_and_of_a_turned_box_are_accepted(small_case):
    add_rigid(small_case, "rod", [1e-12, 1, 1])
    add_rigid(small_case, "box", [[2, 0.5, 0], [0.5, 2, 0], [0, 0, 3]])
    assert load_case(small_case).bodies["box"].inertia[0] == (2.0, 0.5, 0.0)


def test_overrides_take_toml_or_plain_text_and_list_indexes(small_case):
    case = load_case(
        small_case,
        [
            "simulate.step=0.5 us",
            'simulate.output_interval="5 us"',
            "bodies.beam.geometry.add.0.to.0=300 mm",
            "report.modes=[2, 3]",
            "gravity.acceleration=[0, 0, -9.81]",
        ],
    )
    assert case.simulate.record_every == 10
    assert case.bodies["beam"].geometry.add[0].upper[0] == 0.3
    assert case.report.modes == (2, 3)
    assert case.gravity.acceleration == (0.0, 0.0, -9.81)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("simulate.stepp=1", ["simulate.stepp does not exist", "did you mean 'step'"]),
        ("bodies.beem.mesh.size=1", ["bodies.beem", "did you mean 'beam'"]),
        ("sensors.3.name=a", ["sensors.3", "0 to 0"]),
        ("title.x=1", ["title.x"]),
        ("simulate.step", ["key=value"]),
        ("simulate.step=3 kg", ["--set simulate.step=3 kg", "is a mass"]),
    ],
)
def test_overrides_that_lead_nowhere_are_refused(small_case, override, words):
    text = "\n".join(messages(small_case, override))
    for word in words:
        assert word in text


def test_a_syntax_error_names_file_and_line(small_case):
    edit(small_case, ("[simulate]", "[simulate"))
    (line,) = messages(small_case)
    assert line.startswith(str(small_case / "case.toml"))
    number = 1 + (small_case / "case.toml").read_text().splitlines().index("[simulate")
    assert f"line {number}" in line


def test_a_missing_case_is_said(tmp_path):
    with pytest.raises(InputError, match=r"nowhere.*does not exist"):
        load_case(tmp_path / "nowhere")


def test_profiles_of_driven_frames(small_case):
    lines = [
        'motion = "driven"',
        "axis = [0, 1, 0]",
        'angle = { times = [0, "1 s"], values = [0, "90 deg"] }',
        'z = { harmonics = [{ amplitude = "2 cm", frequency = "1 Hz", phase = "90 deg" }] }',
    ]
    edit(small_case, ('motion = "fixed"', "\n".join(lines)))
    frame = load_case(small_case).bodies["beam"].frame
    assert frame.angle.values == (0.0, math.pi / 2)
    assert frame.z.harmonics[0].amplitude == 0.02
    text = "\n".join(messages(small_case, "bodies.beam.frame.angle.values=[0, '1 m']"))
    assert "is a length" in text
    text = "\n".join(messages(small_case, "bodies.beam.frame.angle.times=[0, 0]"))
    assert "increasing times" in text
    text = "\n".join(messages(small_case, "bodies.beam.frame.angle.valus=[0]"))
    assert "valus does not exist; did you mean 'values'" in text


def test_errors_carry_their_parts(small_case):
    edit(small_case, ('density = "7800 kg/m^3"', 'density = "steel"'))
    with pytest.raises(InputErrors) as caught:
        load_case(small_case)
    (error,) = caught.value.errors
    assert error.key == "bodies.beam.material.density"
    assert error.source == str(small_case / "case.toml")


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("bodies.beam.modes.count=-4", "bodies.beam.modes.count", "-4 is too small; expected a number >= 0"),
        (
            "bodies.beam.modes.count=true",
            "bodies.beam.modes.count",
            "True is not an integer; expected an integer",
        ),
        (
            "bodies.beam.modes.count='4'",
            "bodies.beam.modes.count",
            "'4' is not an integer; expected an integer",
        ),
        (
            "bodies.beam.mesh.curved=5",
            "bodies.beam.mesh.curved",
            "5 is neither true nor false; expected true or false",
        ),
        (
            "bodies.beam.mesh.divisions={w=[1]}",
            "bodies.beam.mesh.divisions.w",
            "'w'; expected 'x', 'y' or 'z'",
        ),
        ("bodies.beam.geometry.add=[]", "bodies.beam.geometry.add", "has 0 entries; expected at least 1"),
        (
            "bodies.beam.geometry.type=blobs",
            "bodies.beam.geometry",
            "type = 'blobs'; expected one of 'blocks'",
        ),
        ("bodies.beam.geometry.groups.root.at=3 s", "bodies.beam.geometry.groups.root.at", "'3 s' is a time"),
        (
            "bodies.beam.material.poisson_ratio=0.5",
            "bodies.beam.material.poisson_ratio",
            "0.5 is too large; expected a number < 0.5",
        ),
        ("bodies.beam.modes.basis=krylov", "bodies.beam.modes", "basis 'krylov' without loads"),
        ("bodies.beam.geometry.type=mesh", "bodies.beam.geometry.add", "unknown key; expected one of"),
        ("bodies.beam.mesh.curved=true", "bodies.beam", "'mesh.curved' with geometry 'blocks'"),
        (
            "bodies.beam.initial.position=[1]",
            "bodies.beam.initial.position",
            "[1] has 1 entries; expected at least 3",
        ),
        (
            "bodies.beam.geometry.add.0.to=['0.5 s', 1, 1]",
            "bodies.beam.geometry.add.0.to.0",
            "'0.5 s' is a time",
        ),
        ("bodies.beam.frame.motion=loose", "bodies.beam.frame", "motion = 'loose'; expected one of"),
        (
            "bodies.beam.modes.static_directions=q",
            "bodies.beam.modes.static_directions",
            "'q'; expected text like",
        ),
        (
            'bodies.beam.modes.static_directions=""',
            "bodies.beam.modes.static_directions",
            "''; expected at least 1 ",
        ),
        ("check.1.id=mass", "check.1.id", "'mass' occurs 2 times"),
    ],
)
def test_one_mistake_is_said_once_under_the_key_that_the_file_has(small_case, override, key, words):
    lines = [line.removeprefix(f"--set {override}: ") for line in messages(small_case, override)]
    lines = [line.removeprefix(f"{small_case / 'case.toml'}: ") for line in lines]
    if "geometry.type=mesh" in override:
        assert len(lines) == 2  # the file is missing, and the blocks do not belong there
        lines = [line for line in lines if line.startswith(f"{key}: ")]
    (line,) = lines
    assert line.startswith(f"{key}: {words}"), line
    assert "expected" in line
    if words.endswith("0.5"):
        assert line.endswith(words)


def test_a_list_under_the_name_of_the_type_is_an_unknown_key(small_case):
    lines = messages(small_case, "bodies.beam.geometry={type='blocks', blocks=[1]}")
    assert any("bodies.beam.geometry.add: is missing; expected a value" in line for line in lines)
    assert any("bodies.beam.geometry.blocks: unknown key; expected one of: add," in line for line in lines)


def test_a_misspelt_key_is_one_line_with_the_hint_before_what_is_expected(small_case):
    edit(small_case, ("density =", "densty ="))
    (line,) = messages(small_case)
    assert (
        ": bodies.beam.material.densty: unknown key; did you mean 'density'?; expected one of: density,"
        in line
    )


def test_a_missing_table_is_named_without_the_kind_of_body(small_case):
    edit(small_case, ('[bodies.beam.modes]\ncount = 3\nclamp = ["root"]', ""))
    (line,) = messages(small_case)
    assert ": bodies.beam.modes: is missing; expected a value" in line


def test_a_free_frame_is_not_clamped(small_case):
    (line,) = messages(small_case, "bodies.beam.frame.motion=free")
    assert ": bodies.beam.modes.clamp: ['root']" in line
    assert "expected no clamp with a free frame" in line
    load_case(small_case, ["bodies.beam.frame.motion=free", "bodies.beam.modes.clamp=[]"])


@pytest.mark.parametrize("divisions", [("[1]", "[2]"), ("[2]", "[1]")])
def test_a_single_brick_with_reduced_integration_through_a_wall_is_refused(small_case, divisions):
    y, z = divisions
    overrides = [f"bodies.beam.mesh.divisions.y={y}", f"bodies.beam.mesh.divisions.z={z}"]
    load_case(small_case, overrides)
    (line,) = messages(small_case, *overrides, "bodies.beam.mesh.formulation=reduced")
    assert f": bodies.beam.mesh.divisions.{'y' if y == '[1]' else 'z'}: [1]: one brick" in line
    both = [f"bodies.beam.mesh.divisions.{axis}=[2]" for axis in "yz"]
    load_case(small_case, [*both, "bodies.beam.mesh.formulation=reduced"])


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("check.1.reference.quantity=ringdown.beam.1", "check.1.reference.quantity", "compared with itself"),
        (
            "converge.reference.quantity=ringdown.beam.2",
            "converge.reference.quantity",
            "compared with itself",
        ),
        ("check.0.tolerance.relative=1", "check.0.tolerance.relative", "expected a number < 1"),
        ("check.0.tolerance.relative=250 %", "check.0.tolerance.relative", "expected a number < 1"),
        ("check.0.source=' '", "check.0.source", "expected where the reference comes from"),
        ("check.1.quantity=ringdown.beam.4", "check.1.quantity", "vector 4 of 3"),
    ],
)
def test_checks_that_cannot_fail_are_refused(small_case, override, key, words):
    (line,) = messages(small_case, override)
    assert f": {key}: " in line
    assert words in line


FREE = ("bodies.beam.frame.motion=free", "bodies.beam.modes.clamp=[]")
FORCE = "forces=[{name='push', body='beam', point=[0, 0, 0], force=[1, 0, 0]}]"


@pytest.mark.parametrize("drift", ["momentum", "angular_momentum"])
@pytest.mark.parametrize(
    ("overrides", "cause"),
    [
        ((), "the fixed frame of 'beam'"),
        ((*FREE, "gravity.acceleration=[0, 0, -9.81]"), "gravity"),
        ((*FREE, FORCE), "force 'push'"),
        (FREE, ""),
    ],
)
def test_momentum_is_conserved_only_by_free_bodies_without_forces(small_case, drift, overrides, cause):
    edit(
        small_case,
        ('quantity = "ringdown.beam.1"', f'quantity = "drift.{drift}"'),
        ('reference = { quantity = "modes.beam.frequency.1" }', "reference = 0.0"),
        ("tolerance = { relative = 1e-4 }", "tolerance = { absolute = 1e-6 }"),
    )
    if cause:
        (line,) = messages(small_case, *overrides)
        assert ": check.1.quantity: " in line
        assert f"{cause} changes the momentum" in line
    else:
        load_case(small_case, overrides)
