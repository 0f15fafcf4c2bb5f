"""Two barges with link beams: their database by relations it must obey, their hinge forces wave by wave."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.stages.stages import load_changed_case
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

if TYPE_CHECKING:
    from types import ModuleType

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

CASE = Path(__file__).resolve().parents[2] / "cases" / "two_barges"
MIRRORED = np.tile([1.0, -1.0, 1.0, -1.0, 1.0, -1.0], 2)
"""Signs of surge to yaw of both barges when the wave comes from the other side."""


@pytest.fixture(scope="module")
def database() -> HydrodynamicDatabase:
    return read_netcdf(CASE / "two_barges.nc")


def reference() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_reference_two_barges", CASE / "make_reference.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def unit_of(matrices: np.ndarray) -> np.ndarray:
    """Scale of every entry: root of the product of the largest diagonal entries over all frequencies."""
    largest = np.sqrt(np.abs(np.diagonal(matrices, axis1=1, axis2=2)).max(axis=0))
    return np.outer(largest, largest)


@pytest.mark.parametrize(("name", "bound"), [("added_mass", 0.025), ("damping", 0.045)])
def test_database_is_reciprocal(database: HydrodynamicDatabase, name: str, bound: float) -> None:
    """What one barge feels of the other's motion is what the other feels of its own: A_ij = A_ji, B_ij = B_ji."""
    matrices = getattr(database, name) / unit_of(getattr(database, name))
    between = matrices[:, :6, 6:]
    assert np.abs(between - matrices[:, 6:, :6].transpose(0, 2, 1)).max() < bound
    assert np.abs(between).max() > 10.0 * bound  # the barges do feel each other


def test_barges_are_mirror_images(database: HydrodynamicDatabase) -> None:
    """Turned by half a turn about z, aft is fore: surge, sway, roll and pitch change sign."""
    turned = np.array([-1.0, -1.0, 1.0, -1.0, -1.0, 1.0])
    for matrices in (database.added_mass, database.damping):
        scaled = matrices / unit_of(matrices)
        own = scaled[:, :6, :6] - turned[:, None] * turned * scaled[:, 6:, 6:]
        between = scaled[:, :6, 6:] - turned[:, None] * turned * scaled[:, 6:, :6]
        assert np.abs(own).max() < 1e-4
        assert np.abs(between).max() < 1e-4


def test_damping_is_the_energy_that_waves_carry_away(database: HydrodynamicDatabase) -> None:
    """Haskind and Newman (1962), deep water: ``B_ij = w^3 / (4 pi rho g^3) int Re(X_i X_j*) d beta``."""
    assert np.isinf(database.depth)
    below = database.omega < 1.25
    w, X = database.omega[below], database.excitation[below]
    mirrored = X[:, 1:-1] * MIRRORED
    steps = np.diff(database.headings)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-9)
    everywhere = np.concatenate([X, mirrored], axis=1)  # a full turn in equal steps: the sum is spectral
    energy = steps[0] * np.einsum("wbi,wbj->wij", everywhere, everywhere.conj()).real
    found = w[:, None, None] ** 3 / (4.0 * np.pi * database.density * database.gravity**3) * energy
    B = database.damping[below]
    assert (np.abs(found - 0.5 * (B + B.transpose(0, 2, 1))) / unit_of(B)).max() < 0.06


def test_joints_of_the_reference_are_determinate() -> None:
    """15 independent rows; every force at rest is balanced, as a symmetric stiffness shows."""
    _, _, C, G = reference().structure()
    assert np.linalg.matrix_rank(G) == len(G) == 15
    np.testing.assert_allclose(C, C.T, rtol=0.0, atol=1e-9 * np.abs(C).max())


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory):
    out = tmp_path_factory.mktemp("two_barges")
    return verify_case(CASE, out=out, overrides=(), force=True, log=Log(quiet=True)), out


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_case_meets_its_references(run) -> None:
    result, _ = run
    assert result.outcome is Outcome.COMPLETED, (result.message, [c for c in result.checks if not c.passed])
    assert len(result.checks) == 6


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_hinge_forces_agree_wave_by_wave(run) -> None:
    """Amplitude and phase of each wave, by least squares over a window in which all of them repeat."""
    _, out = run
    module = reference()
    results = load_results(load_changed_case(CASE, ()), out)
    times = results.time
    window = times >= module.TIMES[0] - 1e-9
    waves = np.array(module.WAVES)
    angle = waves[:, 0] * times[window, None]
    columns = np.hstack([np.ones((window.sum(), 1)), np.cos(angle), np.sin(angle)])
    rows = {"port_aft": 0, "port_fore": 5, "starboard_aft": 8, "starboard_fore": 12}
    wanted = module.reactions()
    for joint, row in rows.items():
        force = results[f"{joint}.reaction_force"][window]
        found = np.linalg.lstsq(columns, force, rcond=None)[0][1:]
        n = len(waves)
        amplitude = (found[:n] + 1j * found[n:]) * np.exp(1j * waves[:, 2:]) / module.AMPLITUDE
        exact = wanted[:, row : row + 3]
        size = np.linalg.norm(exact, axis=1)
        error = np.linalg.norm(amplitude - exact, axis=1)
        assert (error / size.max()).max() < 0.01
        large = size > 0.1 * size.max()
        assert large.sum() == n - 1  # at 1.0 rad/s from ahead the pulls on the barges nearly cancel
        assert (error / size)[large].max() < 0.01
