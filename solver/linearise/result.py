"""What a linearisation says: matrices with names and units, and modes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

__all__ = ["BodyShape", "Linearisation"]

Complex = NDArray[np.complex128]

GROWS = 1e-6
"""Damping ratio, with the opposite sign, beyond which a mode is said to grow."""

NAMED = 3
"""Motions that a line of the table names."""

SHARE = 0.05
"""Of the energy of a mode, from which on a motion is named."""


@dataclass(frozen=True, eq=False)
class BodyShape:
    """How the bodies move in the modes, times the same complex number for all.

    Attributes
    ----------
    displacement
        Of its origin, which `position` records, world axes [m], shape (modes, 3); of frames, rods, shells and cables of
        all nodes, shape (modes, nodes, 3).
    rotation
        World axes [rad], shape (modes, 3).
    """

    displacement: Complex
    rotation: Complex


@dataclass(frozen=True, eq=False)
class Linearisation:
    """Small motions about a state, of deviations from it: ``x' = A x + B u``, ``y = C x + D u``.

    Attributes
    ----------
    time
        Of the state [s].
    A, B, C, D
        Shapes (n, n), (n, inputs), (outputs, n), (outputs, inputs). An input that is a position or length has two
        columns, its value and its rate.
    states, state_units
        Names and units of x: displacements as ``load.x`` (of the centre of mass, world axes) and ``load.rotation.1``
        (about principal axes of the body), then their velocities, then what else has a state.
    inputs, input_units, outputs, output_units
        Names and units of u and y.
    eigenvalues
        Of A [1/s], of each pair the one with a positive imaginary part, by modulus. Motions that nothing holds come
        first, with a zero each.
    vectors
        Eigenvectors that belong to them, shape (n, modes); of motions that nothing holds their displacements.
    zeros
        How many eigenvalues of A are zero, two for each motion that nothing holds or brakes.
    shapes
        How bodies move in the modes, by name.
    participation
        Parts of each body in the kinetic energy of the modes, by name, shape (modes, 3): its translation, its
        rotation and its deformation. Water that moves with a hull is left out.
    water, water_states
        Part that the memory of the water about hulls has in the modes, shape (modes,), and how many states it has.
    driven_states
        How many states are places of what inputs drive: modes are those with them as they are.
    residual
        Acceleration that is left at the state, root of its mean square over the masses [m/s2]; rounding in balance.
    speed
        Velocity of the state, likewise [m/s].
    warnings
        What limits the use of all this, as sentences.

    Examples
    --------
    >>> import heavylift as hl
    >>> modes = hl.Simulation("cases/hoist").linearise(outputs=["fall.tension"])
    >>> modes.A.shape, modes.C.shape, modes.output_units
    ((12, 12), (1, 12), ('N',))
    >>> print(modes.words(-1))
    1.007 Hz, period 0.9935 s, damping 0: load z 100 %
    """

    time: float
    A: NDArray[np.float64]
    B: NDArray[np.float64]
    C: NDArray[np.float64]
    D: NDArray[np.float64]
    states: tuple[str, ...]
    state_units: tuple[str, ...]
    inputs: tuple[str, ...]
    input_units: tuple[str, ...]
    outputs: tuple[str, ...]
    output_units: tuple[str, ...]
    eigenvalues: Complex
    vectors: Complex
    zeros: int
    shapes: Mapping[str, BodyShape]
    participation: Mapping[str, NDArray[np.float64]]
    water: NDArray[np.float64]
    water_states: int
    driven_states: int
    residual: float
    speed: float
    warnings: tuple[str, ...] = ()

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Natural frequencies of the modes [Hz], ``|s| / 2 pi`` of pairs, 0 of real eigenvalues."""
        s = self.eigenvalues
        return np.where(s.imag > 0.0, np.abs(s) / (2.0 * np.pi), 0.0)

    @property
    def damping(self) -> NDArray[np.float64]:
        """Damping ratios of the modes, ``-Re s / |s|``; 0 of motions that nothing holds."""
        size = np.abs(self.eigenvalues)
        return np.where(size > 0.0, -self.eigenvalues.real / np.where(size > 0.0, size, 1.0), 0.0)

    @property
    def unstable(self) -> NDArray[np.int64]:
        """Numbers of the modes that grow, faster than rounding lets a mode grow that does not."""
        size = np.abs(self.eigenvalues)
        return np.flatnonzero(self.eigenvalues.real > GROWS * size)

    @property
    def of_bodies(self) -> NDArray[np.int64]:
        """Numbers of the modes that are motions of bodies, as many as these have, by the smallest part of the water."""
        left = len(self.states) - self.water_states - self.driven_states - self.zeros
        chosen = np.flatnonzero(self.eigenvalues == 0.0).tolist()
        moving = np.flatnonzero(self.eigenvalues != 0.0)
        for mode in moving[np.argsort(self.water[moving], kind="stable")].tolist():
            left -= 2 if self.eigenvalues[mode].imag > 0.0 else 1
            if left < 0:
                break
            chosen.append(mode)
        return np.sort(np.array(chosen, dtype=np.int64))

    def transfer(self, omega: NDArray[np.float64] | float) -> Complex:
        """Outputs by inputs that oscillate, ``C (i omega - A)^-1 B + D``.

        Parameters
        ----------
        omega
            Angular frequencies [rad/s], shape (k,) or a single one.

        Returns
        -------
        NDArray
            Complex, shape (k, outputs, inputs), or (outputs, inputs) of a single frequency.

        Raises
        ------
        InputError
            If there is no answer: at a frequency of an undamped mode, or at 0 with a motion that is free.
        """
        each = np.atleast_1d(np.asarray(omega, dtype=np.float64))
        eye = np.eye(len(self.A))
        try:
            found = np.array([self.C @ np.linalg.solve(1j * w * eye - self.A, self.B) + self.D for w in each])
        except np.linalg.LinAlgError:
            found = np.array(np.nan)
        if not np.all(np.isfinite(found)):
            raise InputError(
                f"no answer at {np.ndarray.tolist(each)} rad/s",
                source="linearisation",
                key="omega",
                expected="finite frequencies: none of an undamped mode, nor 0 with a motion that is free",
            )
        return found if np.ndim(omega) else np.asarray(found[0])

    def table(self, count: int | None = None) -> str:
        """The modes in lines of text: frequency, period, damping, and what moves most.

        Parameters
        ----------
        count
            How many modes; all if None.
        """
        lines = [f"{'mode':>4}  {'frequency':>11}  {'period':>10}  {'damping':>9}  what moves"]
        of_bodies = self.of_bodies
        for mode in of_bodies[:count].tolist():
            s = self.eigenvalues[mode]
            if s == 0.0:
                what = f"{'free':>11}  {'':>10}  {'':>9}"
            elif s.imag == 0.0:
                word = "grows in" if s.real > 0.0 else "fades in"
                what = f"{word:>11}  {1.0 / abs(s.real):8.4g} s  {'':>9}"
            else:
                frequency, damping = float(self.frequencies[mode]), self._damping(mode)
                what = f"{frequency:8.4g} Hz  {1.0 / frequency:8.4g} s  {damping:9.2g}"
            lines.append(f"{mode + 1:>4}  {what}  {self._movers(mode)}")
        if len(of_bodies) > len(lines) - 1:
            lines.append(f"and {len(of_bodies) - len(lines) + 1} faster ones")
        if len(of_bodies) < len(self.eigenvalues):
            lines.append(f"and {len(self.eigenvalues) - len(of_bodies)} of the memory of the water")
        return "\n".join(lines)

    def words(self, mode: int) -> str:
        """A mode as words: frequency, period, damping, and what moves most.

        Parameters
        ----------
        mode
            Its number, from 0 on.
        """
        s, frequency = self.eigenvalues[mode], float(self.frequencies[mode])
        if s == 0.0:
            what = "free"
        elif frequency == 0.0:
            what = f"{'grows' if s.real > 0.0 else 'fades'} in {1.0 / abs(s.real):.4g} s"
        else:
            what = f"{frequency:.4g} Hz, period {1.0 / frequency:.4g} s, damping {self._damping(mode):.2g}"
        return f"{what}: {self._movers(mode)}"

    def _damping(self, mode: int) -> float:
        """Damping ratio without its rounding."""
        damping = float(self.damping[mode])
        return damping if abs(damping) > GROWS else 0.0

    def _movers(self, mode: int) -> str:
        """What has most of the energy: bodies, and the axes of the world along or about which they move most."""
        parts = []
        for name, shares in self.participation.items():
            shape = self.shapes[name]
            along = "xyz"[int(np.abs(shape.displacement[mode]).reshape(-1, 3).max(axis=0).argmax())]
            about = "xyz"[int(np.abs(shape.rotation[mode]).argmax())]
            for way, share in zip((along, f"about {about}", "bending"), shares[mode], strict=True):
                parts.append((float(share), f"{name} {way}"))
        parts.sort(key=lambda part: -part[0])
        return ", ".join(f"{what} {100.0 * share:.0f} %" for share, what in parts[:NAMED] if share >= SHARE)
