"""Files of the hydrostatics of a hull: what they contain, and what a person is shown."""

import csv
import json
import math

import numpy as np
import pytest
from PIL import Image

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.stages.hydrostatics import hydrostatics_lines, hydrostatics_report
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.water.hulls.hydrostatics import Tank

L, B, D, T = 97.5, 36.0, 6.0, 4.5
MASS = 1025.0 * L * B * T
BM, GM = B * B / (12.0 * T), B * B / (12.0 * T) - 0.75 - 1.0


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hydrostatics") / "new"
    tank = Tank(0.1 * MASS, (0.0, 0.0, 1.0), (0.2 * MASS, 0.3 * MASS), name="ballast")
    return hydrostatics_report(
        "barge", box_surface((L, B, D)), 0.9 * MASS, (0.0, 0.0, 1.0), folder, level=3.0, tanks=[tank]
    )


@pytest.mark.slow
def test_figures_of_a_box(report):
    document = json.loads(report.files[0].read_text(encoding="utf-8"))
    figures = document["figures"]
    assert document["water"] == {"density": 1025.0, "gravity": 9.81, "level": 3.0}
    assert document["tanks"][0]["name"] == "ballast"
    expected = {
        "displacement": MASS,
        "draft": T,
        "KB": 0.5 * T,
        "KG": 4.0,
        "BM_T": BM,
        "GM_T": GM - 0.2,
        "GM_L": L * L / (12.0 * T) - 1.75 - 0.3,
        "origin_z": 3.0 + 0.5 * D - T,
        "waterplane_area": L * B,
        "mass_per_immersion": 1025.0 * L * B,
        "equilibrium_angle": 0.0,
    }
    assert {key: figures[key] for key in expected} == pytest.approx(expected)
    assert figures["freeboard"] is None  # a closed hull has no opening
    assert figures["flooding_angle"] is None
    with report.files[1].open(encoding="utf-8", newline="") as stream:
        rows = {row["quantity"]: row for row in csv.DictReader(stream)}
    assert float(rows["GM_T"]["value"]) == pytest.approx(GM - 0.2)
    assert rows["GM_T"]["unit"] == "m"
    assert rows["flooding_angle"]["value"] == ""


def test_table_of_righting_arms(report):
    table = np.genfromtxt(report.files[2], delimiter=",", names=True)
    heel = table["heel_rad"]
    dry = np.tan(heel) < 2.0 * (D - T) / B
    assert dry.sum() == 5
    wall_sided = np.sin(heel) * (GM - 0.2 + 0.5 * BM * np.tan(heel) ** 2)
    assert table["GZ_m"][dry] == pytest.approx(wall_sided[dry], abs=1e-9)
    # area up to 30 degrees, by another quadrature of the finely spaced arms
    up_to = heel <= math.radians(30.0) + 1e-12
    assert report.figures["area_30"] == pytest.approx(
        np.trapezoid(table["GZ_m"][up_to], heel[up_to]), rel=1e-3
    )


def test_plot_and_lines(report):
    with Image.open(report.files[3]) as image:
        assert image.size[0] > 800
        assert len(image.convert("RGB").getcolors(1 << 20)) > 10
    lines = hydrostatics_lines(report)
    row = next(line for line in lines if "metacentric height, GM" in line)
    assert row.split()[-2:] == [f"{GM - 0.2:.6g}", "m"]
    immersion = next(line for line in lines if "immersion" in line)
    assert immersion.split()[-2:] == [f"{1025.0 * L * B * 1e-5:.6g}", "t/cm"]
    assert not any("nan" in line or "inf" in line for line in lines)


def test_open_hull_that_lists(tmp_path):
    """A list to the negative side is drawn to that side, and the curve ends where the rim floods."""
    box = box_surface((L, B, D))
    top = (box.points[box.triangles][:, :, 2] > 0.0).all(axis=1)
    hull = TriangleSurface(box.points, box.triangles[~top], name="hull.stl")
    result = hydrostatics_report("open", hull, MASS, (0.0, 0.5, 1.0), tmp_path, open_deck=3.0)
    assert result.curve.side == -1
    assert result.position.pose.list < 0.0
    assert result.figures["equilibrium_angle"] == pytest.approx(-result.position.pose.list)
    assert result.figures["flooding_angle"] == pytest.approx(math.atan(2.0 * (D - T) / B))
    assert all(path.is_file() for path in result.files)
    with pytest.raises(InputError, match=r"hull.stl: bodies.barge.hull: leaks"):
        hydrostatics_report("open", hull, MASS, (0.0, 0.0, 1.0), tmp_path, key="bodies.barge.hull")
