"""Waves, a spectrum of wind, a shape of a surface, a line of a frame and a load on it are one new file each."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

FILES = {
    "waves/swell.py": '''
        """Swell with a Gaussian spectrum, ``S = Hs^2/16 exp(-(w - wp)^2/(2 s^2))/(s sqrt(2 pi))``."""

        import math
        from dataclasses import dataclass
        from typing import Annotated, ClassVar

        import numpy as np

        from heavylift.numerics.quantity import Positive
        from heavylift.solver.scene.waves import WAVES, IrregularWaves
        from heavylift.solver.water.waves.spectra import WaveSpectrum


        @WAVES.describe("swell")
        @dataclass(frozen=True, eq=False, kw_only=True)
        class Swell(IrregularWaves):
            """Swell of one storm far away."""

            SIZE: ClassVar = ("significant height", "significant_height", "peak_period")

            significant_height: Annotated[float, Positive("length")]
            """Hs [m]."""
            peak_period: Annotated[float, Positive("time")]
            """Tp [s]."""
            width: Annotated[float, Positive("angular velocity")] = 0.05
            """Standard deviation of the frequency [rad/s]."""

            def spectrum(self) -> WaveSpectrum:
                """Its spectrum."""
                wp, s = 2.0 * math.pi / self.peak_period, self.width
                scale = self.significant_height**2 / 16.0 / (s * math.sqrt(2.0 * math.pi))
                places = wp + s * np.linspace(-6.0, 6.0, 49)
                return WaveSpectrum("Gauss", lambda w: scale * np.exp(-0.5 * ((w - wp) / s) ** 2), places, False, wp)
        ''',
    "wind/puffs.py": '''
        """Puffs: a wind that rises and falls as a sine."""

        from dataclasses import dataclass
        from typing import Annotated

        import numpy as np

        from heavylift.numerics.quantity import Positive
        from heavylift.solver.scene.wind_loads import WIND_SPECTRA, FluctuationRecord


        @WIND_SPECTRA.describe("puffs")
        @dataclass(frozen=True, eq=False, kw_only=True)
        class Puffs:
            """A wind in puffs."""

            period: Annotated[float, Positive("time")]
            """[s]."""

            def record(self, speed: float, duration: float) -> FluctuationRecord:
                """A tenth of the mean."""
                times = np.arange(0.0, duration + 0.3, 0.1)
                return FluctuationRecord(0.1, 0.1 * speed * np.sin(2.0 * np.pi * times / self.period))
        ''',
    "shapes/wedge.py": '''
        """A wedge: half a box."""

        from dataclasses import dataclass
        from typing import Annotated, Any

        import numpy as np

        from heavylift.numerics.quantity import Positive
        from heavylift.pipeline.shapes.shape import SHAPES, SurfaceShape
        from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


        @SHAPES.describe("wedge")
        @dataclass(frozen=True, eq=False, kw_only=True)
        class WedgeShape(SurfaceShape):
            """A wedge that rises along x."""

            size: Annotated[tuple[float, float, float], Positive("length")]
            """From face to face [m]."""

            @staticmethod
            def smallest(spec: Any) -> float:
                """Its shortest side."""
                return float(min(spec.size))

            def surface(self, rounding: float, name: str) -> TriangleSurface:
                """Eight triangles."""
                x, y, z = self.size
                points = np.array([[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0], [x, 0, z], [x, y, z]], dtype=float)
                triangles = [[0, 2, 1], [0, 3, 2], [1, 2, 5], [1, 5, 4], [0, 4, 5], [0, 5, 3], [0, 1, 4], [3, 5, 2]]
                return TriangleSurface(points, np.array(triangles), rounding, name)
        ''',
    "frame_shapes/helix.py": '''
        """A helix about z."""

        import math
        from dataclasses import dataclass
        from typing import Annotated, Any, ClassVar

        import numpy as np
        from annotated_types import Interval

        from heavylift.numerics.outcome import InputError
        from heavylift.numerics.quantity import Positive
        from heavylift.solver.scene.mesh_shapes import FRAME_SHAPES, FrameMesh, FrameShape


        @FRAME_SHAPES.describe("helix")
        @dataclass(frozen=True, eq=False, kw_only=True)
        class HelixShape(FrameShape):
            """A helix about z, cut into equal elements."""

            CURVED: ClassVar = True

            radius: Annotated[float, Positive("length")]
            """[m]."""
            lead: Annotated[float, Positive("length")]
            """Height of a turn [m]."""
            turns: Annotated[float, Positive("number")] = 1.0
            """How many."""
            elements: Annotated[int, Interval(ge=1)]
            """Number of elements."""

            @staticmethod
            def check(spec: Any) -> None:
                """Elements see the turns."""
                if spec.elements < 8 * spec.turns:
                    raise InputError(f"{spec.elements}", key="elements", expected="eight a turn or more")

            def mesh(self) -> FrameMesh:
                """Its nodes and tangents."""
                a = 2.0 * math.pi * self.turns * np.linspace(0.0, 1.0, self.elements + 1)
                h = self.lead / (2.0 * math.pi)
                nodes = np.stack([self.radius * np.cos(a), self.radius * np.sin(a), h * a], axis=1)
                along = np.stack([-self.radius * np.sin(a), self.radius * np.cos(a), 0.0 * a + h], axis=1)
                first = np.arange(self.elements)
                tangents = along / math.hypot(self.radius, h)
                return FrameMesh(nodes, tangents, np.stack([first, first + 1], axis=1))
        ''',
    "frame_loads/snow.py": '''
        """Snow: a load downwards."""

        from dataclasses import dataclass
        from typing import Annotated

        import numpy as np

        from heavylift.numerics.quantity import Positive
        from heavylift.solver.scene.mesh_loads import FRAME_LOADS, SpreadLoad
        from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
        from heavylift.solver.scene.meshes import DistributedLoad


        @FRAME_LOADS.describe("snow")
        @dataclass(frozen=True, eq=False, kw_only=True)
        class Snow(SpreadLoad):
            """Snow on a frame."""

            weight: Annotated[float, Positive("force per length")]
            """[N/m]."""

            def load(self, mesh: FrameMesh | ShellMesh) -> DistributedLoad:
                """Downwards."""
                return DistributedLoad(np.array([0.0, 0.0, -self.weight]), elements=self.chosen(mesh), **self.table)
        ''',
}
CASE = """
title = "New things"

[bodies.block]
type = "rigid"
mass = "1 t"
inertia = [1, 1, 1]
frame = { motion = "free" }

[bodies.spring]
type = "frame"
geometry = { type = "helix", radius = "1 m", lead = "500 mm", turns = 3, elements = 90 }
section = { density = 7850, young_modulus = "210 GPa", diameter = "20 mm" }
model = "exact"
loads = [{ type = "snow", weight = "10 N/m", elements = [3] }]

[[surfaces]]
name = "ramp"
body = "block"
shape = { type = "wedge", size = [3, 2, 1] }

[sea]
waves = { type = "swell", significant_height = "2 m", peak_period = "14 s", seed = 3 }
wind = { speed = "10 m/s", spectrum = { type = "puffs", period = "4 s" } }

[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "2 s"
"""
PROGRAM = """
import math
import sys
from pathlib import Path

import heavylift.pipeline.shapes
import heavylift.solver.scene.frame_loads
import heavylift.solver.scene.frame_shapes
import heavylift.solver.water.waves
import heavylift.solver.water.wind

folder = Path(sys.argv[1])
for package, name in (
    (heavylift.solver.water.waves, "waves"),
    (heavylift.solver.water.wind, "wind"),
    (heavylift.pipeline.shapes, "shapes"),
    (heavylift.solver.scene.frame_shapes, "frame_shapes"),
    (heavylift.solver.scene.frame_loads, "frame_loads"),
):
    package.__path__.append(str(folder / name))

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.case_file import load_case

case = load_case(folder / "case")
assert not {"numba", "scipy"} & set(sys.modules)

from heavylift.pipeline.assemble.early_checks import scene_errors

for wrong, message in (
    ("sea.waves.significant_height=2 s", "sea.waves.significant_height: '2 s' is a time; expected a length [m]"),
    ("sea.waves.peak_period=3", "sea.waves.significant_height: significant height 2 m at 3 s is beyond breaking"),
    ("sea.waves.type=swel", "sea.waves: type = 'swel'; expected one of 'regular', 'jonswap', "),
    ("sea.waves.type=swel", "'elevation', 'swell'"),
    ("sea.wind.spectrum.type=puff", "sea.wind.spectrum: type = 'puff'; expected one of 'npd', 'puffs'"),
    ("sea.wind.spectrum.period=0", "sea.wind.spectrum.period: 0 is too small"),
    ("surfaces.0.radius=0.6", "surfaces.0.radius: 0.6 m rounds all of the shape off; expected less than 0.5 m"),
    ("bodies.spring.geometry.elements=9", "bodies.spring.geometry.elements: 9; expected eight a turn or more"),
    ("bodies.spring.model=green-lagrange", "model 'green-lagrange' with geometry 'helix'"),
    ("bodies.spring.loads.0.weight=2 m", "bodies.spring.loads.0.weight: '2 m' is a length"),
    ("bodies.spring.loads.0.elements=[90]", "bodies.spring.loads.0.elements.0: there is no element 90"),
):
    try:
        errors = scene_errors(load_case(folder / "case", [wrong]))
        assert any(message in str(error) for error in errors), (wrong, errors)
    except InputError as error:
        assert message in str(error), error

from heavylift.pipeline.case.schema import key_pages

pages = key_pages()
for page, line in (
    ("sea", "| `width` | angular velocity [rad/s] > 0 | `0.05` | Standard deviation of the frequency [rad/s]. |"),
    ("sea", "| `period` | time [s] > 0 |  | [s]. |"),
    ("surfaces", "A wedge that rises along x."),
    ("bodies", "| `lead` | length [m] > 0 |  | Height of a turn [m]. |"),
    ("bodies", "Snow on a frame."),
):
    assert line in pages[f"{page}.md"], line

import numpy as np

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.assemble.sea import make_waves
from heavylift.pipeline.assemble.surfaces import make_surface
from heavylift.pipeline.results.storage import OutputFolder

waves = make_waves(case)
assert abs(waves.significant_height - 2.0) < 1e-6
assert abs(np.average(waves.omega, weights=waves.amplitude**2) - 2.0 * math.pi / 14.0) < 0.005
scene = assemble_scene(case, OutputFolder(folder / "out"))
(wind,) = scene.sea.fields
assert abs(wind.fluctuation.values.max() - 0.1 * 10.0) < 1e-3
made = make_surface(case, 0)
sides = 3.0 * 2.0 + 2.0 * 1.0 + 2.0 * math.hypot(3.0, 1.0) + 3.0 * 1.0
assert abs(made.report["area"] - sides) < 1e-12 and made.report["watertight"]
frame = next(body for body in scene.bodies if body.name == "spring")
chords = np.linalg.norm(np.diff(frame.nodes, axis=0), axis=1)
assert np.allclose(chords, math.hypot(2.0 * math.sin(math.pi / 30.0), 0.5 / 30.0), rtol=1e-12)
(load,) = frame.loads
assert load.load.tolist() == [0.0, 0.0, -10.0] and load.elements.tolist() == [3]
print("all")
"""


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_waves_wind_surfaces_lines_and_loads_are_one_new_file_each(tmp_path: Path) -> None:
    for name, text in (*FILES.items(), ("case/case.toml", CASE)):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(textwrap.dedent(text))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "all", done.stderr
