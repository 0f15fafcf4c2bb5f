"""A piece of equipment is one new file: case, schema, run, report, criteria and restart know it, nothing is edited."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from typing import TYPE_CHECKING

import pytest

from heavylift.pipeline.equipment.parts import Equipment

if TYPE_CHECKING:
    from pathlib import Path

TRIPLATES = '''
    """Triplates: a plate under a pendant, from which two slings go to the lugs of a load.

    Slings at the angle th from the vertical carry ``W/(2 cos th)`` each.
    """

    import math
    from dataclasses import dataclass
    from typing import Annotated, Any

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.numerics.outcome import InputError
    from heavylift.numerics.quantity import BodyPoint, Least, NameOf, Positive
    from heavylift.pipeline.equipment.parts import DOWN, EQUIPMENT, Equipment, Made, Places, listed


    @EQUIPMENT.part
    @dataclass(frozen=True, eq=False, kw_only=True)
    class TriplateHook:
        """What it hangs on."""

        body: Annotated[str, NameOf("side")]
        """Body, or ``"ground"``."""
        point: Annotated[NDArray[np.float64], BodyPoint()]
        """The place [m]."""


    @EQUIPMENT.part
    @dataclass(frozen=True, eq=False, kw_only=True)
    class TriplateLug:
        """A lug."""

        body: Annotated[str, NameOf("body")]
        """The load."""
        point: Annotated[NDArray[np.float64], BodyPoint()]
        """The place [m]."""


    @EQUIPMENT.describe("triplates")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Triplate(Equipment):
        """A plate on a pendant with two slings."""

        name: str
        hook: TriplateHook
        """What the pendant hangs on."""
        mass: Annotated[float, Positive("mass")]
        """Of the plate [kg]."""
        pendant: Annotated[float, Positive("length")]
        """Length of the pendant [m]."""
        stiffness: Annotated[float, Positive("force")]
        """EA of all ropes [N]."""
        lugs: Annotated[tuple[TriplateLug, ...], Least(2)]
        """One a sling."""

        @staticmethod
        def check(spec: Any) -> None:
            """Two slings."""
            if len(spec.lugs) > 2:
                raise InputError(f"{len(spec.lugs)} lugs", key="lugs", expected="two")

        @staticmethod
        def build(spec: Any, places: Places, made: Made) -> None:
            """Write plate, pendant and slings."""
            hook = {"body": spec.hook.body, "point": list(spec.hook.point)}
            top = places.world(spec.hook.body, spec.hook.point)
            plate, rope = f"{spec.name}_plate", {"axial_stiffness": spec.stiffness}
            made.rigid(plate, spec.mass, [spec.mass] * 3, top + spec.pendant * DOWN, key="mass")
            made.add(
                "ropes",
                rope
                | {"name": f"{spec.name}_pendant", "path": [hook, {"body": plate, "point": [0.0, 0.0, 0.0]}]},
                "pendant",
            )
            for i, lug in enumerate(spec.lugs):
                if places.world(lug.body, lug.point)[2] >= top[2] - spec.pendant:
                    raise InputError("the lug is above the plate", key=f"lugs.{i}.point", expected="a lug below it")
                path = [
                    {"body": plate, "point": [0.0, 0.0, 0.0]},
                    {"body": lug.body, "point": listed(lug.point)},
                ]
                made.add("ropes", rope | {"name": f"{spec.name}_sling_{i + 1}", "path": path}, f"lugs.{i}")
'''
CASE = """
title = "A load on a triplate"

[gravity]
acceleration = [0, 0, -10]

[bodies.load]
type = "rigid"
mass = "8 t"
inertia = [1e4, 1e4, 1e4]
frame = { motion = "free" }
initial.position = [0, 0, -10]

[[triplates]]
name = "top"
hook = { body = "ground", point = [0, 0, 0] }
mass = "200 kg"
pendant = "2 m"
stiffness = "5 GN"
lugs = [{ body = "load", point = [3, 0, 4] }, { body = "load", point = [-3, 0, 4] }]

[simulate]
start = "equilibrium"
step = "2 ms"
output_interval = "20 ms"
duration = "100 ms"

[[criteria]]
name = "slings"
type = "sling"
ropes = ["top_sling_*"]
breaking_load = "300 kN"
termination_factor = 1
static_at = "start"
dynamic_factor = 1.1

[[check]]
id = "tension"
quantity = "channel.top_sling_1.tension.end"
reference = 50e3
tolerance = { relative = 1e-3 }
source = "80 kN on two slings of 3, 4, 5 m"

[report]
channels = ["top_sling_1.tension", "top_plate.position"]
"""
HEAD = """
import sys
from pathlib import Path

import heavylift.pipeline.equipment as package

folder = Path(sys.argv[1])
package.__path__.append(str(folder / "equipment"))

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.case_file import load_case
"""
READ = """
case = load_case(folder / "case")
assert not {"numba", "scipy"} & set(sys.modules)
assert [rope.name for rope in case.ropes] == ["top_pendant", "top_sling_1", "top_sling_2"]
for wrong, message in (
    ("triplates.0.mass=2 m", "triplates.0.mass: '2 m' is a length; expected a mass [kg]"),
    ("triplates.0.lugs.0.point=[3, 0, 12]", "triplates.0.lugs.0.point: the lug is above the plate"),
    ("triplates.0.lugs.0.body=lode", "triplates.0.lugs.0.body: body 'lode' does not exist"),
    ("triplates.0.penant=2", "triplates.0.penant does not exist; did you mean 'pendant'?"),
    ("triplates.0.name=load", "'load' occurs 2 times"),
):
    try:
        load_case(folder / "case", [wrong])
    except InputError as error:
        assert message in str(error), error
    else:
        raise AssertionError(wrong)

from heavylift.pipeline.case.schema import case_schema, key_tables

tables = key_tables()
assert "## triplates" in tables
assert "A plate on a pendant with two slings." in tables
assert "| `pendant` | length [m] > 0 |  | Length of the pendant [m]. |" in tables
words = case_schema()["properties"]["triplates"]["description"]
assert words == "Triplates: a plate on a pendant with two slings.", words

from pathlib import Path as P
from heavylift.pipeline.case.equipment import equip
from heavylift.pipeline.case.repeat import expand

# in a block that repeats and shifts; a spreader, which is written earlier, hangs on the plate and waits for it
document = dict(case.document, bodies=dict(case.document["bodies"]))
hook = {"body": "ground", "point": [0.0, 0.0, 30.0]}
lugs = [{"body": "load", "point": [x, 0.0, 0.0]} for x in (-1.0, 1.0)]
document["repeat"] = [
    {"count": 2, "shift": [0.0, 5.0, 0.0], "triplates": [dict(document["triplates"][0], name="row_{i}", hook=hook)]}
]
document["spreaders"] = [
    {
        "name": "beam", "hook": {"body": "top_plate", "point": [0.0, 0.0, 0.0]}, "beam": {"mass": 100.0, "length": 2.0},
        "sling_length": 3.0, "sling": {"axial_stiffness": 1e7}, "line": {"axial_stiffness": 1e7},
        "lines": [{"at": x, "body": "load", "point": [x, 0.0, 0.0]} for x in (-1.0, 1.0)],
    }
]
built = equip(expand(document, P("case.toml")).document, P("case.toml"))
assert not built.errors, built.errors
bodies = built.document["bodies"]
assert [bodies[f"row_{i}_plate"]["initial"]["position"] for i in (0, 1)] == [[0.0, 0.0, 28.0], [0.0, 5.0, 28.0]]
assert bodies["beam_beam"]["initial"]["position"][2] < -2.0 - 8.0**0.5
assert built.locate("ropes.0.length") == ("triplates.0.pendant", "rope 'top_pendant', length")
print("all")
"""
RUN = """
import numpy as np

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.commands.cli import app
from heavylift.pipeline.results.histories import read_segments
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages import advance
from heavylift.solver.simulation import Simulation

case, out = folder / "case", folder / "out"
for command in ("run", "verify", "criteria"):
    try:
        app([command, str(case), "--out", str(out), "--quiet"])
    except SystemExit as done:
        assert done.code in (0, None), (command, done.code)
report = (out / "report" / "report.md").read_text()
for text in ("top_plate", "top_sling_1", "slings: "):
    assert text in report, text


class Soon(advance.StopRequest):
    calls = 0

    def __bool__(self):
        Soon.calls += 1
        return Soon.calls > 3


def histories(name, stop):
    ran = advance.Advancer(Simulation(scene, 2e-3), folder / name, "d", 100)
    done = ran.resume()
    outcome, _ = ran.run(stop, lambda done, note: None)
    return done, outcome, np.concatenate([part.records for part in read_segments(folder / name)])


advance.SEGMENT_SECONDS, advance.FIRST_PIECE = 0.0, 9
advance.next_piece = lambda piece, seconds, growth: 11
scene = assemble_scene(load_case(case, ["bodies.load.initial.velocity=[0.5, 0, 0]"]), OutputFolder(out))
_, _, whole = histories("whole", advance.StopRequest())
_, outcome, part = histories("stopped", Soon())
assert outcome is Outcome.INTERRUPTED and 0 < len(part) < len(whole)
done, outcome, resumed = histories("stopped", advance.StopRequest())
assert 0 < done < 100 and outcome is Outcome.COMPLETED
assert np.array_equal(whole, resumed)
print("all")
"""


def run(program: str, folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", HEAD + program, str(folder)], capture_output=True, text=True, check=False
    )
    assert done.stdout.strip().endswith("all"), done.stdout + done.stderr


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in (("equipment/triplates.py", TRIPLATES), ("case/case.toml", CASE)):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(textwrap.dedent(text))
    return tmp_path


def test_a_new_piece_of_equipment_is_one_new_file(folder: Path) -> None:
    run(READ, folder)


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_new_piece_of_equipment_runs_is_judged_and_reported(folder: Path) -> None:
    run(RUN, folder)


def test_equipment_without_build_is_refused() -> None:
    with pytest.raises(TypeError, match="Idle: a piece of equipment has a function 'build'"):
        type("Idle", (Equipment,), {})


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("triplates", "Triplate writes 'triplates', of which it is written itself"),
        ("rope", "Triplate writes 'rope', which is no table of a scene"),
    ],
)
def test_what_is_written_stands_in_a_table_of_something_else(folder: Path, table: str, message: str) -> None:
    file = folder / "equipment" / "triplates.py"
    file.write_text(
        file.read_text().replace('made.add(\n            "ropes"', f'made.add(\n            "{table}"')
    )
    done = subprocess.run(
        [sys.executable, "-c", HEAD + "load_case(folder / 'case')", str(folder)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert message in done.stderr
