"""Public output of panel codes, with all its faults, gives the decay that its numbers say in the frequency domain."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.io import netcdf_file

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.hulls import database_manifest
from heavylift.pipeline.commands.database import database_command
from heavylift.pipeline.commands.response_operators import rao_command
from heavylift.pipeline.log import Log

pytestmark = pytest.mark.slow

CASE = """
title = "Heave decay"

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[sea]
density = "1000 kg/m^3"
{depth}

[bodies.hull]
type = "rigid"
mass = {mass}
inertia = [{inertia}, {inertia}, {inertia}]
centre_of_mass = [0, 0, 0]
frame = {{ motion = "free" }}

[bodies.hull.initial]
position = [0, 0, 0.1]

[hulls.hull]
reference = {reference}

[hulls.hull.linear]
volume = {volume}
centre_of_buoyancy = [0, 0, 0]
reference = [0, 0, 0]
area = {area}
second_moments = [{moment}, {moment}, 0]

{more}

[databases.water]
{database}

[simulate]
step = "10 ms"
output_interval = "50 ms"
duration = "20 s"
"""

BASE = """
[bodies.base]
type = "rigid"
mass = 1000
inertia = [1e5, 1e5, 1e5]
centre_of_mass = [0, 0, 0]
frame = { motion = "free" }

[hulls.base]
restoring = "none"

[[joints]]
type = "fixed"
name = "bolts"
between = ["base", "ground"]
at = [0, 0, 0]
"""


def numeric_heave(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, added mass and damping in heave of the first body of a ``.1`` file, ULEN 1 m, 1000 kg/m^3."""
    rows = [line.split() for line in path.read_text().splitlines()[1:]]
    own = np.array([[float(v) for v in row] for row in rows if len(row) == 5 and row[1] == row[2] == "3"])
    omega = 2.0 * np.pi / own[:, 0]
    return omega, 1000.0 * own[:, 3], 1000.0 * omega * own[:, 4]


def netcdf_heave(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    with netcdf_file(path, mmap=False) as file:
        names = ("omega", "added_mass", "radiation_damping")
        omega, A, B = (np.array(file.variables[name][:], dtype=np.float64) for name in names)
    good = np.isfinite(A[:, 2, 2])
    return omega[good], A[good, 2, 2], B[good, 2, 2]


def released(
    times: NDArray[np.float64], heave: tuple[NDArray[np.float64], ...], mass: float, stiffness: float
) -> NDArray[np.float64]:
    """Motion per initial displacement, released from rest: 1 - c s(t), s the response to a step of the force.

    s(t) = 2/pi int Re[H(w)] sin(w t) / w dw, H = 1 / (c - w^2 (m + A) + i w B). No kernel, no limit of the added mass.
    """
    omega, A, B = heave
    w = np.arange(0.0005, 80.0, 0.001)
    added = np.interp(w, omega, A)
    damping = np.interp(w, np.append(0.0, omega), np.append(0.0, B), right=0.0)
    H = 1.0 / (stiffness - w**2 * (mass + added) + 1j * w * damping)
    step = np.array([2.0 / np.pi * np.sum(H.real * np.sin(w * t) / w) * 0.001 for t in times])
    return np.asarray(1.0 - stiffness * step)


def natural_period(heave: tuple[NDArray[np.float64], ...], mass: float, stiffness: float) -> float:
    """2 pi sqrt((m + A(w)) / c), iterated."""
    w = 1.0
    for _ in range(60):
        w = math.sqrt(stiffness / (mass + float(np.interp(w, heave[0], heave[1]))))
    return 2.0 * math.pi / w


CASES: dict[str, dict[str, Any]] = {
    "ellipsoid": {
        "files": ["ellipsoid/ellipsoid.1", "ellipsoid/ellipsoid.3", "ellipsoid/ellipsoid.hst"],
        "database": 'file = "ellipsoid.1"\nhulls = ["hull"]',
        "mass": 76213.9,
        "area": 63.57515,
        "told": ["negative damping of heave, -5.9% of the largest at 9.24 rad/s"],
    },
    "listing": {
        "files": ["ellipsoid/ellipsoid.out"],
        "database": 'file = "ellipsoid.out"\nhulls = ["hull"]',
        "mass": 76213.9,
        "area": 63.57515,
        "told": ["negative damping of heave, -5.9% of the largest at 9.24 rad/s"],
    },
    "sphere": {
        "files": ["sphere_hydrodynamics.nc"],
        "database": 'file = "sphere_hydrodynamics.nc"\nhulls = ["hull"]\nreference_points = [[0, 0, -2]]',
        "mass": 261363.975,
        "area": 769965.687 / 9810.0,
        "depth": "depth = 50",
        "reference": [0, 0, -2],
        "told": ["no finite numbers at 3 of 420 frequencies", "found from the damping by Ogilvie's relation"],
    },
    "oswec": {
        "files": ["oswec/oswec.1", "oswec/oswec.hst"],
        "database": 'file = "oswec.1"\nhulls = ["hull", "base"]',
        "mass": 127000.0,
        "area": 32.40002,
        "depth": "depth = 10.9",
        "more": BASE,
        "told": ["no exciting forces", "negative damping of hull surge, -8.3% of the largest at 9.16 rad/s"],
    },
}


class Heard(Log):
    def __init__(self) -> None:
        super().__init__(quiet=True)
        self.lines: list[str] = []

    def say(self, text: str) -> None:
        self.lines.append(text)


def write_case(folder: Path, data: Path, name: str) -> None:
    about = CASES[name]
    for file in about["files"]:
        shutil.copyfile(data / file, folder / Path(file).name)
    keys = {"depth": "", "more": "", "reference": [0, 0, 0], "volume": about["mass"] / 1000.0}
    keys |= {"inertia": 5.0 * about["mass"], "moment": 10.0 * about["area"]}
    (folder / "case.toml").write_text(CASE.format_map({**keys, **about}))


@pytest.mark.parametrize("name", CASES)
def test_heave_decay_is_that_of_the_frequency_domain(name: str, hydro_data: Path, tmp_path: Path) -> None:
    about, log = CASES[name], Heard()
    write_case(tmp_path, hydro_data, name)
    run = run_case(load_case(tmp_path), stages=("mesh", "simulate"), log=log)
    told = database_manifest(run.folder)["water"]["properties"]["repairs"]
    for words in about["told"]:
        assert [line for line in told if words in line], told
        assert [line for line in log.lines if "REPAIRED" in line and words in line]
    results = load_results(run.folder.root)
    times, height = results.time, results["hull.position"][:, 2] / 0.1
    mass, stiffness = about["mass"], 9810.0 * about["area"]
    if name == "sphere":
        heave = netcdf_heave(hydro_data / about["files"][0])
    else:
        heave = numeric_heave(hydro_data / f"{'oswec/oswec' if name == 'oswec' else 'ellipsoid/ellipsoid'}.1")
    expected = released(times, heave, mass, stiffness)
    assert np.abs(height - expected).max() < 0.002
    # the first whole oscillation between passages upwards is a damped period
    up = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))[:2]
    crossings = [times[i] - height[i] * (times[i + 1] - times[i]) / (height[i + 1] - height[i]) for i in up]
    assert np.diff(crossings)[0] == pytest.approx(natural_period(heave, mass, stiffness), rel=0.02)


def test_pictures_of_radiation_alone_and_natural_periods(hydro_data: Path, tmp_path: Path) -> None:
    write_case(tmp_path, hydro_data, "oswec")
    document, lines = database_command(tmp_path, log=Log(quiet=True))
    (entry,) = document["databases"]
    assert entry["headings"] == []
    assert not [file for file in entry["files"] if "excitation" in file]
    assert [line for line in lines if "repaired: negative damping" in line]
    with pytest.raises(InputError, match=r"oswec\.1: excitation: no exciting forces"):
        rao_command(tmp_path, headings=[0.0], log=Log(quiet=True))
    document, lines = rao_command(tmp_path, log=Log(quiet=True))
    assert document["headings"] == []
    assert [Path(file).name for file in document["files"]] == ["rao.json", "matrices.json"]
    assert "no response operators" in lines[-4]
    about = CASES["oswec"]
    heave = numeric_heave(hydro_data / "oswec/oswec.1")
    expected = natural_period(heave, about["mass"], 9810.0 * about["area"])
    (found,) = [m["period"] for m in document["natural_modes"] if m["coordinate"] == "hull.heave"]
    assert found == pytest.approx(expected, rel=1e-3)


def test_waves_need_exciting_forces(hydro_data: Path, tmp_path: Path) -> None:
    write_case(tmp_path, hydro_data, "oswec")
    waves = 'sea.waves={type = "regular", height = 1, period = 8}'
    with pytest.raises(InputError, match=r"oswec\.1: waves.*radiation alone.*a sea without waves"):
        run_case(load_case(tmp_path, [waves]), stages=("mesh", "simulate"), log=Log(quiet=True))
