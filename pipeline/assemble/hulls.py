"""From the hulls of a case to what the solver integrates: hydrostatics, databases and their panels."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.assemble.frames import assemble_rigid
from heavylift.pipeline.assemble.sides import Side
from heavylift.pipeline.assemble.surfaces import stored_surface
from heavylift.pipeline.assemble.water import water_of
from heavylift.pipeline.case.places import located
from heavylift.pipeline.results.provenance import database_digest, memory_digest
from heavylift.pipeline.results.storage import read_json
from heavylift.preprocess.hydrodynamics.bem import BemInputs
from heavylift.preprocess.hydrodynamics.hull_panels import (
    box_panels,
    cut_at_plane,
    hydrostatics,
    surface_panels,
)
from heavylift.preprocess.hydrodynamics.panel_mesh import PanelMesh, hull_panels
from heavylift.preprocess.hydrodynamics.repairs import FEWEST, implied_scatter, repaired
from heavylift.preprocess.hydrodynamics.water_planes import lid_panels, moonpools
from heavylift.solver.scene import sea as seas

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.hulls import ComputeSection, DatabaseSection
    from heavylift.pipeline.case.surfaces import SurfaceSection
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.preprocess.hydrodynamics.hull_panels import HullPanels, PanelHydrostatics
    from heavylift.preprocess.hydrodynamics.words import FirstColumn
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.scene.sea import Radiation
    from heavylift.solver.water.hulls.hydrostatics import FloatingPosition
    from heavylift.solver.water.hulls.hydrostatics import Tank as Liquid

__all__ = [
    "assemble_hulls",
    "assemble_radiation",
    "bem_inputs",
    "database_manifest",
    "frame_origin",
    "hull_surface",
    "hull_tanks",
    "linear_from_panels",
    "linear_restoring",
    "liquid_at_start",
    "read_database_source",
    "resting_position",
    "stored_database",
    "upright_position",
]

LEVEL = 2e-3
"""List or trim [rad] at rest, beyond which a hull is not upright."""


def assemble_hulls(case: Case, sides: Mapping[str, Side], folder: OutputFolder) -> tuple[seas.Hull, ...]:
    """Hulls of a case in the frames of their bodies.

    Raises
    ------
    InputError
        If a surface is no hull, or linear restoring is asked for and the hull does not rest upright.
    """
    found = []
    for name, section in case.hulls.items():
        with located(case, f"hulls.{name}"):
            restoring = _restoring(case, name, section, sides, folder)
            deck = _open_deck(section, sides[name].origin)
            given = {"body": name, "restoring": restoring, "open_deck": deck}
            found.append(assemble(section, sides, case.folder, name, **given))
    return tuple(found)


def _open_deck(section: Any, origin: NDArray[np.float64]) -> float | None:
    """Height in the frame of a hull from which on its surface may be open [m]."""
    return None if section.open_deck is None else section.open_deck - float(origin[2])


def frame_origin(case: Case, name: str) -> NDArray[np.float64]:
    """Origin of the frame of a rigid body in the coordinates of its geometry [m]."""
    return np.array(case.bodies[name].drawn_origin)


def hull_surface(case: Case, name: str, folder: OutputFolder) -> TriangleSurface:
    """Surface of a hull in the frame of its body."""
    from heavylift.preprocess.surfaces.triangle_surface import placed

    wanted = case.hulls[name].surface
    index = next(i for i, surface in enumerate(case.surfaces) if surface.name == wanted)
    surface = stored_surface(case, index, folder).surface
    return placed(surface, position=-frame_origin(case, name))


def hull_tanks(case: Case, name: str) -> tuple[Liquid, ...]:
    """Tanks of a hull as they are at the start, in the frame of its body."""
    sides, water = {name: Side(np.zeros(3), np.eye(3), frame_origin(case, name))}, water_of(case)
    tanks = (assemble(tank, sides, case.folder) for tank in case.tanks if tank.hull == name)
    return tuple(liquid_at_start(tank, water) for tank in tanks)


def liquid_at_start(tank: seas.Tank, water: seas.Water, origin: ArrayLike = (0.0, 0.0, 0.0)) -> Liquid:
    """What is in a tank at the start, with its centre [m] from a point that is `origin` less that of the frame."""
    from heavylift.solver.water.hulls.hydrostatics import Tank as Liquid

    point, surface, _ = tank.contents(tank.start_mass, water)
    x, y, z = (point + np.asarray(origin)).tolist()
    return Liquid(tank.start_mass, (x, y, z), surface, tank.name)


def resting_position(case: Case, name: str, folder: OutputFolder) -> FloatingPosition:
    """How a hull floats with its tanks and all that joints hold on it, without waves and lines.

    Raises
    ------
    InputError
        If its surface is no hull, or it does not float.
    """
    from heavylift.pipeline.assemble.loading import case_loading
    from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
    from heavylift.solver.water.hulls.hydrostatics import equilibrium

    section, origin, loading = case.hulls[name], frame_origin(case, name), case_loading(case, name, folder)
    hull = check_hull(hull_surface(case, name, folder), open_deck=_open_deck(section, origin))
    water = water_of(case)
    return equilibrium(
        hull,
        loading.mass,
        loading.centre,
        density=water.density,
        gravity=water.gravity,
        level=water.level,
        tanks=hull_tanks(case, name),
    )


def upright_position(case: Case, name: str, folder: OutputFolder) -> FloatingPosition:
    """The same of a hull that floats upright.

    Raises
    ------
    InputError
        If it has a list or a trim.
    """
    position = resting_position(case, name, folder)
    pose = position.pose
    if max(abs(pose.list), abs(pose.trim)) > LEVEL:
        from heavylift.pipeline.assemble.loading import case_loading

        found = case_loading(case, name, folder)
        carries = f", carrying {', '.join(found.bodies)}" if found.bodies else ""
        left = f"; not counted: {', '.join(found.left_out)}" if found.left_out else ""
        raise InputError(
            f"{name!r} floats with a list of {math.degrees(pose.list):.3g} and a trim of "
            f"{math.degrees(pose.trim):.3g} degrees{carries}{left}",
            key="surface",
            expected="a hull that floats upright with its mass, its tanks, what joints hold on it, and 'hanging'",
        )
    return position


def _restoring(
    case: Case, name: str, section: Any, sides: Mapping[str, Side], folder: OutputFolder
) -> TriangleSurface | seas.LinearRestoring | None:
    if section.kind == "none":
        return None
    if section.kind == "clipped":
        return hull_surface(case, name, folder)
    if section.linear is None:
        return linear_restoring(case, name, folder)
    made: seas.LinearRestoring = assemble(section.linear, sides, case.folder, name)
    return made


def linear_restoring(case: Case, name: str, folder: OutputFolder) -> seas.LinearRestoring:
    """Linear restoring of the surface of a hull about the place where it rests upright."""
    from heavylift.preprocess.hydrodynamics.hull_panels import hydrostatics, surface_panels

    height = upright_position(case, name, folder).pose.height
    panels = surface_panels(hull_surface(case, name, folder), level=-height, name=name)
    return linear_from_panels(hydrostatics(panels, 1.0, 1.0, np.zeros(3)), -height)


def linear_from_panels(still: PanelHydrostatics, level: float) -> seas.LinearRestoring:
    """Moments of the water plane from a stiffness about the origin of the water plane, with rho g = 1.

    Parameters
    ----------
    still
        Of panels whose z is measured from the water, about their origin.
    level
        Height of the water in the frame of the body [m].
    """
    C, V, centre = still.stiffness, still.volume, still.centre_of_buoyancy
    lever = V * centre[2]
    # C33 = A, C34 = Sy, C35 = -Sx, C44 = Iyy + V z_B, C55 = Ixx + V z_B, C45 = -Ixy
    shift = np.array([0.0, 0.0, level])
    return seas.RestoringOfSurface(
        volume=float(V),
        centre_of_buoyancy=centre + shift,
        reference=shift,
        area=C[2, 2],
        first_moments=(-C[2, 4], C[2, 3]),
        second_moments=(C[4, 4] - lever, C[3, 3] - lever, -C[3, 4]),
    )


PARALLEL = math.radians(0.5)
"""Between headings of hulls that share a database [rad]."""
SAME_PLACE = 1e-6
"""Of the extent: how far the mirror image of a corner may be from another corner."""


def bem_inputs(
    case: Case,
    section: DatabaseSection,
    folder: OutputFolder,
    *,
    say: Callable[[str], None] = lambda _text: None,
) -> BemInputs:
    """What a database is computed from.

    The axes of the database are those of the first hull at the start, its origin above or below that of its frame.
    Every hull lies upright, where it is at the start, as deep as it floats with its tanks and what joints hold on it.
    `say` is called with a sentence about the panels of each.

    Raises
    ------
    InputError
        If a hull does not float upright, several do not head the same way, or hulls declared symmetric are
        not.
    """
    assert section.compute is not None
    compute, water = section.compute, water_of(case)
    places = {name: _place(case, name) for name in section.hulls}
    origin, heading = places[section.hulls[0]]
    turn = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
    hulls: list[HullPanels] = []
    references, curved = [], 0.0
    for index, name in enumerate(section.hulls):
        place, own = places[name]
        off = math.remainder(own - heading, 2.0 * math.pi)
        if abs(off) > PARALLEL:
            raise InputError(
                f"{name!r} heads {math.degrees(off):.4g} degrees off {section.hulls[0]!r}",
                key=f"hulls.{index}",
                expected="hulls of one database that head the same way at the start",
            )
        x, y = (float(value) for value in turn @ (place - origin))
        height = upright_position(case, name, folder).pose.height
        mesh = _panels(case, name, compute, folder, height)
        say(_panel_words(mesh, compute.panel_size))
        hulls.append(mesh.hull.translated(x, y, name=name))
        curved += mesh.curved * len(mesh.hull.panels)
        reference = np.array(case.hulls[name].reference) - frame_origin(case, name)
        references.append(reference + np.array([x, y, height]))
    if compute.symmetric:
        for hull in hulls:
            _check_symmetry(hull)
    headings = compute.headings or _headings(compute)
    return BemInputs(
        hulls=tuple(hulls),
        omega=np.array(section.frequencies),
        headings=np.array(headings),
        reference_points=np.array(references),
        density=water.density,
        gravity=water.gravity,
        depth=water.depth,
        symmetric=compute.symmetric,
        lid=compute.lid,
        lids=_lids(hulls, compute, say),
        method=_method(hulls, curved),
        only_at_headings=bool(compute.headings),
    )


def _place(case: Case, name: str) -> tuple[NDArray[np.float64], float]:
    """Horizontal place of the frame of a hull at the start [m], shape (2,), and its heading [rad]."""
    from heavylift.numerics.rotation import rotation_matrix

    body = case.bodies[name]
    rigid, _ = assemble_rigid(name, body)
    R = rotation_matrix(rigid.orientation)
    return rigid.position[:2], math.atan2(R[1, 0], R[0, 0])


def _panels(case: Case, name: str, compute: ComputeSection, folder: OutputFolder, height: float) -> PanelMesh:
    """Wetted panels of a hull whose frame is at a height above the water [m]."""
    surface = next(entry for entry in case.surfaces if entry.name == case.hulls[name].surface)
    origin = frame_origin(case, name)
    size = _plain_box(surface)
    if size is not None:
        length, breadth, depth = size
        x, y, z = (float(value) for value in np.array(surface.at) - origin)
        draft = 0.5 * depth - z - height
        box = box_panels(length, breadth, draft, compute.panel_size, name=name).translated(x, y)
        return PanelMesh(box, 1.0, 1.0, 1.0, 0.0)
    wetted = surface_panels(hull_surface(case, name, folder), level=-height, name=name)
    if compute.symmetric:
        _check_halves(wetted)
    return hull_panels(wetted, compute.panel_size, symmetric=compute.symmetric)


def _check_halves(wetted: HullPanels) -> None:
    """What is on both sides of y = 0 is equal."""
    whole, half = (
        hydrostatics(panels, 1.0, 1.0, np.zeros(3)) for panels in (wetted, cut_at_plane(wetted, 1))
    )
    extent = float(np.ptp(wetted.points, axis=0).max())
    if (
        abs(2.0 * half.volume - whole.volume) > SAME_PLACE * whole.volume
        or abs(float(whole.centre_of_buoyancy[1])) > SAME_PLACE * extent
    ):
        raise _not_symmetric(wetted.name, "unequal halves")


def _panel_words(mesh: PanelMesh, size: float) -> str:
    """What a user should know of the panels of a hull."""
    words = f"{mesh.hull.name}: {len(mesh.hull.panels)} panels of {size:g} m"
    if mesh.size < 1.0:
        words += f", {mesh.size * size:.3g} m where it is round"
    words += (
        f"; volume {mesh.volume - 1.0:+.2%} and water plane {mesh.waterplane - 1.0:+.2%} against its surface"
    )
    if mesh.problem:
        words += (
            f"; WARNING: its triangles were halved instead of remeshed ({mesh.problem}), "
            "which takes several times as many panels"
        )
    return words


def _lids(
    hulls: list[HullPanels], compute: ComputeSection, say: Callable[[str], None]
) -> tuple[HullPanels | None, ...]:
    """Lids of hulls; none if a rim is not clear, for which Capytaine then lays rectangles."""
    if not compute.lid:
        return ()
    try:
        size = LID_SIZE * compute.panel_size
        return tuple(lid_panels(hull, size, symmetric=compute.symmetric) for hull in hulls)
    except InputError as error:
        say(f"{error.source}: WARNING: no lid from rim to rim ({error.problem}); one of rectangles instead")
        return ()


def _method(hulls: list[HullPanels], curved: float) -> Literal["indirect", "direct"]:
    """Unknowns of the integral equation: potentials for round hulls, and where water is enclosed.

    Sources leave negative damping beyond the resonance of a moonpool, potentials do not.
    """
    if curved > ROUND * sum(len(hull.panels) for hull in hulls):
        return "direct"
    try:
        return "direct" if any(moonpools(hull) for hull in hulls) else "indirect"
    except InputError:
        return "indirect"


LID_SIZE = 1.5
"""Of the panels of a lid relative to those of the hull: it is felt above the first irregular frequency alone."""
ROUND = 0.5
"""Share of curved surface from which on the unknowns are potentials."""


def _not_symmetric(name: str, what: str) -> InputError:
    return InputError(
        f"{name!r} has {what}",
        key="compute.symmetric",
        expected="hulls that are symmetric about y = 0 of the first one, or 'symmetric = false'",
    )


def _plain_box(surface: SurfaceSection) -> tuple[float, float, float] | None:
    """Size of a surface that is a box along the axes of its body, which has panels of four corners; else None."""
    shape = surface.shape
    whole = not surface.exclude and surface.radius == 0.0 and surface.turned is None
    return shape.size if whole and shape is not None and shape.type == "box" else None


def _headings(compute: ComputeSection) -> NDArray[np.float64]:
    """Equal steps over half a turn, or over a whole one."""
    whole = math.pi if compute.symmetric else 2.0 * math.pi
    count = math.ceil(whole / compute.heading_step - 1e-9)
    return np.linspace(0.0, whole, count + 1)[: None if compute.symmetric else -1]


def _check_symmetry(hull: HullPanels) -> None:
    """Every corner has its mirror image."""
    scale = SAME_PLACE * float(np.ptp(hull.points, axis=0).max())
    corners = {tuple(row) for row in np.round(hull.points / scale).astype(np.int64).tolist()}
    for x, y, z in corners:
        near = ((x + i, -y + j, z + k) for i in (0, -1, 1) for j in (0, -1, 1) for k in (0, -1, 1))
        if not any(corner in corners for corner in near):
            raise _not_symmetric(hull.name, f"a corner at y = {y * scale:.4g} m without its mirror image")


def assemble_radiation(case: Case, folder: OutputFolder) -> tuple[Radiation, ...]:
    """Databases of a case."""
    from heavylift.preprocess.hydrodynamics.memory_fit import read_memory
    from heavylift.solver.scene.sea import Radiation

    found = []
    for name, section in case.databases.items():
        with located(case, f"databases.{name}"):
            database = stored_database(case, name, folder)
            if database.body_count != len(section.hulls):
                raise InputError(
                    f"{len(section.hulls)} hulls for a database of {database.body_count}",
                    key="hulls",
                    expected=f"one for each of {', '.join(database.bodies)}",
                )
        found.append(
            Radiation(
                bodies=section.hulls,
                database=database,
                memory=section.memory,
                memory_length=section.memory_length,
                fit_error=section.fit_error,
                drift=section.drift,
                fit=read_memory(folder.memory(name), memory_digest(case, section))
                if section.memory == "exponentials"
                else None,
            )
        )
    return tuple(found)


def database_manifest(folder: OutputFolder) -> dict[str, Any]:
    """What the mesh stage says of the databases, by name; empty if it has not run."""
    return dict((read_json(folder.database_manifest) or {}).get("items", {}))


def stored_database(case: Case, name: str, folder: OutputFolder) -> HydrodynamicDatabase:
    """Database of a case as its output folder has it; one of a file is read anew if it is absent or of other inputs.

    Raises
    ------
    InputError
        If one that has to be computed is not there, or a file cannot be read.
    """
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

    section, file = case.databases[name], folder.database(name)
    item = database_manifest(folder).get(name, {})
    if file.is_file() and item.get("digest") == database_digest(case, section):
        stored = replace(read_netcdf(file, checked=False), source=str(item["properties"]["source"]))
        return repaired(stored, section.repair) if section.file is None else stored
    if section.file is not None:
        return read_database_source(case, section)
    raise InputError(
        "has not been computed for these inputs",
        key="compute",
        expected="a database in the output folder; make it with `heavylift mesh CASE`",
    )


def read_database_source(case: Case, section: DatabaseSection) -> HydrodynamicDatabase:
    """Database from the file that a case names, called by this name, wherever the case folder is.

    Raises
    ------
    InputError
        If the file cannot be read, or is no database that can be true.
    """
    return replace(_read(case, section), source=str(section.file))


def _read(case: Case, section: DatabaseSection) -> HydrodynamicDatabase:
    """The same by the name that its reader gives it."""
    assert section.file is not None
    path = case.folder / section.file
    points = None if section.reference_points is None else np.array(section.reference_points)
    if section.file_format == "netcdf":
        from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

        return read_netcdf(
            path,
            time_convention=section.time_convention,
            reference_points=points,
            repair=section.repair,
        )
    if section.file_format == "bemio":
        from heavylift.preprocess.hydrodynamics.bemio_files import read_bemio

        return read_bemio(
            path, reference_points=points, symmetric=bool(section.symmetric), repair=section.repair
        )
    water = water_of(case)
    if section.file_format == "wamit-out":
        from heavylift.preprocess.hydrodynamics.wamit_files import read_wamit_out

        return read_wamit_out(
            path,
            density=water.density,
            bodies=section.hulls,
            symmetric=bool(section.symmetric),
            forces=section.forces or "diffraction",
            repair=section.repair,
        )
    from heavylift.preprocess.hydrodynamics.wamit_files import read_wamit

    def read(first_column: FirstColumn) -> HydrodynamicDatabase:
        return read_wamit(
            path,
            length=section.length_scale or 1.0,
            density=water.density,
            gravity=water.gravity,
            depth=water.depth,
            reference_points=np.zeros((len(section.hulls), 3)) if points is None else points,
            bodies=section.hulls,
            first_column=first_column,
            symmetric=bool(section.symmetric),
            repair=section.repair,
        )

    column = section.first_column or "period"
    other: FirstColumn = "frequency" if column == "period" else "period"
    try:
        found = read(column)
    except InputError as error:
        try:
            read(other)
        except InputError:
            raise error from None
        raise _of_the_other_column(error, column, other) from None
    if section.first_column is None and len(found.omega) >= FEWEST:
        scatter = implied_scatter(found)
        if scatter > DOUBTED:
            try:
                better = implied_scatter(read(other))
            except InputError:
                return found
            if better < BETTER * scatter:
                doubt = InputError(
                    f"added mass and damping do not belong to each other, by {scatter:.1%}",
                    source=str(path),
                    key="first_column",
                    expected=f"'first_column = \"{column}\"' if that is so",
                )
                raise _of_the_other_column(doubt, column, other)
    return found


DOUBTED, BETTER = 0.02, 0.2
"""`implied_scatter` from which a first column is doubted, and the part of it that the other reading must stay below."""


def _of_the_other_column(error: InputError, column: FirstColumn, other: FirstColumn) -> InputError:
    """The same error, with the word by which the file is sound."""
    what = {"period": "periods [s]", "frequency": "frequencies [rad/s]"}
    return InputError(
        f"{error.problem}; its first column was read as {what[column]}",
        source=error.source,
        key=error.key,
        expected=f"{error.expected}; or 'first_column = \"{other}\"', with which the file is sound: HAMS and others "
        "write frequencies, WAMIT periods",
    )
