"""Pictures and tables of response operators hold what was computed."""

import csv
import io
import json
import math

import numpy as np
import pytest

from heavylift.pipeline.pictures.hull_plots import operator_plot
from heavylift.pipeline.report.response_operators import operator_rows, write_rao_report
from heavylift.solver.water.hulls.frequency_domain import MotionOperators, NaturalMode, ResponseStatistics

OMEGA = np.linspace(0.2, 2.5, 80)


@pytest.fixture(scope="module")
def operators():
    headings = np.deg2rad([0.0, 45.0, 90.0])
    natural = np.array([0.1, 0.1, 0.8, 0.9, 0.7, 0.1, 0.1, 0.1, 0.9, 0.9, 0.9, 0.1])
    scale = np.array([1.0, 1.0, 1.0, 0.03, 0.02, 0.01] * 2)
    w = OMEGA[:, None]
    one = scale * natural**2 * np.exp(1j * np.arange(12)) / (natural**2 - w**2 - 0.2j * w * natural)
    by_heading = np.stack([np.cos(headings), np.sin(headings), np.ones(3)] * 4).T
    return MotionOperators(
        OMEGA, headings, one[:, None] * by_heading, np.zeros((80, 3, 0), complex), ("barge", "dock")
    )


MODES = (NaturalMode(2.0 * math.pi / 0.8, np.eye(12)[2], 2),)


def picture(png):
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    return pixels.shape, float(np.mean(np.ptp(pixels, axis=2) > 40))


@pytest.mark.slow
def test_a_picture_is_drawn(operators):
    shape, ink = picture(operator_plot(operators, body=1, modes=MODES))
    assert shape[1] == 1100
    assert ink > 0.002


def test_table_has_amplitude_and_phase_of_every_coordinate(operators):
    header, *rows = operator_rows(operators)
    assert len(rows) == 2 * 3 * 80
    assert len(header) == len(rows[0]) == 16
    row = rows[80 * 3 + 80 + 7]  # second hull, second heading
    assert row[:2] == ["dock", 45.0]
    pitch = operators.motion[7, 1, 10]
    assert row[header.index("pitch_deg_per_m")] == pytest.approx(math.degrees(abs(pitch)))
    assert row[header.index("pitch_phase_deg")] == pytest.approx(math.degrees(np.angle(pitch)))


@pytest.mark.slow
def test_report_writes_table_summary_and_a_picture_of_each_hull(operators, tmp_path):
    deviation = np.linspace(0.1, 1.2, 12)
    response = ResponseStatistics(OMEGA, np.ones((80, 12)), deviation, 2.0 * deviation, np.full(12, 7.0))
    files = write_rao_report(
        tmp_path / "out", operators, modes=MODES, responses={"Hs 2 m, Tp 8 s, 0 deg": response}
    )
    assert [file.name for file in files] == ["rao.csv", "rao.json", "rao_barge.png", "rao_dock.png"]
    assert all(file.stat().st_size > 0 for file in files)
    with files[0].open() as file:
        assert len(list(csv.reader(file))) == 481
    document = json.loads(files[1].read_text())
    assert document["natural_modes"][0]["coordinate"] == "barge.heave"
    heave = next(one for one in document["largest"] if one["coordinate"] == "barge.heave")
    assert heave["amplitude"] == pytest.approx(operators.amplitude[:, :, 2].max())
    sea = document["responses"]["Hs 2 m, Tp 8 s, 0 deg"]
    assert sea["barge.heave"]["standard_deviation"] == pytest.approx(response.standard_deviation[2])
    assert sea["barge.yaw"]["mean_period"] is not None
