"""Plots: spectra find what is in a signal, envelopes keep what is extreme, units read well."""

import io

import numpy as np
import pytest

from heavylift.pipeline.pictures import plots
from heavylift.pipeline.pictures.plots import Series, constant_parts, energy_plot, history_plot, spectrum_plot
from heavylift.pipeline.results.signals import amplitude_spectrum, envelope, scaled_unit, spectrum_peaks

INTERVAL = 1.0e-4
TIMES = np.arange(5000) * INTERVAL


def shape_and_ink(png):
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    return pixels.shape, float(np.mean(np.ptp(pixels, axis=2) > 40))


@pytest.mark.parametrize("frequency", [50.0, 123.4, 777.7])
def test_spectrum_peak_is_the_frequency_and_amplitude_of_a_sine(frequency):
    signal = 3.0 + 0.25 * np.sin(2.0 * np.pi * frequency * TIMES + 0.4)
    ((found, amplitude),) = spectrum_peaks(amplitude_spectrum(signal, INTERVAL))
    assert found == pytest.approx(frequency, abs=0.01)  # the resolution is 2 Hz
    assert amplitude == pytest.approx(0.25, rel=0.05)  # scalloping of a Hann window, zero padded


def test_spectrum_of_a_whole_number_of_periods_has_the_exact_amplitude():
    times = np.arange(4096) * INTERVAL
    frequency = 100 / (4096 * INTERVAL)
    spectrum = amplitude_spectrum(0.7 * np.cos(2.0 * np.pi * frequency * times), INTERVAL)
    line = np.argmin(np.abs(spectrum.frequencies - frequency))
    assert spectrum.amplitudes[line] == pytest.approx(0.7, rel=1e-12)


def test_peaks_are_the_sinusoids_and_not_their_side_lobes():
    parts = {100.0: 1.0, 250.3: 0.05, 1111.1: 0.4, 3000.0: 0.01}
    signal = sum(a * np.sin(2.0 * np.pi * f * TIMES + f) for f, a in parts.items())
    found = spectrum_peaks(amplitude_spectrum(signal, INTERVAL), count=10)
    np.testing.assert_allclose([f for f, _ in found], list(parts), rtol=1e-4)
    np.testing.assert_allclose([a for _, a in found], list(parts.values()), rtol=0.05)
    assert [round(f) for f, _ in spectrum_peaks(amplitude_spectrum(signal, INTERVAL), count=2)] == [100, 1111]
    assert spectrum_peaks(amplitude_spectrum(np.ones(100), INTERVAL)) == []


def test_noise_and_the_side_lobes_of_a_drift_are_no_peaks():
    drift = amplitude_spectrum(TIMES**2 + np.sin(2.0 * np.pi * 2.2 * TIMES), INTERVAL)
    assert spectrum_peaks(drift, floor=1e-9) == []
    noise = np.random.default_rng(5).normal(size=len(TIMES))
    assert spectrum_peaks(amplitude_spectrum(noise, INTERVAL)) == []
    sine = 2.0 * np.sin(2.0 * np.pi * 431.0 * TIMES)
    ((found, _),) = spectrum_peaks(amplitude_spectrum(sine + 0.5 * noise, INTERVAL))
    assert found == pytest.approx(431.0, abs=0.1)
    pair = sine + np.sin(2.0 * np.pi * 441.0 * TIMES)  # five widths apart
    found = [f for f, _ in spectrum_peaks(amplitude_spectrum(pair, INTERVAL))]
    np.testing.assert_allclose(found, [431.0, 441.0], atol=0.1)


def test_an_aliased_curve_is_named_and_its_peaks_are_not_labelled(monkeypatch):
    from matplotlib.axes import Axes

    written, names = [], []
    annotate, plot = Axes.annotate, Axes.plot
    monkeypatch.setattr(
        Axes, "annotate", lambda self, text, *a, **k: written.append(text) or annotate(self, text, *a, **k)
    )
    monkeypatch.setattr(
        Axes, "plot", lambda self, *a, **k: names.append(k.get("label")) or plot(self, *a, **k)
    )
    slow, fast = (np.sin(2.0 * np.pi * f * TIMES) for f in (300.0, 9000.0))  # 9 kHz shows at 1 kHz
    spectrum_plot(INTERVAL, [Series("a", slow), Series("b", fast, aliased=True)], title="t", unit="m")
    assert written == ["300 Hz"]
    assert "b (aliased)" in names


def test_envelope_keeps_every_extreme_in_order():
    generator = np.random.default_rng(1)
    times = np.arange(100_003) * 0.01
    values = generator.normal(size=len(times))
    values[77_777], values[3] = 50.0, -60.0
    t, y = envelope(times, values, 1000)
    assert len(t) <= 1002
    assert (np.diff(t) > 0.0).all()
    assert (y.max(), y.min()) == (50.0, -60.0)
    assert (t[0], t[-1]) == (times[0], times[-1])
    lookup = dict(zip(times, values, strict=True))
    assert all(lookup[a] == b for a, b in zip(t, y, strict=True))
    assert len(envelope(times[:1000], values[:1000], 1000)[0]) == 1000


@pytest.mark.parametrize(
    ("unit", "largest", "expected"),
    [
        ("m", 0.105, (1e-3, "mm")),
        ("s", 20.0, (1.0, "s")),
        ("s", 1280.0, (1.0, "s")),  # nobody counts in kiloseconds
        ("s", 0.02, (1e-3, "ms")),
        ("Pa", 2.1e11, (1e9, "GPa")),
        ("m/s^2", 5e-5, (1e-6, "µm/s^2")),
        ("N m", 3.2e4, (1e3, "kN m")),
        ("kg m/s", 2e-5, (1e-6, "10^-6 kg m/s")),
        ("m kg^0.5", 3e-7, (1e-9, "nm kg^0.5")),
        ("kg", 4.0, (1.0, "kg")),
        ("m", 0.0, (1.0, "m")),
        ("m", np.nan, (1.0, "m")),
    ],
)
def test_units_are_written_with_a_readable_prefix(unit, largest, expected):
    divisor, text = scaled_unit(unit, [np.array([0.0, -largest])])
    assert (pytest.approx(divisor, rel=1e-12), text) == expected


@pytest.mark.slow
def test_plots_are_drawn():
    sine = np.sin(2.0 * np.pi * 60.0 * TIMES)
    curves = [Series("x", 1e-3 * sine), Series("y & $ <b>", 2e-3 * sine**2), Series("z", 0.0 * sine)]
    plots = [
        history_plot(TIMES, curves, title="tip", unit="m"),
        history_plot(TIMES, curves, title="tip", unit="m", stacked=True),
        spectrum_plot(INTERVAL, curves, title="tip", unit="m", lines={"1": 60.0, "2": 61.0, "3": 9e9}),
        energy_plot(
            TIMES,
            {"kinetic": sine**2, "elastic": 1 - sine**2, "potential": 0 * sine, "balance": 1 + 1e-13 * sine},
        ),
        energy_plot(TIMES, {"kinetic": 0 * sine, "balance": 0 * sine}),
    ]
    for number, plot in enumerate(plots):
        shape, ink = shape_and_ink(plot)
        assert shape[1] == 1100
        assert shape[0] > 300
        assert ink > (0.002 if number < 4 else 0.0005)


@pytest.mark.parametrize("count", [2, 8])
def test_legends_have_rows_enough_for_their_words(monkeypatch, count):
    figures = []
    original = plots.figure_png
    monkeypatch.setattr(plots, "figure_png", lambda figure: figures.append(figure) or original(figure))
    curves = [Series(f"floating_crane_hook_{i + 1}", TIMES * i) for i in range(count)]
    history_plot(TIMES, curves, title="Hook loads", unit="N")
    (figure,) = figures
    box = figure.axes[0].get_legend().get_window_extent()
    title = figure._suptitle.get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.x1
    assert box.y1 <= figure.bbox.y1
    assert not box.overlaps(title)


def test_energies_at_rest_are_left_out_and_the_drift_is_relative(monkeypatch):
    from matplotlib.axes import Axes

    drawn = []
    original = Axes.plot
    monkeypatch.setattr(
        Axes,
        "plot",
        lambda self, x, y, **k: drawn.append((k.get("label"), np.array(y))) or original(self, x, y, **k),
    )
    time = np.linspace(0.0, 1.0, 50)
    energy_plot(time, {"kinetic": 4.0 + 0 * time, "potential": 0 * time, "balance": 4.0 + 8e-9 * time})
    assert [label for label, _ in drawn] == ["kinetic", None]
    assert drawn[1][1][-1] == pytest.approx(2.0)  # 2e-9 of the largest energy, in units of 1e-9


def test_what_does_not_change_is_subtracted_from_energies(monkeypatch):
    """The potential of a ship of 1.75 GJ hides 3 kJ of motion; a pendulum's potential, which comes near zero, stays."""
    from matplotlib.axes import Axes

    drawn = {}
    original = Axes.plot
    monkeypatch.setattr(
        Axes,
        "plot",
        lambda self, x, y, **k: drawn.update({k.get("label"): np.array(y)}) or original(self, x, y, **k),
    )
    time = np.linspace(0.0, 2.0 * np.pi, 200)
    kinetic = 3.0e3 * np.sin(time) ** 2
    energies = {"kinetic": kinetic, "potential": 1.75e9 - kinetic, "balance": 1.75e9 + 0 * time}
    assert constant_parts(energies) == {"potential": 1.75e9}
    energy_plot(time, energies)
    np.testing.assert_allclose(drawn["potential - 1.75 GJ"], -drawn["kinetic"], atol=1e-9)
    assert drawn["kinetic"].max() == pytest.approx(3.0, rel=1e-3)  # kJ
    assert constant_parts({"kinetic": kinetic, "potential": -kinetic, "balance": 0 * time}) == {}
    assert constant_parts({"kinetic": 4.0 + 1e-14 * np.sin(time), "balance": 4.0 + 0 * time}) == {}
