"""Cases of hulls that oscillate freely: their checks, and what their references and databases rest on."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.stages.stages import load_changed_case
from heavylift.preprocess.hydrodynamics.database import check_database
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.hydrodynamics.retardation import retardation_kernel

if TYPE_CHECKING:
    from types import ModuleType

CASES = Path(__file__).resolve().parents[2] / "cases"
SLOW = [pytest.mark.slow, pytest.mark.timeout(1800)]


def script(case: str, name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"{name}_of_{case}", CASES / case / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def values(name: str, out: Path, *overrides: str, good: bool = True) -> dict[str, float]:
    """Values of the checks of a case."""
    verdict = verify_case(CASES / name, out=out, overrides=overrides, force=True, log=Log(quiet=True))
    if good:
        assert verdict.outcome is Outcome.COMPLETED, (
            verdict.message,
            [check for check in verdict.checks if not check.passed],
        )
    return {check.id: check.value for check in verdict.checks}


class TestBargeSlow:
    pytestmark = SLOW

    def test_case_meets_its_references(self, tmp_path: Path) -> None:
        found = values("barge_decay", tmp_path)
        assert len(found) == 5
        assert found["energy_drift"] < 5e-7

    def test_periods_are_too_long_by_the_square_of_the_step(self, tmp_path: Path) -> None:
        """(omega h)^2 / 12 of the midpoint rule, to its next term: half a second is an eighth of a period."""
        exact = dict(
            zip(
                ("heave", "roll", "pitch"),
                script("barge_decay", "closed_forms").closed_forms(),
                strict=True,
            )
        )
        for h in (0.5, 0.1):
            found = values(
                "barge_decay", tmp_path, f"simulate.step={h} s", "simulate.duration=600 s", good=False
            )
            for name, period in exact.items():
                half = np.pi * h / period
                expected = half / np.arctan(half)  # midpoint rule: tan(omega' h / 2) = omega h / 2
                assert 1.0 / found[f"{name}_frequency"] / period == pytest.approx(expected, abs=5e-6)


class TestSphereSlow:
    pytestmark = SLOW

    def test_case_meets_its_references(self, tmp_path: Path) -> None:
        found = values("sphere_decay", tmp_path)
        assert len(found) == 4
        assert found["error_max"] < 4e-4

    def test_convolution_meets_them_too(self, tmp_path: Path) -> None:
        """And its error falls with the square of the step."""
        direct = ("databases.sphere.memory=direct", "databases.sphere.memory_length=40 s")
        assert values("sphere_decay", tmp_path, *direct)["error_max"] < 4e-4
        errors = [
            values("sphere_decay", tmp_path, *direct, f"simulate.step={h}", good=False)["error_hulme"]
            for h in (0.1, 0.05, 0.025)
        ]
        np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.1)

    def test_long_steps_are_stable(self, tmp_path: Path) -> None:
        """Half a second, a ninth of the period."""
        found = values(
            "sphere_decay", tmp_path, "simulate.step=0.5 s", "simulate.output_interval=0.5 s",
            "converge=", "reference=",
            'check=[{id="end",quantity="channel.sphere.position.z.end",reference=0.0,tolerance={absolute=0.02},source="decay"},'
            '{id="max",quantity="channel.sphere.position.z.max",reference=1.0,tolerance={absolute=1e-9},source="decay"}]',
            good=False,
        )  # fmt: skip
        assert abs(found["end"]) < 0.02
        assert found["max"] == pytest.approx(1.0, abs=1e-9)


def test_periods_of_the_barge_from_its_matrices() -> None:
    """Closed forms against the coupled matrices, and both against what the case asks for."""
    reference = script("barge_decay", "closed_forms")
    closed = reference.closed_forms()
    np.testing.assert_allclose(np.sort(reference.from_matrices()), np.sort(closed), rtol=1e-12)
    case = load_changed_case(CASES / "barge_decay", ())
    asked = {check.id: check.reference for check in case.check}
    for name, period in zip(("heave", "roll", "pitch"), closed, strict=True):
        assert asked[f"{name}_frequency"] == pytest.approx(1.0 / period, rel=1e-11)


def test_masses_of_the_barge_are_those_of_the_reference() -> None:
    case, reference = load_changed_case(CASES / "barge_decay", ()), script("barge_decay", "closed_forms")
    mass = reference.DENSITY * reference.LENGTH * reference.BREADTH * reference.DRAFT
    for name in ("heaving", "rolling", "pitching", "rocking"):
        body = case.bodies[name]
        assert body.mass == pytest.approx(mass, rel=1e-12)
        roll, pitch = mass * reference.RADIUS_ROLL**2, mass * reference.RADIUS_PITCH**2
        np.testing.assert_allclose(body.inertia, np.diag([roll, pitch, pitch]), rtol=1e-9)
        # KG is measured from the bottom, 3 m below the middle of the box
        assert body.centre_of_mass[2] + 3.0 == pytest.approx(reference.KG)


def test_database_of_the_sphere_is_hulmes() -> None:
    """Damping of the file against the table at its frequencies; the added mass was made from the damping."""
    database = read_netcdf(CASES / "sphere_decay" / "sphere.nc")
    check_database(database)
    ka, added, damping = np.loadtxt(CASES / "sphere_decay" / "hulme.csv", delimiter=",", skiprows=2)[:, :3].T
    w = np.sqrt(9.81 * ka / 5.0)
    displaced = 1000.0 * 2.0 / 3.0 * np.pi * 125.0
    B = np.interp(w, database.omega, database.damping[:, 2, 2]) / (displaced * w)
    np.testing.assert_allclose(B, damping, atol=1e-4)
    A = np.interp(w, database.omega, database.added_mass[:, 2, 2]) / displaced
    np.testing.assert_allclose(A, added, atol=5e-4)
    assert database.added_mass_infinite[2, 2] == 130876.8
    assert not np.any(database.excitation)
    assert not np.any(np.delete(np.delete(database.damping, 2, 1), 2, 2))


def test_database_of_the_sphere_is_made_by_its_script() -> None:
    made, stored = script("sphere_decay", "make_database"), read_netcdf(CASES / "sphere_decay" / "sphere.nc")
    w = stored.omega[::100]
    np.testing.assert_allclose(made.heave_damping(w), stored.damping[::100, 2, 2], rtol=1e-12)
    np.testing.assert_allclose(made.heave_added_mass(w), stored.added_mass[::100, 2, 2], rtol=1e-12)


def test_reference_of_the_sphere_is_solved_with_the_kernel_of_its_database() -> None:
    """Simpson's rule over 20,001 frequencies against exact integrals of piecewise linear damping."""
    reference = script("sphere_decay", "make_reference")
    database = read_netcdf(CASES / "sphere_decay" / "sphere.nc")
    kernel = retardation_kernel(database.omega, database.damping[:, 2:3, 2:3])
    t = np.linspace(0.0, 30.0, 61)
    K = reference.kernel(t)
    np.testing.assert_allclose(kernel(t)[:, 0, 0], K, atol=1e-4 * K[0])


def test_decays_of_the_sphere_agree() -> None:
    """WAMIT's damping and Hulme's; of an independent solution with steps of 20 ms too."""
    folder = CASES / "sphere_decay"
    wamit, hulme = (
        np.loadtxt(folder / name, delimiter=",", skiprows=2) for name in ("decay.csv", "decay_hulme.csv")
    )
    np.testing.assert_allclose(hulme, wamit, atol=6e-4)
    reference = script("sphere_decay", "make_reference")
    z = reference.decay(reference.kernel(0.02 * np.arange(1001)), 0.02)
    np.testing.assert_allclose(z[::5], hulme[:201, 1], atol=5e-4)
