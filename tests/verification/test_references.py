"""Reference tables of cases: the stored files are what their generators make, and start where the case starts."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

if TYPE_CHECKING:
    from types import ModuleType

CASES = Path(__file__).resolve().parents[2] / "cases"
SCRIPTS = [*sorted(CASES.glob("*/make_reference.py")), CASES / "plate_turn_over" / "make_case.py"]
SLOW = {
    "ball_on_beam",
    "block_offloading",
    "flexible_pendulum",
    "mbs_a04",
    "mbs_a05",
    "mbs_chain",
    "point_mass_on_beam",
}
BY_OTHERS = {
    "mbs_a04_thin",
    "flexible_pendulum_g50",
    "flexible_pendulum_stiff",
    "load_out_level",
    "spmt_warp",
    "spring_barge",
    "tank_erection",
}
"""Tables that another case makes, or that others made (`spring_barge`, `load_out_level`), or that are input: waves of
`tank_erection`, the road of `spmt_warp`."""

assert SCRIPTS, "no case has a generator"


def generator(script: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"make_reference_{script.parent.name}", script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize(
    "script",
    [
        pytest.param(
            path,
            marks=[pytest.mark.slow, pytest.mark.timeout(1800)] if path.parent.name in SLOW else (),
            id=path.parent.name,
        )
        for path in SCRIPTS
    ],
)
def test_stored_tables_are_reproduced(script: Path) -> None:
    """Another machine and another SciPy find the same numbers, to far below what the checks ask for."""
    tables = generator(script).references()
    assert tables
    for name, table in tables.items():
        lines = (script.parent / name).read_text(encoding="utf-8").splitlines()
        remarks = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        stored = np.loadtxt(lines, delimiter=",", skiprows=remarks + 1)
        assert len(stored) >= 2
        assert stored.shape == table.shape
        scale = np.maximum(1.0, np.abs(stored).max(axis=0))
        np.testing.assert_allclose(table / scale, stored / scale, rtol=0.0, atol=2e-9, err_msg=name)


def test_every_stored_table_has_a_generator() -> None:
    folders = {file.parent for file in CASES.glob("*/*.csv")}
    made = {path.parent for path in SCRIPTS} | {CASES / name for name in BY_OTHERS}
    assert folders <= made


def test_andrews_mechanism_agrees_with_the_published_solution() -> None:
    """Angles at 30 ms from the Test set for IVP solvers, whose own accuracy is about 1e-9."""
    module = generator(CASES / "mbs_a03" / "make_reference.py")
    angles = module.solution()[60, :7]
    np.testing.assert_allclose(angles, module.absolute(module.AT_0_03), rtol=0.0, atol=3e-9)


def test_two_four_bars_agree_with_the_published_end() -> None:
    """Tip of the first crank after 10 s for two loops, to the eight digits of the Exudyn example of this benchmark."""
    table = generator(CASES / "mbs_a02" / "make_reference.py").references()["reference_2.csv"]
    np.testing.assert_allclose(table[-1, 1:3], [0.32845811, 0.94451854], rtol=0.0, atol=6e-9)


def test_bricard_loop_closes_at_every_angle() -> None:
    module = generator(CASES / "mbs_a04" / "make_reference.py")
    assert module.closure_error() < 1e-14


def test_governor_keeps_its_energy_balance() -> None:
    """A short piece of the motion: energies and what the dampers took add up."""
    module = generator(CASES / "mbs_a05" / "make_reference.py")
    y = np.array([module.START_ANGLE, module.START_HEIGHT, 0.0, 0.0, 0.0])
    from scipy.integrate import solve_ivp

    found = solve_ivp(module.rate, (0.0, 0.02), y, "DOP853", rtol=1e-12, atol=1e-13).y.T
    assert np.ptp([module.balance(row) for row in found]) < 1e-8
