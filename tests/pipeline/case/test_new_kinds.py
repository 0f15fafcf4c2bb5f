"""A force, a rope, a load of the wind and a body that are one new file each: nothing that exists is edited."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

FORCE = '''
    """Magnetic dipoles on one line, on two bodies: they attract with c / r^4."""

    from __future__ import annotations

    from dataclasses import dataclass
    from typing import Annotated, ClassVar

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.numerics.arrays import Arrays
    from heavylift.numerics.jit import kernel
    from heavylift.numerics.quantity import Positive
    from heavylift.numerics.records import Record, Records, filled, records
    from heavylift.solver.interface import FORCES as LEVEL, Workspace, add_forces, record_forces
    from heavylift.solver.kinds import implement
    from heavylift.solver.recording import outputs_at
    from heavylift.solver.scene.connections import FORCES, Between, PackedForce
    from heavylift.solver.scene.outputs import Outputs, channel, outputs


    @outputs
    class DipolesOutputs(Outputs):
        """What they record."""

        attraction: float = channel("force", "attraction of the magnets")


    @FORCES.describe("dipoles")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Dipoles(Between, PackedForce):
        """Two magnets attract each other."""

        CHANNELS: ClassVar = DipolesOutputs.CHANNELS

        strength: Annotated[float, Positive("force")]
        """Attraction [N] at a distance of 1 m."""


    class DipolesEntry(Record):
        a: int
        b: int
        column: int
        strength: float


    dipoles_outputs = outputs_at(DipolesOutputs)


    class AllDipoles(Arrays):
        """All pairs of a scene."""

        table: Records[DipolesEntry]


    def pack(forces, context):
        """Make the kind."""
        rows = [
            filled(
                DipolesEntry,
                a=context.point(f.body_a, f.point_a, LEVEL),
                b=context.point(f.body_b, f.point_b, LEVEL),
                column=context.column(f),
                strength=f.strength,
            )
            for f in forces
        ]
        context.add_forces(AllDipoles(records(DipolesEntry, rows)))


    @implement(add_forces, AllDipoles)
    @kernel(internal=True)
    def add_dipoles(kind: AllDipoles, time: float, work: Workspace) -> None:
        """Attraction on both."""
        for i in range(kind.table.shape[0]):
            entry = kind.table[i]
            a, b = work.markers[entry.a], work.markers[entry.b]
            square = 0.0
            for k in range(3):
                square += (b.point[k] - a.point[k]) ** 2
            for k in range(3):
                pull = entry.strength * (b.point[k] - a.point[k]) / square**2.5
                a.force[k] += pull
                b.force[k] -= pull


    @implement(record_forces, AllDipoles)
    @kernel(internal=True)
    def record_dipoles(kind: AllDipoles, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
        """Attraction."""
        for i in range(kind.table.shape[0]):
            entry = kind.table[i]
            a, b = work.markers[entry.a], work.markers[entry.b]
            square = 0.0
            for k in range(3):
                square += (b.point[k] - a.point[k]) ** 2
            dipoles_outputs(row, entry.column).attraction = entry.strength / square**2
'''
ROPE = '''
    """Ropes of nylon, by their breaking load."""

    from __future__ import annotations

    from dataclasses import dataclass
    from typing import Annotated, ClassVar

    from heavylift.numerics.outcome import InputError
    from heavylift.numerics.quantity import Least, Positive, Quantity
    from heavylift.solver.scene.connections import ROPES, RopeOutputs, RopeParts, RopePoint


    @ROPES.describe("nylon")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Nylon:
        """A rope that says when it breaks."""

        CHANNELS: ClassVar = (*RopeOutputs.CHANNELS, *RopeParts.CHANNELS)

        name: str
        path: Annotated[tuple[RopePoint, ...], Least(2)]
        """Its places."""
        breaking_load: Annotated[float, Positive("force")]
        """Tension at which it breaks [N]."""
        breaking_strain: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.2
        """Strain at which it breaks."""
        damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
        """[N s/m]."""
        length: Annotated[float | None, Positive("length")] = None
        """Unstretched length [m]; as drawn if absent."""

        @property
        def axial_stiffness(self) -> float:
            """EA [N]."""
            return self.breaking_load / self.breaking_strain

        @staticmethod
        def check(said):
            """Nylon is soft."""
            if said.breaking_strain < 0.05:
                raise InputError("as stiff as steel", key="breaking_strain", expected="0.05 or more")
'''
LOAD = '''
    """Round pipes in wind or current."""

    from __future__ import annotations

    from dataclasses import dataclass
    from typing import Annotated

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.numerics.quantity import BodyPoint, Positive
    from heavylift.solver.scene.wind_loads import FLUID_LOADS, DragElement, FluidLoad


    @FLUID_LOADS.describe("pipe")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Pipe(FluidLoad):
        """Drag on a pipe across the flow."""

        point: Annotated[NDArray[np.float64], BodyPoint()]
        """Its middle [m]."""
        diameter: Annotated[float, Positive("length")]
        """Outer [m]."""
        length: Annotated[float, Positive("length")]
        """[m]."""

        def pieces(self):
            return (
                DragElement(
                    name=self.name, body=self.body, fluid=self.fluid, point=self.point,
                    area=self.diameter * self.length, coefficient=0.7,
                ),
            )
'''
BODY = '''
    """Solid balls: rigid bodies by density and radius."""

    from __future__ import annotations

    from dataclasses import dataclass
    from typing import Annotated, ClassVar

    import numpy as np

    from heavylift.numerics.quantity import Positive
    from heavylift.solver.scene.bodies import BODIES, Placed, RigidBody


    @BODIES.describe("solid_ball")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class SolidBall(Placed):
        """A ball of one material."""

        KIND_MODULE: ClassVar = RigidBody.KIND_MODULE
        ORDER: ClassVar = RigidBody.ORDER
        NOUN: ClassVar = "ball"
        CHANNELS: ClassVar = RigidBody.CHANNELS
        DEFORMS: ClassVar = False

        name: str
        density: Annotated[float, Positive("density")]
        """Of its material."""
        radius: Annotated[float, Positive("length")]
        """Of its surface."""

        centre_of_mass = np.zeros(3)
        holder = RigidBody.holder
        inverse_masses = RigidBody.inverse_masses
        inverse_scales = RigidBody.inverse_scales
        mass_properties = RigidBody.mass_properties

        @property
        def mass(self):
            """[kg]."""
            return self.density * 4.0 / 3.0 * np.pi * self.radius**3

        @property
        def inertia(self):
            """About its centre [kg m2]."""
            return 0.4 * self.mass * self.radius**2 * np.eye(3)
'''
CASE = """
title = "Magnets, a nylon rope, a pipe in the wind and a ball"

[bodies.shot]
type = "solid_ball"
density = "7850 kg/m^3"
radius = "50 mm"
frame = { motion = "free" }
initial = { position = [40.0, 0.0, 10.0], velocity = [3.0, 0.0, 0.0] }

[bodies.load]
type = "rigid"
mass = "100 kg"
inertia = [10.0, 10.0, 10.0]
frame = { motion = "free" }

[bodies.pipe]
type = "rigid"
mass = "100 kg"
inertia = [10.0, 10.0, 10.0]
frame = { motion = "free" }
initial.position = [20.0, 0.0, 10.0]

[[forces]]
type = "dipoles"
name = "magnets"
between = ["ground", "load"]
points = [[2.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
strength = "1.6 kN"

[[ropes]]
type = "nylon"
name = "hawser"
path = [{ body = "ground", point = [0.0, 0.0, 4.0] }, { body = "load", point = [0.0, 0.0, 0.0] }]
breaking_load = "50 kN"

[sea]
wind = { speed = "10 m/s", profile = "uniform" }

[[fluid_loads]]
type = "pipe"
name = "windage"
body = "pipe"
point = [0.0, 0.0, 0.0]
diameter = "500 mm"
length = "10 m"

[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "20 ms"
"""
PROGRAM = """
import sys
from dataclasses import replace
from pathlib import Path

import heavylift.solver.bodies
import heavylift.solver.forces
import heavylift.solver.force_elements
import heavylift.solver.water.wind

folder = Path(sys.argv[1])
heavylift.solver.bodies.__path__.append(str(folder / "bodies"))
heavylift.solver.forces.__path__.append(str(folder / "forces"))
heavylift.solver.force_elements.__path__.append(str(folder / "laws"))
heavylift.solver.water.wind.__path__.append(str(folder / "wind"))

from heavylift.numerics.outcome import InputErrors
from heavylift.pipeline.case.case_file import load_case

case = load_case(folder / "case")
assert not {"numba", "scipy"} & set(sys.modules)
assert case.forces[0].strength == 1600.0
for wrong, message in (
    ("bodies.shot.radius=2 kg", "bodies.shot.radius: '2 kg' is a mass; expected a length [m]"),
    ("forces.0.strength=2 m", "forces.0.strength: '2 m' is a length; expected a force [N]"),
    ("ropes.0.breaking_strain=0.01", "ropes.0.breaking_strain: as stiff as steel; expected 0.05 or more"),
    ("fluid_loads.0.fluid=gale", "fluid_loads.0.fluid: wind or current 'gale' does not exist"),
):
    try:
        load_case(folder / "case", [wrong])
    except InputErrors as error:
        assert message in str(error), error
    else:
        raise AssertionError(wrong)

from heavylift.pipeline.case.schema import key_tables

tables = key_tables()
for line in (
    "| `strength` | force [N] > 0 |  | Attraction [N] at a distance of 1 m. |",
    "| `NAME.attraction` | N |  | attraction of the magnets |",
    "| `breaking_strain` | number > 0, < 1 | `0.2` | Strain at which it breaks. |",
    "| `diameter` | length [m] > 0 |  | Outer [m]. |",
):
    assert line in tables, line
assert case.quantity("channel.magnets.attraction.end").kind.name == "force"
assert case.quantity("channel.hawser.tension.end").kind.name == "force"

from heavylift.pipeline.report.connections import connection_tables

rows = [row for table in connection_tables(case) for row in table.rows]
assert ("magnets", "dipoles", "ground – load", "(2, 0, 0) m and (0, 0, 0) m", "strength 1.6 kN") in rows
assert ("hawser", "nylon", "ground – load", "breaking load 50 kN") in rows

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.layout import pack_scene
from heavylift.solver.simulation import Simulation

scene = assemble_scene(case, OutputFolder(folder / "out"))
packed = pack_scene(scene)
assert "magnets.attraction" in {channel.name for channel in packed.channels}
assert any(type(kind).__name__ == "AllDipoles" for kind in packed.forces.kinds)

# where kernels are compiled the folders are not known, so the magnets stay at rest; tuggers are such a force that runs
run = Simulation(replace(scene, forces=()), 1e-3)
row = run.advance(1)[1][-1]
column = {channel.name: channel.column for channel in run.channels}
assert row[column["hawser.length"]] > 0.0
drag = 0.5 * 1.225 * 0.7 * 5.0 * 10.0**2
assert abs(row[column["windage.force"]] - drag) < 1e-2 * drag
assert abs(row[column["pipe.velocity"]] * 100.0 / 1e-3 - drag) < 1e-2 * drag
momentum = 7850.0 * 4.0 / 3.0 * 3.141592653589793 * 0.05**3 * 3.0 + row[column["pipe.velocity"]] * 100.0
assert abs(row[column["momentum.linear"]] - momentum) < 1e-9 * momentum
print("all")
"""


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_new_force_rope_load_and_body_are_one_new_file_each(tmp_path: Path) -> None:
    for name, text in (
        ("forces/dipoles.py", FORCE),
        ("laws/nylon.py", ROPE),
        ("wind/pipe.py", LOAD),
        ("bodies/solid_ball/__init__.py", ""),
        ("bodies/solid_ball/solid_ball.py", BODY),
        ("case/case.toml", CASE),
    ):
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / name).write_text(textwrap.dedent(text))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "all", done.stderr
