"""Response operators, natural periods and responses in a sea as CSV and JSON files."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.results.storage import replacing, write_json
from heavylift.preprocess.hydrodynamics.database import COORDINATES

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from heavylift.solver.water.hulls.frequency_domain import MotionOperators, NaturalMode, ResponseStatistics

__all__ = ["operator_rows", "rao_document", "write_rao_report"]


def operator_rows(operators: MotionOperators) -> list[list[object]]:
    """The table of all operators, with a header row.

    Returns
    -------
    list
        Rows: body, heading [deg], omega [rad/s], period [s], then amplitude [m/m, deg/m] and phase [deg] of the six
        coordinates. The phase is the lag behind the crest at the reference point of the first hull.
    """
    header: list[object] = ["body", "heading_deg", "omega_rad_s", "period_s"]
    for j, name in enumerate(COORDINATES):
        header += [f"{name}_{'m' if j < 3 else 'deg'}_per_m", f"{name}_phase_deg"]
    rows = [header]
    factor = np.array([1.0] * 3 + [180.0 / math.pi] * 3)
    for body, name in enumerate(operators.bodies):
        own = slice(6 * body, 6 * body + 6)
        for h, heading in enumerate(operators.headings):
            for k, w in enumerate(operators.omega):
                amplitude = factor * operators.amplitude[k, h, own]
                phase = np.degrees(operators.phase[k, h, own])
                row: list[object] = [
                    name,
                    round(math.degrees(heading), 6),
                    float(w),
                    2.0 * math.pi / float(w),
                ]
                for j in range(6):
                    row += [float(amplitude[j]), float(phase[j])]
                rows.append(row)
    return rows


def rao_document(
    operators: MotionOperators,
    modes: Sequence[NaturalMode] = (),
    responses: Mapping[str, ResponseStatistics] | None = None,
) -> dict[str, Any]:
    """Everything but the table itself, SI units and radians, ready for JSON.

    Parameters
    ----------
    operators
        Response operators.
    modes
        Natural modes.
    responses
        Words for a sea to the responses in it.
    """
    names = [f"{body}.{coordinate}" for body in operators.bodies for coordinate in COORDINATES]
    return {
        "conventions": {
            "heading": "direction in which the waves travel, from +x of the hulls, anticlockwise, rad",
            "phase": "lag behind the crest at the reference point of the first hull, rad: cos(omega t - phase)",
            "units": "SI; amplitudes in m and rad per metre of wave amplitude",
        },
        "bodies": list(operators.bodies),
        "headings": operators.headings.tolist(),
        "omega": [float(operators.omega[0]), float(operators.omega[-1]), len(operators.omega)],
        "largest": [
            {
                "coordinate": name,
                "heading": float(operators.headings[h]),
                "amplitude": float(operators.amplitude[k, h, j]),
                "period": 2.0 * math.pi / float(operators.omega[k]),
            }
            for j, name in enumerate(names)
            if len(operators.headings)
            for k, h in [
                np.unravel_index(int(np.argmax(operators.amplitude[:, :, j])), operators.amplitude.shape[:2])
            ]
        ],
        "natural_modes": [
            {
                "period": mode.period,
                "coordinate": names[mode.coordinate],
                "shape": {name: float(value) for name, value in zip(names, mode.shape, strict=True)},
            }
            for mode in modes
        ],
        "responses": {
            sea: {
                name: {
                    "standard_deviation": float(one.standard_deviation[j]),
                    "significant_amplitude": float(one.significant[j]),
                    "mean_period": float(one.mean_period[j]) if one.standard_deviation[j] > 0.0 else None,
                }
                for j, name in enumerate(names)
            }
            for sea, one in (responses or {}).items()
        },
    }


def write_rao_report(
    folder: Path,
    operators: MotionOperators,
    *,
    modes: Sequence[NaturalMode] = (),
    responses: Mapping[str, ResponseStatistics] | None = None,
    pictures: bool = True,
) -> list[Path]:
    """Write ``rao.csv``, ``rao.json`` and a picture of each hull; of operators without headings ``rao.json`` alone.

    Parameters
    ----------
    folder
        Made if it is missing.
    operators, modes, responses
        As in `rao_document`.
    pictures
        Draw ``rao_<body>.png``.

    Returns
    -------
    list
        The files, in this order.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not len(operators.headings):
        for stale in ("rao.csv", *(f"rao_{name}.png" for name in operators.bodies)):
            (folder / stale).unlink(missing_ok=True)
        write_json(folder / "rao.json", rao_document(operators, modes, responses))
        return [folder / "rao.json"]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for row in operator_rows(operators):
        writer.writerow([f"{value:.9g}" if isinstance(value, float) else value for value in row])
    files = [folder / "rao.csv", folder / "rao.json"]
    with replacing(files[0]) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8")
    write_json(files[1], rao_document(operators, modes, responses))
    if pictures:
        from heavylift.pipeline.pictures.hull_plots import operator_plot

        for body, name in enumerate(operators.bodies):
            files.append(folder / f"rao_{name}.png")
            with replacing(files[-1]) as temporary:
                temporary.write_bytes(operator_plot(operators, body=body, modes=modes))
    return files
