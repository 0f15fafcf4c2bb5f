"""Time histories made fit for a plot: envelopes of long ones, amplitude spectra, peaks, readable units."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Scaled", "Spectrum", "amplitude_spectrum", "envelope", "scaled_unit", "spectrum_peaks"]

_PREFIXES = ((1.0e9, "G"), (1.0e6, "M"), (1.0e3, "k"), (1.0, ""), (1.0e-3, "m"), (1.0e-6, "µ"), (1.0e-9, "n"))
_PROMINENCE = 10.0  # of a peak over its neighbourhood
_TAKES_PREFIX = re.compile(r"(m|s|N|J|W|Pa|Hz|rad)(?=$|[ /^])")


class Scaled(NamedTuple):
    """Unit for display: divide SI values by `divisor`, write `text`."""

    divisor: float
    text: str


class Spectrum(NamedTuple):
    """One-sided amplitude spectrum; shapes (nf,)."""

    frequencies: NDArray[np.float64]
    """[Hz]"""
    amplitudes: NDArray[np.float64]
    """In the unit of the signal."""
    width: float
    """One over the length of the history [Hz]; a peak is four times as wide."""


def envelope(
    times: NDArray[np.float64], values: NDArray[np.float64], count: int = 2000
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shorten a history to about `count` points that keep every local extreme of the drawn line.

    Parameters
    ----------
    times, values
        The history, shapes (nt,).
    count
        Histories of at most so many points are returned unchanged.

    Returns
    -------
    tuple
        Times and values, shapes (m,): first and last point, and the smallest and the largest value of each of
        count / 2 groups of successive points, in the order in which they occur.
    """
    if len(times) <= count:
        return times, values
    groups = max(1, count // 2)
    starts = (np.arange(groups) * len(times)) // groups
    ends = np.append(starts[1:], len(times))
    width = int((ends - starts).max())
    index = np.minimum(starts[:, None] + np.arange(width), ends[:, None] - 1)
    block = values[index]
    extreme = np.column_stack([block.argmin(axis=1), block.argmax(axis=1)])
    chosen = np.take_along_axis(index, extreme, axis=1).ravel()
    chosen = np.unique(np.concatenate([[0], chosen, [len(times) - 1]]))
    return times[chosen], values[chosen]


def amplitude_spectrum(values: NDArray[np.float64], interval: float) -> Spectrum:
    """Amplitude spectrum of a history at equal intervals, mean removed, under a Hann window.

    Parameters
    ----------
    values
        Samples, shape (nt,).
    interval
        Time between samples [s].

    Notes
    -----
    ``A_k = 2 |sum_n w_n (x_n - mean) exp(-2 pi i k n / N)| / sum_n w_n``, the mean weighted by w too: a
    sinusoid at a line of the spectrum shows with its amplitude. Zeros are appended to twice the length at
    least, so that a peak between two lines is not missed.
    """
    count = len(values)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    weight = max(float(window.sum()), np.finfo(float).tiny)
    size = 1 << int(np.ceil(np.log2(max(2 * count, 2))))
    transform = np.fft.rfft(window * (values - window @ values / weight), size)
    frequencies = np.arange(len(transform)) / (size * interval)
    return Spectrum(frequencies, 2.0 * np.abs(transform) / weight, 1.0 / (count * interval))


def spectrum_peaks(spectrum: Spectrum, *, count: int = 6, floor: float = 1.0e-3) -> list[tuple[float, float]]:
    """Frequency [Hz] and amplitude of the highest peaks, by frequency.

    Parameters
    ----------
    spectrum
        As `amplitude_spectrum` gives it.
    count
        At most so many.
    floor
        Smallest amplitude, relative to the largest.

    Notes
    -----
    A peak stands ten times above its neighbourhood beyond the main lobe of the window (`_neighbourhood`); side
    lobes, noise and the flanks of a slow drift do not. A sinusoid of amplitude A leaks at most
    ``A / (pi x (x^2 - 1))`` to a frequency x widths away through a Hann window, x > 2; what does not rise above
    twice that, summed over the higher peaks, what is slower than a peak is wide, and the mirror images at
    negative frequencies, is no peak. Frequencies are refined by a parabola through the logarithms of three lines.
    """
    f, a, width = spectrum
    if len(a) < 3 or not a.max() > 0.0:
        return []
    middle = np.arange(1, len(a) - 1)
    middle = middle[
        (a[middle] > a[middle - 1]) & (a[middle] >= a[middle + 1]) & (a[middle] > floor * a.max())
    ]
    found: list[tuple[float, float]] = []
    # what is slower than the main lobe is wide is no peak, but it leaks like one
    slow = int(np.argmax(a[: max(1, int(np.searchsorted(f, 2.0 * width, side="right")))]))
    sources = [(float(f[slow]), float(a[slow]))]
    for i in middle[np.argsort(-a[middle])]:
        left, top, right = np.log(np.maximum(a[i - 1 : i + 2], np.finfo(float).tiny))
        bend = left - 2.0 * top + right
        frequency = float(f[i] + (0.5 * (left - right) / bend if bend < 0.0 else 0.0) * (f[1] - f[0]))
        leaked = sum(_leakage(frequency, other, width) * height for other, height in (*sources, *found))
        if (
            frequency > 2.0 * width
            and a[i] > 2.0 * leaked
            and a[i] >= _PROMINENCE * _neighbourhood(spectrum, int(i))
        ):
            found.append((frequency, float(a[i])))
            if len(found) == count:
                break
    return sorted(found)


def _neighbourhood(spectrum: Spectrum, place: int) -> float:
    """Level of a spectrum two to six widths beside a line: outside the main lobe of a sinusoid there.

    The level of each width is its largest line, the top of a side lobe; of the eight, four on either side, the
    third smallest is taken, so that another sinusoid close by on one side does not hide this one.
    """
    f, a, width = spectrum
    step = width / (f[1] - f[0])  # lines a width, two or more
    tops = []
    for start in range(2, 6):
        near, far = int(np.ceil(start * step)), int(np.ceil((start + 1) * step))
        for low, high in ((place + near, place + far), (place - far + 1, place - near + 1)):
            part = a[max(low, 0) : max(high, 0)]
            if part.size:
                tops.append(float(part.max()))
    return sorted(tops)[min(2, len(tops) - 1)] if tops else 0.0


def _leakage(frequency: float, source: float, width: float) -> float:
    """Bound of the Hann window's transform between two frequencies and between one and the other's mirror image."""
    bound = 0.0
    for distance in (abs(frequency - source), frequency + source):
        x = distance / width
        bound += 1.0 / (np.pi * x * (x * x - 1.0)) if x > 2.0 else 1.0
    return bound


def scaled_unit(unit: str, arrays: Sequence[NDArray[np.float64]]) -> Scaled:
    """Prefix of a unit (or power of ten) that brings the largest of some SI values between 1 and 1000.

    Nobody counts time in kiloseconds: long ones are in seconds.

    Examples
    --------
    >>> scaled_unit("m/s", [np.array([0.012, -0.2])])
    Scaled(divisor=0.001, text='mm/s')
    >>> scaled_unit("kg m/s", [np.array([2e-5])])
    Scaled(divisor=1e-06, text='10^-6 kg m/s')
    """
    largest = max((float(np.abs(array).max(initial=0.0)) for array in arrays), default=0.0)
    if not (largest > 0.0 and np.isfinite(largest)):
        return Scaled(1.0, unit)
    # 0.9: what reaches almost to one is better read with its prefix than as 900 of the next
    prefixes = [(d, p) for d, p in _PREFIXES if unit != "s" or d <= 1.0]
    divisor, prefix = next(((d, p) for d, p in prefixes if largest >= 0.9 * d), prefixes[-1])
    if largest < 1.0e-3 * divisor or not _TAKES_PREFIX.match(unit):
        exponent = 3 * int(np.floor(np.log10(largest / 0.9) / 3.0))
        if -3 < exponent <= 3 and unit in {"", "-", "1"}:
            exponent = 0
        return Scaled(10.0**exponent, f"10^{exponent} {unit}") if exponent else Scaled(1.0, unit)
    return Scaled(divisor, prefix + unit)
