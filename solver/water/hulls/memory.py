"""Memory of radiated waves in the time domain: recursive exponentials, and direct convolution as the reference.

The force of the waves that a group of hulls has made so far is

    F(t) = - int_0^t K(t - s) u(s) ds - D u(t)

(Cummins, The impulse response function and ship motions, Schiffstechnik 9 (1962); *Integrated simulation ... ships
and offshore structures* (2018), section 2.9). Within a step the velocity u is taken as linear (first-order hold),
and every integral is then exact. An integrator that evaluates its forces at the middle of a step gets

    F_middle = known - implicit u_middle,      u linear from u_start to u_middle in the first half of the step,

so the part that belongs to the present velocity can go to the left side of the equations. The work that the hulls
lose to the memory in a step of length h is -h u_middle . F_middle; over an oscillation of frequency w it has the sign
of sinc^2(w h / 2) B(w) - sinc^2(w h / 2 - pi) B(2 pi / h - w) + ..., so a passive memory stays so in steps up to about
half of the shortest period at which waves are made, far beyond what accuracy allows.

Both forms start from rest: no waves before the start. A velocity may jump between steps (an impact): each step
brings its own velocities at its start and its end.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel

__all__ = [
    "DirectMemory",
    "ExponentialMemory",
    "advance_memory_direct",
    "advance_memory_exponential",
    "memory_force_direct",
    "memory_force_exponential",
    "memory_force_now_direct",
    "memory_force_now_exponential",
    "prepare_memory_exponential",
]

PIECE = 0.0125
"""Longest pieces [s] in which the weights of the direct convolution are integrated; four or more in a step."""

SERIES_BELOW = 0.5
"""Of the modulus of pole times step; above it the closed forms lose no digits."""


class ExponentialMemory(Arrays):
    """Memory of one group of n coordinates, K(t) = Re sum_p R_p exp(s_p t), one pole of each conjugate pair.

    Complex numbers are stored as all P real parts followed by all P imaginary parts.

    Attributes
    ----------
    poles
        s_p [1/s], shape (2 P,).
    channels
        Force coordinate and velocity coordinate of the entries of K that are not zero, shape (c, 2).
    residues
        Of these entries, shape (c, 2 P), imaginary parts with the opposite sign: a dot product with a row of the
        state is a force.
    damping
        D, of velocities at the same time, shape (n, n).
    state
        z_jp = int exp(s_p (t - s)) u_j(s) ds, shape (n, 2 P). All that outlives a step.
    decay, of_start, of_end
        Coefficients of the recursion for the step length in `step`, of the whole step: of the state and of the
        velocities at its start and end, shape (2 P,).
    halves
        Coefficients of the half step, of the channels, shape (c, 2 P).
    step
        Length for which the coefficients hold [s], shape (1,); negative: none yet.
    implicit
        Coefficient of the velocity at the middle of the step, D included, shape (n, n).
    explicit
        Coefficient of the velocity at the start of the step, shape (n, n).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    poles: Floats1
    channels: Ints2
    residues: Floats2
    damping: Floats2
    state: Floats2
    decay: Floats1
    of_start: Floats1
    of_end: Floats1
    halves: Floats2
    step: Floats1
    implicit: Floats2
    explicit: Floats2


class DirectMemory(Arrays):
    """Memory of one group of n coordinates by convolution over the velocities of the last T steps.

    Attributes
    ----------
    channels
        Force coordinate and velocity coordinate of the entries of K that are not zero, shape (c, 2).
    middle, now
        Weights of the velocities at start and end of the past steps, the newest step first, for the force at the
        middle of the next step and for that at the present, shape (c, 2 T).
    damping
        D, shape (n, n).
    state
        Place of the newest step in the ring, then for each coordinate the velocities at start and end of each step
        in the ring, shape (1 + 2 n T,).
    step
        Length of every step [s], shape (1,).
    implicit, explicit
        As in `ExponentialMemory`.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    channels: Ints2
    middle: Floats2
    now: Floats2
    damping: Floats2
    state: Floats1
    step: Floats1
    implicit: Floats2
    explicit: Floats2


@kernel(internal=True)
def hold_integrals(real: float, imaginary: float, h: float) -> tuple[complex, complex, complex]:
    """Exact first-order hold over a length h: exp(s h) and the factors of the two velocities.

    z(h) = exp(s h) z(0) + int_0^h exp(s (h - t)) (u_0 + (u_1 - u_0) t / h) dt = e z(0) + a u_0 + b u_1.

    Returns
    -------
    tuple of complex
        e, a and b [s].
    """
    x = complex(real * h, imaginary * h)
    e = np.exp(x)
    if x.real * x.real + x.imag * x.imag < SERIES_BELOW * SERIES_BELOW:
        # (e - 1 - x) / x^2 and (e - 1) / x as series: short steps must not cost digits
        second = complex(0.0, 0.0)
        first = complex(0.0, 0.0)
        for k in range(16, 0, -1):
            second = (second * x + 1.0) / (k + 1.0)
            first = (first * x + 1.0) / k
    else:
        first = (e - 1.0) / x
        second = (first - 1.0) / x
    return e, h * (first - second), h * second


@kernel(internal=True)
def prepare_memory_exponential(memory: ExponentialMemory, h: float) -> None:
    """Coefficients of a step of length h [s], unless they are there already."""
    if memory.step[0] == h:
        return
    count = memory.poles.shape[0] // 2
    n = memory.damping.shape[0]
    for i in range(n):
        for j in range(n):
            memory.implicit[i, j] = memory.damping[i, j]
            memory.explicit[i, j] = 0.0
    for p in range(count):
        real, imaginary = memory.poles[p], memory.poles[count + p]
        e, a, b = hold_integrals(real, imaginary, h)
        memory.decay[p], memory.decay[count + p] = e.real, e.imag
        memory.of_start[p], memory.of_start[count + p] = a.real, a.imag
        memory.of_end[p], memory.of_end[count + p] = b.real, b.imag
        e, a, b = hold_integrals(real, imaginary, 0.5 * h)
        for c in range(memory.channels.shape[0]):
            i, j = memory.channels[c, 0], memory.channels[c, 1]
            R = complex(memory.residues[c, p], -memory.residues[c, count + p])
            turned = R * e
            memory.halves[c, p] = turned.real
            memory.halves[c, count + p] = -turned.imag
            memory.explicit[i, j] += (R * a).real
            memory.implicit[i, j] += (R * b).real
    memory.step[0] = h


@kernel(internal=True, reassociate=True)
def memory_force_exponential(
    memory: ExponentialMemory, u_start: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """Known part of the force at the middle of the prepared step: F = out - implicit u_middle.

    Parameters
    ----------
    memory
        At the start of the step.
    u_start
        Velocities there, shape (n,).
    out
        Written, shape (n,).
    """
    width = memory.poles.shape[0]
    for i in range(memory.damping.shape[0]):
        out[i] = 0.0
    for c in range(memory.channels.shape[0]):
        i, j = memory.channels[c, 0], memory.channels[c, 1]
        total = memory.explicit[i, j] * u_start[j]
        for k in range(width):
            total += memory.halves[c, k] * memory.state[j, k]
        out[i] -= total


@kernel(internal=True)
def advance_memory_exponential(
    memory: ExponentialMemory, u_start: NDArray[np.float64], u_end: NDArray[np.float64]
) -> None:
    """Take the state to the end of the prepared step, velocities linear from start to end, each of shape (n,)."""
    count = memory.poles.shape[0] // 2
    for j in range(memory.damping.shape[0]):
        u0, u1 = u_start[j], u_end[j]
        for p in range(count):
            q = count + p
            e, f = memory.decay[p], memory.decay[q]
            x, y = memory.state[j, p], memory.state[j, q]
            added = memory.of_start[p] * u0 + memory.of_end[p] * u1
            turned = memory.of_start[q] * u0 + memory.of_end[q] * u1
            memory.state[j, p] = e * x - f * y + added
            memory.state[j, q] = e * y + f * x + turned


@kernel(internal=True)
def memory_force_now_exponential(
    memory: ExponentialMemory, u: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """Force at the carried state with the velocities there, both of shape (n,)."""
    instant_damping(memory.damping, u, out)
    for c in range(memory.channels.shape[0]):
        i, j = memory.channels[c, 0], memory.channels[c, 1]
        total = 0.0
        for k in range(memory.poles.shape[0]):
            total += memory.residues[c, k] * memory.state[j, k]
        out[i] -= total


@kernel(internal=True)
def instant_damping(damping: NDArray[np.float64], u: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Write -D u to out."""
    for i in range(damping.shape[0]):
        total = 0.0
        for j in range(damping.shape[0]):
            total += damping[i, j] * u[j]
        out[i] = -total


@kernel(internal=True, reassociate=True)
def ring_sum(
    weights: NDArray[np.float64], c: int, state: NDArray[np.float64], first: int, newest: int, length: int
) -> float:
    """Sum of the weights of channel c times one row of the ring, which is read from its newest step round to it."""
    ahead = length - newest
    row = weights[c]
    ring = state[first : first + length]
    recent = ring[newest:]
    old = row[ahead:]
    total = 0.0
    for k in range(ahead):
        total += row[k] * recent[k]
    for k in range(newest):
        total += old[k] * ring[k]
    return total


@kernel(internal=True)
def memory_force_direct(memory: DirectMemory, u_start: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """As `memory_force_exponential`, for the fixed step of the memory."""
    length = memory.middle.shape[1]
    newest = 2 * int(memory.state[0])
    for i in range(memory.damping.shape[0]):
        out[i] = 0.0
    for c in range(memory.channels.shape[0]):
        i, j = memory.channels[c, 0], memory.channels[c, 1]
        past = ring_sum(memory.middle, c, memory.state, 1 + j * length, newest, length)
        out[i] -= memory.explicit[i, j] * u_start[j] + past


@kernel(internal=True)
def advance_memory_direct(
    memory: DirectMemory, u_start: NDArray[np.float64], u_end: NDArray[np.float64]
) -> None:
    """Put the velocities of a step, each of shape (n,), in the place of those of the oldest one."""
    length = memory.middle.shape[1]
    taps = length // 2
    newest = (int(memory.state[0]) + taps - 1) % taps
    for j in range(memory.damping.shape[0]):
        place = 1 + j * length + 2 * newest
        memory.state[place] = u_start[j]
        memory.state[place + 1] = u_end[j]
    memory.state[0] = newest


@kernel(internal=True)
def memory_force_now_direct(memory: DirectMemory, u: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Force at the carried state with the velocities there, both of shape (n,)."""
    length = memory.now.shape[1]
    newest = 2 * int(memory.state[0])
    instant_damping(memory.damping, u, out)
    for c in range(memory.channels.shape[0]):
        i, j = memory.channels[c, 0], memory.channels[c, 1]
        out[i] -= ring_sum(memory.now, c, memory.state, 1 + j * length, newest, length)
