"""Frequency of a single sinusoid by least squares."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Sinusoid", "fit_sinusoid"]

ITERATIONS = 20
CONVERGED = 1e-11
"""Last relative change of the frequency that is accepted; clean data reach 1e-15."""
SMALLEST = 1e-30
"""Samples that vary less are taken as constant."""


class Sinusoid(NamedTuple):
    """``exp(-decay t) (cosine cos(2 pi frequency t) + sine sin(2 pi frequency t)) + offset``.

    Attributes
    ----------
    frequency
        [Hz].
    decay
        [1/s]; zero unless it was fitted.
    cosine, sine, offset
        In the unit of the samples.
    residual
        Root mean square of what is left, relative to that of the samples.
    """

    frequency: float
    decay: float
    cosine: float
    sine: float
    offset: float
    residual: float


def fit_sinusoid(
    times: NDArray[np.float64], values: NDArray[np.float64], *, damped: bool = False
) -> Sinusoid:
    """Fit one sinusoid to samples.

    Parameters
    ----------
    times
        Equidistant [s], shape (n,), n >= 8.
    values
        Samples, shape (n,), over at least one period.
    damped
        Whether an exponential decay is fitted as well.

    Raises
    ------
    InputError
        If there are too few samples, they do not oscillate, or the fit does not converge.

    Notes
    -----
    The first guess is the largest line of the discrete Fourier transform with a Hann window, refined by
    the parabola through the logarithms of three lines. Then Gauss-Newton on frequency, decay and the
    amplitudes together, with time counted from the middle of the record, where the frequency and the
    phase are least correlated: the frequency is then accurate to rounding for clean data.
    """
    t, y = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if len(t) < 8:
        raise InputError(f"{len(t)} samples", source="sinusoid fit", expected="at least 8")
    scale = float(np.sqrt(np.mean((y - y.mean()) ** 2)))
    if not np.isfinite(scale) or scale < SMALLEST:
        raise InputError(
            "the samples do not oscillate", source="sinusoid fit", expected="finite, changing values"
        )
    middle = 0.5 * (t[0] + t[-1])
    tau = t - middle
    parameters = np.zeros(5)  # omega, decay, cosine, sine, offset
    parameters[0] = 2.0 * np.pi * _largest_line(t, y)
    parameters[2:] = np.linalg.lstsq(_columns(tau, parameters)[:, 2:], y, rcond=None)[0]
    free = np.array([0, 1, 2, 3, 4] if damped else [0, 2, 3, 4])
    change = np.array([np.inf])
    for _ in range(ITERATIONS):
        columns = _columns(tau, parameters)
        change = np.linalg.lstsq(columns[:, free], y - _model(tau, parameters), rcond=None)[0]
        parameters[free] += change
        if abs(change[0]) <= 1e-15 * abs(parameters[0]):
            break
    if not abs(change[0]) <= CONVERGED * abs(parameters[0]):
        raise InputError(
            "the fit does not converge", source="sinusoid fit", expected="one dominant frequency"
        )
    residual = float(np.sqrt(np.mean((y - _model(tau, parameters)) ** 2))) / scale
    omega, decay, a, b, offset = (float(p) for p in parameters)
    # amplitudes at t = 0 instead of the middle of the record
    growth, angle = np.exp(decay * middle), omega * middle
    cosine = growth * (a * np.cos(angle) - b * np.sin(angle))
    sine = growth * (a * np.sin(angle) + b * np.cos(angle))
    return Sinusoid(abs(omega) / (2.0 * np.pi), decay, float(cosine), float(sine), offset, residual)


def _model(tau: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    omega, decay, a, b, offset = p
    return np.exp(-decay * tau) * (a * np.cos(omega * tau) + b * np.sin(omega * tau)) + offset


def _columns(tau: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivatives of the model by omega, decay, cosine, sine and offset, shape (n, 5)."""
    omega, decay, a, b, _offset = p
    envelope = np.exp(-decay * tau)
    cos, sin = envelope * np.cos(omega * tau), envelope * np.sin(omega * tau)
    return np.stack(
        [tau * (b * cos - a * sin), -tau * (a * cos + b * sin), cos, sin, np.ones_like(tau)], axis=1
    )


def _largest_line(t: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Frequency of the largest spectral line [Hz]."""
    n = len(t)
    spectrum = np.abs(np.fft.rfft((y - y.mean()) * np.hanning(n)))
    spectrum[0] = 0.0
    k = int(np.argmax(spectrum))
    shift = 0.0
    if 1 <= k < len(spectrum) - 1 and spectrum[k - 1] > 0.0 and spectrum[k + 1] > 0.0:
        left, centre, right = np.log(spectrum[k - 1 : k + 2])
        curvature = left - 2.0 * centre + right
        shift = 0.5 * (left - right) / curvature if curvature < 0.0 else 0.0
    return float((k + shift) * (n - 1) / (n * (t[-1] - t[0])))
