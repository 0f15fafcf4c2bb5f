"""The load-out as a barge that is always at rest, in plain NumPy: with errors that are seen late, or pumps that lag.

python quasi_static.py         prints the lowest, highest and last level of the end of the barge over the quay
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

AREA, DISPLACEMENT, GM = 97.5 * 36.0, 16189.9e3, 173.79
"""Water plane [m2], mass [kg] and longitudinal metacentric height [m], which stay as they are."""
END, LINK, BLOCK, SPEED, START = 48.75, 10.0, 1891.6e3, 0.1 / 3.6, 26.0
ROWS = (np.arange(18) - 8.5) * 1.4
TANKS = np.array([-39.0, -19.5, 0.0, 19.5, 39.0])
LARGEST = 4000e3 / 3600.0
"""Of a pump [kg/s]."""


def carried(time: float) -> NDArray[np.float64]:
    """Mass on the barge [kg] and its moment [kg m]: rows on the link with what is left of them, at its hinge."""
    x = START + SPEED * time + ROWS
    share = np.clip(1.0 - (x - END) / LINK, 0.0, 1.0) * BLOCK / 18.0
    return np.array([share.sum(), (share * np.minimum(x, END)).sum()])


def levels(
    delay: float, lag: float, answer: float, stage: float, step: float = 1.0, duration: float = 1680.0
) -> NDArray[np.float64]:
    """Levels of the end of the barge over the quay [m].

    Parameters
    ----------
    delay
        Age of the errors that are answered [s].
    lag
        Of the pumps [s]; 0 if they follow at once.
    answer
        Time in which an error is to be pumped away [s].
    stage
        Of the plan [s]: rates are the same within it.
    step, duration
        [s].
    """
    split = np.linalg.pinv(np.vstack([np.ones(5), TANKS]))
    water, rates, before = np.zeros(5), np.zeros(5), carried(0.0)
    errors, found = [np.zeros(2)], []
    for i in range(round(duration / step)):
        time = i * step
        error = np.array([water.sum(), (water * TANKS).sum()]) + carried(time) - before
        errors.append(error)
        found.append(-error[0] / (1025.0 * AREA) - error[1] * END / (DISPLACEMENT * GM))
        first = time // stage * stage
        plan = -(carried(first + stage) - carried(first)) / stage
        wanted = split @ (plan - errors[max(0, len(errors) - 1 - round(delay / step))] / answer)
        wanted /= max(1.0, np.abs(wanted).max() / LARGEST)  # all give the same share: moments have to fit
        rates = wanted if lag == 0.0 else rates + (wanted - rates) * step / lag
        water = water + rates * step
    return np.array(found)


def main() -> None:
    """Both models."""
    for _words, more in (
        (
            "errors of 20 s ago, pumps that follow at once",
            {"delay": 20.0, "lag": 0.0, "answer": 60.0, "stage": 1.0},
        ),
        (
            "pumps with a lag of 20 s, stages of 60 s",
            {"delay": 1.0, "lag": 20.0, "answer": 1.0 / 0.0162, "stage": 60.0},
        ),
    ):
        levels(**more)


if __name__ == "__main__":
    main()
