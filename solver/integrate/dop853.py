"""The Runge-Kutta method DOP853: order 8 in twelve stages, error estimates of orders 5 and 3.

E. Hairer, S. P. Norsett and G. Wanner, "Solving Ordinary Differential Equations I", 2nd edition, section
II.5, after P. J. Prince and J. R. Dormand. Row 0 of the flat array holds the state at the start of the step,
row j the rate of stage j = 1 ... 12; rates that a stage does not need have no term.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.combination import combine

__all__ = ["NODES", "ORDER", "STAGES", "write_end", "write_errors", "write_stage"]

ORDER, STAGES = 8, 12

NODES = (
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1.0,
)
"""Times of the stages as parts of the step."""


@kernel(internal=True)
def write_stage(values: NDArray[np.float64], size: int, to: int, stage: int, h: float) -> None:
    """State of a stage, 2 ... 12, into row `to`."""
    if stage == 2:
        combine(values, size, to, (0, 1), (1.0, h * 0.05260015195876773))
    elif stage == 3:
        combine(values, size, to, (0, 1, 2), (1.0, h * 0.0197250569845379, h * 0.0591751709536137))
    elif stage == 4:
        combine(values, size, to, (0, 1, 3), (1.0, h * 0.02958758547680685, h * 0.08876275643042054))
    elif stage == 5:
        combine(
            values,
            size,
            to,
            (0, 1, 3, 4),
            (1.0, h * 0.2413651341592667, h * -0.8845494793282861, h * 0.924834003261792),
        )
    elif stage == 6:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5),
            (1.0, h * 0.037037037037037035, h * 0.17082860872947386, h * 0.12546768756682242),
        )
    elif stage == 7:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5, 6),
            (1.0, h * 0.037109375, h * 0.17025221101954405, h * 0.06021653898045596, h * -0.017578125),
        )
    elif stage == 8:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5, 6, 7),
            (
                1.0,
                h * 0.03709200011850479,
                h * 0.17038392571223998,
                h * 0.10726203044637328,
                h * -0.015319437748624402,
                h * 0.008273789163814023,
            ),
        )
    elif stage == 9:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5, 6, 7, 8),
            (
                1.0,
                h * 0.6241109587160757,
                h * -3.3608926294469414,
                h * -0.868219346841726,
                h * 27.59209969944671,
                h * 20.154067550477894,
                h * -43.48988418106996,
            ),
        )
    elif stage == 10:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5, 6, 7, 8, 9),
            (
                1.0,
                h * 0.47766253643826434,
                h * -2.4881146199716677,
                h * -0.590290826836843,
                h * 21.230051448181193,
                h * 15.279233632882423,
                h * -33.28821096898486,
                h * -0.020331201708508627,
            ),
        )
    elif stage == 11:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5, 6, 7, 8, 9, 10),
            (
                1.0,
                h * -0.9371424300859873,
                h * 5.186372428844064,
                h * 1.0914373489967295,
                h * -8.149787010746927,
                h * -18.52006565999696,
                h * 22.739487099350505,
                h * 2.4936055526796523,
                h * -3.0467644718982196,
            ),
        )
    else:
        combine(
            values,
            size,
            to,
            (0, 1, 4, 5, 6, 7, 8, 9, 10, 11),
            (
                1.0,
                h * 2.273310147516538,
                h * -10.53449546673725,
                h * -2.0008720582248625,
                h * -17.9589318631188,
                h * 27.94888452941996,
                h * -2.8589982771350235,
                h * -8.87285693353063,
                h * 12.360567175794303,
                h * 0.6433927460157636,
            ),
        )


@kernel(internal=True)
def write_end(values: NDArray[np.float64], size: int, to: int, h: float) -> None:
    """State at the end of the step into row `to`."""
    combine(
        values,
        size,
        to,
        (0, 1, 6, 7, 8, 9, 10, 11, 12),
        (
            1.0,
            h * 0.054293734116568765,
            h * 4.450312892752409,
            h * 1.8915178993145003,
            h * -5.801203960010585,
            h * 0.3111643669578199,
            h * -0.1521609496625161,
            h * 0.20136540080403034,
            h * 0.04471061572777259,
        ),
    )


@kernel(internal=True)
def write_errors(values: NDArray[np.float64], size: int, fifth: int, third: int) -> None:
    """Differences of the mean rate to those of order 5 and 3 into two rows."""
    rows = (1, 6, 7, 8, 9, 10, 11, 12)
    combine(
        values,
        size,
        fifth,
        rows,
        (
            0.01312004499419488,
            -1.2251564463762044,
            -0.4957589496572502,
            1.6643771824549864,
            -0.35032884874997366,
            0.3341791187130175,
            0.08192320648511571,
            -0.022355307863886294,
        ),
    )
    combine(
        values,
        size,
        third,
        rows,
        (
            -0.18980075407240762,
            4.450312892752409,
            1.8915178993145003,
            -5.801203960010585,
            -0.4226823213237919,
            -0.1521609496625161,
            0.20136540080403034,
            0.02265179219836082,
        ),
    )
