"""Cross-sections of beams, and the shapes that ships and frames are made of.

A shape is a sum of rectangles between coordinates y, along axis 2 of the beam, and z, along axis 3. Area and second
moments are exact. The torsion constant of an open shape is the sum of ``b t^3 / 3``, of one rectangle times
``1 - 0.63 t/b (1 - t^4 / (12 b^4))`` (Timoshenko and Goodier, *Theory of Elasticity*, section 109), of a closed one
Bredt's ``4 A^2 / sum(l/t)``. Shear areas are those of the parts along the force, 5/6 of flat bars and flanges.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "PROFILES",
    "BeamSection",
    "Profile",
    "Rectangle",
    "bulb_as_angle",
    "centroid",
    "profile",
    "rectangles_section",
    "round_section",
]

Rectangle = tuple[float, float, float, float]
"""Bounds y0, y1, z0, z1 [m]."""


@dataclass(frozen=True, eq=False)
class BeamSection:
    """Constants of a section in its axes 2 and 3, axis 2 lying in plane 1 of the beam.

    Attributes
    ----------
    area
        A [m2].
    second_moment_1
        Of bending in plane 1, about axis 3 through the centroid [m4] (Nastran I1).
    second_moment_2
        Of bending in plane 2, about axis 2 [m4] (Nastran I2).
    product
        Integral of the product of both coordinates [m4] (Nastran I12).
    torsion
        J [m4].
    shear_area_1, shear_area_2
        Of shear in planes 1 and 2 [m2]; infinite without shear flexibility.
    shear_centre
        From the centroid, axes 2 and 3 [m].
    nonstructural_mass
        [kg/m].
    corners
        Points at which stress is evaluated, relative to the centroid, axes 2 and 3 [m], shape (m, 2); may be empty.
    name
        For the report, e.g. ``"HP 300 x 13"``.
    """

    area: float
    second_moment_1: float
    second_moment_2: float
    torsion: float
    product: float = 0.0
    shear_area_1: float = np.inf
    shear_area_2: float = np.inf
    shear_centre: tuple[float, float] = (0.0, 0.0)
    nonstructural_mass: float = 0.0
    corners: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    name: str = ""


class Profile(NamedTuple):
    """A section, and where its centroid is.

    Attributes
    ----------
    section
        Axis 2 along the web, away from its foot; axis 3 to the side that flanges and bulbs point to.
    foot
        From the middle of the foot of the web to the centroid, axes 2 and 3 [m].
    """

    section: BeamSection
    foot: tuple[float, float]


PROFILES: dict[str, tuple[str, ...]] = {
    "flat": ("height", "thickness"),
    "bulb": ("height", "thickness"),
    "angle": ("height", "thickness", "width", "flange_thickness"),
    "tee": ("height", "thickness", "width", "flange_thickness"),
    "channel": ("height", "thickness", "width", "flange_thickness"),
    "h": ("height", "thickness", "width", "flange_thickness"),
    "box": ("height", "thickness", "width", "flange_thickness"),
    "round": ("diameter",),
    "tube": ("diameter", "thickness"),
}
"""Measures of each shape."""


def bulb_as_angle(height: float, thickness: float) -> tuple[float, float, float, float]:
    """Height and thickness of the web, width and thickness of the flange of the angle that stands for a bulb flat [m].

    Notes
    -----
    IACS Common Structural Rules, Part 1, Chapter 3, Section 7, in mm: ``h_w = h - h/9.2 + 2``,
    ``b_f = a (t + h/6.7 - 2)``, ``t_f = h/9.2 - 2`` with a = 1, up to h = 120 ``1.1 + (120 - h)^2 / 3000``. The flange
    begins at the outer face of the web.
    """
    h, t = 1e3 * height, 1e3 * thickness
    factor = 1.0 if h > 120.0 else 1.1 + (120.0 - h) ** 2 / 3000.0
    return 1e-3 * (h - h / 9.2 + 2.0), thickness, 1e-3 * factor * (t + h / 6.7 - 2.0), 1e-3 * (h / 9.2 - 2.0)


def profile(shape: str, **measures: float) -> Profile:
    """Section of a shape.

    Parameters
    ----------
    shape
        Key of `PROFILES`.
    measures
        Those of the shape [m]: ``height`` of the whole section along its web, ``thickness`` of the web or wall,
        ``width`` of flanges or of the box, ``flange_thickness``, outer ``diameter``.

    Raises
    ------
    InputError
        An unknown shape, measures that are missing, too many, or make no section.

    Notes
    -----
    Shear centres are those of thin walls (Timoshenko): of angles and tees where the middle lines of web and flange
    meet, of channels ``3 b^2 t_f / (h t_w + 6 b t_f)`` behind the web.
    """
    name = f"{shape} " + " x ".join(
        f"{1e3 * measures[key]:g}" for key in PROFILES.get(shape, ()) if key in measures
    )
    if shape not in PROFILES:
        raise InputError(
            f"shape {shape!r}", source="section", expected="one of " + ", ".join(map(repr, PROFILES))
        )
    needed = set(PROFILES[shape])
    wrong = [key for key, value in measures.items() if not (np.isfinite(value) and value > 0.0)]
    if set(measures) != needed or wrong:
        raise InputError(
            f"{', '.join(f'{key} {value:g} m' for key, value in measures.items()) or 'no measures'}",
            source="section",
            key=f"shape {shape!r}",
            expected=f"positive {', '.join(PROFILES[shape])}, and no other",
        )
    if shape in ("round", "tube"):
        outer = 0.5 * measures["diameter"]
        inner = outer - measures["thickness"] if shape == "tube" else 0.0
        return Profile(round_section(outer, inner, name=name.strip()), (outer, 0.0))
    h, t = measures["height"], measures["thickness"]
    b, tf = measures.get("width", 0.0), measures.get("flange_thickness", 0.0)
    centre: tuple[float, float] | None = None
    walls = None
    if shape == "bulb":
        _, t, b, tf = bulb_as_angle(h, t)
    if shape == "flat":
        parts: list[Rectangle] = [(0.0, h, -t / 2, t / 2)]
    elif shape in ("angle", "bulb"):
        parts, centre = [(0.0, h - tf, -t / 2, t / 2), (h - tf, h, -t / 2, b - t / 2)], (h - tf / 2, 0.0)
    elif shape == "tee":
        parts, centre = [(0.0, h - tf, -t / 2, t / 2), (h - tf, h, -b / 2, b / 2)], (h - tf / 2, 0.0)
    elif shape == "channel":
        parts = [(0.0, tf, -t / 2, b - t / 2), (tf, h - tf, -t / 2, t / 2), (h - tf, h, -t / 2, b - t / 2)]
        flange, web = b - t / 2, h - tf
        centre = (h / 2, -3.0 * flange**2 * tf / (web * t + 6.0 * flange * tf))
    elif shape == "h":
        parts = [(0.0, tf, -b / 2, b / 2), (tf, h - tf, -t / 2, t / 2), (h - tf, h, -b / 2, b / 2)]
    else:
        inner = b / 2 - t
        parts = [(0.0, tf, -b / 2, b / 2), (h - tf, h, -b / 2, b / 2)]
        parts += [(tf, h - tf, -b / 2, -inner), (tf, h - tf, inner, b / 2)]
        walls = ((h - tf) * (b - t), [(b - t, tf)] * 2 + [(h - tf, t)] * 2)
        if inner <= 0.0:
            parts = []
    if shape in ("angle", "bulb", "tee", "channel", "h") and b <= t:
        parts = []
    if not parts:
        raise InputError(
            name.strip() + " mm",
            source="section",
            key=f"shape {shape!r}",
            expected="walls thinner than the shape",
        )
    return _profile(parts, walls, centre, name.strip())


def _profile(
    parts: list[Rectangle],
    walls: tuple[float, list[tuple[float, float]]] | None,
    shear_centre: tuple[float, float] | None,
    name: str,
) -> Profile:
    y, z = centroid(parts)
    at = (0.0, 0.0) if shear_centre is None else (shear_centre[0] - y, shear_centre[1] - z)
    return Profile(rectangles_section(parts, walls, name=name, shear_centre=at), (y, z))


def centroid(rectangles: list[Rectangle]) -> tuple[float, float]:
    """Of rectangles, y and z [m]."""
    y0, y1, z0, z1 = np.array(rectangles, dtype=np.float64).T
    area = (y1 - y0) * (z1 - z0)
    return float(0.5 * (y0 + y1) @ area / area.sum()), float(0.5 * (z0 + z1) @ area / area.sum())


def rectangles_section(
    rectangles: list[Rectangle],
    closed: tuple[float, list[tuple[float, float]]] | None = None,
    *,
    nonstructural_mass: float = 0.0,
    name: str = "",
    shear_centre: tuple[float, float] = (0.0, 0.0),
) -> BeamSection:
    """Section of rectangles that do not overlap.

    Parameters
    ----------
    rectangles
        Their bounds [m].
    closed
        Area within the middle line of the walls [m2], and length and thickness of each wall [m]; None: it is open.
    nonstructural_mass
        [kg/m].
    name
        Of the section.
    shear_centre
        From the centroid, axes 2 and 3 [m].

    Raises
    ------
    InputError
        A rectangle without area.
    """
    y0, y1, z0, z1 = np.array(rectangles, dtype=np.float64).T
    dy, dz = y1 - y0, z1 - z0
    if not ((dy > 0.0) & (dz > 0.0)).all():
        raise InputError(
            "dimensions that leave no wall",
            source="section",
            key=name,
            expected="walls thinner than the shape",
        )
    area = dy * dz
    centre = centroid(rectangles)
    y, z = 0.5 * (y0 + y1) - centre[0], 0.5 * (z0 + z1) - centre[1]
    length, thin = np.maximum(dy, dz), np.minimum(dy, dz)
    if closed is not None:
        torsion = 4.0 * closed[0] ** 2 / sum(wall / t for wall, t in closed[1])
    elif len(rectangles) == 1:
        r = float(thin[0] / length[0])
        torsion = float(length[0] * thin[0] ** 3) / 3.0 * (1.0 - 0.63 * r * (1.0 - r**4 / 12.0))
    else:
        torsion = float(length @ thin**3) / 3.0
    upright = dy >= dz
    flat = 5.0 / 6.0 * float(area.sum())
    single = len(rectangles) == 1
    across = 1.0 if closed is not None else 5.0 / 6.0
    corners = np.concatenate([np.column_stack([a, b]) for a in (y0, y1) for b in (z0, z1)]) - centre
    # corners of inner faces are passed on too: the largest stress is at one of the outer ones
    return BeamSection(
        area=float(area.sum()),
        second_moment_1=float(area @ (dy**2 / 12.0 + y**2)),
        second_moment_2=float(area @ (dz**2 / 12.0 + z**2)),
        torsion=torsion,
        product=float(area @ (y * z)),
        shear_area_1=flat if single else float(area[upright].sum()) or flat,
        shear_area_2=flat if single else across * float(area[~upright].sum()) or flat,
        shear_centre=shear_centre,
        nonstructural_mass=nonstructural_mass,
        corners=np.unique(np.round(corners, 12), axis=0),
        name=name,
    )


def round_section(
    outer: float, inner: float = 0.0, *, nonstructural_mass: float = 0.0, name: str = ""
) -> BeamSection:
    """Section of a round bar or tube of outer and inner radius [m].

    Raises
    ------
    InputError
        Radii out of order.

    Notes
    -----
    Shear area: G. R. Cowper, J. Appl. Mech. 33 (1966) 335, hollow circle at nu = 0.3, m = inner / outer:
    ``k = 6 (1 + nu)(1 + m^2)^2 / ((7 + 6 nu)(1 + m^2)^2 + (20 + 12 nu) m^2)``.
    """
    if not 0.0 <= inner < outer:
        raise InputError(
            f"radii {inner:g} and {outer:g} m", source="section", expected="0 <= inner < outer radius"
        )
    area, second = np.pi * (outer**2 - inner**2), 0.25 * np.pi * (outer**4 - inner**4)
    nu, m2 = 0.3, (inner / outer) ** 2
    shear = (
        area
        * 6.0
        * (1.0 + nu)
        * (1.0 + m2) ** 2
        / ((7.0 + 6.0 * nu) * (1.0 + m2) ** 2 + (20.0 + 12.0 * nu) * m2)
    )
    angles = np.arange(8) * 0.25 * np.pi
    return BeamSection(
        area=area,
        second_moment_1=second,
        second_moment_2=second,
        torsion=2.0 * second,
        shear_area_1=shear,
        shear_area_2=shear,
        nonstructural_mass=nonstructural_mass,
        corners=outer * np.column_stack([np.cos(angles), np.sin(angles)]),
        name=name,
    )
