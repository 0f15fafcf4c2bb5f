"""Ringing: what the end velocities of a step have of motions that it does not resolve.

The midpoint rule gives a mode with the angular frequency w at a step of h the factor ``(1 - i h w/2)/(1 + i h w/2)``,
which tends to -1: end velocity and strain of a stiff mode change their sign with every step, while the velocity in the
middle, and with it the path, has hardly anything of it. Energy is kept, so this is not damped; but it is no motion.

So what is recorded of a force of a damper is not taken from the end velocities alone. The *steady* end velocity
extends the mean velocities of the last two steps by half a step: it is of second order where the motion is resolved,
and has little of the ringing. Where a velocity has jumped, as in an impact, the velocity of the end itself is nearer,
so the smaller of both changes counts, and none if they differ in sign (the minmod limiter, A. Harten, J. Comput.
Phys. 49, 1983).

Forces of joints are known in the middle of steps and are carried on by half a step. Where one changes by turns, three
steps on end, the part that does so is left out; of a vector along the direction in which it does, so that it does not
matter along which axes its components are. Where one has jumped, as where something is released, its slope is no slope:
what it is carried on by is at most `STEEPER` times what it was before, and nothing where it turns, unless its second
differences say that it turns smoothly.

A midpoint that is predicted along ringing velocities is off by h/2 of them, and the directions of forces there with
it: this drives the ringing, in shells by a percent a step, until it has as much energy as the motion. There the part
of the end velocities that changes its sign with every step is left out where it matters.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel

__all__ = [
    "STEEPER",
    "alternating",
    "alternating_slope",
    "carried_force",
    "kept_share",
    "steady_force",
    "steady_rate",
]

STEEPER = 3.0
"""Slope of a step over that of the one before that is still a slope: what grows by the square of time has 3 in its
second step, and less in all behind."""


@kernel(inline=True, internal=True)
def steady_rate(mean: float, growth: float, end: float) -> float:
    """Rate at the end of a step without ringing.

    Parameters
    ----------
    mean
        Of the step.
    growth
        What it grows by in half a step, as far as the mean rates of this step and the one before determine.
    end
        Rate by the velocities at the end.
    """
    change = end - mean
    if change * growth <= 0.0:
        return mean
    return mean + (growth if abs(growth) < abs(change) else change)


@kernel(inline=True, internal=True)
def alternating(deviation: float, before: float) -> float:
    """The part of a deviation that changes its sign with every step, from those of this step and the one before.

    What a step resolves deviates too, by the square of the step, but keeps its sign for half of its period.
    """
    if deviation * before >= 0.0:
        return 0.0
    return deviation if abs(deviation) < abs(before) else -before


@kernel(inline=True, internal=True)
def alternating_slope(slope: float, before: float, long_before: float) -> float:
    """The part of three slopes on end, the last one first, that changes its sign with every step: 0 if they do not.

    Their second difference, which leaves out what is constant; but no more than twice the smallest of them, so that it
    begins and ends without a jump.
    """
    if slope * before >= 0.0 or before * long_before >= 0.0:
        return 0.0
    part = 0.25 * (slope - 2.0 * before + long_before)
    least = 2.0 * min(abs(slope), abs(before), abs(long_before))
    return max(-least, min(least, part))


@kernel(inline=True, internal=True)
def kept_share(
    along: float,
    square: float,
    before_square: float,
    bend: float,
    bend_square: float,
    bend_before_square: float,
) -> float:
    """Share of a slope that those before bear out: a jump has none (limiter of S. Chakravarthy, S. Osher).

    Parameters
    ----------
    along, square, before_square
        Of a vector, or of a number, without the parts that alternate: slope times slope before, and their squares.
    bend, bend_square, bend_before_square
        The same of the last two differences of slopes.
    """
    if bend > 0.0 and bend_square <= STEEPER * STEEPER * bend_before_square:
        return 1.0
    if along <= 0.0:
        return 0.0
    return min(1.0, STEEPER * math.sqrt(before_square / square))


@kernel(inline=True, internal=True)
def carried_force(
    middle: float, slope: float, part: float, share: float, step: float, spacing: float
) -> float:
    """Force at the end of a step without ringing, from that in its middle.

    Parameters
    ----------
    middle
        In the middle of the step [N].
    slope, part, share
        Of the force from the middle of the step before to that of this one, its `alternating_slope` [N/s], and the
        `kept_share` of the rest.
    step, spacing
        The step, and the time since the middle of the one before [s].
    """
    return middle + 0.5 * step * share * (slope - part) - 0.5 * spacing * part


@kernel(inline=True, internal=True)
def steady_force(
    middle: float, slope: float, before: float, long_before: float, step: float, spacing: float
) -> float:
    """Force at the end of a step without ringing, from those in the middles of the last four.

    Parameters
    ----------
    middle
        In the middle of the step [N].
    slope, before, long_before
        Of the force from the middle of one step to that of the next [N/s]: the last one first.
    step, spacing
        The step, and the time since the middle of the one before [s].

    Notes
    -----
    Of second order where the force is smooth: three slopes on end never alternate there, and where it turns its slope
    is of the order of the step.
    """
    part = alternating_slope(slope, before, long_before)
    now, old, oldest = slope - part, before + part, long_before - part
    bend, bend_before = now - old, old - oldest
    share = kept_share(
        now * old, now * now, old * old, bend * bend_before, bend * bend, bend_before * bend_before
    )
    return carried_force(middle, slope, part, share, step, spacing)
