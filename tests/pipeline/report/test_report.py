"""The report: everything the stages left is in it, nothing that is missing stops it, no text breaks its markup."""

import dataclasses
import html.parser
import json
import re

import h5py
import numpy as np
import pytest
from scipy.sparse import csr_array, identity

from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import ReducedBody
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.pictures import render as picture_render
from heavylift.pipeline.report import report
from heavylift.pipeline.report.bodies import body_sections
from heavylift.pipeline.report.document import (
    Album,
    Document,
    Facts,
    Section,
    Table,
    Text,
    to_html,
    to_markdown,
)
from heavylift.pipeline.report.report import write_report
from heavylift.pipeline.results.histories import FORMAT
from heavylift.pipeline.results.model_io import write_model, write_reduced
from heavylift.pipeline.results.storage import OutputFolder, write_json
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import FEModel, Material

FREQUENCIES = np.array([40.0, 95.0])
CASE = """
title = "Bar <script>alert(1)</script> & $x$ | *y*"
sources = ["a <i>book</i>"]
[bodies.bar]
type = "flexible"
material = { young_modulus = "210 GPa", poisson_ratio = 0.3, density = "7850 kg/m^3" }
mesh = { element = "hex8", size = "100 mm", mass = "lumped" }
modes = { count = 2, clamp = ["root"] }
frame = { motion = "fixed" }
[bodies.bar.geometry]
type = "blocks"
add = [{ name = "bar", from = ["0 mm", "0 mm", "0 mm"], to = ["400 mm", "100 mm", "100 mm"] }]
groups = { root = { plane = "x", at = "0 mm" } }
[simulate]
step = "1 ms"
output_interval = "1 ms"
duration = "1 s"
[report]
modes = [1, 2, 7]
stress_times = ["100 ms"]
channels = ["bar.modal_position", "bar.reaction_moment"]
[[check]]
id = "first"
quantity = "modes.bar.frequency.1"
reference = "40.1 Hz"
tolerance = { relative = 1e-2 }
source = "closed <b>form</b> & more"
[[check]]
id = "second"
quantity = "modes.bar.frequency.2"
reference = "90 Hz"
tolerance = { absolute = "1 Hz" }
source = "measured"
[[check]]
id = "ring"
quantity = "ringdown.bar.1"
reference = { quantity = "modes.bar.frequency.1" }
tolerance = { relative = 1e-6 }
source = "reduced eigenvalue"
"""


@pytest.fixture
def case(tmp_path):
    folder = tmp_path / "bar_case"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE)
    return load_case(folder)


def write_bodies(out):
    """A bar of four bricks with two shapes that no solver made."""
    axes = (np.linspace(0.0, 0.4, 5), np.array([0.0, 0.1]), np.array([0.0, 0.1]))
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    elements = np.array([[b, b + 4, b + 6, b + 2, b + 1, b + 5, b + 7, b + 3] for b in range(0, 16, 4)])
    mesh = Mesh(nodes, elements, "hex8").check()
    mass = csr_array(identity(len(nodes), format="csr") * (31.4 / len(nodes)))
    stiffness = csr_array(identity(3 * len(nodes), format="csr"))
    groups = {"root": np.arange(4)}
    material = Material(2.1e11, 0.3, 7850.0)
    model = FEModel(nodes, stiffness, mass, mesh=mesh, material=material, node_groups=groups)
    shapes = np.zeros((2, len(nodes), 3))
    shapes[0, :, 1] = (nodes[:, 0] / 0.4) ** 2
    shapes[1, :, 2] = (nodes[:, 0] / 0.4) ** 2
    shapes /= np.sqrt(np.einsum("mni,mni->m", shapes, shapes) * 31.4 / len(nodes))[:, None, None]
    reduced = ReducedBody(
        nodes=nodes,
        eigenvalues=(2.0 * np.pi * FREQUENCIES) ** 2,
        mode_shapes=shapes,
        integrals=shape_integrals(nodes, shapes, mass),
        mean_axis=False,
        labels=("eigenmode 1", "eigenmode 2"),
        residuals=np.array([1e-9, 2e-9]),
        orthogonality=1e-15,
    )
    stages = OutputFolder(out)
    write_model(stages.model("bar"), model, {})
    write_json(
        stages.manifest("mesh"),
        {"items": {"bar": {"digest": "d1ge57", "size": 1, "cpu_s": 1.0}}, "versions": {"gmsh": "9.9"}},
    )
    return stages, reduced


def write_results(out, last_finite=None, records=1001, **attributes):
    times = np.arange(1001) * 1e-3
    history = 1e-3 * np.column_stack([np.sin(2.0 * np.pi * f * times) for f in FREQUENCIES])
    if last_finite is not None:
        history[last_finite + 1 :] = np.nan
    omega = 2.0 * np.pi * FREQUENCIES
    channels = {
        "bar.modal_position": ("m kg^0.5", ("1", "2"), history),
        "energy.elastic": ("J", ("",), 0.5 * (history**2 @ omega**2)[:, None]),
        "energy.kinetic": ("J", ("",), 0.5 * (1e-6 * omega @ omega - history**2 @ omega**2)[:, None]),
        "energy.balance": ("J", ("",), np.full((1001, 1), 0.5e-6 * omega @ omega)),
    }
    file = OutputFolder(out).results
    file.parent.mkdir(parents=True, exist_ok=True)
    with h5py.File(file, "w") as target:
        target.attrs.update(
            {"format": FORMAT, "outcome": "completed", "channel_order": json.dumps(list(channels))}
        )
        target.attrs.update({"steps": 1000, "cpu_s": 0.25, "message": ""} | attributes)
        target["time"] = times[:records]
        for name, (unit, components, data) in channels.items():
            dataset = target.create_dataset(f"channels/{name}", data=data[:records])
            dataset.attrs.update({"unit": unit, "components": json.dumps(components), "column": 0})


class Reader(html.parser.HTMLParser):
    """Tags in balance, pictures and visible text of an HTML file."""

    def __init__(self, text):
        super().__init__()
        self.open, self.pictures, self.text, self.tags = [], [], [], set()
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        if tag == "img":
            self.pictures.append(dict(attrs)["src"])
        if tag not in {"img", "input", "meta"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "script" not in self.open:
            self.text.append(data)


def read(paths):
    by_name = {path.name: path for path in paths}
    assert all(path.is_file() for path in paths)
    reader = Reader(by_name["report.html"].read_text(encoding="utf-8"))
    return by_name, reader, " ".join(reader.text), by_name["report.md"].read_text(encoding="utf-8")


@pytest.fixture
def drawn(monkeypatch):
    try:
        picture_render.rendering_backend()
    except picture_render.RenderingUnavailableError as error:
        pytest.skip(str(error))


@pytest.mark.slow
def test_whole_report(case, tmp_path, drawn):
    out = tmp_path / "out"
    stages, reduced = write_bodies(out)
    write_reduced(stages.reduced("bar"), reduced, {"frame_origin": [0.0, 0.0, 0.0]})
    write_results(out)
    files, reader, text, markdown = read(write_report(case, out / "report", out))
    names = {
        "bar_mesh",
        "bar_modes",
        "bar_mode_1",
        "bar_mode_2",
        "bar_stress_mode_1",
        "bar_stress_time_1",
        "energy",
        "scene_start",
        "scene_end",
    }
    names |= {"history_bar_modal_position", "spectrum_bar_modal_position"}
    assert {f"{name}.png" for name in names} | {"report.html", "report.md"} == set(files)
    assert len(reader.pictures) == len(names)
    assert all(source.startswith("data:image/png;base64,") for source in reader.pictures)
    assert set(re.findall(r"\]\((\w+)\.png\)", markdown)) == names
    # checks: value, reference, verdict; the second is 5 Hz off, the third is fitted from the history
    assert "Failed: 1 of 3 checks (second)." in text
    rows = [line for line in markdown.splitlines() if line.startswith(("| first", "| second", "| ring"))]
    assert [row.rstrip(" |").rpartition("| ")[2] for row in rows] == ["passed", "FAILED", "passed"]
    assert "| 40 | 40.1 | Hz | 2.49e-03 rel. | 1.00e-02 rel. |" in rows[0]
    assert "| 95 | 90 | Hz | 5.00e+00 Hz | 1.00e+00 Hz | measured |" in rows[1]
    for words in (
        "210 GPa",
        "31.4 kg",
        "4 hex8 elements, 20 nodes",
        "0.25 s",
        "d1ge57",
        "gmsh 9.9",
        "t = 100 ms",
    ):
        assert words in text, words
    assert "Channel 'bar.reaction_moment' is not recorded" in text
    # nothing loaded from elsewhere, no text turned into markup
    page = files["report.html"].read_text(encoding="utf-8")
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)", page)
    assert {"i", "link"}.isdisjoint(reader.tags)
    assert page.count("<script") == 4  # header, numbers, library and script of the scene, none of the title
    assert "Bar <script>alert(1)</script> & $x$ | *y*" in text
    assert "closed <b>form</b> & more" in text
    assert "<script>" not in markdown
    assert "<b>" not in markdown


@pytest.mark.slow
@pytest.mark.parametrize("stage", ["nothing", "mesh", "modes"])
def test_missing_stages_leave_the_rest(case, tmp_path, drawn, stage):
    out = tmp_path / "out"
    if stage != "nothing":
        stages, reduced = write_bodies(out)
        if stage == "modes":
            write_reduced(stages.reduced("bar"), reduced, {"frame_origin": [0.0, 0.0, 0.0]})
    files, _, text, _ = read(write_report(case, out / "report", out))
    assert ("bar_mesh.png" in files) == (stage != "nothing")
    assert ("bar_mode_1.png" in files) == (stage == "modes")
    assert "energy.png" not in files
    assert ("Failed: 1 of 3" if stage == "modes" else "Open: 3 of 3 checks") in text
    assert "No time histories" in text
    for check in ("first", "second", "ring"):
        assert check in text
    assert "not run" in text


@pytest.mark.slow
def test_report_goes_on_where_nothing_can_be_drawn(case, tmp_path, monkeypatch):
    def refuse():
        raise picture_render.RenderingUnavailableError("install libegl1")

    monkeypatch.setattr(report, "Renderer", refuse)
    out = tmp_path / "out"
    stages, reduced = write_bodies(out)
    write_reduced(stages.reduced("bar"), reduced, {"frame_origin": [0.0, 0.0, 0.0]})
    write_results(out)
    files, _, text, _ = read(write_report(case, out / "report", out))
    assert "install libegl1" in text
    assert {"energy.png", "spectrum_bar_modal_position.png"} < set(files)
    assert "bar_mesh.png" not in files
    assert "Failed: 1 of 3 checks" in text


def test_diverged_history_is_shown_up_to_its_last_finite_value(case, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "_renderer", lambda: (None, ""))
    out = tmp_path / "out"
    write_results(out, last_finite=300)
    files, _, text, _ = read(write_report(case, out / "report", out))
    assert "not finite from t = 0.301 s on" in text
    assert "301 records" in text
    assert "energy.png" in files


@pytest.mark.slow
@pytest.mark.parametrize("records", [0, 1, 301])
def test_a_run_that_stopped_by_itself_is_the_verdict(case, tmp_path, monkeypatch, records):
    monkeypatch.setattr(report, "_renderer", lambda: (None, ""))
    out = tmp_path / "out"
    stages, reduced = write_bodies(out)
    write_reduced(stages.reduced("bar"), reduced, {"frame_origin": [0.0, 0.0, 0.0]})
    message = "at t = 0.301 s the modal coordinates of bar are not finite"
    write_results(out, records=records, outcome="not_finite", message=message)
    files, _, text, markdown = read(write_report(case, out / "report", out))
    page = files["report.html"].read_text(encoding="utf-8")
    box = re.search(r'<p class="verdict failed">(.*?)</p>', page).group(1)
    assert box.startswith(f"Stopped: a value is not finite. {message}.")
    assert "Failed besides: second" in box
    assert f"**{box}**" in markdown
    assert "first" in text
    assert "not_finite" in text


def test_a_run_that_stopped_without_any_file_is_the_verdict(case, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "_renderer", lambda: (None, ""))
    out = tmp_path / "out"
    manifest = {"outcome": "step_too_large", "message": "bar turns 2 rad a step"}
    write_json(OutputFolder(out).manifest("simulate"), manifest)
    _, _, text, _ = read(write_report(case, out / "report", out))
    assert "Stopped: the step is too large. bar turns 2 rad a step." in text
    manifest = {"outcome": "interrupted", "message": ""}
    write_json(OutputFolder(out).manifest("simulate"), manifest)
    files, *_ = read(write_report(case, out / "report", out))
    assert '<p class="verdict open">Stopped: interrupted.' in files["report.html"].read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(("fast", "warned"), [(95.0, False), (1095.0, True)])
def test_frequencies_that_the_records_cannot_resolve_are_called_false(
    case, tmp_path, monkeypatch, fast, warned
):
    """Sampled every millisecond, 1095 Hz and 95 Hz have the same records."""
    monkeypatch.setattr(report, "_renderer", lambda: (None, ""))
    out = tmp_path / "out"
    stages, reduced = write_bodies(out)
    eigenvalues = (2.0 * np.pi * np.array([40.0, fast])) ** 2
    write_reduced(stages.reduced("bar"), dataclasses.replace(reduced, eigenvalues=eigenvalues), {})
    write_results(out)
    files, _, text, _ = read(write_report(case, out / "report", out))
    page = files["report.html"].read_text(encoding="utf-8")
    warning = [words for words in re.findall(r'<p class="warning">(.*?)</p>', page) if "aliasing" in words]
    assert len(warning) == int(warned)
    assert ("Aliased: mode 2; natural frequencies above 500 Hz" in text) == warned
    if warned:
        assert "1 natural frequency exceeds 500 Hz" in warning[0]
        assert "mode 2 is excited" in warning[0]


def test_only_eigenmodes_have_a_residual(case, tmp_path):
    stages, reduced = write_bodies(tmp_path / "out")
    for residuals, cells in (
        ([1e-9, 2e-9], ["1.0e-09", "2.0e-09"]),
        ([1e-9, 0.7], ["1.0e-09", "not an eigenmode"]),
    ):
        body = dataclasses.replace(reduced, residuals=np.array(residuals))
        write_reduced(stages.reduced("bar"), body, {})
        section = body_sections(case, "bar", case.bodies["bar"], stages, None, None, None)[1]
        assert [row[-1] for row in section.items[0].rows] == cells
        notes = [item.text for item in section.items if isinstance(item, Text)]
        assert len(notes) == cells.count("not an eigenmode")
        assert all("no eigenmode of the full model" in note for note in notes)


@pytest.mark.parametrize(("wanted", "drawn_count"), [(2, 30), (33, 33)])
def test_the_contact_sheet_is_limited(case, tmp_path, wanted, drawn_count):
    from heavylift.pipeline.report.bodies import _mode_figures

    class Sheets:
        has_outline = True

        def resized(self, *_):
            return self

        def mode(self, *_, **__):
            return b""

        def contact_sheet(self, shapes, labels, **_):
            assert len(shapes) == len(labels) == drawn_count
            return b""

    _, reduced = write_bodies(tmp_path / "out")
    many = dataclasses.replace(
        reduced,
        eigenvalues=np.arange(1.0, 41.0),
        mode_shapes=np.repeat(reduced.mode_shapes, 20, axis=0),
        labels=("vector",) * 40,
        residuals=np.zeros(40),
    )
    modes = tuple(range(1, wanted + 1))
    asked = case.model_copy(update={"report": case.report.model_copy(update={"modes": modes})})
    figures = _mode_figures(asked, "bar", many, Sheets(), Album(tmp_path))
    assert figures[0].caption == f"The first {drawn_count} of 40 shapes of bar."


INPUTS = """
[gravity]
acceleration = ["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"]
[[forces]]
name = "push"
body = "bar"
point = ["400 mm", "0 mm", "0 mm"]
times = ["0 s", "20 ms"]
forces = [["0 N", "0 N", "0 N"], ["0 N", "12 N", "-3 N"]]
frame = "body"
[[forces]]
name = "weight"
body = "rotor"
point = ["0 mm", "0 mm", "0 mm"]
force = ["0 N", "0 N", "-5 kN"]
[[sensors]]
name = "tip"
body = "bar"
point = ["400 mm", "50 mm", "50 mm"]
[bodies.bar.initial]
modal_velocity = ["0.2 m/s", "0.1 m/s"]
[bodies.rotor]
type = "rigid"
mass = "2.5 kg"
inertia = ["1 kg m^2", "2 kg m^2", "2.5 kg m^2"]
[bodies.rotor.frame]
motion = "driven"
axis = [0, 1, 0]
angle = { harmonics = [{ amplitude = "0.3 rad", frequency = "5 Hz" }] }
x = { times = ["0 s", "2 s"], values = ["0 m", "0.7 m"] }
[bodies.free]
type = "rigid"
mass = "3 kg"
inertia = [[2.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 2.0]]
frame = { motion = "free" }
[bodies.free.initial]
position = ["1 m", "2 m", "3 m"]
orientation = { axis = [0, 0, 1], angle = "0.5 rad" }
velocity = ["4 m/s", "0 m/s", "0 m/s"]
angular_velocity = ["0 rad/s", "7 rad/s", "0 rad/s"]
"""


def test_all_inputs_are_in_the_report(tmp_path, monkeypatch):
    monkeypatch.setattr(report, "_renderer", lambda: (None, ""))
    folder = tmp_path / "full"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE + INPUTS)
    full = load_case(folder, ["simulate.step=0.5 ms", "bodies.bar.mesh.formulation=reduced"])
    out = tmp_path / "out"
    write_bodies(out)
    _, _, _, markdown = read(write_report(full, out / "report", out))
    for row in (
        "| gravity | (0, 0, -9.81) m/s^2 |",
        "| time integration | dele2: step 500 µs, output interval 1 ms, duration 1 s |",
        "| override (--set) | simulate.step=0.5 ms |",
        "| push | point | bar | (400, 0, 0) mm | 2 times: 0 to 20 ms; 2 forces: smallest (0, 0, -3) N, ",
        "largest (0, 12, 0) N; frame body |",
        "| weight | point | rotor | (0, 0, 0) m | frame world; force (0, 0, -5) kN |",
        "| tip | bar | (400, 50, 50) mm |",
        "| initial modal velocity | (200, 100) mm/s, shapes of largest component 1 |",
        "| geometry | blocks: 1 added |",
        "| element size | 100 mm |",
        "| element | hex8, reduced integration with hourglass stiffness |",
        "| mass | 2.5 kg |",
        "| inertia about the centre of mass | diagonal (1, 2, 2.5) kg m^2 |",
        "| inertia about the centre of mass | xx, yy, zz, xy, xz, yz: (2, 2, 2, 0.1, 0, 0) kg m^2 |",
        "| driven along x | table of 2 points, 0 to 2 s: 0 to 700 mm |",
        "| driven rotation | 300 mrad sine at 5 Hz, phase 0 rad; axis (0, 1, 0) through (0, 0, 0) m |",
        "| initial position | (1, 2, 3) m |",
        "| initial orientation | 0.5 rad about (0, 0, 1) |",
        "| initial velocity | (4, 0, 0) m/s |",
        "| initial angular velocity | (0, 7, 0) rad/s |",
    ):
        assert row.replace("_", r"\_") in markdown, row


def test_pictures_of_an_earlier_report_are_removed_and_other_files_kept(case, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "_renderer", lambda: (None, ""))
    out = tmp_path / "out"
    write_results(out)
    write_report(case, out / "report", out)
    assert (out / "report" / "energy.png").exists()
    (out / "report" / "mine.png").write_bytes(b"kept")
    OutputFolder(out).results.unlink()
    write_report(case, out / "report", out)
    assert not (out / "report" / "energy.png").exists()
    assert (out / "report" / "mine.png").read_bytes() == b"kept"


def test_both_forms_say_the_same():
    table = Table(("a", "b"), (("x|y", "1 < 2"), ("<p>", "*3*")), frozenset({1}), (True, False))
    parts = (Text("one & two", warning=True), Facts((("key", "`value`"),)), table)
    document = Document("T_1", "sub", (Section("S", parts),))
    page = to_html(document, {})
    words = " ".join(Reader(page).text)
    for cell in ("x|y", "1 < 2", "<p>", "*3*", "one & two", "`value`", "T_1", "sub"):
        assert cell in words
    markdown = to_markdown(document)
    assert r"| x\|y | 1 &lt; 2 |" in markdown
    assert r"| &lt;p&gt; | \*3\* |" in markdown
    assert "|---|---:|" in markdown
    assert '<tr class="failed">' in page


LINKS = """
title = "Links without a mesh"
[[repeat]]
count = 6
shift = ["1 m", 0, 0]
[repeat.bodies."link_{i}"]
type = "rigid"
mass = "2 kg"
inertia = [1, 1, 1]
frame = { motion = "free" }
[[repeat.joints]]
type = "hinge"
name = "pin_{i}"
between = ["ground", "link_{i}"]
at = [0, 0, 0]
axis = [0, 1, 0]
limits = { lower = "-30 deg", stiffness = "1 kN m/rad" }
[[ropes]]
name = "fall"
axial_stiffness = "1 MN"
path = [{ body = "ground", point = [0, 0, "5 m"] }, { body = "link_0", point = [0, 0, 0] }]
[[forces]]
type = "motor"
name = "drum"
joint = "pin_1"
load = "20 N m"
[[sensors]]
name = "tip"
body = "link_5"
point = [0, 0, 0]
[[reference]]
name = "tip"
channel = "tip.position"
file = "tip.csv"
[simulate]
integrator = "accurate"
output_interval = "10 ms"
duration = "1 s"
"""


@pytest.mark.slow
def test_a_scene_of_rigid_bodies_only(tmp_path):
    folder = tmp_path / "links"
    folder.mkdir()
    (folder / "case.toml").write_text(LINKS)
    (folder / "tip.csv").write_text("time,x\n0,0\n0.5,0.25\n1,1\n")
    case = load_case(folder)
    times = np.linspace(0.0, 1.0, 101)
    channels = {
        "tip.position": (np.column_stack([times**2, 0 * times, times]), "m", ("x", "y", "z")),
        "fall.tension": (1e3 * times, "N", ("tension",)),
        "link_0.position": (np.column_stack([times] * 3), "m", ("x", "y", "z")),
        "monitor.violation": (1e-9 * times, "m", ("violation",)),
        "energy.kinetic": (times, "J", ("kinetic",)),
        "energy.elastic": (1 - times, "J", ("elastic",)),
        "energy.balance": (np.ones(101), "J", ("balance",)),
    }
    out = folder / "out"
    (out / "simulate").mkdir(parents=True)
    with h5py.File(OutputFolder(out).results, "w") as file:
        file.attrs.update(format=FORMAT, channel_order=json.dumps(list(channels)), outcome="completed")
        file.attrs.update(degrees_of_freedom=1, redundant=json.dumps(["joint 'pin_3'"]), choice="auto: stiff")
        file["time"] = times
        for name, (values, unit, parts) in channels.items():
            data = file.create_dataset(f"channels/{name}", data=values.reshape(101, -1))
            data.attrs.update(unit=unit, components=json.dumps(parts), column=0)

    write_report(case, out / "report", out)
    markdown = (out / "report" / "report.md").read_text().replace("\\_", "_")
    for text in (
        "The scene at the end, true to scale. Boxes: same mass and inertia, brown: ropes, dots: joints",
        "accurate: tolerance 1e-07, output interval 10 ms, duration 1 s",
        "| degrees of freedom | 1 |",
        "| redundant joints | joint 'pin_3' |",
        "| pin_2 | hinge | ground – link_2 | (2, 0, 0) m | (0, 1, 0) | limits from -523.599 mrad, 1 kN m/rad |",
        "| fall | wire | ground – link_0 | axial stiffness 1 MN |",
        "| drum | motor | pin_1 | load 20 N m |",
        "## 6 rigid bodies",
        "| link_4 | 2 | (0, 0, 0) m | diagonal (1, 1, 1) kg m^2 | free | position (4, 0, 0) m |",
        "Distance of tip.position from the reference tip.csv; the largest is 0 m.",
    ):
        assert text in markdown, text
    pictures = re.findall(r"\]\(([A-Za-z0-9_-]+)\.png\)", markdown)
    assert pictures == [
        "scene_start",
        "scene_end",
        "energy",
        "history_tip_position",
        "history_fall_tension",
        "history_monitor_violation",
        "deviation_tip",
    ]


def test_what_other_processes_say_is_said_once(tmp_path, monkeypatch, capsys):
    """Two parts with a picture of one name are drawn again, one after the other."""
    monkeypatch.setenv("HEAVYLIFT_PROCESSES", "2")
    monkeypatch.setattr(report, "has_drawn", lambda: False)

    def draw(album, log):
        album.add("view", b"")
        log.say("drawn")
        return []

    made, spoken = report._side_by_side(
        [draw, draw], lambda _: None, lambda _: None, Album(tmp_path), Log(), alone=False, judge_first=False
    )
    assert (made, spoken) == (None, True)
    assert capsys.readouterr().out.count("drawn") == 2
