"""Input of MoorDyn for a mooring line, and what a catenary does not need to know of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.moorings import check_sections
from heavylift.solver.water.lines.placed_line import hang_line

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = ["LineDynamics", "moordyn_input"]

SEABED_STIFFNESS, SEABED_DAMPING = 3.0e6, 3.0e5
"""[Pa/m], [Pa s/m]: of MoorDyn's examples."""
DEEP = 1.0e4
"""Depth [m] of a line without a seabed."""
STEP_PART = 0.8
"""Inner time step of MoorDyn times the largest frequency of a segment: explicit, and the damping is large."""
REST_TIME = 60.0
"""Time [s] that a line may take to come to rest at the start."""


@dataclass(frozen=True)
class LineDynamics:
    """What a catenary does not need to know of a line, but its motion does.

    Attributes
    ----------
    masses
        Of each section a length, in air [kg/m]. What a section weighs less in water gives its displaced volume and
        thereby the diameter that drag and added mass refer to.
    drag, axial_drag, added_mass, axial_added_mass
        Coefficients of a cylinder of that diameter, across and along the line: the defaults are those of studless
        chain by DNV-OS-E301 with the diameter of equal volume, 1.8 times that of the bar.
    damping
        Of the elongation, as part of the critical damping of a segment.
    segment
        Longest segment [m].
    """

    masses: tuple[float, ...]
    drag: float = 1.33
    axial_drag: float = 0.64
    added_mass: float = 1.0
    axial_added_mass: float = 0.5
    damping: float = 0.8
    segment: float = 10.0


def moordyn_input(
    line: MooringLine,
    dynamics: LineDynamics,
    anchor: NDArray[np.float64],
    fairlead: NDArray[np.float64],
    *,
    level: float = 0.0,
    density: float = 1025.0,
    gravity: float = 9.80665,
    anchor_moves: bool = False,
) -> str:
    """Input file of MoorDyn (version 2) for one line.

    Parameters
    ----------
    line, dynamics
        The line.
    anchor, fairlead
        Its ends at the start, world [m], shape (3,).
    level
        Height of the water [m]; MoorDyn has it at zero.
    density, gravity
        Of the water [kg/m3], [m/s2].
    anchor_moves
        Whether the anchor is on a body.

    Raises
    ------
    InputError
        If the masses do not fit the sections or weigh less in air than the sections in water, one does not stretch, or
        the seabed slopes.

    Notes
    -----
    Joints of sections are free points, which begin where the catenary has them; a clump is a mass without volume
    there, a buoy a volume without mass.
    """
    check_sections(line.sections, line.clumps, friction=line.friction, source=line.name)
    if len(dynamics.masses) != len(line.sections):
        raise InputError(
            f"{len(dynamics.masses)} masses of {len(line.sections)} sections",
            source=line.name,
            key="masses",
            expected="one mass a length [kg/m] a section",
        )
    if line.seabed_slope is not None:
        raise InputError(
            "the seabed slopes",
            source=line.name,
            key="seabed_slope",
            expected="a level seabed, for --moordyn",
        )
    types, points, lines = [], [], []
    step = np.inf
    shift = np.array([0.0, 0.0, level])
    joints = _joints(line, anchor, fairlead)
    for number, (section, mass) in enumerate(zip(line.sections, dynamics.masses, strict=True), start=1):
        displaced = mass - section.weight / gravity
        if not (mass > 0.0 and displaced >= -1e-6 * mass):
            raise InputError(
                f"a mass of {mass:g} kg/m weighs less in air than the section in water, {section.weight:g} N/m",
                source=line.name,
                key=f"masses.{number - 1}",
                expected=f"more than {section.weight / gravity:g} kg/m",
            )
        if not np.isfinite(section.axial_stiffness):
            raise InputError(
                f"section {number} does not stretch",
                source=line.name,
                key=f"sections.{number - 1}.axial_stiffness",
                expected="a finite EA [N]: MoorDyn integrates the waves along the line",
            )
        diameter = max(np.sqrt(4.0 * max(displaced, 0.0) / (np.pi * density)), 1e-4)
        types.append(
            f"type{number} {diameter:.12g} {mass:.12g} {section.axial_stiffness:.12g} {-dynamics.damping:g} 0"
            f" {dynamics.drag:g} {dynamics.added_mass:g} {dynamics.axial_drag:g} {dynamics.axial_added_mass:g}"
        )
        count = max(2, int(np.ceil(section.length / dynamics.segment)))
        step = min(step, 0.5 * STEP_PART * section.length / count * np.sqrt(mass / section.axial_stiffness))
        lines.append(f"{number} type{number} {number} {number + 1} {section.length:.12g} {count} -")
    clumps = [0.0, *(line.clumps or [0.0] * (len(line.sections) - 1)), 0.0]
    places = [anchor, *joints, fairlead]
    kinds = [
        "Coupled" if anchor_moves else "Fixed",
        *(["Free"] * len(joints)),
        "Coupled",
    ]
    for number, (place, kind, clump) in enumerate(zip(places, kinds, clumps, strict=True), start=1):
        x, y, z = np.asarray(place) - shift
        mass, volume = max(clump, 0.0) / gravity, max(-clump, 0.0) / (density * gravity)
        points.append(f"{number} {kind} {x:.12g} {y:.12g} {z:.12g} {mass:.12g} {volume:.12g} 0 0")
    depth = DEEP if line.seabed is None else level - line.seabed
    return "\n".join(
        [
            f"Mooring line {line.name}",
            "---------------------- LINE TYPES ----------------------",
            "Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx",
            "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)",
            *types,
            "---------------------- POINTS ----------------------",
            "ID Attachment X Y Z Mass Volume CdA Ca",
            "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)",
            *points,
            "---------------------- LINES ----------------------",
            "ID LineType AttachA AttachB UnstrLen NumSegs Outputs",
            "(#) (name) (#) (#) (m) (-) (-)",
            *lines,
            "---------------------- OPTIONS ----------------------",
            "0 writeLog",
            "1 disableOutput",
            "1 disableOutTime",
            f"{step:.6g} dtM",
            f"{depth:.12g} WtrDpth",
            f"{density:.12g} WtrDnsty",
            f"{gravity:.12g} gravity",
            f"{SEABED_STIFFNESS:g} kBot",
            f"{SEABED_DAMPING:g} cBot",
            f"{line.friction:g} FrictionCoefficient",
            f"{REST_TIME:g} TmaxIC",
            "0.0001 threshIC",
            "---------------------- OUTPUTS ----------------------",
            "---------------------- END ----------------------",
            "",
        ]
    )


def _joints(
    line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Where the catenary has the joints of the sections, world [m]."""
    r = np.asarray(fairlead) - np.asarray(anchor)
    span = float(np.hypot(r[0], r[1]))
    _, profile = hang_line(line, np.asarray(anchor), np.asarray(fairlead))
    at = np.cumsum([section.length for section in line.sections])[:-1]
    x = np.interp(at, profile.s, profile.x) * (span / max(profile.x[-1], 1e-9))
    z = np.interp(at, profile.s, profile.z)
    e = np.array([r[0], r[1], 0.0]) / max(span, 1e-9)
    return [np.asarray(anchor) + xi * e + np.array([0.0, 0.0, zi]) for xi, zi in zip(x, z, strict=True)]
