"""Descriptions of the sea: water, hulls that float, hydrodynamic databases, waves, wind, lines; SI units."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyPoint, Least, NameOf, Positive, Quantity, Shape, Square
from heavylift.solver.scene.bodies import RigidBody
from heavylift.solver.scene.descriptions import XYZ, Family, check_table, no_rows
from heavylift.solver.scene.drawn import At, Element, Filling, Solid
from heavylift.solver.scene.outlines import surface_triangles
from heavylift.solver.scene.outputs import Components, Outputs, channel, outputs

if TYPE_CHECKING:
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.preprocess.hydrodynamics.exponentials import ExponentialKernel
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.scene.wind_loads import (
        CurrentField,
        FluidLoad,
        WindField,
    )
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = [
    "AT_SEA",
    "Excitation",
    "FloatingBody",
    "Hull",
    "HullOutputs",
    "LinearRestoring",
    "Memory",
    "Radiation",
    "Restored",
    "RestoringOfSurface",
    "Sea",
    "Tank",
    "TankOutputs",
    "Tide",
    "Water",
]

Memory = Literal["exponentials", "direct", "none"]
"""Of radiated waves: recursive sums of exponentials, convolution, or added mass at infinite frequency alone."""

Excitation = Literal["summed", "series"]
"""Of waves: every component at the place of each hull at every time, or tabulated once for the start."""

UNSYMMETRIC = 1e-6
"""Of its largest entry, that a matrix of damping may be off symmetry."""


@dataclass(frozen=True)
class Water:
    """Still water.

    Attributes
    ----------
    density, gravity
        [kg/m3], [m/s2].
    level
        Height of the still water plane in the world [m].
    depth
        [m]; infinite for deep water.
    tide
        Rise and fall of the still water; `level` is that at the start then.
    """

    density: float = 1025.0
    gravity: float = 9.80665
    level: float = 0.0
    depth: float = math.inf
    tide: Tide | None = None


AT_SEA: Family[Any] = Family("table", "heavylift.solver.scene", typed=False)
"""What floats and what is in it, by the tables of a case file in which they stand."""


@AT_SEA.part
@dataclass(frozen=True, eq=False, kw_only=True)
class LinearRestoring:
    """Buoyancy for small motions about a float plane, in numbers."""

    # Forces derive from the potential rho g / 2 int (height of the float plane)^2 dA plus that of the constant volume,
    # whose buoyancy acts at its centre. Weight acts at the centre of mass of the body, so its terms (-m g z_G in roll
    # and pitch) are not part of this.

    volume: Annotated[float, Positive("volume")]
    """Displaced at rest [m^3]."""
    centre_of_buoyancy: Annotated[NDArray[np.float64], BodyPoint()]
    """In the coordinates of the geometry [m]."""
    reference: Annotated[NDArray[np.float64], BodyPoint()]
    """Point of the float plane, to which the moments refer, in the coordinates of the geometry [m]."""
    area: Annotated[float, Positive("area")]
    """Of the float plane [m^2]."""
    first_moments: Annotated[tuple[float, float], Quantity("volume")] = (0.0, 0.0)
    """Integrals of x and y over it [m^3]."""
    second_moments: Annotated[tuple[float, float, float], Quantity("second moment of area")]
    """Integrals of x^2, y^2 and x y over it [m^4]."""

    @property
    def waterplane(self) -> NDArray[np.float64]:
        """A, Sx, Sy, Ixx, Iyy, Ixy: area and moments in the axes of the body."""
        return np.array([self.area, *self.first_moments, *self.second_moments], dtype=np.float64)


class RestoringOfSurface(LinearRestoring):
    """The same, taken from the surface of a hull: its numbers say what the surface does."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Restored:
    """What gives a hull its buoyancy. A case file names a surface, or says it in numbers.

    Attributes
    ----------
    body
        Name of a free rigid body. Channels of the hull go under it: ``body.buoyancy`` ...
    restoring
        A closed surface in the frame of the body, clipped at the water level at every instant; or `LinearRestoring`;
        or None for a body under water whose weight is given as it weighs there. Never two of them.
    open_deck
        Height in the body frame [m] from which on the surface may be open; right while all of that is dry.
    """

    body: str
    restoring: TriangleSurface | LinearRestoring | None
    open_deck: float | None = None

    @property
    def name(self) -> str:
        """That of its body."""
        return self.body

    def drawn(self) -> Iterable[Element]:
        """Its plating, if its body has no other surface."""
        if self.restoring is None or isinstance(self.restoring, LinearRestoring):
            return
        points, triangles, _ = surface_triangles(self.restoring)
        yield Solid(name=self.body, role="hull", body=self.body, points=points, triangles=triangles)


def _undamped() -> NDArray[np.float64]:
    return np.zeros((6, 6))


@outputs
class HullOutputs(Outputs):
    """What a hull records behind the channels of its body."""

    displaced_volume: float = channel("volume", "volume of the water that the hull displaces")
    buoyancy_centre: Components = channel("length", "centre of that volume, in the world", XYZ)
    ballast: float = channel("mass", "mass of the water in the tanks of the hull")
    wave_elevation: float = channel(
        "length", "elevation of the undisturbed waves at the low-passed place of the reference point"
    )
    wave_force: Components = channel("force", "force of the waves, heading axes", XYZ)
    wave_moment: Components = channel(
        "moment or energy", "moment of the waves about the reference point, heading axes", XYZ
    )
    radiation_force: Components = channel(
        "force", "force of memory and damping, without added mass, heading axes", XYZ
    )
    radiation_moment: Components = channel(
        "moment or energy", "moment of memory and damping about the reference point, heading axes", XYZ
    )
    water_level: float = channel("length", "height of the still water, with the tide")


@AT_SEA.describe("hulls")
@dataclass(frozen=True, eq=False, kw_only=True)
class Hull(Restored):
    """A rigid body that floats: its buoyancy, and its damping besides radiated waves."""

    CHANNELS: ClassVar = HullOutputs.CHANNELS
    """What it records behind the channels of its body."""

    reference: Annotated[NDArray[np.float64], BodyPoint()] = field(default_factory=lambda: np.zeros(3))
    """Point to which damping and database refer, in the coordinates of the geometry [m]."""
    damping: Annotated[NDArray[np.float64], Quantity("number"), Square(6), Absent()] = field(
        default_factory=_undamped
    )
    """Six numbers, or 6 x 6, of surge to yaw in SI: in addition to that of radiated waves, along the heading."""
    quadratic_damping: Annotated[
        NDArray[np.float64], Quantity("number", minimum=0.0, closed=True), Shape((6,))
    ] = field(default_factory=lambda: np.zeros(6))
    """Force for the square of the velocity, of surge to yaw, in SI."""
    low_pass: Annotated[float, Quantity("angular velocity", minimum=0.0, maximum=1.0)] = 0.05
    """Cut-off of the filter of place and heading that the waves see [rad/s]; well below the waves."""

    @staticmethod
    def check(spec: Any) -> None:
        """Damping dissipates."""
        if spec.damping is None:
            return
        D = np.array(spec.damping, dtype=np.float64)
        size = float(np.abs(D).max())
        if np.abs(D - D.T).max() > UNSYMMETRIC * size or np.linalg.eigvalsh(D)[0] < -1e-9 * size:
            raise InputError(
                f"{D.tolist()}",
                key="damping",
                expected="a symmetric matrix that dissipates in every direction",
            )


@dataclass(frozen=True, eq=False, kw_only=True)
class Radiation:
    """Waves that hulls make and feel, from a database of one hull or of several that interact.

    Attributes
    ----------
    bodies
        Names of hulls in the order of the database, whose reference points are those of the hulls.
    database
        Added mass, damping and excitation.
    memory
        ``"exponentials"``: recursive, fast, passive; ``"direct"``: convolution over past velocities, the reference,
        for fixed steps; ``"none"``: added mass at infinite frequency and excitation only.
    memory_length
        Of the direct convolution [s], and of the samples that exponentials are fitted to, which reach 60 s at least;
        None: until the kernel has decayed to 1 %, 40 to 60 s.
    fit_error
        Of the kernel relative to its largest value, that the exponentials may have.
    drift
        Whether mean drift forces of the database act (slow part by Newman's approximation).
    fit
        The exponentials, if they have been fitted before; None: they are fitted when the scene is packed.
    """

    bodies: tuple[str, ...]
    database: HydrodynamicDatabase
    memory: Memory = "exponentials"
    memory_length: float | None = None
    fit_error: float = 1e-3
    drift: bool = False
    fit: ExponentialKernel | None = None


@outputs
class TankOutputs(Outputs):
    """What a tank records."""

    mass: float = channel("mass", "mass of the water in the tank")
    depth: float = channel("length", "depth of the water in a tank with `size` or `depths`, else 0")


@AT_SEA.describe("tanks")
@dataclass(frozen=True, eq=False, kw_only=True)
class Tank:
    """Ballast water: a point mass, a rectangular tank, or one by a table over its volume."""

    SENTENCES: ClassVar = {"name": "Name."}

    # Water comes and goes with the velocity of the hull; its free surface takes from the restoring of roll and pitch
    # for small angles.
    CHANNELS: ClassVar = TankOutputs.CHANNELS

    name: str
    hull: Annotated[str, NameOf("hull")]
    """Hull that it is in."""
    point: Annotated[NDArray[np.float64] | None, BodyPoint()] = None
    """Centre of the water, in the coordinates of the geometry [m], of a tank without `size` and `volumes`."""
    mass: Annotated[float | None, Quantity("mass", minimum=0.0, closed=True)] = None
    """[kg]; at the start, if pumps fill or empty it."""
    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """In place of `mass`, a schedule: [s], increasing."""
    masses: Annotated[NDArray[np.float64], Quantity("mass", minimum=0.0, closed=True), Shape((None,))] = (
        field(default_factory=no_rows)
    )
    """[kg], one a time, linear between, held at the ends."""
    free_surface: Annotated[
        tuple[float, float], Quantity("second moment of area", minimum=0.0, closed=True)
    ] = (0.0, 0.0)
    """Second moments of its surface about its longitudinal and its transverse axis [m^4]: l b^3 / 12 and b l^3 / 12;
    of a tank with `point`."""
    density: Annotated[float | None, Quantity("density", minimum=100.0, maximum=20_000.0)] = None
    """Of its water [kg/m^3]; that of the sea if absent."""
    floor: Annotated[NDArray[np.float64] | None, BodyPoint()] = None
    """Of a rectangular tank, in place of `point`: the middle of its floor, in the coordinates of the geometry [m]."""
    size: Annotated[NDArray[np.float64] | None, Quantity("length", minimum=0.0), Shape((3,))] = None
    """Its length, breadth and height inside, along the axes of the body [m]."""
    permeability: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 1.0
    """Share of its space that water can take."""
    volumes: Annotated[NDArray[np.float64], Quantity("volume", minimum=0.0, closed=True), Shape((None,))] = (
        field(default_factory=no_rows)
    )
    """In place of `point`, a table over the volume of the water [m^3]: from 0 to that of the full tank, increasing."""
    centres: Annotated[NDArray[np.float64] | None, BodyPoint(), Shape((None, 3))] = None
    """Centre of the water at each volume with the hull upright, in the coordinates of the geometry [m], linear
    between."""
    surfaces: Annotated[
        NDArray[np.float64] | None,
        Quantity("second moment of area", minimum=0.0, closed=True),
        Shape((None, 2)),
    ] = None
    """Second moments of the free surface about its longitudinal and its transverse axis at each volume [m^4]; zero if
    absent."""
    depths: Annotated[NDArray[np.float64], Quantity("length", minimum=0.0, closed=True), Shape((None,))] = (
        field(default_factory=no_rows)
    )
    """Depth of the water at each volume, for the record [m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """A mass, or a schedule; a place of one kind."""
        if (spec.mass is None) == (not len(spec.times)):
            problem = "neither 'mass' nor 'times'" if spec.mass is None else "both 'mass' and 'times'"
            raise InputError(problem, expected="one of them")
        check_table("times", spec.times, "masses", spec.masses)
        given = {
            "point": spec.point is not None,
            "size": spec.size is not None,
            "volumes": len(spec.volumes) > 0,
        }
        ways = [key for key, there in given.items() if there]
        if len(ways) != 1:
            raise InputError(
                f"{' and '.join(map(repr, ways)) or 'no place'}",
                key=ways[-1] if ways else "point",
                expected="'point'; or 'floor' and 'size'; or 'volumes' and 'centres'",
            )
        way = ways[0]
        if (spec.floor is not None) != (way == "size"):
            raise InputError(
                f"{'no' if spec.floor is None else 'a'} 'floor' with {way!r}",
                key="floor",
                expected="'floor' and 'size' together",
            )
        if way != "point" and any(spec.free_surface):
            raise InputError(
                f"'free_surface' with {way!r}", key="free_surface", expected="the free surface of that"
            )
        if way != "size" and spec.permeability != 1.0:
            raise InputError(f"'permeability' with {way!r}", key="permeability", expected="'size'")
        if not spec.permeability > 0.0:
            raise InputError(f"{spec.permeability:g}", key="permeability", expected="more than 0, at most 1")
        if way == "volumes":
            Tank._check_volumes(spec)
        elif spec.centres is not None or spec.surfaces is not None or len(spec.depths):
            raise InputError(f"a table with {way!r}", key="volumes", expected="'volumes' and 'centres'")

    @staticmethod
    def _check_volumes(spec: Any) -> None:
        """A table from the empty to the full tank."""
        check_table("volumes", spec.volumes, "centres", spec.centres or (), shortest=2)
        if spec.volumes[0] != 0.0:
            raise InputError(
                f"begins at {spec.volumes[0]:g} m^3", key="volumes", expected="0, the empty tank, first"
            )
        if spec.surfaces is not None:
            check_table("volumes", spec.volumes, "surfaces", spec.surfaces)
        if len(spec.depths):
            check_table("volumes", spec.volumes, "depths", spec.depths)

    @property
    def schedule(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times [s] and masses [kg]; of a mass that does not change one of each."""
        if self.mass is not None:
            return np.zeros(1), np.array([self.mass], dtype=np.float64)
        return self.times, self.masses

    def drawn(self) -> Iterable[Element]:
        """A ball of as much water as it holds, about the middle of the tank."""
        middle = self.point
        if self.size is not None and self.floor is not None:
            middle = self.floor + np.array([0.0, 0.0, 0.5 * self.size[2]])
        elif self.centres is not None:
            middle = np.mean(self.centres, axis=0)
        times, masses = self.schedule
        yield Filling(
            name=self.name, role="tank", at=At(self.hull, np.asarray(middle, dtype=np.float64)), times=times,
            masses=masses, density=self.density,
        )  # fmt: skip

    @property
    def start_mass(self) -> float:
        """Mass at the start [kg]."""
        return float(np.interp(0.0, *self.schedule))

    def shape(self, water: Water) -> NDArray[np.float64]:
        """Rows of mass [kg], centre [m], density times second moments of the surface [kg m] and depth [m].

        It is linear between them. One row if the centre stays; else from the empty to the full tank. Neither an empty
        nor a full tank has a free surface, whatever its rows say. Shape (rows, 7).
        """
        density = water.density if self.density is None else self.density
        if self.size is not None:
            assert self.floor is not None
            l, b, h = self.size
            whole = density * self.permeability
            about = (whole * l * b**3 / 12.0, whole * b * l**3 / 12.0)
            x, y, z = self.floor
            ends = ((0.0, 0.0), (whole * l * b * h, h))
            return np.array([[mass, x, y, z + 0.5 * depth, *about, depth] for mass, depth in ends])
        if len(self.volumes):
            n = len(self.volumes)
            surfaces = np.zeros((n, 2)) if self.surfaces is None else self.surfaces
            depths = self.depths if len(self.depths) else np.zeros(n)
            assert self.centres is not None
            return np.column_stack([density * self.volumes, self.centres, density * surfaces, depths])
        assert self.point is not None
        return np.array([[0.0, *self.point, *(density * one for one in self.free_surface), 0.0]])

    def capacity(self, water: Water) -> float:
        """Mass of the full tank [kg]; infinite of a point mass."""
        rows = self.shape(water)
        return float(rows[-1, 0]) if len(rows) > 1 else math.inf

    def contents(self, mass: float, water: Water) -> tuple[NDArray[np.float64], tuple[float, float], float]:
        """Centre of some water in it [m], density times second moments of its surface [kg m], depth [m]."""
        rows = self.shape(water)
        x, y, z, about_x, about_y, depth = (
            float(np.interp(mass, rows[:, 0], rows[:, k])) if len(rows) > 1 else float(rows[0, k])
            for k in range(1, 7)
        )
        free = 0.0 < mass < self.capacity(water)
        return np.array([x, y, z]), (about_x, about_y) if free else (0.0, 0.0), depth


@AT_SEA.describe("tide")
@dataclass(frozen=True, eq=False, kw_only=True)
class Tide:
    """Still water that rises and falls."""

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,)), Least(2)]
    """[s], increasing."""
    levels: Annotated[NDArray[np.float64], Quantity("length"), Shape((None,))]
    """Height of the still water over `level` of the sea [m], one a time, linear between, held at the ends."""

    @staticmethod
    def check(spec: Any) -> None:
        """A level a time."""
        check_table("times", spec.times, "levels", spec.levels)

    @property
    def at_start(self) -> float:
        """Level at the start of time [m]."""
        return float(np.interp(0.0, self.times, self.levels))


@dataclass(frozen=True, eq=False, kw_only=True)
class Sea:
    """All that water and air do in a scene.

    Attributes
    ----------
    water
        Still water.
    hulls, radiation, tanks
        What floats.
    pumps, controllers
        What moves the water of tanks, and what commands pumps.
    waves
        Trains of waves, or None.
    ramp
        Time in which waves, wind and current grow from nothing at the start [s].
    at_rest
        Whether wind and current have their full strength from the start, as a start in equilibrium needs them: only
        waves grow then. A simulation that starts at rest sets it.
    excitation
        ``"summed"``: every component at the low-passed place and heading of each hull; ``"series"``: once for the
        place and heading at the start, tabulated over `duration`, which is faster.
    duration
        Length of the tabulated series [s].
    fields, loads
        Wind and current, and the elements on bodies that feel them.
    lines, fenders
        Catenaries and one-sided springs.
    """

    water: Water = field(default_factory=Water)
    hulls: tuple[Hull, ...] = ()
    radiation: tuple[Radiation, ...] = ()
    tanks: tuple[Tank, ...] = ()
    pumps: tuple[Any, ...] = ()
    controllers: tuple[Any, ...] = ()
    waves: WaveTrains | None = None
    ramp: float = 0.0
    at_rest: bool = False
    excitation: Excitation = "summed"
    duration: float = 0.0
    fields: tuple[WindField | CurrentField, ...] = ()
    loads: tuple[FluidLoad, ...] = ()
    lines: tuple[Any, ...] = ()
    fenders: tuple[Any, ...] = ()

    def tanks_of(self, bodies: Iterable[Any]) -> list[Tank]:
        """Tanks in the order in which the solver has them: hull by hull, as these are among the bodies of a scene."""
        return [tank for body in bodies for tank in self.tanks if tank.hull == body.name]


@dataclass(frozen=True, eq=False)
class FloatingBody(RigidBody):
    """A rigid body of a scene that a hull makes float, with its place among those it interacts with.

    Attributes
    ----------
    hull
        What floats.
    group
        Names of all hulls whose velocities are coupled by water, in order.
    """

    KIND_MODULE: ClassVar[str] = "heavylift.solver.water.hulls.packing"
    ORDER: ClassVar[int] = 3
    FLOATS: ClassVar[bool] = True
    CHANNELS: ClassVar = (*RigidBody.CHANNELS, *Hull.CHANNELS)

    hull: Hull = field(default_factory=lambda: Hull(body="", restoring=None))
    group: tuple[str, ...] = ()

    @property
    def group_names(self) -> tuple[str, ...]:
        """All hulls that water couples with it."""
        return self.group

    @property
    def inverse_masses(self) -> NDArray[np.float64] | None:
        """None: added mass is a matrix."""
        return None
