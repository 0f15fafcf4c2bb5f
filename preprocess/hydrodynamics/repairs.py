"""What panel codes leave missing or wrong in a database, repaired where possible, and reported with its size.

Panel codes break reciprocity and give damping that drives near irregular frequencies and where waves are shorter
than a few panels, leave NaN where a problem failed, and are often run without infinite frequency or without waves.
The time domain takes symmetric matrices, passive memory and the limit of the added mass that belongs to the damping
anyway (Ogilvie's relation, see `retardation`), so much of this is no reason to refuse a database. Deviations within
`PANEL_ACCURACY` are left as they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import (
    PANEL_ACCURACY,
    Limits,
    at_frequencies,
    check_axes,
    check_bodies,
    check_database,
    check_phase,
    check_shapes,
    coordinate_name,
    database_faults,
    fault_error,
    length_scales,
    mass_scales,
)
from heavylift.preprocess.hydrodynamics.plausibility import check_plausibility
from heavylift.preprocess.hydrodynamics.retardation import infinite_added_mass, ogilvie_deviation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import Fault, HydrodynamicDatabase

__all__ = [
    "FELT_MASS",
    "FEWEST",
    "LARGEST_TOLERANCE",
    "TOLERANCE",
    "Repair",
    "implied_scatter",
    "passive_damping",
    "refuse_between",
    "remedies",
    "repaired",
]

TOLERANCE = 0.1
"""Of the largest: unsymmetric matrices and driving damping up to this are repaired if nothing else is asked for."""

INCONSISTENT = 0.1
"""Of the added mass: how far its limit may be from what the damping implies before anything has to be done."""

FELT_MASS = 0.01
"""Of the mass of a hull and the water with it: an added mass that is smaller need not be known better than this."""

FEWEST = 3
"""Frequencies that have to be left; a kernel of memory needs as many."""

FEW = 4
"""At most one in so many frequencies is proposed to be left out."""

LARGEST_TOLERANCE = 0.5
"""Above it a whole matrix is implausible."""

ROUND = 1e-9

FELT_DAMPING = 1e-3
"""Of the critical damping: smaller changes are not reported."""

PROJECTIONS, ENOUGH = 200, 1e-3
"""At most, and the eigenvalue below zero of correlations at which they end; the rest is scaled away."""


@dataclass(frozen=True)
class Repair:
    """What of a database is used, and what may be repaired.

    Attributes
    ----------
    frequency_range
        Lowest and highest frequency that are used [rad/s]; None: all.
    leave_out
        The nearest frequencies are left out [rad/s]; in between is interpolated.
    symmetrise
        Whether unsymmetric matrices and damping that drives are repaired. Without, they are refused.
    tolerance
        How much of it is repaired, as a share of the largest entry or eigenvalue; more is refused.

    Raises
    ------
    InputError
        A number that is none, a range upside down, a frequency to be left out that is not positive, a tolerance of one
        or more.
    """

    frequency_range: tuple[float, float] | None = None
    leave_out: tuple[float, ...] = ()
    symmetrise: bool = True
    tolerance: float = TOLERANCE

    def __post_init__(self) -> None:
        low, high = self.frequency_range or (0.0, np.inf)
        for key, good, expected in (
            ("frequency_range", 0.0 <= low < high, "[lowest, highest] in rad/s"),
            ("leave_out", all(0.0 < omega < np.inf for omega in self.leave_out), "frequencies > 0 [rad/s]"),
            ("tolerance", 0.0 <= self.tolerance < 1.0, "a share of the largest, from 0 to less than 1"),
        ):
            if not good:  # comparisons with what is not a number are false
                raise InputError(f"{getattr(self, key)}", source="Repair", key=key, expected=expected)

    @property
    def limits(self) -> Limits:
        """Beyond these a database is refused."""
        if not self.symmetrise:
            return PANEL_ACCURACY
        return Limits(
            max(self.tolerance, PANEL_ACCURACY.unsymmetric), max(self.tolerance, PANEL_ACCURACY.negative)
        )


def repaired(
    database: HydrodynamicDatabase, repair: Repair | None = None, *, more: Sequence[str] = ()
) -> HydrodynamicDatabase:
    """A database that can be true, with sentences about all that was repaired in `repairs`.

    Parameters
    ----------
    database
        As a file has it, or as it was computed. Entries may be NaN, the whole limit of infinite frequency too.
    repair
        What may be done; by default up to 10 % of the largest entry.
    more
        What may help besides if matrices are refused, for the message.

    Raises
    ------
    InputError
        What cannot be repaired, with file, entry and what to set; what `check_database`, `check_phase` and
        `check_plausibility` refuse.
    """
    repair = repair or Repair()
    check_shapes(database)
    check_axes(database)
    check_bodies(database)
    if not database.has_excitation:
        database = _told(database, "no exciting forces: for motions in still water")
    for step in (_asked, _finite):
        database = step(database, repair)
    faults = database_faults(database, repair.limits)
    if faults:
        words = [*more, *remedies(database, faults, repair)]
        raise fault_error(database, faults, repair.limits, "; or ".join(words))
    for step in (_symmetric, _dissipative, _with_limit):
        database = step(database, repair)
    check_database(database)
    check_phase(database)
    check_plausibility(database)
    return database


def remedies(
    database: HydrodynamicDatabase, faults: Sequence[Fault], repair: Repair | None = None
) -> list[str]:
    """Keys to set against matrices that are refused."""
    repair = repair or Repair()
    omega = database.omega
    bad = np.array(sorted({fault.omega for fault in faults if np.isfinite(fault.omega)}))
    good = np.setdiff1d(omega, bad)
    words = []
    if len(bad) and len(good) >= FEWEST:
        if bad[0] > good[-1] and len(bad) <= len(omega) // 2:
            words.append(f"'frequency_range = [{_down(omega[0])}, {_down(good[-1], up=True)}]'")
        elif bad[-1] < good[0] and len(bad) <= len(omega) // FEW:
            words.append(f"'frequency_range = [{_down(good[0])}, {_down(omega[-1], up=True)}]'")
        elif len(bad) <= len(omega) // FEW:
            words.append(f"'leave_out = [{', '.join(f'{w:.4g}' for w in bad)}]'")
    size = max(abs(fault.size) for fault in faults)
    if not repair.symmetrise:
        words.append("'symmetrise = true'")
    elif size < LARGEST_TOLERANCE:
        words.append(f"'tolerance = {np.ceil(100.0 * size + 0.5) / 100.0:g}' if that is good enough")
    return words or ["a finer mesh, or a lid against irregular frequencies"]


def _down(omega: float, *, up: bool = False) -> str:
    """A frequency in few digits, not above it, or not below it."""
    step = 10.0 ** (np.floor(np.log10(omega)) - 3.0)
    return f"{(np.ceil(omega / step - ROUND) if up else np.floor(omega / step + ROUND)) * step:.4g}"


MEANT = 0.1
"""Of the step to the next frequency: how far from one a number still means it."""
SHOWN = 8
"""Frequencies that a sentence names."""


def refuse_between(wanted: float, omega: NDArray[np.float64], source: str = "") -> None:
    """Refuse a frequency that is to be left out and is none: its neighbours are good, and would go in its place.

    Parameters
    ----------
    wanted
        What is to be left out [rad/s].
    omega
        Frequencies that there are [rad/s], increasing.
    source
        Of the message.

    Raises
    ------
    InputError
        With the nearest ones.
    """
    at = int(np.argmin(np.abs(omega - wanted)))
    steps = np.diff(omega)[max(at - 1, 0) : at + 1]
    if abs(omega[at] - wanted) > MEANT * float(min(steps, default=0.0)) + 5e-4 * wanted:
        near = " and ".join(f"{w:.6g}" for w in np.sort(omega[np.argsort(np.abs(omega - wanted))[:2]]))
        raise InputError(
            f"{wanted:.6g} rad/s is none of the frequencies",
            source=source,
            key="leave_out",
            expected=f"frequencies from {omega[0]:.6g} to {omega[-1]:.6g} rad/s that are there; the nearest are {near}",
        )


# ---- steps ----


def _asked(database: HydrodynamicDatabase, repair: Repair) -> HydrodynamicDatabase:
    """Frequencies of the range that is asked for, without those that are to be left out."""
    omega = database.omega
    kept = np.ones(len(omega), dtype=bool)
    if repair.frequency_range is not None:
        low, high = repair.frequency_range
        kept = (omega >= low * (1.0 - ROUND)) & (omega <= high * (1.0 + ROUND))
        if not kept.any():
            raise _few(database, kept, f"from {low:g} to {high:g} rad/s", "frequency_range")
    for wanted in repair.leave_out:
        at = int(np.argmin(np.abs(omega - wanted)))
        refuse_between(wanted, omega, database.source)
        kept[at] = False
    if kept.all():
        return database
    if kept.sum() < FEWEST:
        raise _few(database, kept, "", "leave_out" if repair.leave_out else "frequency_range")
    left, gone = omega[kept], omega[~kept]
    which = ", ".join(f"{w:.4g}" for w in gone[:SHOWN]) + (", ..." if len(gone) > SHOWN else "")
    return _told(
        at_frequencies(database, kept),
        f"{len(gone)} of {len(omega)} frequencies left out as asked ({which} rad/s); "
        f"{left[0]:.4g} to {left[-1]:.4g} rad/s are used",
    )


def _finite(database: HydrodynamicDatabase, _repair: Repair) -> HydrodynamicDatabase:
    """Without the frequencies at which something is not finite: problems that failed, or were not solved."""
    kept = np.ones(len(database.omega), dtype=bool)
    first = ""
    for key in ("added_mass", "damping", "excitation", "drift"):
        values = getattr(database, key)
        if values is None:
            continue
        bad = ~np.isfinite(values)
        at = bad.reshape(len(kept), -1).any(axis=1)
        if at.any() and not first:
            first = _entry(database, key, tuple(int(i) for i in np.argwhere(bad)[0]))
        kept &= ~at
    if kept.all():
        return database
    if kept.sum() < FEWEST:
        raise _few(database, kept, f"with finite numbers: there is no {first}", "omega")
    omega = database.omega
    return _told(
        at_frequencies(database, kept),
        f"no finite numbers at {np.count_nonzero(~kept)} of {len(omega)} frequencies ({_between(omega[~kept])}; "
        f"first {first}): left out",
    )


def _symmetric(database: HydrodynamicDatabase, repair: Repair) -> HydrodynamicDatabase:
    """Symmetric parts of the matrices that are further from symmetric than panel codes."""
    if not repair.symmetrise:
        return database
    faults = [fault for fault in database_faults(database) if fault.size > 0.0]
    for key in dict.fromkeys(fault.key for fault in faults):
        own = [fault for fault in faults if fault.key == key]
        worst = max(own, key=lambda fault: fault.size)
        name = "-".join(coordinate_name(database, i) for i in sorted(worst.entries))
        where = _most([fault.omega for fault in own], worst.omega)
        values = getattr(database, key)
        database = _told(
            replace(database, **{key: 0.5 * (values + np.swapaxes(values, -1, -2))}),
            f"{key.replace('_', ' ')} of {name} unsymmetric by {worst.size:.1%} of the largest {where}: symmetrised",
        )
    return database


def _dissipative(database: HydrodynamicDatabase, repair: Repair) -> HydrodynamicDatabase:
    """Damping that takes energy away from every motion, where it is further from that than panel codes are.

    Couplings count against the damping of their coordinates, not against the largest of all: what is little beside
    the flap of a wave maker drives the base below it all the same.
    """
    if not repair.symmetrise:
        return database
    symmetric = 0.5 * (database.damping + np.swapaxes(database.damping, 1, 2))
    at, passive = passive_damping(symmetric)
    if not len(at):
        return database
    own = np.diagonal(symmetric, axis1=1, axis2=2)
    omega = float(database.omega[np.argmax(own @ length_scales(database) ** 2)])
    size = np.sqrt(np.maximum(own.max(axis=0), 2.0 * FELT_DAMPING * mass_scales(database) * omega))
    share = np.abs(passive - symmetric[at]) / np.outer(size, size)
    share[:, np.arange(len(size)), np.arange(len(size))] = 0.0
    beyond = share.max(axis=(1, 2)) > PANEL_ACCURACY.unsymmetric
    faults = [fault for fault in database_faults(database) if fault.size < 0.0]
    if not faults and not beyond.any():
        return database
    damping = database.damping.copy()
    damping[at] = passive
    database = replace(database, damping=damping)
    if faults:
        worst = min(faults, key=lambda fault: fault.size)
        database = _told(
            database,
            f"negative damping of {coordinate_name(database, worst.entries[0])}, {worst.size:.1%} of the largest "
            f"{_most([fault.omega for fault in faults], worst.omega)}: set to zero",
        )
    if beyond.any():
        w, i, j = (int(v) for v in np.unravel_index(np.argmax(share), share.shape))
        name = "-".join(coordinate_name(database, k) for k in sorted((i, j)))
        where = _most(list(database.omega[at[beyond]]), float(database.omega[at[w]]))
        database = _told(
            database,
            f"damping of {name} beyond what that of the two coordinates allows, by {share[w, i, j]:.0%} of their "
            f"largest {where}: the nearest passive coupling is taken",
        )
    return database


def passive_damping(damping: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Nearest matrices that only take energy away, where damping is none: places of frequencies, and the matrices.

    Parameters
    ----------
    damping
        Symmetric, shape (nw, n, n).

    Notes
    -----
    A negative damping of a coordinate becomes zero, with its couplings. That of the others is kept, so that each moves
    by itself as before, and B_ij / sqrt(B_ii B_jj) becomes the nearest matrix of correlations: alternating projections
    of Higham, Computing the nearest correlation matrix, IMA J. Numer. Anal. 22 (2002).
    """
    own = np.diagonal(damping, axis1=1, axis2=2)
    positive = own > 0.0
    size = np.sqrt(np.where(positive, own, 1.0))
    both = positive[:, :, None] & positive[:, None, :]
    C = np.where(both, damping / (size[:, :, None] * size[:, None, :]), 0.0)
    diagonal = np.arange(damping.shape[1])
    C[:, diagonal, diagonal] = 1.0
    dropped = (np.abs(np.where(both, 0.0, damping)) > 0.0).any(axis=(1, 2))
    at = np.flatnonzero((np.linalg.eigvalsh(C)[:, 0] < -ROUND) | dropped)
    Y = np.clip(C[at], -1.0, 1.0)
    correction = np.zeros_like(Y)
    for _ in range(PROJECTIONS):
        wanted = Y - correction
        values, vectors = np.linalg.eigh(wanted)
        X = np.einsum("wik,wk,wjk->wij", vectors, np.maximum(values, 0.0), vectors)
        correction = X - wanted
        Y = X.copy()
        Y[:, diagonal, diagonal] = 1.0
        if len(at) == 0 or np.linalg.eigvalsh(Y)[:, 0].min() > -ENOUGH:
            break
    if len(at):
        root = np.sqrt(np.diagonal(X, axis1=1, axis2=2))
        Y = X / (root[:, :, None] * root[:, None, :])
    return at, np.where(both[at], Y * size[at][:, :, None] * size[at][:, None, :], 0.0)


def _with_limit(database: HydrodynamicDatabase, repair: Repair) -> HydrodynamicDatabase:
    """Added mass of infinite frequency, found from the damping where there is none or one that is off but tolerated.

    One that is off by more is left: it matters in the time domain alone, which refuses it.
    """
    given = database.added_mass_infinite
    if np.isfinite(given).all():
        if not repair.symmetrise or repair.tolerance <= INCONSISTENT or len(database.omega) < FEWEST:
            return database
        least = FELT_MASS * mass_scales(database)
        deviation = ogilvie_deviation(database.omega, database.added_mass, database.damping, given, least)
        i, j = (int(v) for v in np.unravel_index(np.argmax(deviation), deviation.shape))
        if not INCONSISTENT < deviation[i, j] <= repair.tolerance:
            return database
        name = "-".join(coordinate_name(database, k) for k in sorted((i, j)))
        return _told(
            replace(database, added_mass_infinite=_implied(database)[0]),
            f"added mass of infinite frequency of {name} off by {deviation[i, j]:.1%} of what the damping implies: "
            "all of it found from the damping by Ogilvie's relation",
        )
    value, spread = _implied(database)
    scatter = _relative(database, spread)
    if scatter > max(INCONSISTENT, repair.tolerance):
        raise InputError(
            f"no added mass of infinite frequency, and what damping implies scatters by {scatter:.1%}",
            source=database.source,
            key="added_mass_infinite",
            expected="a run with infinite frequency, or damping up to frequencies where it has decayed",
        )
    return _told(
        replace(database, added_mass_infinite=value),
        "no added mass of infinite frequency: found from the damping by Ogilvie's relation, "
        f"which scatters by {max(scatter, 1e-4):.2%} over these frequencies and neglects damping beyond them",
    )


def implied_scatter(database: HydrodynamicDatabase) -> float:
    """How far added mass and damping are from belonging to each other over the frequencies, of the added mass.

    Ogilvie's relation gives the added mass of infinite frequency at each frequency; of a true database all are one.

    Raises
    ------
    InputError
        Too few frequencies.
    """
    return _relative(database, _implied(database)[1])


def _relative(database: HydrodynamicDatabase, spread: NDArray[np.float64]) -> float:
    """Largest entry of a matrix of masses over the largest added masses of its coordinates."""
    largest = np.abs(np.diagonal(database.added_mass, axis1=1, axis2=2)).max(axis=0)
    largest = np.maximum(largest, FELT_MASS * mass_scales(database))
    return float((spread / np.sqrt(np.outer(largest, largest))).max())


def _implied(database: HydrodynamicDatabase) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if len(database.omega) < FEWEST:
        raise InputError(
            f"no added mass of infinite frequency, and {len(database.omega)} others",
            source=database.source,
            key="added_mass_infinite",
            expected=f"infinite frequency (period 0), or {FEWEST} frequencies or more from whose damping it is found",
        )
    return infinite_added_mass(database.omega, database.added_mass, database.damping, source=database.source)


# ---- words ----


def _told(database: HydrodynamicDatabase, sentence: str) -> HydrodynamicDatabase:
    if sentence in database.repairs:  # repaired before
        return database
    return replace(database, repairs=(*database.repairs, sentence))


def _between(omega: NDArray[np.float64]) -> str:
    """One frequency, a few, or a range."""
    if len(omega) <= FEW:
        return ", ".join(f"{w:.4g}" for w in omega) + " rad/s"
    return f"between {omega[0]:.4g} and {omega[-1]:.4g} rad/s"


def _most(omega: Sequence[float], worst: float) -> str:
    """Where the worst is, and how many others there are."""
    at = f"at {worst:.4g} rad/s" if np.isfinite(worst) else "at infinite frequency"
    return at if len(omega) == 1 else f"{at} (the worst of {len(omega)} frequencies)"


def _few(database: HydrodynamicDatabase, kept: NDArray[np.bool_], which: str, key: str) -> InputError:
    omega = database.omega
    return InputError(
        f"{np.count_nonzero(kept)} of {len(omega)} frequencies are left" + (f" {which}" if which else ""),
        source=database.source,
        key=key,
        expected=f"{FEWEST} or more of those from {omega[0]:.4g} to {omega[-1]:.4g} rad/s",
    )


def _entry(database: HydrodynamicDatabase, key: str, place: tuple[int, ...]) -> str:
    """A matrix entry or a force in words."""
    w = f"{database.omega[place[0]]:.4g} rad/s"
    name: Callable[[int], str] = lambda i: coordinate_name(database, i)  # noqa: E731
    if key in {"excitation", "drift"}:
        return f"{key} of {name(place[2])} at {w}, {np.rad2deg(database.headings[place[1]]):g} deg"
    return f"{key.replace('_', ' ')} of {name(place[1])}-{name(place[2])} at {w}"
