"""Names of the package with their types, for editors and type checkers.

Written by `heavylift schema --python`; do not edit. The module itself imports each name when it is first used.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Required, TypedDict

from numpy.typing import NDArray
from heavylift.numerics.outcome import InputError as InputError, Outcome as Outcome
from heavylift.pipeline.case.case_file import Case as Case, load_case as load_case
from heavylift.pipeline.exchange.client import ExchangeError as ExchangeError, RemoteSimulation as RemoteSimulation, connect as connect, open_child as open_child
from heavylift.pipeline.model.components import Component as Component
from heavylift.pipeline.model.model import Model as Model, load as load
from heavylift.pipeline.model.results import Run as Run
from heavylift.pipeline.results.histories import Results as Results, load_results as load_results
from heavylift.pipeline.results.storage import StopError as StopError
from heavylift.pipeline.stages.stages import run_case as run_case
from heavylift.pipeline.stepping.simulation import Simulation as Simulation, SimulationStopped as SimulationStopped
from heavylift.pipeline.stepping.state import State as State
from heavylift.solver.linearise.result import Linearisation as Linearisation

__all__ = [
    "Ball", "Ballast", "BandContour", "BilateralLawContact", "Case", "Check", "ClearanceCriterion",
    "Clutch", "CoefficientLoad", "Component", "Controller", "Converge", "CraneCriterion", "CurveContour",
    "CylinderContour", "Cylindrical", "Database", "Deck", "Distance", "Drag", "DrivePositionInput",
    "DriveSpeedInput", "DynamicsCriterion", "EdgeClamp", "EdgeHinge", "Equalizer", "ExchangeError",
    "Falls", "Fender", "FixedJoint", "FleetAngle", "FlexibleBody", "FloatingCrane", "FluidDirectionInput",
    "FluidSpeedInput", "Fmu", "ForceInput", "FrameAngleInput", "FrameBody", "FramePositionInput",
    "FrameSpeedInput", "FrameTurnRateInput", "GantryCrane", "Gravity", "Guide", "HeightTargetInput",
    "HertzLawCollision", "HertzLawContact", "Hinge", "HookLoad", "Hull", "HuntCrossleyLawCollision",
    "HuntCrossleyLawContact", "InputError", "JointLoadInput", "JointMotor", "JointSpring",
    "LimitCriterion", "LineBearing", "LinearLawCollision", "LinearLawContact", "Linearisation",
    "LinkBeam", "Lug", "LugCriterion", "LumpedCable", "MaxwellRope", "Model", "MomentInput",
    "MooringLine", "Outcome", "Planar", "PointForce", "Pump", "Reference", "RelativeMotion",
    "RemoteSimulation", "Repeat", "Report", "Results", "RigidBody", "RigidLawCollision",
    "RigidLawContact", "RodBody", "Rope", "RopeGroup", "Run", "Scenario", "Screw", "Sea", "Sensor",
    "ShackleCriterion", "SharedLines", "ShellBody", "Simulate", "Simulation", "SimulationStopped",
    "SlackCriterion", "Slider", "SliderHinge", "SlingAngleCriterion", "SlingCriterion", "SpreadCriterion",
    "Spreader", "Spring", "SpringRope", "State", "StopError", "Surface", "SurfaceContour", "Tank",
    "TankRateInput", "ThesisLawCollision", "TiltCriterion", "TiltTargetInput", "TransportCriterion",
    "Transporter", "Tugger", "Universal", "WinchLengthInput", "WinchSpeedInput", "YieldCriterion",
    "connect", "load", "load_case", "load_results", "open_child", "run_case"
]

Quantity = float | str
"""A number in SI, or a text with a unit: ``"95 mm"``."""
Numbers = Sequence[Quantity] | NDArray[Any]
"""Several of them."""

BlockTable = TypedDict("BlockTable", {"name": Required[str], "from": Required[Numbers], "to": Required[Numbers]}, total=False)

class PlaneGroupTable(TypedDict, total=False):
    """Nodes in a plane across a coordinate axis."""
    plane: Required[Literal["x", "y", "z"]]
    at: Required[Quantity]

BoxGroupTable = TypedDict("BoxGroupTable", {"from": Required[Numbers], "to": Required[Numbers]}, total=False)

class FaceGroupTable(TypedDict, total=False):
    """Nodes of a named face of the geometry."""
    face: Required[str]

class BlocksGeometryTable(TypedDict, total=False):
    """Union of blocks minus the union of other blocks."""
    type: Required[Literal["blocks"]]
    add: Required[Sequence[BlockTable | Mapping[str, Any]]]
    cut: Sequence[BlockTable | Mapping[str, Any]]
    groups: Mapping[str, PlaneGroupTable | Mapping[str, Any] | BoxGroupTable | FaceGroupTable]

class StepGeometryTable(TypedDict, total=False):
    """Solids of a STEP file."""
    type: Required[Literal["step"]]
    file: Required[str]
    groups: Mapping[str, PlaneGroupTable | Mapping[str, Any] | BoxGroupTable | FaceGroupTable]

class MeshFileGeometryTable(TypedDict, total=False):
    """A deck of Abaqus, CalculiX or Nastran, or a mesh file of a format of meshio, with bricks or tet10."""
    type: Required[Literal["mesh"]]
    file: Required[str]
    length_unit: Quantity
    mass_unit: Quantity | None
    elements: Sequence[str]
    part: int | None
    merge_nodes: Quantity | None
    ignore_material: bool
    groups: Mapping[str, PlaneGroupTable | Mapping[str, Any] | BoxGroupTable | FaceGroupTable]

class FourFilesGeometryTable(TypedDict, total=False):
    """Matrices of a finite-element program: ``u0``, ``mij``, ``modeShapeMatrix``, ``stiffnessMatrix``."""
    type: Required[Literal["four_files"]]
    folder: Required[str]
    length_unit: Quantity
    mass_unit: Quantity
    stiffness_unit: Quantity
    clamped_nodes: Sequence[int] | NDArray[Any] | None
    groups: Mapping[str, PlaneGroupTable | Mapping[str, Any] | BoxGroupTable | FaceGroupTable]

class MatricesGeometryTable(TypedDict, total=False):
    """Stiffness and mass written by CalculiX (``.sti``, ``.mas``, ``.dof``) or Abaqus (``.mtx``), and the deck."""
    type: Required[Literal["matrices"]]
    file: Required[str]
    stiffness: str | None
    mass: str | None
    degrees: str | None
    length_unit: Quantity
    mass_unit: Quantity
    stiffness_unit: Quantity
    groups: Mapping[str, PlaneGroupTable | Mapping[str, Any] | BoxGroupTable | FaceGroupTable]

class MaterialTable(TypedDict, total=False):
    """Linear elastic, isotropic material; all of it, but for what a mesh file with materials brings."""
    young_modulus: Quantity | None
    poisson_ratio: Quantity | None
    density: Quantity | None

class OpeningTable(TypedDict, total=False):
    """An opening in a plate: round, or oblong with round ends."""
    centre: Required[Numbers]
    diameter: Quantity | None
    width: Quantity | None
    height: Quantity | None
    direction: Numbers | None
    step: Numbers | Sequence[Numbers] | NDArray[Any]
    count: int | Sequence[int] | NDArray[Any]

class PlateTable(TypedDict, total=False):
    """Plane plates of one thickness: a polygon and its copies, or faces of the file of the geometry."""
    step: Numbers | Sequence[Numbers] | NDArray[Any]
    count: int | Sequence[int] | NDArray[Any]
    thickness: Required[Quantity]
    corners: Sequence[Numbers] | NDArray[Any]
    faces: Sequence[str]
    across: Numbers | None
    at: Quantity | Numbers
    offset: Quantity
    nonstructural_mass: Quantity
    material: MaterialTable | Mapping[str, Any] | None
    openings: Sequence[OpeningTable | Mapping[str, Any]]

class ProfileTable(TypedDict, total=False):
    """Section of a stiffener or beam."""
    shape: Required[Literal["flat", "bulb", "angle", "tee", "round", "tube", "box", "channel", "h"]]
    height: Quantity | None
    thickness: Quantity | None
    width: Quantity | None
    flange_thickness: Quantity | None
    diameter: Quantity | None

class StiffenerTable(TypedDict, total=False):
    """Beams along a line and its copies, welded to a plate by their web or standing alone."""
    step: Numbers | Sequence[Numbers] | NDArray[Any]
    count: int | Sequence[int] | NDArray[Any]
    line: Required[Sequence[Numbers] | NDArray[Any]]
    section: Required[ProfileTable | Mapping[str, Any]]
    plate: str | None
    web: Required[Numbers]
    flange: Numbers | None
    material: MaterialTable | Mapping[str, Any] | None

class LugTable(TypedDict, total=False):
    """A lug with a pin hole on a plate; its name is that of the interface at the centre of the hole."""
    foot: Required[Numbers]
    along: Required[Numbers]
    normal: Required[Numbers]
    thickness: Required[Quantity]
    length: Required[Quantity]
    height: Required[Quantity]
    radius: Required[Quantity]
    hole: Required[Quantity]
    bracket: Quantity | None
    material: MaterialTable | Mapping[str, Any] | None

class PanelsGeometryTable(TypedDict, total=False):
    """Plates with stiffeners, openings and lugs, meshed with shells and beams."""
    type: Required[Literal["panels"]]
    plates: Required[Mapping[str, PlateTable | Mapping[str, Any]]]
    stiffeners: Mapping[str, StiffenerTable | Mapping[str, Any]]
    lugs: Mapping[str, LugTable | Mapping[str, Any]]
    file: str | None
    scale: Quantity
    groups: Mapping[str, PlaneGroupTable | Mapping[str, Any] | BoxGroupTable | FaceGroupTable]

class RefinementTable(TypedDict, total=False):
    """Smaller elements along edges of the geometry, where stresses are singular; for tetrahedra."""
    at: Required[str]
    size: Required[Quantity]
    growth: Quantity

class MeshTable(TypedDict, total=False):
    """How the geometry is meshed and the matrices are integrated; for blocks and STEP files."""
    element: Literal["tet10", "hex8"]
    size: Quantity | None
    refine: Sequence[RefinementTable | Mapping[str, Any]]
    curved: bool
    divisions: Mapping[str, Sequence[int] | NDArray[Any]]
    formulation: Literal["full", "incompatible", "reduced"] | None
    mass: Literal["consistent", "lumped"]

class PlateGroupTable(TypedDict, total=False):
    """Plates of a set of elements of a mesh file; what is left out is as the file says."""
    thickness: Quantity | None
    offset: Quantity | None
    nonstructural_mass: Quantity | None
    material: MaterialTable | Mapping[str, Any] | None

class StiffenerGroupTable(TypedDict, total=False):
    """Beams of a set of elements of a mesh file; what is left out is as the file says."""
    section: ProfileTable | Mapping[str, Any] | None
    web: Numbers | None
    flange: Numbers | None
    foot: Quantity | None
    material: MaterialTable | Mapping[str, Any] | None

ContactPatchTable = TypedDict("ContactPatchTable", {"on": Required[str], "from": Numbers | None, "to": Numbers | None, "centre": Numbers | None, "radius": Quantity | None, "footprint": bool, "directions": str}, total=False)

class ModesTable(TypedDict, total=False):
    """Reduction of a finite-element model to a few deformation shapes."""
    basis: Literal["eigenmodes", "craig_bampton", "krylov", "stored"]
    count: int
    up_to: Quantity | None
    clamp: Sequence[str]
    select: Sequence[int] | NDArray[Any]
    interface: Sequence[str]
    static_points: Sequence[Numbers] | NDArray[Any]
    static_groups: Sequence[str]
    static_directions: str
    attach: Literal["contour"] | None
    attach_directions: str | None
    patches: Sequence[ContactPatchTable | Mapping[str, Any]]
    order: int
    stiffening: bool
    damping_ratio: Quantity | Numbers
    stiffness_damping: Quantity

BodySupportTable = TypedDict("BodySupportTable", {"on": str | Sequence[str], "from": Numbers | None, "to": Numbers | None, "fixed": str | None, "rotations": str | None, "symmetry": Literal["x", "y", "z"] | None, "at": Quantity}, total=False)

StaticLoadTable = TypedDict("StaticLoadTable", {"on": str | Sequence[str], "from": Numbers | None, "to": Numbers | None, "pressure": Quantity | None, "traction": Numbers | None, "force": Numbers | None, "moment": Numbers | None, "acceleration": Numbers | None}, total=False)

class StaticCaseTable(TypedDict, total=False):
    """Loads under which a flexible body is at rest: linear, small displacements, on its finite-element model."""
    name: Required[str]
    loads: Required[Sequence[StaticLoadTable | Mapping[str, Any]]]
    buckling: bool

class InterfaceTable(TypedDict, total=False):
    """A place where others are attached: its motion is that of a group of nodes, or of a point of an element."""
    at: Numbers | None
    group: str | None
    radius: Quantity | None
    kind: Literal["average", "rigid"]

class StressGroupTable(TypedDict, total=False):
    """Points of a flexible body whose largest stress is told."""
    grade: str | None
    yield_strength: Quantity | None
    thickness: Quantity | None
    name: Required[str]

class HotSpotTable(TypedDict, total=False):
    """A weld toe whose structural stress is extrapolated from two points before it."""
    name: Required[str]
    toe: Required[Numbers]
    direction: Required[Numbers]
    thickness: Required[Quantity]
    side: Literal["top", "bottom"] | None

class StressTable(TypedDict, total=False):
    """Stress of a flexible body over the run: of groups at each record, and the envelope at all points."""
    grade: str | None
    yield_strength: Quantity | None
    thickness: Quantity | None
    groups: Sequence[StressGroupTable | Mapping[str, Any]]
    gamma_M: Quantity
    correction: bool
    hot_spots: Sequence[HotSpotTable | Mapping[str, Any]]
    panels: bool
    buckling: bool

class FreeTable(TypedDict, total=False):
    """The frame moves by the equations of motion."""
    origin: Literal["geometry", "centre_of_mass"]
    motion: Required[Literal["free"]]

class FixedTable(TypedDict, total=False):
    """The frame stays where it is; its reaction is recorded."""
    origin: Literal["geometry", "centre_of_mass"]
    motion: Required[Literal["fixed"]]

class TravelHarmonicTable(TypedDict, total=False):
    """``amplitude sin(2 pi frequency t + phase)``."""
    amplitude: Required[Quantity]
    frequency: Required[Quantity]
    phase: Quantity

class TravelProfileTable(TypedDict, total=False):
    """A function of time: a smooth curve through a table, or speeds, plus harmonics. A table is at rest before
    and after its times; speeds begin from 0 at the start.
    """
    times: Numbers
    values: Numbers
    harmonics: Sequence[TravelHarmonicTable | Mapping[str, Any]]
    interpolation: Literal["smooth", "monotone"]
    speeds: Numbers
    acceleration: Quantity | None
    jerk: Quantity | None

class DrivenTable(TypedDict, total=False):
    """The frame follows functions of time; its reaction and the work of the drive are recorded."""
    origin: Literal["geometry", "centre_of_mass"]
    motion: Required[Literal["driven"]]
    x: TravelProfileTable | Mapping[str, Any] | None
    y: TravelProfileTable | Mapping[str, Any] | None
    z: TravelProfileTable | Mapping[str, Any] | None
    angle: TravelProfileTable | Mapping[str, Any] | None
    axis: Numbers
    pivot: Numbers

class AxisAngleTable(TypedDict, total=False):
    """A rotation about an axis."""
    axis: Required[Numbers]
    angle: Required[Quantity]

class InitialTable(TypedDict, total=False):
    """Initial state of a flexible body."""
    position: Numbers | None
    orientation: AxisAngleTable | Mapping[str, Any] | None
    velocity: Numbers | None
    angular_velocity: Numbers | None
    modal_scaling: Literal["unit_max", "mass"]
    modal_position: Numbers
    modal_velocity: Numbers

class RigidInitialTable(TypedDict, total=False):
    """Initial state of the frame of a body."""
    position: Numbers | None
    orientation: AxisAngleTable | Mapping[str, Any] | None
    velocity: Numbers | None
    angular_velocity: Numbers | None

class MeshDampingTable(TypedDict, total=False):
    """Damping of a frame or shell."""
    viscous: Quantity
    stiffness: Quantity

class LineShapeTable(TypedDict, total=False):
    """A straight line, cut into equal elements."""
    type: Required[Literal["line"]]
    start: Required[Numbers]
    end: Required[Numbers]
    elements: Required[int]

ArcShapeTable = TypedDict("ArcShapeTable", {"type": Required[Literal["arc"]], "centre": Numbers, "radius": Required[Quantity], "from": Quantity, "to": Required[Quantity], "normal": Numbers, "reference": Numbers, "elements": Required[int]}, total=False)

class SplineShapeTable(TypedDict, total=False):
    """A smooth curve through points, cut into elements of equal length, or at the points."""
    type: Required[Literal["spline"]]
    points: Sequence[Numbers] | NDArray[Any]
    file: str | None
    elements: int | None

class FrameSectionTableTable(TypedDict, total=False):
    """Cross-section and material of a frame: round, a tube, square, or by its numbers."""
    density: Required[Quantity]
    young_modulus: Required[Quantity]
    diameter: Quantity | None
    wall: Quantity | None
    side: Quantity | None
    area: Quantity | None
    second_moment: Quantity | None
    outer_fibre: Quantity | None
    torsion_constant: Quantity | None

class FrameRegionTable(TypedDict, total=False):
    """Elements of a frame with another section or another pre-stress than the others; the last region counts."""
    elements: Sequence[int] | NDArray[Any]
    box: BoxGroupTable | Mapping[str, Any] | None
    section: str | None
    axial_strain: Quantity | None

class FrameFixedTable(TypedDict, total=False):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""
    position: str | None
    tangent: str | None

class FrameSupportTable(TypedDict, total=False):
    """Nodes of a frame that are held to the ground."""
    nodes: Sequence[int] | NDArray[Any]
    point: Numbers | None
    box: BoxGroupTable | Mapping[str, Any] | None
    at: Literal["start", "end"] | Sequence[Literal["start", "end"]]
    fix: Literal["pinned", "clamped"] | None
    fixed: FrameFixedTable | Mapping[str, Any] | None

class LineLoadTable(TypedDict, total=False):
    """A load along a frame that keeps its direction."""
    type: Literal["distributed"]
    times: Numbers
    factors: Numbers
    elements: Sequence[int] | NDArray[Any]
    force: Required[Numbers]

class LineFollowerTable(TypedDict, total=False):
    """A load along a frame that turns with it."""
    type: Required[Literal["follower"]]
    axis: Numbers
    times: Numbers
    factors: Numbers
    elements: Sequence[int] | NDArray[Any]
    normal: Quantity
    tangential: Quantity

class FollowerForceTable(TypedDict, total=False):
    """A force on one node of a frame that turns with it."""
    type: Required[Literal["follower_force"]]
    axis: Numbers
    times: Numbers
    factors: Numbers
    at: Literal["start", "end"] | None
    node: int | None
    normal: Quantity
    tangential: Quantity

class RodFixedTable(TypedDict, total=False):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""
    position: str | None
    tangent: str | None
    normal: str | None
    binormal: str | None

class RodSupportTable(TypedDict, total=False):
    """Nodes of a rod that are held to the ground."""
    nodes: Sequence[int] | NDArray[Any]
    point: Numbers | None
    box: BoxGroupTable | Mapping[str, Any] | None
    at: Literal["start", "end"] | Sequence[Literal["start", "end"]]
    fix: Literal["pinned", "clamped"] | None
    fixed: RodFixedTable | Mapping[str, Any] | None

class RectangleShapeTable(TypedDict, total=False):
    """A rectangle in the x-y plane of the body, its corner ``x_min y_min`` at the origin, cut into equal
    elements.
    """
    type: Required[Literal["rectangle"]]
    size: Required[Numbers]
    elements: Required[int | Sequence[int] | NDArray[Any]]

class QuadrilateralShapeTable(TypedDict, total=False):
    """A plane quadrilateral with straight edges, cut into as many parts on opposite edges."""
    type: Required[Literal["quadrilateral"]]
    corners: Required[Sequence[Numbers] | NDArray[Any]]
    elements: Required[int | Sequence[int] | NDArray[Any]]

class GridShapeTable(TypedDict, total=False):
    """A plane mesh of quadrilaterals through given points."""
    type: Required[Literal["grid"]]
    points: Sequence[Numbers] | NDArray[Any]
    file: str | None
    elements: Required[int | Sequence[int] | NDArray[Any]]

class ShellSectionTableTable(TypedDict, total=False):
    """Thickness and material of a shell."""
    density: Required[Quantity]
    young_modulus: Required[Quantity]
    thickness: Required[Quantity]
    poisson_ratio: Required[Quantity]

class RegionTable(TypedDict, total=False):
    """Elements with another section than the others; of several regions with an element the last one counts."""
    elements: Sequence[int] | NDArray[Any]
    box: BoxGroupTable | Mapping[str, Any] | None
    section: Required[str]

class ShellFixedTable(TypedDict, total=False):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""
    position: str | None
    slope_x: str | None
    slope_y: str | None
    twist: str | None

class ShellSupportTable(TypedDict, total=False):
    """Nodes of a shell that are held to the ground."""
    nodes: Sequence[int] | NDArray[Any]
    point: Numbers | None
    box: BoxGroupTable | Mapping[str, Any] | None
    edge: Literal["x_min", "x_max", "y_min", "y_max", "all"] | Sequence[Literal["x_min", "x_max", "y_min", "y_max", "all"]]
    corner: Literal["x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max", "all"] | Sequence[Literal["x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max", "all"]]
    fix: Literal["pinned", "hinged", "clamped"] | None
    sliding: bool
    twist_free: bool
    fixed: ShellFixedTable | Mapping[str, Any] | None

class AreaLoadTable(TypedDict, total=False):
    """A load on a shell that keeps its direction."""
    type: Literal["distributed"]
    times: Numbers
    factors: Numbers
    elements: Sequence[int] | NDArray[Any]
    force: Required[Numbers]

class PressureLoadTable(TypedDict, total=False):
    """A pressure on a shell, along its normal as it turns."""
    type: Required[Literal["pressure"]]
    times: Numbers
    factors: Numbers
    elements: Sequence[int] | NDArray[Any]
    pressure: Required[Quantity]

class AngleLimitsTable(TypedDict, total=False):
    """Stops of an angle: a spring and a damper beyond each."""
    lower: Quantity | None
    upper: Quantity | None
    stiffness: Required[Quantity]
    damping: Quantity

class TravelLimitsTable(TypedDict, total=False):
    """Stops of a travel: a spring and a damper beyond each."""
    lower: Quantity | None
    upper: Quantity | None
    stiffness: Required[Quantity]
    damping: Quantity

class RopePointTable(TypedDict, total=False):
    """A place the rope passes: an end, an eye, or a pulley."""
    body: Required[str]
    point: Required[Numbers | str]
    radius: Quantity
    axis: Numbers | None
    efficiency: Quantity
    friction: Quantity

class WinchTable(TypedDict, total=False):
    """How a winch hauls in: its speed, the length or the tension of the rope, at some times; or as another one."""
    times: Numbers
    speeds: Numbers
    lengths: Numbers
    speed: Quantity | None
    acceleration: Quantity | None
    jerk: Quantity | None
    tensions: Numbers
    dead_band: Quantity
    brake: Quantity | None
    follow: str | None
    ratio: Quantity
    fastest: Quantity | None
    end: Literal["first", "last", "both"]

class MoveTable(TypedDict, total=False):
    """A move over a distance: from rest to a speed along a ramp, on, and to rest along another one."""
    start: Required[Quantity]
    distance: Required[Quantity]
    speed: Required[Quantity]
    ramp: Quantity

class HoistTable(TypedDict, total=False):
    """A hoist on a trolley, and its hook."""
    at: Numbers
    drop: Required[Quantity]
    parts: Required[int]
    moves: Sequence[MoveTable | Mapping[str, Any]]

class TrolleyTable(TypedDict, total=False):
    """A trolley on the girder."""
    mass: Quantity
    position: Quantity
    moves: Sequence[MoveTable | Mapping[str, Any]]
    hoists: Required[Sequence[HoistTable | Mapping[str, Any]]]

class HookBlockTable(TypedDict, total=False):
    """The hook block: sheaves about y of its axes, and the hook below them."""
    mass: Required[Quantity]
    inertia: Numbers | Sequence[Numbers] | NDArray[Any] | None
    hook_depth: Quantity

class FallsRopeTable(TypedDict, total=False):
    """The rope of falls."""
    axial_stiffness: Required[Quantity]
    damping: Quantity
    tension: Quantity | None
    brake: Quantity | None
    fastest: Quantity | None

class BoomTable(TypedDict, total=False):
    """The boom: x of its axes from the foot to the head, y across it."""
    length: Required[Quantity]
    angle: Required[Quantity]
    mass: Required[Quantity]
    centre: Quantity | None
    width: Quantity

class BoomStayTable(TypedDict, total=False):
    """The rope that holds and luffs the boom."""
    head: Required[Numbers]
    parts: Required[int]
    at: Quantity | None
    rope: Required[FallsRopeTable | Mapping[str, Any]]

class TurnTable(TypedDict, total=False):
    """A turn through an angle: from rest to a speed along a ramp, on, and to rest along another one."""
    start: Required[Quantity]
    angle: Required[Quantity]
    speed: Required[Quantity]
    ramp: Quantity

class SlewingTable(TypedDict, total=False):
    """A table on the hull that turns with boom, stay and winches."""
    centre: Required[Numbers]
    mass: Required[Quantity]
    radius: Quantity
    moves: Sequence[TurnTable | Mapping[str, Any]]
    driven: bool

class BoomHookTable(TypedDict, total=False):
    """A hook at the head of the boom."""
    number: int | None
    at: Numbers
    drop: Required[Quantity]
    parts: Required[int]
    winch: Numbers | None
    tension: Quantity | None
    moves: Sequence[MoveTable | Mapping[str, Any]]

class FallsCrownTable(TypedDict, total=False):
    """Where a part of the falls is on what carries it."""
    body: Required[str]
    point: Required[Numbers | str]

class EqualizerHookTable(TypedDict, total=False):
    """What an equalizer hangs on."""
    body: Required[str]
    point: Required[Numbers | str]

class EqualizerBeamTable(TypedDict, total=False):
    """The beam that carries guides and fixed sheaves."""
    mass: Required[Quantity]
    inertia: Numbers | Sequence[Numbers] | NDArray[Any] | None

class EqualizerPulleyTable(TypedDict, total=False):
    """The moving pulleys."""
    mass: Required[Quantity]
    inertia: Numbers | Sequence[Numbers] | NDArray[Any] | None

class EqualizerTravelTable(TypedDict, total=False):
    """How far pulleys move on their guides, from the place where all are at the same depth."""
    up: Required[Quantity]
    down: Required[Quantity]
    stiffness: Quantity
    damping: Quantity
    at_stops: bool

class EqualizerRopeTable(TypedDict, total=False):
    """The rope over all pulleys, or what all lines are made of."""
    axial_stiffness: Required[Quantity]
    damping: Quantity

class EqualizerLineTable(TypedDict, total=False):
    """A line from a moving pulley to the load."""
    body: Required[str]
    point: Required[Numbers | str]
    other_point: Numbers | None
    length: Quantity | None
    count: int

class EqualizerExtensionTable(TypedDict, total=False):
    """Extension pulleys, each under a line, with a sling to two lugs."""
    mass: Required[Quantity]
    radius: Required[Quantity]
    sling_length: Required[Quantity]

class SpreaderBeamTable(TypedDict, total=False):
    """The beam."""
    mass: Required[Quantity]
    length: Required[Quantity]
    depth: Quantity
    inertia: Numbers | Sequence[Numbers] | NDArray[Any] | None

class SpreaderLineTable(TypedDict, total=False):
    """A line from the beam to the load."""
    at: Required[Quantity]
    body: Required[str]
    point: Required[Numbers | str]
    length: Quantity | None

FaceTable = TypedDict("FaceTable", {"on": str | None, "plane": Literal["x", "y", "z"] | None, "at": Quantity | None, "from": Numbers | None, "to": Numbers | None}, total=False)

class SurfaceSplineTable(TypedDict, total=False):
    """A surface of another program, as B-spline or NURBS."""
    degree: int | Sequence[int] | NDArray[Any]
    knots: Required[Sequence[Numbers] | NDArray[Any]]
    control: Required[Sequence[Sequence[Numbers] | NDArray[Any]]]
    weights: Sequence[Numbers] | NDArray[Any]

class CircleTable(TypedDict, total=False):
    """A circle: points on it, or the nodes of a flexible body that lie on it."""
    centre: Numbers
    axis: Required[Numbers]
    radius: Required[Quantity]
    points: int | None

class CurveSplineTable(TypedDict, total=False):
    """A curve of another program, as B-spline or NURBS."""
    degree: int
    knots: Required[Numbers]
    control: Required[Sequence[Numbers] | NDArray[Any]]
    weights: Numbers

class PointShapeTable(TypedDict, total=False):
    """The point itself."""
    type: Required[Literal["point"]]

class SphereShapeTable(TypedDict, total=False):
    """A ball about the point."""
    type: Required[Literal["sphere"]]
    radius: Required[Quantity]

class CircleShapeTable(TypedDict, total=False):
    """A thin ring, the rim of a disc or wheel, about the point."""
    type: Required[Literal["circle"]]
    radius: Required[Quantity]
    axis: Required[Numbers]

class TurnTable2(TypedDict, total=False):
    """A rotation from the axes of the body to those of a shape."""
    axis: Required[Numbers]
    angle: Required[Quantity]

class EllipsoidShapeTable(TypedDict, total=False):
    """An ellipsoid about the point."""
    type: Required[Literal["ellipsoid"]]
    half_axes: Required[Numbers]
    turned: TurnTable2 | Mapping[str, Any] | None

class BoxShapeTable(TypedDict, total=False):
    """A box about the point, with rounded edges: on a sharp one the direction of a contact would jump."""
    type: Required[Literal["box"]]
    size: Required[Numbers]
    rounding: Required[Quantity]
    turned: TurnTable2 | Mapping[str, Any] | None

class CapsuleShapeTable(TypedDict, total=False):
    """A round bar with half balls as ends, about the point."""
    type: Required[Literal["capsule"]]
    radius: Required[Quantity]
    length: Required[Quantity]
    axis: Required[Numbers]

class CylinderShapeTable(TypedDict, total=False):
    """A round bar with rounded rims, about the point."""
    type: Required[Literal["cylinder"]]
    radius: Required[Quantity]
    length: Required[Quantity]
    rounding: Required[Quantity]
    axis: Required[Numbers]

class PlaneShapeTable(TypedDict, total=False):
    """A rectangle about the origin, in the plane of x and y."""
    type: Required[Literal["plane"]]
    size: Required[Numbers]

class BoxShapeTable2(TypedDict, total=False):
    """A box about the origin."""
    type: Required[Literal["box"]]
    size: Required[Numbers]

class SphereShapeTable2(TypedDict, total=False):
    """A ball about the origin, exactly round."""
    type: Required[Literal["sphere"]]
    radius: Required[Quantity]

class CapsuleShapeTable2(TypedDict, total=False):
    """A round bar with half balls as ends about the origin, exactly round."""
    type: Required[Literal["capsule"]]
    radius: Required[Quantity]
    length: Required[Quantity]
    axis: Numbers

class CylinderShapeTable2(TypedDict, total=False):
    """A cylinder about the origin: a prism of many sides."""
    type: Required[Literal["cylinder"]]
    radius: Required[Quantity]
    length: Required[Quantity]
    axis: Numbers
    sides: int

class ExclusionTable(TypedDict, total=False):
    """A box that moves with the body: triangles completely on one side of it are excluded from collisions."""
    centre: Required[Numbers]
    size: Required[Numbers]
    turned: TurnTable2 | Mapping[str, Any] | None
    keep: Literal["outside", "inside"]

class RegularWavesTable(TypedDict, total=False):
    """One sinusoidal wave."""
    type: Required[Literal["regular"]]
    direction: Quantity
    height: Required[Quantity]
    period: Required[Quantity]
    phase: Quantity

class SpreadingTable(TypedDict, total=False):
    """Directions of irregular waves about their mean: cos^2s of half the angle."""
    exponent: Required[Quantity]
    directions: int

class JonswapWavesTable(TypedDict, total=False):
    """Irregular waves of the JONSWAP spectrum."""
    type: Required[Literal["jonswap"]]
    direction: Quantity
    seed: Required[int]
    count: int
    bins: Literal["random", "equal"]
    amplitudes: Literal["deterministic", "rayleigh"]
    spreading: SpreadingTable | Mapping[str, Any] | None
    frequency_range: Numbers | None
    significant_height: Required[Quantity]
    peak_period: Required[Quantity]
    gamma: Quantity

class PiersonMoskowitzWavesTable(TypedDict, total=False):
    """Irregular waves of the Pierson-Moskowitz spectrum with two parameters (Bretschneider, ISSC)."""
    type: Required[Literal["pierson-moskowitz"]]
    direction: Quantity
    seed: Required[int]
    count: int
    bins: Literal["random", "equal"]
    amplitudes: Literal["deterministic", "rayleigh"]
    spreading: SpreadingTable | Mapping[str, Any] | None
    frequency_range: Numbers | None
    significant_height: Required[Quantity]
    peak_period: Required[Quantity]

class SpectrumWavesTable(TypedDict, total=False):
    """Irregular waves of a spectrum in a file."""
    type: Required[Literal["spectrum"]]
    direction: Quantity
    seed: Required[int]
    count: int
    bins: Literal["random", "equal"]
    amplitudes: Literal["deterministic", "rayleigh"]
    spreading: SpreadingTable | Mapping[str, Any] | None
    frequency_range: Numbers | None
    file: Required[str]

class ElevationWavesTable(TypedDict, total=False):
    """Waves through an elevation that was measured at one place."""
    type: Required[Literal["elevation"]]
    direction: Quantity
    file: Required[str]
    place: Numbers
    frequency_range: Numbers | None

class NpdTurbulenceTable(TypedDict, total=False):
    """Fluctuation of the wind by the NPD spectrum of ISO 19901-1."""
    type: Literal["npd"]
    seed: Required[int]
    count: int
    height: Quantity
    step: Quantity

class AngleVeeringTable(TypedDict, total=False):
    """A direction that changes in time, linear between."""
    times: Required[Numbers]
    angles: Required[Numbers]

class WindFieldTable(TypedDict, total=False):
    """Wind above the still water."""
    name: str
    spectrum: NpdTurbulenceTable | Mapping[str, Any] | None
    speed: Required[Quantity]
    averaging_time: Quantity
    direction: Quantity | AngleVeeringTable | Mapping[str, Any]
    profile: Literal["log", "power", "uniform"]
    exponent: Quantity | None
    gust: Quantity | None
    density: Quantity

class CurrentProfileTable(TypedDict, total=False):
    """A current over the depth, linear between, held beyond."""
    depths: Required[Numbers]
    speeds: Required[Numbers]

class CurrentFieldTable(TypedDict, total=False):
    """Current below the still water."""
    name: str
    speed: Required[Quantity | CurrentProfileTable | Mapping[str, Any]]
    direction: Quantity | AngleVeeringTable | Mapping[str, Any]

class TideTable(TypedDict, total=False):
    """Still water that rises and falls."""
    times: Required[Numbers]
    levels: Required[Numbers]

class LinearRestoringTable(TypedDict, total=False):
    """Buoyancy for small motions about a float plane, in numbers."""
    volume: Required[Quantity]
    centre_of_buoyancy: Required[Numbers]
    reference: Required[Numbers]
    area: Required[Quantity]
    first_moments: Numbers
    second_moments: Required[Numbers]

class HangingTable(TypedDict, total=False):
    """What hangs on a hull by ropes, as if its mass were where it hangs."""
    mass: Required[Quantity]
    point: Required[Numbers]

class FrequenciesTable(TypedDict, total=False):
    """Equal steps of the frequency."""
    first: Required[Quantity]
    last: Required[Quantity]
    count: Required[int]

class ComputeTable(TypedDict, total=False):
    """A database that the mesh stage computes with Capytaine, from the surfaces of the hulls below the still
    water.
    """
    panel_size: Required[Quantity]
    frequencies: Required[FrequenciesTable | Mapping[str, Any]]
    heading_step: Quantity
    headings: Numbers
    symmetric: bool
    lid: bool
    processes: int

class LevelPointTable(TypedDict, total=False):
    """A point of a hull whose height a controller keeps."""
    point: Required[Numbers | str]
    height: Required[Quantity]
    of: str
    beside: Numbers | None

class DragPieceTable(TypedDict, total=False):
    """A piece of a body at its own height."""
    point: Required[Numbers | str]
    area: Quantity | None
    areas: Numbers | None
    coefficient: Quantity
    vertical: bool
    extent: Quantity

class LineSectionTable(TypedDict, total=False):
    """A piece of a line with the same properties all along."""
    length: Quantity | None
    weight: Required[Quantity]
    axial_stiffness: Quantity | None

class SeabedSlopeTable(TypedDict, total=False):
    """A bottom that is an inclined plane. Of a line its slope in the vertical plane of the two ends counts."""
    angle: Required[Quantity]
    downhill: Quantity
    point: Numbers | None

class BumpTable(TypedDict, total=False):
    """A bump across a deck."""
    start: Required[Quantity]
    length: Required[Quantity]
    height: Required[Quantity]
    shape: Literal["cosine", "smooth"]

class HeightGridTable(TypedDict, total=False):
    """Heights over a rectangle of a deck, whose first and last stations and offsets are its borders. Each cell
    of the grid is four plane triangles about its middle, which is as high as the mean of its corners. From
    the surface that is linear in both directions (bilinear) they differ by a sixteenth of ``h00 - h10 - h01 +
    h11`` at most.
    """
    file: str | None
    stations: Numbers
    offsets: Numbers
    heights: Sequence[Numbers] | NDArray[Any]

class OilPumpTable(TypedDict, total=False):
    """Oil that is pumped into a group, as the lift of all bogies of the group."""
    times: Required[Numbers]
    lifts: Required[Numbers]

class BogieGroupTable(TypedDict, total=False):
    """Bogies whose cylinders share their oil: one pressure."""
    name: Required[str]
    bogies: Required[Sequence[Numbers] | NDArray[Any]]
    oil_stiffness: Quantity | None
    gas_length: Quantity | None
    constant_force: bool
    relief_force: Quantity | None
    leak_speed: Quantity
    load: Quantity | None
    pump: OilPumpTable | Mapping[str, Any] | None

class PathLegTable(TypedDict, total=False):
    """A leg of the path of a transporter, from rest to rest, in the plan of the ground and the decks at the
    start.
    """
    steering: Literal["all", "front", "rear", "crab", "carousel"]
    points: Sequence[Numbers] | NDArray[Any]
    curve: Literal["corners", "smooth"]
    radius: Quantity | None
    transition: Quantity
    turn: Quantity | None
    centre: Numbers
    speed: Required[Quantity]
    acceleration: Quantity
    pause: Quantity

class DriveTable(TypedDict, total=False):
    """Motors and brakes: all driven bogies push with one force, as hydraulic motors in parallel do."""
    bogies: Sequence[int] | NDArray[Any]
    rolling_resistance: Quantity
    friction: Quantity
    speeds: Numbers
    forces: Numbers
    brake_force: Quantity | None

class TyresTable(TypedDict, total=False):
    """Tyres with side slip, all alike: side forces by the angle between rolling direction and velocity of a
    bogie.
    """
    cornering: Required[Quantity]
    relaxation_length: Quantity
    damping_time: Quantity
    steering_errors: Numbers

class LevellingTable(TypedDict, total=False):
    """Pumps that keep a vehicle level: they sample its tilt at intervals, and lift and lower its groups."""
    speed: Required[Quantity]
    time_constant: Quantity
    period: Quantity
    dead_angle: Quantity
    roll: Quantity
    pitch: Quantity

class ActionTable(TypedDict, total=False):
    """What happens when a phase begins: commands to a winch, hook, drive, tank, path; release, connection, note."""
    winch: str | Sequence[str] | None
    hook: str | Sequence[str] | None
    drive: str | Sequence[str] | None
    tank: str | Sequence[str] | None
    path: str | Sequence[str] | None
    release: str | Sequence[str] | None
    fail: str | Sequence[str] | None
    restore: str | Sequence[str] | None
    connect: str | Sequence[str] | None
    note: str | None
    horn: str | None
    speed: Quantity | None
    ramp: Quantity
    acceleration: Quantity | None
    distance: Quantity | None
    jerk: Quantity | None
    level: bool | None
    dead_band: Quantity
    brake: bool | None
    length: Quantity | None
    follow: str | None
    ratio: Quantity
    tension: Quantity | None
    height: Quantity | None
    position: Quantity | None
    rate: Quantity | None
    mass: Quantity | None
    planned: Literal[True] | None
    slack: Quantity
    pitch: Quantity

class ConditionTable(TypedDict, total=False):
    """Something that becomes true."""
    quantity: str | None
    of: str | Sequence[str] | None
    taut: str | Sequence[str] | None
    slack: str | Sequence[str] | None
    above: Quantity | None
    below: Quantity | None
    time: Quantity | None
    arrived: str | Sequence[str] | None
    user: Literal["continue"] | None
    hold: Quantity

class UntilTable(TypedDict, total=False):
    """When a phase ends: a condition, or several."""
    quantity: str | None
    of: str | Sequence[str] | None
    taut: str | Sequence[str] | None
    slack: str | Sequence[str] | None
    above: Quantity | None
    below: Quantity | None
    time: Quantity | None
    arrived: str | Sequence[str] | None
    user: Literal["continue"] | None
    hold: Quantity
    all: Sequence[ConditionTable | Mapping[str, Any]]
    any: Sequence[ConditionTable | Mapping[str, Any]]

class LimitTable(TypedDict, total=False):
    """What has to be so while a phase lasts."""
    quantity: Required[str]
    of: str | Sequence[str] | None
    above: Quantity | None
    below: Quantity | None
    otherwise: Literal["stop", "warn"]

class TimeoutTable(TypedDict, total=False):
    """When a phase takes too long."""
    after: Required[Quantity]
    then: Literal["stop"]

class PhaseTable(TypedDict, total=False):
    """A part of an operation."""
    name: Required[str]
    actions: Sequence[ActionTable | Mapping[str, Any]]
    until: UntilTable | Mapping[str, Any] | None
    limits: Sequence[LimitTable | Mapping[str, Any]]
    timeout: TimeoutTable | Mapping[str, Any] | None

class TrackTable(TypedDict, total=False):
    """Phases that run in parallel with the others, as of a crane that works independently."""
    name: Required[str]
    phases: Required[Sequence[PhaseTable | Mapping[str, Any]]]

class StageLoadTable(TypedDict, total=False):
    """A load on the hull at a stage."""
    mass: Required[Quantity]
    point: Required[Numbers]
    length: Quantity

class BallastStageTable(TypedDict, total=False):
    """A moment of the operation: where its loads are, and how the hull is to lie."""
    name: Required[str]
    loads: Sequence[StageLoadTable | Mapping[str, Any]]
    time: Quantity | None
    draft: Quantity | None
    heel: Quantity | None
    trim: Quantity | None

class LightshipTable(TypedDict, total=False):
    """How the mass of the hull is spread along it."""
    stations: Required[Numbers]
    weights: Required[Numbers]

class AnimationTable(TypedDict, total=False):
    """A moving picture of a run: its bodies, and what is attached to them."""
    enabled: bool
    frames: int
    duration: Quantity | None
    format: Literal["auto", "gif", "mp4"]

class QuantityReferenceTable(TypedDict, total=False):
    """A reference that is itself computed."""
    quantity: Required[str]

class RunReferenceTable(TypedDict, total=False):
    """A reference that is the same quantity of another run."""
    run: Required[Any]

class SeriesTable(TypedDict, total=False):
    """One curve of a study of several: some keys of the case are set, then one parameter takes its values."""
    name: Required[str]
    set: Mapping[str, Any]
    parameter: Required[str]
    values: Required[Sequence[Any]]

class ToleranceTable(TypedDict, total=False):
    """Largest error that passes; exactly one of the two."""
    relative: Quantity | None
    absolute: Quantity | None

class CurveTable(TypedDict, total=False):
    """What a crane may carry at a radius: linear between its rows, nothing outside."""
    radius: Required[Numbers]
    capacity: Required[Numbers]

class PlaceTable(TypedDict, total=False):
    """A point of a body, or of the ground."""
    body: Required[str]
    point: Required[Numbers | str]

class ReachTable(TypedDict, total=False):
    """Between which points the radius of a crane is."""
    centre: Required[PlaceTable | Mapping[str, Any]]
    tip: Required[PlaceTable | Mapping[str, Any]]

class Repeat(Component):
    """Tables that are copied for i = first, ..., first + count - 1; {i+1} in a text becomes a number.

    Parameters
    ----------
    count : integer >= 0 or text
        Number of copies: an integer, or arithmetic of the parameters such as "n + 1".
    first : integer or text, default 0
        The first index: an integer, or arithmetic of the parameters.
    shift : 3 x length [m], default [0.0, 0.0, 0.0]
        Added i times to places in the world at the start [m]: positions of bodies, pivots of driven
        frames, at of joints and contacts, points and surfaces on the ground.
    bodies : table, optional
        Bodies by name, as in the case.
    joints : list of table, optional
        Joints, as in the case.
    ropes : list of table, optional
        Ropes, as in the case.
    gantry_cranes : list of table, optional
        Gantry cranes, as in the case.
    floating_cranes : list of table, optional
        Floating cranes, as in the case.
    falls : list of table, optional
        Falls, as in the case.
    equalizers : list of table, optional
        Equalizers, as in the case.
    spreaders : list of table, optional
        Spreaders, as in the case.
    link_beams : list of table, optional
        Link beams, as in the case.
    forces : list of table, optional
        Forces, as in the case.
    contours : table, optional
        Contours by name, as in the case.
    contacts : list of table, optional
        Contacts, as in the case.
    surfaces : list of table, optional
        Surfaces, as in the case.
    collisions : list of table, optional
        Collisions, as in the case.
    hulls : table, optional
        Hulls by name, as in the case.
    databases : table, optional
        Databases by name, as in the case.
    tanks : list of table, optional
        Tanks, as in the case.
    pumps : list of table, optional
        Pumps, as in the case.
    controllers : list of table, optional
        Controllers, as in the case.
    fluid_loads : list of table, optional
        Loads of wind and current, as in the case.
    lines : list of table, optional
        Mooring lines, as in the case.
    fenders : list of table, optional
        Fenders, as in the case.
    decks : list of table, optional
        Decks, as in the case.
    transporters : list of table, optional
        Transporters, as in the case.
    sensors : list of table, optional
        Sensors, as in the case.
    relative_motions : list of table, optional
        Relative motions, as in the case.
    leads : list of table, optional
        Fleet angles, as in the case.
    lugs : list of table, optional
        Lugs, as in the case.
    hook_loads : list of table, optional
        Hook loads, as in the case.
    rope_groups : list of table, optional
        Rope groups, as in the case.
    fmus : list of table, optional
        FMUs, as in the case.
    inputs : list of table, optional
        Inputs, as in the case.
    """

    def __init__(
        self,
        *,
        count: int | str,
        first: int | str = ...,
        shift: Numbers = ...,
        bodies: Mapping[str, Mapping[str, Any]] = ...,
        joints: Sequence[Mapping[str, Any]] = ...,
        ropes: Sequence[Mapping[str, Any]] = ...,
        gantry_cranes: Sequence[Mapping[str, Any]] = ...,
        floating_cranes: Sequence[Mapping[str, Any]] = ...,
        falls: Sequence[Mapping[str, Any]] = ...,
        equalizers: Sequence[Mapping[str, Any]] = ...,
        spreaders: Sequence[Mapping[str, Any]] = ...,
        link_beams: Sequence[Mapping[str, Any]] = ...,
        forces: Sequence[Mapping[str, Any]] = ...,
        contours: Mapping[str, Mapping[str, Any]] = ...,
        contacts: Sequence[Mapping[str, Any]] = ...,
        surfaces: Sequence[Mapping[str, Any]] = ...,
        collisions: Sequence[Mapping[str, Any]] = ...,
        hulls: Mapping[str, Mapping[str, Any]] = ...,
        databases: Mapping[str, Mapping[str, Any]] = ...,
        tanks: Sequence[Mapping[str, Any]] = ...,
        pumps: Sequence[Mapping[str, Any]] = ...,
        controllers: Sequence[Mapping[str, Any]] = ...,
        fluid_loads: Sequence[Mapping[str, Any]] = ...,
        lines: Sequence[Mapping[str, Any]] = ...,
        fenders: Sequence[Mapping[str, Any]] = ...,
        decks: Sequence[Mapping[str, Any]] = ...,
        transporters: Sequence[Mapping[str, Any]] = ...,
        sensors: Sequence[Mapping[str, Any]] = ...,
        relative_motions: Sequence[Mapping[str, Any]] = ...,
        leads: Sequence[Mapping[str, Any]] = ...,
        lugs: Sequence[Mapping[str, Any]] = ...,
        hook_loads: Sequence[Mapping[str, Any]] = ...,
        rope_groups: Sequence[Mapping[str, Any]] = ...,
        fmus: Sequence[Mapping[str, Any]] = ...,
        inputs: Sequence[Mapping[str, Any]] = ...,
    ) -> None: ...
    count: int | str
    first: int | str
    shift: Numbers
    bodies: Mapping[str, Mapping[str, Any]]
    joints: Sequence[Mapping[str, Any]]
    ropes: Sequence[Mapping[str, Any]]
    gantry_cranes: Sequence[Mapping[str, Any]]
    floating_cranes: Sequence[Mapping[str, Any]]
    falls: Sequence[Mapping[str, Any]]
    equalizers: Sequence[Mapping[str, Any]]
    spreaders: Sequence[Mapping[str, Any]]
    link_beams: Sequence[Mapping[str, Any]]
    forces: Sequence[Mapping[str, Any]]
    contours: Mapping[str, Mapping[str, Any]]
    contacts: Sequence[Mapping[str, Any]]
    surfaces: Sequence[Mapping[str, Any]]
    collisions: Sequence[Mapping[str, Any]]
    hulls: Mapping[str, Mapping[str, Any]]
    databases: Mapping[str, Mapping[str, Any]]
    tanks: Sequence[Mapping[str, Any]]
    pumps: Sequence[Mapping[str, Any]]
    controllers: Sequence[Mapping[str, Any]]
    fluid_loads: Sequence[Mapping[str, Any]]
    lines: Sequence[Mapping[str, Any]]
    fenders: Sequence[Mapping[str, Any]]
    decks: Sequence[Mapping[str, Any]]
    transporters: Sequence[Mapping[str, Any]]
    sensors: Sequence[Mapping[str, Any]]
    relative_motions: Sequence[Mapping[str, Any]]
    leads: Sequence[Mapping[str, Any]]
    lugs: Sequence[Mapping[str, Any]]
    hook_loads: Sequence[Mapping[str, Any]]
    rope_groups: Sequence[Mapping[str, Any]]
    fmus: Sequence[Mapping[str, Any]]
    inputs: Sequence[Mapping[str, Any]]

class FlexibleBody(Component):
    """A body with a finite-element model that deforms.

    Parameters
    ----------
    name : text
        Name.
    geometry : table: BlocksGeometry, StepGeometry, MeshFileGeometry, FourFilesGeometry, MatricesGeometry, PanelsGeometry
        Shape, or matrices of another program.
    modes : table: Modes
        Reduction to mode shapes.
    frame : table: Free, Fixed, Driven
        How the body frame moves.
    material : table: Material, optional
        Material; needed unless the geometry brings matrices, or is a mesh file that says it, which must
        agree.
    mesh : table: Mesh, optional
        Elements; for geometries that are meshed here.
    plates : table: PlateGroup, optional
        Of a mesh file, plates by name of their element set: what the file lacks, or what is otherwise
        here.
    stiffeners : table: StiffenerGroup, optional
        Of a mesh file, beams by name of their element set: what the file lacks, or what is otherwise
        here.
    supports : list of tables: BodySupport, optional
        What is held in single directions, and planes of symmetry; besides modes.clamp.
    static : list of tables: StaticCase, optional
        Static load cases, solved with the modes.
    interfaces : tables by name: Interface, optional
        Places where others are attached, by name; each adds six attachment modes to the basis.
    stress : table: Stress, optional
        Stress over the run; none if absent.
    initial : table: Initial, optional
        Initial state.

    Notes
    -----
    Channels: NAME.position [m], NAME.orientation [1], NAME.velocity [m/s], NAME.angular_velocity
    [rad/s], NAME.modal_position [m kg^0.5], NAME.modal_velocity [m kg^0.5/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        geometry: BlocksGeometryTable | Mapping[str, Any] | StepGeometryTable | MeshFileGeometryTable | FourFilesGeometryTable | MatricesGeometryTable | PanelsGeometryTable,
        modes: ModesTable | Mapping[str, Any],
        frame: FreeTable | Mapping[str, Any] | FixedTable | DrivenTable,
        material: MaterialTable | Mapping[str, Any] | None = ...,
        mesh: MeshTable | Mapping[str, Any] = ...,
        plates: Mapping[str, PlateGroupTable | Mapping[str, Any]] = ...,
        stiffeners: Mapping[str, StiffenerGroupTable | Mapping[str, Any]] = ...,
        supports: Sequence[BodySupportTable | Mapping[str, Any]] = ...,
        static: Sequence[StaticCaseTable | Mapping[str, Any]] = ...,
        interfaces: Mapping[str, InterfaceTable | Mapping[str, Any]] = ...,
        stress: StressTable | Mapping[str, Any] | None = ...,
        initial: InitialTable | Mapping[str, Any] = ...,
    ) -> None: ...
    geometry: BlocksGeometryTable | Mapping[str, Any] | StepGeometryTable | MeshFileGeometryTable | FourFilesGeometryTable | MatricesGeometryTable | PanelsGeometryTable
    modes: ModesTable | Mapping[str, Any]
    frame: FreeTable | Mapping[str, Any] | FixedTable | DrivenTable
    material: MaterialTable | Mapping[str, Any] | None
    mesh: MeshTable | Mapping[str, Any]
    plates: Mapping[str, PlateGroupTable | Mapping[str, Any]]
    stiffeners: Mapping[str, StiffenerGroupTable | Mapping[str, Any]]
    supports: Sequence[BodySupportTable | Mapping[str, Any]]
    static: Sequence[StaticCaseTable | Mapping[str, Any]]
    interfaces: Mapping[str, InterfaceTable | Mapping[str, Any]]
    stress: StressTable | Mapping[str, Any] | None
    initial: InitialTable | Mapping[str, Any]

class RigidBody(Component):
    """A body that does not deform.

    Parameters
    ----------
    name : text
        Name.
    mass : mass [kg] > 0
        Mass [kg].
    inertia : list of quantity or list of list of quantity
        About the centre of mass, body axes [kg m^2]: three principal values or a symmetric 3 x 3
        matrix.
    frame : table: Free, Fixed, Driven
        How the body frame moves.
    centre_of_mass : 3 x length [m], default [0.0, 0.0, 0.0]
        In the coordinates of the geometry [m].
    initial : table: RigidInitial, optional
        Initial state.

    Notes
    -----
    Channels: NAME.position [m], NAME.orientation [1], NAME.velocity [m/s], NAME.angular_velocity
    [rad/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        mass: Quantity,
        inertia: Numbers | Sequence[Numbers] | NDArray[Any],
        frame: FreeTable | Mapping[str, Any] | FixedTable | DrivenTable,
        centre_of_mass: Numbers = ...,
        initial: RigidInitialTable | Mapping[str, Any] = ...,
    ) -> None: ...
    mass: Quantity
    inertia: Numbers | Sequence[Numbers] | NDArray[Any]
    frame: FreeTable | Mapping[str, Any] | FixedTable | DrivenTable
    centre_of_mass: Numbers
    initial: RigidInitialTable | Mapping[str, Any]

class FrameBody(Component):
    """A beam, cable or rod of cubic elements with large displacements and rotations; it has no torsion.

    Parameters
    ----------
    name : text
        Name.
    geometry : table: LineShape, ArcShape, SplineShape
        Its line and its elements.
    section : table: FrameSectionTable
        Section of all elements that are in no region.
    damping : table: MeshDamping, optional
        Damping; none if absent.
    elasticity : "auto", "carried", "energy-momentum", "explicit", default "auto"
        How stress enters the step: carried carries strains, one linear solve a step; energy-momentum
        iterates; auto is the first until carried strains drift too far; explicit has a largest stable
        step.
    drift_tolerance : number > 0, default 0.001
        Distance of carried strains from those of the shape at which auto changes over; it does so at 5
        % of the largest strain, too.
    initial : table: RigidInitial, optional
        Initial state: place of the body, and its motion as a rigid body.
    sections : tables by name: FrameSectionTable, optional
        Further sections by name, for regions.
    regions : list of tables: FrameRegion, optional
        Elements with other sections or pre-stress.
    model : "green-lagrange", "exact", default "green-lagrange"
        green-lagrange: axial strain of Green-Lagrange, for straight elements; exact: stretch and
        material curvature, also for curved elements and large strains.
    axial_force : force [N], optional
        Tension in the given shape [N]: it is pre-stressed.
    axial_strain : number, optional
        In place of axial_force, the strain in the given shape.
    supports : list of tables: FrameSupport, optional
        What holds it to the ground.
    loads : list of tables: LineLoad, LineFollower, FollowerForce, optional
        Loads on its elements, besides gravity and forces on points.

    Notes
    -----
    Channels: NAME.position [m], NAME.tangent [1], NAME.velocity [m/s], NAME.axial_force [N],
    NAME.bending_moment [N m], NAME.axial_stress [Pa], NAME.strain_drift [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        geometry: LineShapeTable | Mapping[str, Any] | ArcShapeTable | SplineShapeTable,
        section: FrameSectionTableTable | Mapping[str, Any],
        damping: MeshDampingTable | Mapping[str, Any] = ...,
        elasticity: Literal["auto", "carried", "energy-momentum", "explicit"] = ...,
        drift_tolerance: Quantity = ...,
        initial: RigidInitialTable | Mapping[str, Any] = ...,
        sections: Mapping[str, FrameSectionTableTable | Mapping[str, Any]] = ...,
        regions: Sequence[FrameRegionTable | Mapping[str, Any]] = ...,
        model: Literal["green-lagrange", "exact"] = ...,
        axial_force: Quantity | None = ...,
        axial_strain: Quantity | None = ...,
        supports: Sequence[FrameSupportTable | Mapping[str, Any]] = ...,
        loads: Sequence[LineLoadTable | Mapping[str, Any] | LineFollowerTable | FollowerForceTable] = ...,
    ) -> None: ...
    geometry: LineShapeTable | Mapping[str, Any] | ArcShapeTable | SplineShapeTable
    section: FrameSectionTableTable | Mapping[str, Any]
    damping: MeshDampingTable | Mapping[str, Any]
    elasticity: Literal["auto", "carried", "energy-momentum", "explicit"]
    drift_tolerance: Quantity
    initial: RigidInitialTable | Mapping[str, Any]
    sections: Mapping[str, FrameSectionTableTable | Mapping[str, Any]]
    regions: Sequence[FrameRegionTable | Mapping[str, Any]]
    model: Literal["green-lagrange", "exact"]
    axial_force: Quantity | None
    axial_strain: Quantity | None
    supports: Sequence[FrameSupportTable | Mapping[str, Any]]
    loads: Sequence[LineLoadTable | Mapping[str, Any] | LineFollowerTable | FollowerForceTable]

class RodBody(Component):
    """A frame that twists: sections resist torsion and have rotary inertia, and joints on it pass all moments.

    Parameters
    ----------
    name : text
        Name.
    geometry : table: LineShape, ArcShape, SplineShape
        Its line and its elements.
    section : table: FrameSectionTable
        Section of all elements that are in no region.
    shear_modulus : pressure [Pa] > 0
        G [Pa].
    damping : table: MeshDamping, optional
        Damping; none if absent.
    elasticity : "auto", "carried", "energy-momentum", "explicit", default "auto"
        How stress enters the step: carried carries strains, one linear solve a step; energy-momentum
        iterates; auto is the first until carried strains drift too far; explicit has a largest stable
        step.
    drift_tolerance : number > 0, default 0.001
        Distance of carried strains from those of the shape at which auto changes over; it does so at 5
        % of the largest strain, too.
    initial : table: RigidInitial, optional
        Initial state: place of the body, and its motion as a rigid body.
    sections : tables by name: FrameSectionTable, optional
        Further sections by name, for regions.
    regions : list of tables: FrameRegion, optional
        Elements with other sections or pre-stress.
    model : "green-lagrange", default "green-lagrange"
        Axial strain of Green-Lagrange.
    axial_force : force [N], optional
        Tension in the given shape [N]: it is pre-stressed.
    axial_strain : number, optional
        In place of axial_force, the strain in the given shape.
    supports : list of tables: RodSupport, optional
        What holds it to the ground.
    loads : list of tables: LineLoad, LineFollower, FollowerForce, optional
        Loads on its elements, besides gravity and forces on points.
    normal : 3 x number, optional
        Direction of the first director at its first node, in axes of the geometry, of which the part
        across the tangent counts; by default the axis of the geometry that is farthest from the
        tangent.
    twist : angle [rad], default 0.0
        By which the sections are turned from the first node to the last when unloaded, evenly along the
        length.

    Notes
    -----
    Channels: NAME.position [m], NAME.tangent [1], NAME.normal [1], NAME.velocity [m/s],
    NAME.axial_force [N], NAME.twisting_moment [N m], NAME.bending_moment [N m], NAME.axial_stress [Pa],
    NAME.strain_drift [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        geometry: LineShapeTable | Mapping[str, Any] | ArcShapeTable | SplineShapeTable,
        section: FrameSectionTableTable | Mapping[str, Any],
        shear_modulus: Quantity,
        damping: MeshDampingTable | Mapping[str, Any] = ...,
        elasticity: Literal["auto", "carried", "energy-momentum", "explicit"] = ...,
        drift_tolerance: Quantity = ...,
        initial: RigidInitialTable | Mapping[str, Any] = ...,
        sections: Mapping[str, FrameSectionTableTable | Mapping[str, Any]] = ...,
        regions: Sequence[FrameRegionTable | Mapping[str, Any]] = ...,
        model: Literal["green-lagrange"] = ...,
        axial_force: Quantity | None = ...,
        axial_strain: Quantity | None = ...,
        supports: Sequence[RodSupportTable | Mapping[str, Any]] = ...,
        loads: Sequence[LineLoadTable | Mapping[str, Any] | LineFollowerTable | FollowerForceTable] = ...,
        normal: Numbers | None = ...,
        twist: Quantity = ...,
    ) -> None: ...
    geometry: LineShapeTable | Mapping[str, Any] | ArcShapeTable | SplineShapeTable
    section: FrameSectionTableTable | Mapping[str, Any]
    shear_modulus: Quantity
    damping: MeshDampingTable | Mapping[str, Any]
    elasticity: Literal["auto", "carried", "energy-momentum", "explicit"]
    drift_tolerance: Quantity
    initial: RigidInitialTable | Mapping[str, Any]
    sections: Mapping[str, FrameSectionTableTable | Mapping[str, Any]]
    regions: Sequence[FrameRegionTable | Mapping[str, Any]]
    model: Literal["green-lagrange"]
    axial_force: Quantity | None
    axial_strain: Quantity | None
    supports: Sequence[RodSupportTable | Mapping[str, Any]]
    loads: Sequence[LineLoadTable | Mapping[str, Any] | LineFollowerTable | FollowerForceTable]
    normal: Numbers | None
    twist: Quantity

class ShellBody(Component):
    """A plate, shell or membrane of bicubic elements with large displacements and rotations, flat when unloaded.

    Parameters
    ----------
    name : text
        Name.
    geometry : table: RectangleShape, QuadrilateralShape, GridShape
        Its outline and its elements.
    section : table: ShellSectionTable
        Section of all elements that are in no region.
    damping : table: MeshDamping, optional
        Damping; none if absent.
    elasticity : "auto", "carried", "energy-momentum", "explicit", default "auto"
        How stress enters the step: carried carries strains, one linear solve a step; energy-momentum
        iterates; auto is the first until carried strains drift too far; explicit has a largest stable
        step.
    drift_tolerance : number > 0, default 0.001
        Distance of carried strains from those of the shape at which auto changes over; it does so at 5
        % of the largest strain, too.
    initial : table: RigidInitial, optional
        Initial state: place of the body, and its motion as a rigid body.
    sections : tables by name: ShellSectionTable, optional
        Further sections by name, for regions.
    regions : list of tables: Region, optional
        Elements with other sections.
    gauss_points : integer >= 3, <= 7, default 5
        Points along each direction of an element where membrane strains are taken, 3 to 7.
    supports : list of tables: ShellSupport, optional
        What holds it to the ground.
    loads : list of tables: AreaLoad, PressureLoad, optional
        Loads on its elements, besides gravity and forces on points.

    Notes
    -----
    Channels: NAME.position [m], NAME.slope_x [1], NAME.slope_y [1], NAME.twist [1/m], NAME.velocity
    [m/s], NAME.membrane_force [N/m], NAME.bending_moment [N m/m], NAME.von_mises [Pa],
    NAME.strain_drift [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        geometry: RectangleShapeTable | Mapping[str, Any] | QuadrilateralShapeTable | GridShapeTable,
        section: ShellSectionTableTable | Mapping[str, Any],
        damping: MeshDampingTable | Mapping[str, Any] = ...,
        elasticity: Literal["auto", "carried", "energy-momentum", "explicit"] = ...,
        drift_tolerance: Quantity = ...,
        initial: RigidInitialTable | Mapping[str, Any] = ...,
        sections: Mapping[str, ShellSectionTableTable | Mapping[str, Any]] = ...,
        regions: Sequence[RegionTable | Mapping[str, Any]] = ...,
        gauss_points: int = ...,
        supports: Sequence[ShellSupportTable | Mapping[str, Any]] = ...,
        loads: Sequence[AreaLoadTable | Mapping[str, Any] | PressureLoadTable] = ...,
    ) -> None: ...
    geometry: RectangleShapeTable | Mapping[str, Any] | QuadrilateralShapeTable | GridShapeTable
    section: ShellSectionTableTable | Mapping[str, Any]
    damping: MeshDampingTable | Mapping[str, Any]
    elasticity: Literal["auto", "carried", "energy-momentum", "explicit"]
    drift_tolerance: Quantity
    initial: RigidInitialTable | Mapping[str, Any]
    sections: Mapping[str, ShellSectionTableTable | Mapping[str, Any]]
    regions: Sequence[RegionTable | Mapping[str, Any]]
    gauss_points: int
    supports: Sequence[ShellSupportTable | Mapping[str, Any]]
    loads: Sequence[AreaLoadTable | Mapping[str, Any] | PressureLoadTable]

class LumpedCable(Component):
    """A cable or chain as masses on a line, with springs between them that pull alone, or push too.

    Parameters
    ----------
    name : text
        Name.
    segments : integer
        Number of springs, all of one length: there is one node more.
    mass : mass [kg] > 0
        Of all of it; each segment gives half of its own to each of its nodes.
    axial_stiffness : force [N] > 0
        Force at a strain of 1, EA.
    initial : table: RigidInitial, optional
        Initial state: place of the body, and its motion as a rigid body.
    points : list of 3 x length [m], optional
        Corners of the line along which it lies at the start, in the frame of the body [m].
    length : length [m] > 0, optional
        Unstretched, of all of it; that of the line if absent.
    damping_time : time [s] >= 0, default 0.0
        Damping force of a segment over its stiffness times its rate of elongation, while it carries.
    carries : "tension", "both", default "tension"
        tension: segments go slack; both: they carry compression as well, as a bar.

    Notes
    -----
    Channels: NAME.position [m], NAME.velocity [m/s], NAME.segment_tension [N], NAME.start_position [m],
    NAME.end_position [m], NAME.stretched_length [m], NAME.largest_tension [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        segments: int,
        mass: Quantity,
        axial_stiffness: Quantity,
        initial: RigidInitialTable | Mapping[str, Any] = ...,
        points: Sequence[Numbers] | NDArray[Any] = ...,
        length: Quantity | None = ...,
        damping_time: Quantity = ...,
        carries: Literal["tension", "both"] = ...,
    ) -> None: ...
    segments: int
    mass: Quantity
    axial_stiffness: Quantity
    initial: RigidInitialTable | Mapping[str, Any]
    points: Sequence[Numbers] | NDArray[Any]
    length: Quantity | None
    damping_time: Quantity
    carries: Literal["tension", "both"]

class Gravity(Component):
    """Uniform gravity.

    Parameters
    ----------
    acceleration : 3 x acceleration [m/s^2]
        World axes [m/s^2].
    """

    def __init__(
        self,
        *,
        acceleration: Numbers,
    ) -> None: ...
    acceleration: Numbers

class Ball(Component):
    """The two points coincide.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None

class Cylindrical(Component):
    """The point of b slides along the axis, and b turns about it.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.
    angle_limits : table: AngleLimits, optional
        Stops of the angle.
    travel_limits : table: TravelLimits, optional
        Stops of the travel.
    angle_friction : moment or energy [N m] >= 0, default 0.0
        Dry friction against the turn [N m].
    travel_friction : force [N] >= 0, default 0.0
        Dry friction against the travel [N].

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m], NAME.angle [rad], NAME.angular_rate
    [rad/s], NAME.travel [m], NAME.travel_rate [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
        angle_limits: AngleLimitsTable | Mapping[str, Any] | None = ...,
        travel_limits: TravelLimitsTable | Mapping[str, Any] | None = ...,
        angle_friction: Quantity = ...,
        travel_friction: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None
    angle_limits: AngleLimitsTable | Mapping[str, Any] | None
    travel_limits: TravelLimitsTable | Mapping[str, Any] | None
    angle_friction: Quantity
    travel_friction: Quantity

class Distance(Component):
    """The distance of the two points is kept.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    points : 2 x 3 x length [m] or text
        One point a side [m] in the coordinates of the geometry of the body, or the name of an interface
        of it; of the ground in the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    length : length [m] > 0, optional
        Distance [m]; as at the start if absent.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        length: Quantity | None = ...,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    compliance: Quantity
    relaxation: Quantity
    length: Quantity | None

class EdgeClamp(Component):
    """An edge of a shell is built in at the ground, a body or the edge of another shell, and keeps its angle. Stretch and shear angle of the surface stay free at the edge.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    edge : "x_min", "x_max", "y_min", "y_max", optional
        Edge of the shell, the first of its sides.
    edges : 2 x "x_min", "x_max", "y_min", "y_max", optional
        In place of edge, between two shells: an edge of each. They have the same nodes at the start.
    nodes : list of integer >= 0 or 2 x list of integer >= 0, optional
        In place of names: numbers of nodes along a line of the mesh, in order; between two shells two
        such lists.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        edge: Literal["x_min", "x_max", "y_min", "y_max"] | None = ...,
        edges: Sequence[Literal["x_min", "x_max", "y_min", "y_max"]] | None = ...,
        nodes: Sequence[int] | NDArray[Any] | Sequence[Sequence[int] | NDArray[Any]] = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    edge: Literal["x_min", "x_max", "y_min", "y_max"] | None
    edges: Sequence[Literal["x_min", "x_max", "y_min", "y_max"]] | None
    nodes: Sequence[int] | NDArray[Any] | Sequence[Sequence[int] | NDArray[Any]]

class EdgeHinge(Component):
    """A straight edge of a shell turns about itself on the ground, a body or the edge of another shell.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    edge : "x_min", "x_max", "y_min", "y_max", optional
        Edge of the shell, the first of its sides.
    edges : 2 x "x_min", "x_max", "y_min", "y_max", optional
        In place of edge, between two shells: an edge of each. They have the same nodes at the start.
    nodes : list of integer >= 0 or 2 x list of integer >= 0, optional
        In place of names: numbers of nodes along a line of the mesh, in order; between two shells two
        such lists.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        edge: Literal["x_min", "x_max", "y_min", "y_max"] | None = ...,
        edges: Sequence[Literal["x_min", "x_max", "y_min", "y_max"]] | None = ...,
        nodes: Sequence[int] | NDArray[Any] | Sequence[Sequence[int] | NDArray[Any]] = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    edge: Literal["x_min", "x_max", "y_min", "y_max"] | None
    edges: Sequence[Literal["x_min", "x_max", "y_min", "y_max"]] | None
    nodes: Sequence[int] | NDArray[Any] | Sequence[Sequence[int] | NDArray[Any]]

class FixedJoint(Component):
    """The two sides move as one. A frame of ANCF elements keeps its tangent only, 5 rows: it has no torsion.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None

class Guide(Component):
    """The point of b goes along x of a as it is driven, and b does not turn about z; it may heave, roll and pitch.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.
    speed : velocity [m/s], default 0.0
        Of b along x of a, constant [m/s].
    drive : table: TravelProfile, optional
        Additional travel as a function of time [m].

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m], NAME.travel [m], NAME.travel_rate
    [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
        speed: Quantity = ...,
        drive: TravelProfileTable | Mapping[str, Any] | None = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None
    speed: Quantity
    drive: TravelProfileTable | Mapping[str, Any] | None

class Hinge(Component):
    """The points and the axes coincide; b turns about the axis, by the angle. The angle turns x of a into x of b about z.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.
    drive : table: AngleProfile, optional
        The angle as a function of time [rad]: one row more.
    limits : table: AngleLimits, optional
        Stops of the angle.
    friction : moment or energy [N m] >= 0, default 0.0
        Dry friction [N m].

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m], NAME.angle [rad], NAME.angular_rate
    [rad/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
        drive: TravelProfileTable | Mapping[str, Any] | None = ...,
        limits: AngleLimitsTable | Mapping[str, Any] | None = ...,
        friction: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None
    drive: TravelProfileTable | Mapping[str, Any] | None
    limits: AngleLimitsTable | Mapping[str, Any] | None
    friction: Quantity

class Planar(Component):
    """The point of b stays in the plane across the axis of a, and the axes are parallel.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None

class Screw(Component):
    """The point of b travels along the axis as b turns about it, by the lead a turn.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    lead : length [m]
        Travel a turn [m], not zero; positive for a right-handed thread.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m], NAME.angle [rad], NAME.angular_rate
    [rad/s], NAME.travel [m], NAME.travel_rate [m/s], NAME.thread_force [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        lead: Quantity,
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
    ) -> None: ...
    between: Sequence[str]
    lead: Quantity
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None

class Slider(Component):
    """The point of b slides along the axis without turning, by the travel.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.
    drive : table: TravelProfile, optional
        The travel as a function of time [m]: one row more.
    limits : table: TravelLimits, optional
        Stops of the travel.
    friction : force [N] >= 0, default 0.0
        Dry friction [N].

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m], NAME.travel [m], NAME.travel_rate
    [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
        drive: TravelProfileTable | Mapping[str, Any] | None = ...,
        limits: TravelLimitsTable | Mapping[str, Any] | None = ...,
        friction: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None
    drive: TravelProfileTable | Mapping[str, Any] | None
    limits: TravelLimitsTable | Mapping[str, Any] | None
    friction: Quantity

class SliderHinge(Component):
    """The point of b slides along one axis of a, and b turns about another.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    slide_axis : 3 x number
        World direction of the travel at the start, any length; axis is that of the turn.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.
    angle_limits : table: AngleLimits, optional
        Stops of the angle.
    travel_limits : table: TravelLimits, optional
        Stops of the travel.
    angle_friction : moment or energy [N m] >= 0, default 0.0
        Dry friction against the turn [N m].
    travel_friction : force [N] >= 0, default 0.0
        Dry friction against the travel [N].

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m], NAME.angle [rad], NAME.angular_rate
    [rad/s], NAME.travel [m], NAME.travel_rate [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        slide_axis: Numbers,
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
        angle_limits: AngleLimitsTable | Mapping[str, Any] | None = ...,
        travel_limits: TravelLimitsTable | Mapping[str, Any] | None = ...,
        angle_friction: Quantity = ...,
        travel_friction: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    slide_axis: Numbers
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None
    angle_limits: AngleLimitsTable | Mapping[str, Any] | None
    travel_limits: TravelLimitsTable | Mapping[str, Any] | None
    angle_friction: Quantity
    travel_friction: Quantity

class Universal(Component):
    """The points coincide, and the axis of a stays perpendicular to the axis of b.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    compliance : compliance [m/N] >= 0, default 0.0
        Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid.
    relaxation : time [s] >= 0, default 0.0
        Time [s] in which a violation decays; a compliant joint is damped by it.
    at : 3 x length [m], optional
        Where it is at the start [m], in the world, for both sides.
    points : 2 x 3 x length [m] or text, optional
        In place of at, one point a side [m] in the coordinates of the geometry of the body, or the name
        of an interface of it; of the ground in the world.
    axis : 3 x number, optional
        World direction of its axis at the start, any length, for both sides: z of the joint frames.
    axes : 2 x 3 x number, optional
        In place of axis, one direction a side in the coordinates of the geometry of the body; of the
        ground in the world.
    reference : 3 x number, optional
        World direction of x of the joint frames at the start, where an angle is zero; chosen if absent.
    second_axis : 3 x number, optional
        With axis, the axis of a: world direction of the axis of b at the start, any length.

    Notes
    -----
    Channels: NAME.reaction_force [N], NAME.reaction_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        compliance: Quantity = ...,
        relaxation: Quantity = ...,
        at: Numbers | None = ...,
        points: Sequence[Numbers | str] | None = ...,
        axis: Numbers | None = ...,
        axes: Sequence[Numbers] | NDArray[Any] | None = ...,
        reference: Numbers | None = ...,
        second_axis: Numbers | None = ...,
    ) -> None: ...
    between: Sequence[str]
    compliance: Quantity
    relaxation: Quantity
    at: Numbers | None
    points: Sequence[Numbers | str] | None
    axis: Numbers | None
    axes: Sequence[Numbers] | NDArray[Any] | None
    reference: Numbers | None
    second_axis: Numbers | None

class SharedLines(Component):
    """Lines of one force: an equalizer without the masses of its pulleys, as [[equalizers]] writes it.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    path : list of tables: RopePoint
        An outlet and a lug for each line in turn; all outlets are on one body.
    lengths : list of length [m] > 0
        Unstretched lengths of the lines [m].
    depth : length [m] > 0
        Mean of the depths of all pulleys below their outlets, without elongation [m].
    up : length [m] > 0
        Travel of a pulley from that depth towards its outlet [m].
    down : length [m] > 0
        Travel of a pulley from that depth away from its outlet [m].
    axial_stiffness : force [N] > 0
        EA of the rope over all pulleys [N].
    rope_length : length [m] > 0
        Unstretched length of that rope [m].
    line_stiffness : force [N] > 0
        EA of the lines [N].
    direction : 3 x number, default [0.0, 0.0, -1.0]
        Of all guides, in the coordinates of the geometry of that body; any length.
    damping : damping [N s/m] >= 0, default 0.0
        Of each line: tension per rate of elongation [N s/m], while it is taut.
    efficiency : number >= 0.5, <= 1, default 1.0
        Of all sheaves, moving and fixed, as that of a place in the path of a rope.

    Notes
    -----
    Channels: NAME.tension [N], NAME.tension_max [N], NAME.tension_min [N], NAME.segment_tension [N],
    NAME.segment_tension_max [N], NAME.segment_tension_min [N], NAME.stop [1], NAME.stopped_time [s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        path: Sequence[RopePointTable | Mapping[str, Any]],
        lengths: Numbers,
        depth: Quantity,
        up: Quantity,
        down: Quantity,
        axial_stiffness: Quantity,
        rope_length: Quantity,
        line_stiffness: Quantity,
        direction: Numbers = ...,
        damping: Quantity = ...,
        efficiency: Quantity = ...,
    ) -> None: ...
    path: Sequence[RopePointTable | Mapping[str, Any]]
    lengths: Numbers
    depth: Quantity
    up: Quantity
    down: Quantity
    axial_stiffness: Quantity
    rope_length: Quantity
    line_stiffness: Quantity
    direction: Numbers
    damping: Quantity
    efficiency: Quantity

class MaxwellRope(Component):
    """A rope that creeps: a spring and a damper one behind the other, from end to end; it pulls and never pushes.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    path : list of tables: RopePoint
        Two and more places, from end to end; it runs over those between without friction.
    stiffness : stiffness [N/m] > 0
        Of the spring [N/m].
    viscosity : damping [N s/m] > 0
        Of the damper [N s/m]: a tension of a stretch that is held fades in the time viscosity over
        stiffness.
    length : length [m] > 0, optional
        Unstretched length at the start [m]; as drawn if absent.

    Notes
    -----
    Channels: NAME.tension [N], NAME.length [m], NAME.rest_length [m], NAME.drift [m], NAME.strain [1],
    NAME.tension_max [N], NAME.tension_min [N], NAME.segment_tension [N], NAME.creep [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        path: Sequence[RopePointTable | Mapping[str, Any]],
        stiffness: Quantity,
        viscosity: Quantity,
        length: Quantity | None = ...,
    ) -> None: ...
    path: Sequence[RopePointTable | Mapping[str, Any]]
    stiffness: Quantity
    viscosity: Quantity
    length: Quantity | None

class SpringRope(Component):
    """A rope between two points that pulls like a spring and never pushes.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    path : list of tables: RopePoint
        Its two ends.
    stiffness : stiffness [N/m] > 0
        [N/m].
    length : length [m] >= 0, optional
        Unloaded length [m]; the initial geometric length if absent.
    damping : damping [N s/m] >= 0, default 0.0
        [N s/m], while it is taut.

    Notes
    -----
    Channels: NAME.tension [N], NAME.length [m], NAME.rest_length [m], NAME.drift [m], NAME.strain [1],
    NAME.tension_max [N], NAME.tension_min [N], NAME.segment_tension [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        path: Sequence[RopePointTable | Mapping[str, Any]],
        stiffness: Quantity,
        length: Quantity | None = ...,
        damping: Quantity = ...,
    ) -> None: ...
    path: Sequence[RopePointTable | Mapping[str, Any]]
    stiffness: Quantity
    length: Quantity | None
    damping: Quantity

class Rope(Component):
    """A wire rope through any number of points, with one tension all along but for sheaves with an efficiency.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    path : list of tables: RopePoint
        Two and more places, from end to end.
    axial_stiffness : force [N] > 0
        EA [N]: modulus times area.
    length : length [m] > 0, optional
        Unstretched length at the start [m]; the initial geometric length if absent.
    tension : force [N] > 0, optional
        In place of length: tension at the start [N], without that of the damper, from which that
        follows; of a search for equilibrium that in the place of rest.
    damping : damping [N s/m] >= 0, default 0.0
        Tension per rate of elongation [N s/m], while it is taut.
    winch : table: Winch, optional
        How its length changes.
    other_winch : table: Winch, optional
        A second winch, at the end that winch leaves; both have speeds.

    Notes
    -----
    Channels: NAME.tension [N], NAME.length [m], NAME.rest_length [m], NAME.drift [m], NAME.strain [1],
    NAME.tension_max [N], NAME.tension_min [N], NAME.segment_tension [N], NAME.sheave_speed [m/s],
    NAME.sheave_state [1], NAME.segment_tension_max [N], NAME.segment_tension_min [N], NAME.paid_out
    [m], NAME.paying_speed [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        path: Sequence[RopePointTable | Mapping[str, Any]],
        axial_stiffness: Quantity,
        length: Quantity | None = ...,
        tension: Quantity | None = ...,
        damping: Quantity = ...,
        winch: WinchTable | Mapping[str, Any] | None = ...,
        other_winch: WinchTable | Mapping[str, Any] | None = ...,
    ) -> None: ...
    path: Sequence[RopePointTable | Mapping[str, Any]]
    axial_stiffness: Quantity
    length: Quantity | None
    tension: Quantity | None
    damping: Quantity
    winch: WinchTable | Mapping[str, Any] | None
    other_winch: WinchTable | Mapping[str, Any] | None

class GantryCrane(Component):
    """A girder on legs that travels on rails, with trolleys and hoists.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    span : length [m] > 0
        Between the rails [m]: trolleys stay within it.
    girder_height : length [m] > 0
        Of the crowns of all hoists above the rails [m].
    trolleys : list of tables: Trolley
        On the girder.
    sheave_radius : length [m] > 0
        Of all sheaves [m].
    block : table: HookBlock
        Each hook block.
    rope : table: FallsRope
        Ropes of all falls.
    position : 3 x length [m], default [0.0, 0.0, 0.0]
        Middle between the rails at the start, in the world [m]; the girder lies along x.
    mass : mass [kg] > 0, default 3000000.0
        Of girder and legs [kg]; it counts in the force that drives it.
    moves : list of tables: Move, optional
        How it travels along its rails, y.
    efficiency : number >= 0.5, <= 1, default 1.0
        Of each sheave, as that of ropes.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        span: Quantity,
        girder_height: Quantity,
        trolleys: Sequence[TrolleyTable | Mapping[str, Any]],
        sheave_radius: Quantity,
        block: HookBlockTable | Mapping[str, Any],
        rope: FallsRopeTable | Mapping[str, Any],
        position: Numbers = ...,
        mass: Quantity = ...,
        moves: Sequence[MoveTable | Mapping[str, Any]] = ...,
        efficiency: Quantity = ...,
    ) -> None: ...
    span: Quantity
    girder_height: Quantity
    trolleys: Sequence[TrolleyTable | Mapping[str, Any]]
    sheave_radius: Quantity
    block: HookBlockTable | Mapping[str, Any]
    rope: FallsRopeTable | Mapping[str, Any]
    position: Numbers
    mass: Quantity
    moves: Sequence[MoveTable | Mapping[str, Any]]
    efficiency: Quantity

class FloatingCrane(Component):
    """A boom on a hull that luffs, with hooks on falls.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    hull : text
        Body that carries it.
    hinge : 3 x length [m]
        Foot of the boom [m], in the coordinates of the geometry of the hull.
    boom : table: Boom
        The boom.
    sheave_radius : length [m] > 0
        Of all sheaves of the falls [m].
    block : table: HookBlock
        Each hook block.
    rope : table: FallsRope
        Ropes of all falls.
    hooks : list of tables: BoomHook
        Hooks.
    along : 3 x number, default [1.0, 0.0, 0.0]
        Direction of the boom over the deck at the start, in the coordinates of the geometry of the
        hull, without z component; any length.
    stay : table: BoomStay, optional
        What holds the boom; a drive of its hinge if absent.
    luffing : list of tables: Turn, optional
        How the boom luffs, upwards if positive.
    driven : true, false, default false
        Whether the hinge of a boom without stay has a drive without luffing: it is at rest until a
        scenario tells the drive NAME_hinge.
    level : true, false, default false
        Whether the winches of the falls pay out and haul in so that hooks keep their height as the boom
        luffs by luffing.
    slewing : table: Slewing, optional
        A table that slews; none if absent.
    efficiency : number >= 0.5, <= 1, default 1.0
        Of each sheave of the falls, as that of ropes.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hull: str,
        hinge: Numbers,
        boom: BoomTable | Mapping[str, Any],
        sheave_radius: Quantity,
        block: HookBlockTable | Mapping[str, Any],
        rope: FallsRopeTable | Mapping[str, Any],
        hooks: Sequence[BoomHookTable | Mapping[str, Any]],
        along: Numbers = ...,
        stay: BoomStayTable | Mapping[str, Any] | None = ...,
        luffing: Sequence[TurnTable | Mapping[str, Any]] = ...,
        driven: bool = ...,
        level: bool = ...,
        slewing: SlewingTable | Mapping[str, Any] | None = ...,
        efficiency: Quantity = ...,
    ) -> None: ...
    hull: str
    hinge: Numbers
    boom: BoomTable | Mapping[str, Any]
    sheave_radius: Quantity
    block: HookBlockTable | Mapping[str, Any]
    rope: FallsRopeTable | Mapping[str, Any]
    hooks: Sequence[BoomHookTable | Mapping[str, Any]]
    along: Numbers
    stay: BoomStayTable | Mapping[str, Any] | None
    luffing: Sequence[TurnTable | Mapping[str, Any]]
    driven: bool
    level: bool
    slewing: SlewingTable | Mapping[str, Any] | None
    efficiency: Quantity

class Falls(Component):
    """A hook block on a rope of n parts, which a winch hauls in.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    crown : table: FallsCrown
        Upper sheaves.
    parts : integer >= 2
        Parts of rope that carry the block: an even number.
    sheave_radius : length [m] > 0
        Of all sheaves [m].
    drop : length [m] > 0
        Height of the axis of the crown above that of the block at the start [m].
    block : table: HookBlock
        The hook block.
    rope : table: FallsRope
        The rope; its length is the initial geometric length, or follows from its tension.
    along : 3 x number, default [1.0, 0.0, 0.0]
        Horizontal direction in the planes of the sheaves at the start, in the world; any length. With a
        drum its parts run down on the side that is farther from it.
    sheave_spacing : length [m] > 0, optional
        Of sheaves beside each other [m]; a quarter of their radius if absent.
    efficiency : number >= 0.5, <= 1, default 1.0
        Of each sheave, as that of ropes: 0.98 on roller bearings, 0.96 on plain ones.
    drum : table: FallsCrown, optional
        First drum; the rope begins at the crown if absent.
    other_drum : table: FallsCrown, optional
        Second drum; the rope ends at the crown if absent. Both haul in together.
    moves : list of tables: Move, optional
        How the hook is hoisted, upwards if positive: distances and speeds of the hook, one move after
        the other.
    winch : table: Winch, optional
        In place of moves, how the rope is hauled in, n times as fast as the hook moves.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        crown: FallsCrownTable | Mapping[str, Any],
        parts: int,
        sheave_radius: Quantity,
        drop: Quantity,
        block: HookBlockTable | Mapping[str, Any],
        rope: FallsRopeTable | Mapping[str, Any],
        along: Numbers = ...,
        sheave_spacing: Quantity | None = ...,
        efficiency: Quantity = ...,
        drum: FallsCrownTable | Mapping[str, Any] | None = ...,
        other_drum: FallsCrownTable | Mapping[str, Any] | None = ...,
        moves: Sequence[MoveTable | Mapping[str, Any]] = ...,
        winch: WinchTable | Mapping[str, Any] | None = ...,
    ) -> None: ...
    crown: FallsCrownTable | Mapping[str, Any]
    parts: int
    sheave_radius: Quantity
    drop: Quantity
    block: HookBlockTable | Mapping[str, Any]
    rope: FallsRopeTable | Mapping[str, Any]
    along: Numbers
    sheave_spacing: Quantity | None
    efficiency: Quantity
    drum: FallsCrownTable | Mapping[str, Any] | None
    other_drum: FallsCrownTable | Mapping[str, Any] | None
    moves: Sequence[MoveTable | Mapping[str, Any]]
    winch: WinchTable | Mapping[str, Any] | None

class Equalizer(Component):
    """A block loader, whose lines have one force in all of them by moving pulleys on one rope.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    hook : table: EqualizerHook
        What it hangs on, by a hinge with a vertical axis.
    sheave_radius : length [m] > 0
        Of moving pulleys and fixed sheaves [m]; moving pulleys are four radii apart.
    part_length : length [m] > 0
        Unstretched length of a part of the rope with all pulleys at the same depth [m]: their depth
        below the fixed sheaves.
    beam : table: EqualizerBeam
        The beam, with its fixed sheaves.
    travel : table: EqualizerTravel
        How far they move.
    rope : table: EqualizerRope
        The rope over all pulleys.
    line : table: EqualizerRope
        What the lines are made of.
    lines : list of tables: EqualizerLine
        In their order along the beam, each from a moving pulley, or from count of them.
    model : "pulleys", "massless", default "pulleys"
        pulleys: bodies on guides with stops; massless: one row for all lines, or one each with an
        efficiency, no mass of pulleys, and stops that do not yield.
    along : 3 x number, default [1.0, 0.0, 0.0]
        Horizontal direction of the beam at the start, in the world; any length. Lines follow each other
        along it.
    sheave_depth : length [m] > 0, default 1.5
        Of the fixed sheaves, and of the ends of the rope, below the hinge [m].
    pulley : table: EqualizerPulley, optional
        Moving pulleys; none if massless.
    extension : table: EqualizerExtension, optional
        Extension pulleys, of lines with other_point.
    friction : force [N] >= 0, default 0.0
        Of each pulley on its guide [N].
    efficiency : number >= 0.5, <= 1, default 1.0
        Of each sheave, moving, fixed or of an extension, as that of ropes: 0.98 on roller bearings,
        0.96 on plain ones. The smallest force of n lines is then down to efficiency^(2 (n - 1)) of the
        largest.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hook: EqualizerHookTable | Mapping[str, Any],
        sheave_radius: Quantity,
        part_length: Quantity,
        beam: EqualizerBeamTable | Mapping[str, Any],
        travel: EqualizerTravelTable | Mapping[str, Any],
        rope: EqualizerRopeTable | Mapping[str, Any],
        line: EqualizerRopeTable | Mapping[str, Any],
        lines: Sequence[EqualizerLineTable | Mapping[str, Any]],
        model: Literal["pulleys", "massless"] = ...,
        along: Numbers = ...,
        sheave_depth: Quantity = ...,
        pulley: EqualizerPulleyTable | Mapping[str, Any] | None = ...,
        extension: EqualizerExtensionTable | Mapping[str, Any] | None = ...,
        friction: Quantity = ...,
        efficiency: Quantity = ...,
    ) -> None: ...
    hook: EqualizerHookTable | Mapping[str, Any]
    sheave_radius: Quantity
    part_length: Quantity
    beam: EqualizerBeamTable | Mapping[str, Any]
    travel: EqualizerTravelTable | Mapping[str, Any]
    rope: EqualizerRopeTable | Mapping[str, Any]
    line: EqualizerRopeTable | Mapping[str, Any]
    lines: Sequence[EqualizerLineTable | Mapping[str, Any]]
    model: Literal["pulleys", "massless"]
    along: Numbers
    sheave_depth: Quantity
    pulley: EqualizerPulleyTable | Mapping[str, Any] | None
    extension: EqualizerExtensionTable | Mapping[str, Any] | None
    friction: Quantity
    efficiency: Quantity

class Spreader(Component):
    """A beam on two slings, with lines to a load.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    hook : table: EqualizerHook
        What both slings hang on.
    beam : table: SpreaderBeam
        The beam.
    sling_length : length [m] > 0
        Unstretched length of each sling [m].
    sling : table: EqualizerRope
        What slings are made of.
    line : table: EqualizerRope
        What lines are made of.
    lines : list of tables: SpreaderLine
        Lines from the beam to the load.
    along : 3 x number, default [1.0, 0.0, 0.0]
        Horizontal direction of the beam at the start, in the world; any length.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hook: EqualizerHookTable | Mapping[str, Any],
        beam: SpreaderBeamTable | Mapping[str, Any],
        sling_length: Quantity,
        sling: EqualizerRopeTable | Mapping[str, Any],
        line: EqualizerRopeTable | Mapping[str, Any],
        lines: Sequence[SpreaderLineTable | Mapping[str, Any]],
        along: Numbers = ...,
    ) -> None: ...
    hook: EqualizerHookTable | Mapping[str, Any]
    beam: SpreaderBeamTable | Mapping[str, Any]
    sling_length: Quantity
    sling: EqualizerRopeTable | Mapping[str, Any]
    line: EqualizerRopeTable | Mapping[str, Any]
    lines: Sequence[SpreaderLineTable | Mapping[str, Any]]
    along: Numbers

class LinkBeam(Component):
    """A bridge for wheels, with a hinge on one deck and loose on another one.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    hinged_on : text
        Body that its hinge is on.
    hinge : 3 x length [m]
        Middle of its hinge, level with the deck, in the coordinates of the geometry of that body [m].
    rests_on : text
        Body that its other end lies on, or "ground".
    edge : 3 x length [m]
        Where the deck of that begins, before the middle of the link, in the coordinates of its geometry
        [m]; of the ground in the world. The deck is level there.
    length : length [m] > 0
        From the hinge to the end [m].
    breadth : length [m] > 0
        Over which wheels can drive [m]; its bearings are at both corners of the end.
    mass : mass [kg] > 0
        [kg], spread evenly.
    along : 3 x number, default [1.0, 0.0, 0.0]
        Horizontal direction from the hinge to the other end at the start, in the world; any length.
    lip : length [m] > 0, default 0.02
        Height of its upper side over the deck that it lies on, at its end [m]; more than the deflection
        of the bearings, or wheels are on that deck first.
    depth : length [m] > 0, default 0.5
        Of the plate, for its inertia [m].
    friction : number >= 0, default 0.2
        Coefficient between its end and the deck.
    stiffness : stiffness [N/m] > 0, default 100000000.0
        Of each of the two bearings [N/m].
    damping : damping [N s/m] >= 0, optional
        Of each of them [N s/m]; half of what is critical for the link alone if absent.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hinged_on: str,
        hinge: Numbers,
        rests_on: str,
        edge: Numbers,
        length: Quantity,
        breadth: Quantity,
        mass: Quantity,
        along: Numbers = ...,
        lip: Quantity = ...,
        depth: Quantity = ...,
        friction: Quantity = ...,
        stiffness: Quantity = ...,
        damping: Quantity | None = ...,
    ) -> None: ...
    hinged_on: str
    hinge: Numbers
    rests_on: str
    edge: Numbers
    length: Quantity
    breadth: Quantity
    mass: Quantity
    along: Numbers
    lip: Quantity
    depth: Quantity
    friction: Quantity
    stiffness: Quantity
    damping: Quantity | None

class Clutch(Component):
    """A clutch or brake about the axis of a joint: it sticks up to a torque, and slips at it.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    joint : text
        A hinge, or another joint with an angle, on which it acts.
    torque : moment or energy [N m] >= 0, optional
        Torque that it carries at most [N m]; 0 is open.
    times : list of time [s], optional
        In place of torque, a table: times [s], increasing.
    torques : list of moment or energy [N m] >= 0, optional
        Largest torques of the table [N m], linear in between, constant before and after.

    Notes
    -----
    Channels: NAME.torque [N m], NAME.slip_rate [rad/s], NAME.slipped [rad], NAME.slipping [1],
    NAME.heat [J].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        joint: str,
        torque: Quantity | None = ...,
        times: Numbers = ...,
        torques: Numbers = ...,
    ) -> None: ...
    joint: str
    torque: Quantity | None
    times: Numbers
    torques: Numbers

class JointSpring(Component):
    """A spring and damper on the angle of a hinge or the travel of a slider.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    joint : text
        A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts.
    coordinate : "angle", "travel", optional
        Of a joint that both turns and slides: what of it counts.
    rest : quantity, default 0.0
        Angle [rad] or travel [m] without load.
    stiffness : quantity, optional
        [N m/rad] or [N/m].
    damping : quantity, default 0.0
        [N m s/rad] or [N s/m].
    deflections : list of quantity, optional
        In place of the stiffness, a table: angles [rad] or travels [m] less rest, increasing.
    loads : list of quantity, optional
        Restoring torques [N m] or forces [N] of the table, linear in between and beyond its ends.

    Notes
    -----
    Channels: NAME.load [N m], NAME.load [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        joint: str,
        coordinate: Literal["angle", "travel"] | None = ...,
        rest: Quantity = ...,
        stiffness: Quantity | None = ...,
        damping: Quantity = ...,
        deflections: Numbers = ...,
        loads: Numbers = ...,
    ) -> None: ...
    joint: str
    coordinate: Literal["angle", "travel"] | None
    rest: Quantity
    stiffness: Quantity | None
    damping: Quantity
    deflections: Numbers
    loads: Numbers

class LineBearing(Component):
    """A line of a body lies loose on a plane of another one: with both ends it pushes, slides and lifts off.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Body, or "ground", whose plane carries, and the body whose line lies on it.
    points : 2 x 3 x length [m] or text
        Where the deck begins, a point of the plane, and the middle of the line, in the coordinates of
        the geometries; of the ground in the world [m].
    inward : 3 x number
        From its border onto the deck, in the axes of the first body: the line lies across it at the
        start.
    length : length [m] > 0
        Of the line [m].
    stiffness : stiffness [N/m] > 0
        Of each end [N/m], upwards and while it sticks.
    normal : 3 x number, default [0.0, 0.0, 1.0]
        Of the plane, away from it, in the axes of the first body, at a right angle to inward.
    deck_length : length [m] > 0, optional
        From its border to its other one [m]; it has none if absent. An end of the line that leaves the
        deck stops the run.
    damping : damping [N s/m] >= 0, default 0.0
        Of each end, upwards [N s/m]; limited so that it never pulls.
    friction : number >= 0, default 0.0
        Coefficient.

    Notes
    -----
    Channels: NAME.force [N], NAME.force_max [N], NAME.force_min [N], NAME.force_at [N], NAME.friction
    [N], NAME.lift_off [m], NAME.overlap [m], NAME.slip_path [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        inward: Numbers,
        length: Quantity,
        stiffness: Quantity,
        normal: Numbers = ...,
        deck_length: Quantity | None = ...,
        damping: Quantity = ...,
        friction: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    inward: Numbers
    length: Quantity
    stiffness: Quantity
    normal: Numbers
    deck_length: Quantity | None
    damping: Quantity
    friction: Quantity

class JointMotor(Component):
    """A torque or force of side a of a joint on its side b, constant or from a table over time.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    joint : text
        A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts.
    coordinate : "angle", "travel", optional
        Of a joint that both turns and slides: what of it counts.
    load : quantity, optional
        A constant torque [N m] or force [N].
    times : list of time [s], optional
        Times of the table [s], increasing.
    loads : list of quantity, optional
        Torques or forces of the table, linear in between, constant before and after.

    Notes
    -----
    Channels: NAME.load [N m], NAME.load [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        joint: str,
        coordinate: Literal["angle", "travel"] | None = ...,
        load: Quantity | None = ...,
        times: Numbers = ...,
        loads: Numbers = ...,
    ) -> None: ...
    joint: str
    coordinate: Literal["angle", "travel"] | None
    load: Quantity | None
    times: Numbers
    loads: Numbers

class PointForce(Component):
    """A force on a material point, constant or from a table over time.

    Parameters
    ----------
    name : text
        Its name.
    body : text
        Body that is loaded.
    point : 3 x length [m] or text
        Loaded point in the coordinates of the geometry [m]; of a flexible body, frame or shell any
        point of its mesh, or the name of an interface.
    times : list of time [s], optional
        Times of the table [s], increasing.
    forces : list of 3 x force [N], optional
        Forces of the table [N], linear in between, constant before and after.
    frame : "world", "body", default "world"
        Axes of the force: of the world, or of the body frame.
    force : 3 x force [N], optional
        A constant force [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        point: Numbers | str,
        times: Numbers = ...,
        forces: Sequence[Numbers] | NDArray[Any] = ...,
        frame: Literal["world", "body"] = ...,
        force: Numbers | None = ...,
    ) -> None: ...
    body: str
    point: Numbers | str
    times: Numbers
    forces: Sequence[Numbers] | NDArray[Any]
    frame: Literal["world", "body"]
    force: Numbers | None

class Spring(Component):
    """A spring and damper between two points, along their line: it pulls and pushes.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    points : 2 x 3 x length [m] or text
        One point a side [m] in the coordinates of the geometry of the body, or the name of an interface
        of it; of the ground in the world.
    length : length [m] >= 0, optional
        Unloaded length [m]; the initial geometric length if absent.
    stiffness : stiffness [N/m] >= 0, optional
        [N/m].
    damping : damping [N s/m] >= 0, default 0.0
        [N s/m].
    elongations : list of length [m], optional
        In place of the stiffness, a table: elongations [m], increasing.
    forces : list of force [N], optional
        Tensions of the table [N], linear in between and beyond its ends.

    Notes
    -----
    Channels: NAME.force [N], NAME.length [m], NAME.force_max [N], NAME.force_min [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        length: Quantity | None = ...,
        stiffness: Quantity | None = ...,
        damping: Quantity = ...,
        elongations: Numbers = ...,
        forces: Numbers = ...,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    length: Quantity | None
    stiffness: Quantity | None
    damping: Quantity
    elongations: Numbers
    forces: Numbers

class Tugger(Component):
    """A winch pulls the two points together with a constant tension.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    points : 2 x 3 x length [m] or text
        One point a side [m] in the coordinates of the geometry of the body, or the name of an interface
        of it; of the ground in the world.
    tension : force [N] >= 0
        Tension of the line [N].

    Notes
    -----
    Channels: NAME.pull [N], NAME.distance [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        tension: Quantity,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    tension: Quantity

class SurfaceContour(Component):
    """A surface: what touches it is on the side of its normal.

    Parameters
    ----------
    name : text
        Name.
    body : text
        Body that it belongs to, or "ground".
    nodes : text, optional
        Of a flexible body: a file in the case folder with a matrix of numbers of nodes, from 1:
        [1,2,3;4,5,6].
    file : text, optional
        In place of points, a file in the case folder: lines x,y,z [m]; # begins a comment.
    parametrisation : "chord", "centripetal", "uniform", default "chord"
        How parameters are given to the points: by their distances, the roots of these, or all alike.
    face : table: Face, optional
        Of a flexible body: nodes of a face of its mesh.
    points : list of list of 3 x length [m], optional
        Of a rigid body or the ground: rows of points, along the second direction each, in the
        coordinates of the geometry; of the ground in the world [m].
    columns : integer >= 2, optional
        With file: number of points in a row.
    spline : table: SurfaceSpline, optional
        Of a rigid body or the ground: a surface of another program.
    degree : integer >= 3, <= 7 or list of integer >= 3, <= 7, default [3, 3]
        One number for both directions, or two; at least 3.
    closed : true, false or list of true, false, default [false, false]
        Whether the last row follows upon the first one, and so for columns: of tubes and rings.
    flip : true, false, default false
        Turn the normal round: it is along (derivative by the first) x (by the second direction) and
        points out.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        nodes: str | None = ...,
        file: str | None = ...,
        parametrisation: Literal["chord", "centripetal", "uniform"] = ...,
        face: FaceTable | Mapping[str, Any] | None = ...,
        points: Sequence[Sequence[Numbers] | NDArray[Any]] | None = ...,
        columns: int | None = ...,
        spline: SurfaceSplineTable | Mapping[str, Any] | None = ...,
        degree: int | Sequence[int] | NDArray[Any] = ...,
        closed: bool | Sequence[bool] = ...,
        flip: bool = ...,
    ) -> None: ...
    body: str
    nodes: str | None
    file: str | None
    parametrisation: Literal["chord", "centripetal", "uniform"]
    face: FaceTable | Mapping[str, Any] | None
    points: Sequence[Sequence[Numbers] | NDArray[Any]] | None
    columns: int | None
    spline: SurfaceSplineTable | Mapping[str, Any] | None
    degree: int | Sequence[int] | NDArray[Any]
    closed: bool | Sequence[bool]
    flip: bool

class CurveContour(Component):
    """A curve: beads slide along it, balls touch it.

    Parameters
    ----------
    name : text
        Name.
    body : text
        Body that it belongs to, or "ground".
    nodes : text, optional
        Of a flexible body: a file in the case folder with a matrix of numbers of nodes, from 1:
        [1,2,3;4,5,6].
    file : text, optional
        In place of points, a file in the case folder: lines x,y,z [m]; # begins a comment.
    parametrisation : "chord", "centripetal", "uniform", default "chord"
        How parameters are given to the points: by their distances, the roots of these, or all alike.
    line : table: Line, optional
        Of a flexible body: nodes of its mesh on a line.
    points : list of 3 x length [m], optional
        Of a rigid body or the ground: points in order, in the coordinates of the geometry; of the
        ground in the world [m].
    circle : table: Circle, optional
        A circle.
    spline : table: CurveSpline, optional
        Of a rigid body or the ground: a curve of another program.
    degree : integer >= 3, <= 7, default 3
        At least 3.
    closed : true, false, default false
        Whether the first point follows upon the last one; a circle is closed.
    normal : 3 x number, optional
        Direction across it at its start, in the coordinates of the body: the first of the two normals
        of a bead; chosen if absent.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        nodes: str | None = ...,
        file: str | None = ...,
        parametrisation: Literal["chord", "centripetal", "uniform"] = ...,
        line: BoxGroupTable | Mapping[str, Any] | None = ...,
        points: Sequence[Numbers] | NDArray[Any] | None = ...,
        circle: CircleTable | Mapping[str, Any] | None = ...,
        spline: CurveSplineTable | Mapping[str, Any] | None = ...,
        degree: int = ...,
        closed: bool = ...,
        normal: Numbers | None = ...,
    ) -> None: ...
    body: str
    nodes: str | None
    file: str | None
    parametrisation: Literal["chord", "centripetal", "uniform"]
    line: BoxGroupTable | Mapping[str, Any] | None
    points: Sequence[Numbers] | NDArray[Any] | None
    circle: CircleTable | Mapping[str, Any] | None
    spline: CurveSplineTable | Mapping[str, Any] | None
    degree: int
    closed: bool
    normal: Numbers | None

class CylinderContour(Component):
    """The surface of a round bar, cable or pipe about a curve.

    Parameters
    ----------
    name : text
        Name.
    body : text
        Body that it belongs to, or "ground".
    radius : length [m] > 0
        [m].
    nodes : text, optional
        Of a flexible body: a file in the case folder with a matrix of numbers of nodes, from 1:
        [1,2,3;4,5,6].
    file : text, optional
        In place of points, a file in the case folder: lines x,y,z [m]; # begins a comment.
    parametrisation : "chord", "centripetal", "uniform", default "chord"
        How parameters are given to the points: by their distances, the roots of these, or all alike.
    line : table: Line, optional
        Of a flexible body: nodes of its mesh on a line.
    points : list of 3 x length [m], optional
        Of a rigid body or the ground: points in order, in the coordinates of the geometry; of the
        ground in the world [m].
    circle : table: Circle, optional
        A circle.
    spline : table: CurveSpline, optional
        Of a rigid body or the ground: a curve of another program.
    degree : integer >= 3, <= 7, default 3
        At least 3.
    closed : true, false, default false
        Whether the first point follows upon the last one; a circle is closed.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        radius: Quantity,
        nodes: str | None = ...,
        file: str | None = ...,
        parametrisation: Literal["chord", "centripetal", "uniform"] = ...,
        line: BoxGroupTable | Mapping[str, Any] | None = ...,
        points: Sequence[Numbers] | NDArray[Any] | None = ...,
        circle: CircleTable | Mapping[str, Any] | None = ...,
        spline: CurveSplineTable | Mapping[str, Any] | None = ...,
        degree: int = ...,
        closed: bool = ...,
    ) -> None: ...
    body: str
    radius: Quantity
    nodes: str | None
    file: str | None
    parametrisation: Literal["chord", "centripetal", "uniform"]
    line: BoxGroupTable | Mapping[str, Any] | None
    points: Sequence[Numbers] | NDArray[Any] | None
    circle: CircleTable | Mapping[str, Any] | None
    spline: CurveSplineTable | Mapping[str, Any] | None
    degree: int
    closed: bool

class BandContour(Component):
    """The surface of a band along a curve, straight across it.

    Parameters
    ----------
    name : text
        Name.
    body : text
        Body that it belongs to, or "ground".
    width : length [m] > 0
        From edge to edge [m]; the curve is its middle.
    nodes : text, optional
        Of a flexible body: a file in the case folder with a matrix of numbers of nodes, from 1:
        [1,2,3;4,5,6].
    file : text, optional
        In place of points, a file in the case folder: lines x,y,z [m]; # begins a comment.
    parametrisation : "chord", "centripetal", "uniform", default "chord"
        How parameters are given to the points: by their distances, the roots of these, or all alike.
    line : table: Line, optional
        Of a flexible body: nodes of its mesh on a line.
    points : list of 3 x length [m], optional
        Of a rigid body or the ground: points in order, in the coordinates of the geometry; of the
        ground in the world [m].
    circle : table: Circle, optional
        A circle.
    spline : table: CurveSpline, optional
        Of a rigid body or the ground: a curve of another program.
    degree : integer >= 3, <= 7, default 3
        At least 3.
    closed : true, false, default false
        Whether the first point follows upon the last one; a circle is closed.
    across : 3 x number, optional
        Direction along the width, in the coordinates of the body, for all of the curve: the normal is
        across x tangent, of a circle about this axis inward.
    normal : 3 x number, optional
        In place of across: outward normal at the start of the curve.
    flip : true, false, default false
        With across: turn the normal round.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        width: Quantity,
        nodes: str | None = ...,
        file: str | None = ...,
        parametrisation: Literal["chord", "centripetal", "uniform"] = ...,
        line: BoxGroupTable | Mapping[str, Any] | None = ...,
        points: Sequence[Numbers] | NDArray[Any] | None = ...,
        circle: CircleTable | Mapping[str, Any] | None = ...,
        spline: CurveSplineTable | Mapping[str, Any] | None = ...,
        degree: int = ...,
        closed: bool = ...,
        across: Numbers | None = ...,
        normal: Numbers | None = ...,
        flip: bool = ...,
    ) -> None: ...
    body: str
    width: Quantity
    nodes: str | None
    file: str | None
    parametrisation: Literal["chord", "centripetal", "uniform"]
    line: BoxGroupTable | Mapping[str, Any] | None
    points: Sequence[Numbers] | NDArray[Any] | None
    circle: CircleTable | Mapping[str, Any] | None
    spline: CurveSplineTable | Mapping[str, Any] | None
    degree: int
    closed: bool
    across: Numbers | None
    normal: Numbers | None
    flip: bool

class RigidLawContact(Component):
    """Without compliance: contacts do not penetrate, impacts are instantaneous, and give impulses, not forces.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        The body that touches, and the contour that it touches.
    point : 3 x length [m] or text, optional
        Point of the body that touches, or the middle of its shape [m], in the coordinates of the
        geometry, or the name of an interface; its origin if absent.
    at : 3 x length [m], optional
        In place of point: where it is at the start [m], in the world.
    shape : table: PointShape, SphereShape, CircleShape, EllipsoidShape, BoxShape, CapsuleShape, CylinderShape, optional
        What touches; the point itself if absent.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    footprint : length [m] > 0, optional
        Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 -
        r^2/R^2)^2.
    restitution : number >= 0, <= 1, default 0.0
        Velocity after an impact over that before it (Newton's), 0 to 1.
    rest_speed : velocity [m/s] >= 0, default 0.0
        Approach [m/s] below which an impact has no restitution.
    events : true, false, default true
        Split the step where an impact happens; else impacts happen at ends of steps. Contacts of
        surfaces that could close within a step then are rows of that step: nothing passes through. So
        it is with a frame or shell without restitution.

    Notes
    -----
    Channels: NAME.gap [m], NAME.normal_force [N], NAME.friction_force [N], NAME.force [N], NAME.impulse
    [N s], NAME.slip [m/s], NAME.slip_path [m], NAME.coordinate [1], NAME.point [m], NAME.dissipated
    [J], NAME.impacts [1], NAME.normal_force_max [N], NAME.normal_force_min [N], NAME.gap_min [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        point: Numbers | str | None = ...,
        at: Numbers | None = ...,
        shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable = ...,
        friction: Quantity = ...,
        footprint: Quantity | None = ...,
        restitution: Quantity = ...,
        rest_speed: Quantity = ...,
        events: bool = ...,
    ) -> None: ...
    between: Sequence[str]
    point: Numbers | str | None
    at: Numbers | None
    shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable
    friction: Quantity
    footprint: Quantity | None
    restitution: Quantity
    rest_speed: Quantity
    events: bool

class BilateralLawContact(Component):
    """Never leaves the contour: a bead on a curve, a slider in a surface.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        The body that touches, and the contour that it touches.
    point : 3 x length [m] or text, optional
        Point of the body that touches, or the middle of its shape [m], in the coordinates of the
        geometry, or the name of an interface; its origin if absent.
    at : 3 x length [m], optional
        In place of point: where it is at the start [m], in the world.
    shape : table: PointShape, SphereShape, CircleShape, EllipsoidShape, BoxShape, CapsuleShape, CylinderShape, optional
        What touches; the point itself if absent.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    footprint : length [m] > 0, optional
        Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 -
        r^2/R^2)^2.

    Notes
    -----
    Channels: NAME.gap [m], NAME.normal_force [N], NAME.friction_force [N], NAME.force [N], NAME.impulse
    [N s], NAME.slip [m/s], NAME.slip_path [m], NAME.coordinate [1], NAME.point [m], NAME.dissipated
    [J], NAME.impacts [1], NAME.normal_force_max [N], NAME.normal_force_min [N], NAME.gap_min [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        point: Numbers | str | None = ...,
        at: Numbers | None = ...,
        shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable = ...,
        friction: Quantity = ...,
        footprint: Quantity | None = ...,
    ) -> None: ...
    between: Sequence[str]
    point: Numbers | str | None
    at: Numbers | None
    shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable
    friction: Quantity
    footprint: Quantity | None

class LinearLawContact(Component):
    """A spring and a damper that never pull: F = k d + c d'.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        The body that touches, and the contour that it touches.
    stiffness : stiffness [N/m] > 0
        [N/m]; of surfaces that of a patch, which its contacts share.
    point : 3 x length [m] or text, optional
        Point of the body that touches, or the middle of its shape [m], in the coordinates of the
        geometry, or the name of an interface; its origin if absent.
    at : 3 x length [m], optional
        In place of point: where it is at the start [m], in the world.
    shape : table: PointShape, SphereShape, CircleShape, EllipsoidShape, BoxShape, CapsuleShape, CylinderShape, optional
        What touches; the point itself if absent.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    footprint : length [m] > 0, optional
        Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 -
        r^2/R^2)^2.
    damping : damping [N s/m] >= 0, default 0.0
        [N s/m]; of surfaces that of a patch.

    Notes
    -----
    Channels: NAME.gap [m], NAME.normal_force [N], NAME.friction_force [N], NAME.force [N], NAME.impulse
    [N s], NAME.slip [m/s], NAME.slip_path [m], NAME.coordinate [1], NAME.point [m], NAME.dissipated
    [J], NAME.impacts [1], NAME.normal_force_max [N], NAME.normal_force_min [N], NAME.gap_min [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        stiffness: Quantity,
        point: Numbers | str | None = ...,
        at: Numbers | None = ...,
        shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable = ...,
        friction: Quantity = ...,
        footprint: Quantity | None = ...,
        damping: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    stiffness: Quantity
    point: Numbers | str | None
    at: Numbers | None
    shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable
    friction: Quantity
    footprint: Quantity | None
    damping: Quantity

class HertzLawContact(Component):
    """Elastic and smooth bodies (Hertz): a force that grows with the depth to the power of 3/2.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        The body that touches, and the contour that it touches.
    point : 3 x length [m] or text, optional
        Point of the body that touches, or the middle of its shape [m], in the coordinates of the
        geometry, or the name of an interface; its origin if absent.
    at : 3 x length [m], optional
        In place of point: where it is at the start [m], in the world.
    shape : table: PointShape, SphereShape, CircleShape, EllipsoidShape, BoxShape, CapsuleShape, CylinderShape, optional
        What touches; the point itself if absent.
    contact_modulus : pressure [Pa] > 0, optional
        In place of stiffness, of a sphere: E* [Pa] with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; the
        stiffness is 4/3 E* sqrt(radius), of a ball on a flat surface.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    footprint : length [m] > 0, optional
        Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 -
        r^2/R^2)^2.
    stiffness : quantity > 0, optional
        [N/m^1.5], of a ball 4/3 E* sqrt(R); of surfaces that of a patch, which its contacts share.

    Notes
    -----
    Channels: NAME.gap [m], NAME.normal_force [N], NAME.friction_force [N], NAME.force [N], NAME.impulse
    [N s], NAME.slip [m/s], NAME.slip_path [m], NAME.coordinate [1], NAME.point [m], NAME.dissipated
    [J], NAME.impacts [1], NAME.normal_force_max [N], NAME.normal_force_min [N], NAME.gap_min [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        point: Numbers | str | None = ...,
        at: Numbers | None = ...,
        shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable = ...,
        contact_modulus: Quantity | None = ...,
        friction: Quantity = ...,
        footprint: Quantity | None = ...,
        stiffness: Quantity | None = ...,
    ) -> None: ...
    between: Sequence[str]
    point: Numbers | str | None
    at: Numbers | None
    shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable
    contact_modulus: Quantity | None
    friction: Quantity
    footprint: Quantity | None
    stiffness: Quantity | None

class HuntCrossleyLawContact(Component):
    """A force that grows with a power of the depth, and damping that gives a restitution (Hunt and Crossley). F = k d^n (1 + a d') with the damping a [s/m] that the speed of first touch needs.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        The body that touches, and the contour that it touches.
    point : 3 x length [m] or text, optional
        Point of the body that touches, or the middle of its shape [m], in the coordinates of the
        geometry, or the name of an interface; its origin if absent.
    at : 3 x length [m], optional
        In place of point: where it is at the start [m], in the world.
    shape : table: PointShape, SphereShape, CircleShape, EllipsoidShape, BoxShape, CapsuleShape, CylinderShape, optional
        What touches; the point itself if absent.
    contact_modulus : pressure [Pa] > 0, optional
        In place of stiffness, of a sphere: E* [Pa] with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; the
        stiffness is 4/3 E* sqrt(radius), of a ball on a flat surface.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    footprint : length [m] > 0, optional
        Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 -
        r^2/R^2)^2.
    exponent : number >= 1, <= 3, default 1.5
        1.5 of Hertz, 1 linear.
    restitution : number >= 0, <= 1, default 1.0
        Velocity after an impact over that before it, above 0 up to 1.
    stiffness : quantity > 0, optional
        [N/m^exponent]; of surfaces that of a patch, which its contacts share.

    Notes
    -----
    Channels: NAME.gap [m], NAME.normal_force [N], NAME.friction_force [N], NAME.force [N], NAME.impulse
    [N s], NAME.slip [m/s], NAME.slip_path [m], NAME.coordinate [1], NAME.point [m], NAME.dissipated
    [J], NAME.impacts [1], NAME.normal_force_max [N], NAME.normal_force_min [N], NAME.gap_min [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        point: Numbers | str | None = ...,
        at: Numbers | None = ...,
        shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable = ...,
        contact_modulus: Quantity | None = ...,
        friction: Quantity = ...,
        footprint: Quantity | None = ...,
        exponent: Quantity = ...,
        restitution: Quantity = ...,
        stiffness: Quantity | None = ...,
    ) -> None: ...
    between: Sequence[str]
    point: Numbers | str | None
    at: Numbers | None
    shape: PointShapeTable | Mapping[str, Any] | SphereShapeTable | CircleShapeTable | EllipsoidShapeTable | BoxShapeTable | CapsuleShapeTable | CylinderShapeTable
    contact_modulus: Quantity | None
    friction: Quantity
    footprint: Quantity | None
    exponent: Quantity
    restitution: Quantity
    stiffness: Quantity | None

class Surface(Component):
    """Triangles that move with a body: from a file, a simple shape, or of a body that deforms its own surface.

    Parameters
    ----------
    name : text
        Name; collisions are between names of surfaces.
    body : text
        Body that it belongs to, or "ground".
    file : text, optional
        STL, OBJ, PLY, STEP, IGES, BREP or mesh file in the case folder.
    unit : "m", "mm", optional
        Length unit of the coordinates in the file; m if absent. STEP and IGES carry their own.
    size : length [m] > 0, optional
        Of a CAD file: edge length of the triangles on its faces [m]; a twentieth of its extent if
        absent.
    shape : table: PlaneShape, BoxShape, SphereShape, CapsuleShape, CylinderShape, optional
        In place of file: a simple shape.
    at : 3 x length [m], default [0.0, 0.0, 0.0]
        Where the origin of the file or shape is, in the coordinates of the geometry; of the ground in
        the world [m].
    turned : table: Turn, optional
        How it is turned about its origin from the axes of the body; not at all if absent.
    radius : length [m] >= 0, default 0.0
        Rounding [m]: everything at this distance from the triangles of a file or plane is its surface,
        as half the thickness of a plate; of a box or cylinder the radius of its edges, within its size.
    exclude : list of tables: Exclusion, optional
        Boxes whose triangles take no part; of a flexible body in the coordinates of its geometry,
        undeformed.
    facets : integer >= 1, <= 32, optional
        Of a frame or shell: facets along each side of an element; 2 if absent.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        file: str | None = ...,
        unit: Literal["m", "mm"] | None = ...,
        size: Quantity | None = ...,
        shape: PlaneShapeTable | Mapping[str, Any] | BoxShapeTable2 | SphereShapeTable2 | CapsuleShapeTable2 | CylinderShapeTable2 | None = ...,
        at: Numbers = ...,
        turned: TurnTable2 | Mapping[str, Any] | None = ...,
        radius: Quantity = ...,
        exclude: Sequence[ExclusionTable | Mapping[str, Any]] = ...,
        facets: int | None = ...,
    ) -> None: ...
    body: str
    file: str | None
    unit: Literal["m", "mm"] | None
    size: Quantity | None
    shape: PlaneShapeTable | Mapping[str, Any] | BoxShapeTable2 | SphereShapeTable2 | CapsuleShapeTable2 | CylinderShapeTable2 | None
    at: Numbers
    turned: TurnTable2 | Mapping[str, Any] | None
    radius: Quantity
    exclude: Sequence[ExclusionTable | Mapping[str, Any]]
    facets: int | None

class RigidLawCollision(Component):
    """Without compliance: contacts do not penetrate, impacts are instantaneous, and give impulses, not forces.

    Parameters
    ----------
    name : text
        Name; the first part of its channels. With among those of the pairs are NAME_1, NAME_2, ...
    between : 2 x text, optional
        Two surfaces that may touch; forces are recorded on the second.
    among : list of text, optional
        In place of between: all pairs of these surfaces that are not on one body, of which one can
        move.
    peak_stiffness : stiffness [N/m] > 0, optional
        For the report alone: stiffness k [N/m] of what is hit, by which the peak force of an impact is
        estimated as v sqrt(k m).
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    method : "swept", "position-difference", default "swept"
        swept: certified tests of the paths within a step; position-difference: as in "Integrated
        simulation of ships and offshore structures (2018)", section 2.6, which misses collisions; for
        comparison.
    patch_angle : angle [rad] > 0, < 3.14159, default 0.3141592653589793
        Contacts belong to one patch if their normals differ by less [rad].
    patch_size : length [m] > 0, optional
        And lie within this distance [m]; a tenth of the smaller surface, at least 1.5 times its mean
        edge, if absent.
    most_contacts : integer >= 1, <= 100000, default 512
        At once, of a pair; if there are more, the simulation stops. All pairs together have as many for
        each surface. With a frame or shell 64 at most.
    recorded : integer >= 0, <= 1000, default 8
        Contacts recorded one by one, those with the largest forces.
    clearance : true, false, default false
        Record the distance of the surfaces in gap, and its smallest value over all steps in gap_min,
        while they are far apart too; it costs a search for each record, and for each step in which they
        may have come nearer. So it is if a phase waits for it, or criteria, checks, references or the
        report name it. Otherwise both are not a number beyond the reach of the search, a few times the
        motion in a step.
    restitution : number >= 0, <= 1, default 0.0
        Velocity after an impact over that before it (Newton's), 0 to 1.
    rest_speed : velocity [m/s] >= 0, default 0.0
        Approach [m/s] below which an impact has no restitution.
    events : true, false, default true
        Split the step where an impact happens; else impacts happen at ends of steps. Contacts of
        surfaces that could close within a step then are rows of that step: nothing passes through. So
        it is with a frame or shell without restitution.

    Notes
    -----
    Channels: NAME.gap [m], NAME.contacts [1], NAME.patches [1], NAME.force [N], NAME.normal_force [N],
    NAME.largest_force [N], NAME.impulse [N s], NAME.point [m], NAME.slip [m/s], NAME.dissipated [J],
    NAME.impacts [1], NAME.impact_impulse [N s], NAME.normal_force_max [N], NAME.normal_force_min [N],
    NAME.gap_min [m], NAME.contact_1.point [m], NAME.contact_1.normal [1], NAME.contact_1.gap [m],
    NAME.contact_1.force [N], NAME.contact_1.friction [N], NAME.contact_1.impulse [N s],
    NAME.contact_1.patch [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str] | None = ...,
        among: Sequence[str] | None = ...,
        peak_stiffness: Quantity | None = ...,
        friction: Quantity = ...,
        method: Literal["swept", "position-difference"] = ...,
        patch_angle: Quantity = ...,
        patch_size: Quantity | None = ...,
        most_contacts: int = ...,
        recorded: int = ...,
        clearance: bool = ...,
        restitution: Quantity = ...,
        rest_speed: Quantity = ...,
        events: bool = ...,
    ) -> None: ...
    between: Sequence[str] | None
    among: Sequence[str] | None
    peak_stiffness: Quantity | None
    friction: Quantity
    method: Literal["swept", "position-difference"]
    patch_angle: Quantity
    patch_size: Quantity | None
    most_contacts: int
    recorded: int
    clearance: bool
    restitution: Quantity
    rest_speed: Quantity
    events: bool

class LinearLawCollision(Component):
    """A spring and a damper that never pull: F = k d + c d'.

    Parameters
    ----------
    name : text
        Name; the first part of its channels. With among those of the pairs are NAME_1, NAME_2, ...
    stiffness : stiffness [N/m] > 0
        [N/m]; of surfaces that of a patch, which its contacts share.
    between : 2 x text, optional
        Two surfaces that may touch; forces are recorded on the second.
    among : list of text, optional
        In place of between: all pairs of these surfaces that are not on one body, of which one can
        move.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    method : "swept", "position-difference", default "swept"
        swept: certified tests of the paths within a step; position-difference: as in "Integrated
        simulation of ships and offshore structures (2018)", section 2.6, which misses collisions; for
        comparison.
    patch_angle : angle [rad] > 0, < 3.14159, default 0.3141592653589793
        Contacts belong to one patch if their normals differ by less [rad].
    patch_size : length [m] > 0, optional
        And lie within this distance [m]; a tenth of the smaller surface, at least 1.5 times its mean
        edge, if absent.
    most_contacts : integer >= 1, <= 100000, default 512
        At once, of a pair; if there are more, the simulation stops. All pairs together have as many for
        each surface. With a frame or shell 64 at most.
    recorded : integer >= 0, <= 1000, default 8
        Contacts recorded one by one, those with the largest forces.
    clearance : true, false, default false
        Record the distance of the surfaces in gap, and its smallest value over all steps in gap_min,
        while they are far apart too; it costs a search for each record, and for each step in which they
        may have come nearer. So it is if a phase waits for it, or criteria, checks, references or the
        report name it. Otherwise both are not a number beyond the reach of the search, a few times the
        motion in a step.
    damping : damping [N s/m] >= 0, default 0.0
        [N s/m]; of surfaces that of a patch.

    Notes
    -----
    Channels: NAME.gap [m], NAME.contacts [1], NAME.patches [1], NAME.force [N], NAME.normal_force [N],
    NAME.largest_force [N], NAME.impulse [N s], NAME.point [m], NAME.slip [m/s], NAME.dissipated [J],
    NAME.impacts [1], NAME.impact_impulse [N s], NAME.normal_force_max [N], NAME.normal_force_min [N],
    NAME.gap_min [m], NAME.contact_1.point [m], NAME.contact_1.normal [1], NAME.contact_1.gap [m],
    NAME.contact_1.force [N], NAME.contact_1.friction [N], NAME.contact_1.impulse [N s],
    NAME.contact_1.patch [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        stiffness: Quantity,
        between: Sequence[str] | None = ...,
        among: Sequence[str] | None = ...,
        friction: Quantity = ...,
        method: Literal["swept", "position-difference"] = ...,
        patch_angle: Quantity = ...,
        patch_size: Quantity | None = ...,
        most_contacts: int = ...,
        recorded: int = ...,
        clearance: bool = ...,
        damping: Quantity = ...,
    ) -> None: ...
    stiffness: Quantity
    between: Sequence[str] | None
    among: Sequence[str] | None
    friction: Quantity
    method: Literal["swept", "position-difference"]
    patch_angle: Quantity
    patch_size: Quantity | None
    most_contacts: int
    recorded: int
    clearance: bool
    damping: Quantity

class HertzLawCollision(Component):
    """Elastic and smooth bodies (Hertz): a force that grows with the depth to the power of 3/2.

    Parameters
    ----------
    name : text
        Name; the first part of its channels. With among those of the pairs are NAME_1, NAME_2, ...
    stiffness : quantity > 0
        [N/m^1.5], of a ball 4/3 E* sqrt(R); of surfaces that of a patch, which its contacts share.
    between : 2 x text, optional
        Two surfaces that may touch; forces are recorded on the second.
    among : list of text, optional
        In place of between: all pairs of these surfaces that are not on one body, of which one can
        move.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    method : "swept", "position-difference", default "swept"
        swept: certified tests of the paths within a step; position-difference: as in "Integrated
        simulation of ships and offshore structures (2018)", section 2.6, which misses collisions; for
        comparison.
    patch_angle : angle [rad] > 0, < 3.14159, default 0.3141592653589793
        Contacts belong to one patch if their normals differ by less [rad].
    patch_size : length [m] > 0, optional
        And lie within this distance [m]; a tenth of the smaller surface, at least 1.5 times its mean
        edge, if absent.
    most_contacts : integer >= 1, <= 100000, default 512
        At once, of a pair; if there are more, the simulation stops. All pairs together have as many for
        each surface. With a frame or shell 64 at most.
    recorded : integer >= 0, <= 1000, default 8
        Contacts recorded one by one, those with the largest forces.
    clearance : true, false, default false
        Record the distance of the surfaces in gap, and its smallest value over all steps in gap_min,
        while they are far apart too; it costs a search for each record, and for each step in which they
        may have come nearer. So it is if a phase waits for it, or criteria, checks, references or the
        report name it. Otherwise both are not a number beyond the reach of the search, a few times the
        motion in a step.

    Notes
    -----
    Channels: NAME.gap [m], NAME.contacts [1], NAME.patches [1], NAME.force [N], NAME.normal_force [N],
    NAME.largest_force [N], NAME.impulse [N s], NAME.point [m], NAME.slip [m/s], NAME.dissipated [J],
    NAME.impacts [1], NAME.impact_impulse [N s], NAME.normal_force_max [N], NAME.normal_force_min [N],
    NAME.gap_min [m], NAME.contact_1.point [m], NAME.contact_1.normal [1], NAME.contact_1.gap [m],
    NAME.contact_1.force [N], NAME.contact_1.friction [N], NAME.contact_1.impulse [N s],
    NAME.contact_1.patch [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        stiffness: Quantity,
        between: Sequence[str] | None = ...,
        among: Sequence[str] | None = ...,
        friction: Quantity = ...,
        method: Literal["swept", "position-difference"] = ...,
        patch_angle: Quantity = ...,
        patch_size: Quantity | None = ...,
        most_contacts: int = ...,
        recorded: int = ...,
        clearance: bool = ...,
    ) -> None: ...
    stiffness: Quantity
    between: Sequence[str] | None
    among: Sequence[str] | None
    friction: Quantity
    method: Literal["swept", "position-difference"]
    patch_angle: Quantity
    patch_size: Quantity | None
    most_contacts: int
    recorded: int
    clearance: bool

class HuntCrossleyLawCollision(Component):
    """A force that grows with a power of the depth, and damping that gives a restitution (Hunt and Crossley). F = k d^n (1 + a d') with the damping a [s/m] that the speed of first touch needs.

    Parameters
    ----------
    name : text
        Name; the first part of its channels. With among those of the pairs are NAME_1, NAME_2, ...
    stiffness : quantity > 0
        [N/m^exponent]; of surfaces that of a patch, which its contacts share.
    between : 2 x text, optional
        Two surfaces that may touch; forces are recorded on the second.
    among : list of text, optional
        In place of between: all pairs of these surfaces that are not on one body, of which one can
        move.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    method : "swept", "position-difference", default "swept"
        swept: certified tests of the paths within a step; position-difference: as in "Integrated
        simulation of ships and offshore structures (2018)", section 2.6, which misses collisions; for
        comparison.
    patch_angle : angle [rad] > 0, < 3.14159, default 0.3141592653589793
        Contacts belong to one patch if their normals differ by less [rad].
    patch_size : length [m] > 0, optional
        And lie within this distance [m]; a tenth of the smaller surface, at least 1.5 times its mean
        edge, if absent.
    most_contacts : integer >= 1, <= 100000, default 512
        At once, of a pair; if there are more, the simulation stops. All pairs together have as many for
        each surface. With a frame or shell 64 at most.
    recorded : integer >= 0, <= 1000, default 8
        Contacts recorded one by one, those with the largest forces.
    clearance : true, false, default false
        Record the distance of the surfaces in gap, and its smallest value over all steps in gap_min,
        while they are far apart too; it costs a search for each record, and for each step in which they
        may have come nearer. So it is if a phase waits for it, or criteria, checks, references or the
        report name it. Otherwise both are not a number beyond the reach of the search, a few times the
        motion in a step.
    exponent : number >= 1, <= 3, default 1.5
        1.5 of Hertz, 1 linear.
    restitution : number >= 0, <= 1, default 1.0
        Velocity after an impact over that before it, above 0 up to 1.

    Notes
    -----
    Channels: NAME.gap [m], NAME.contacts [1], NAME.patches [1], NAME.force [N], NAME.normal_force [N],
    NAME.largest_force [N], NAME.impulse [N s], NAME.point [m], NAME.slip [m/s], NAME.dissipated [J],
    NAME.impacts [1], NAME.impact_impulse [N s], NAME.normal_force_max [N], NAME.normal_force_min [N],
    NAME.gap_min [m], NAME.contact_1.point [m], NAME.contact_1.normal [1], NAME.contact_1.gap [m],
    NAME.contact_1.force [N], NAME.contact_1.friction [N], NAME.contact_1.impulse [N s],
    NAME.contact_1.patch [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        stiffness: Quantity,
        between: Sequence[str] | None = ...,
        among: Sequence[str] | None = ...,
        friction: Quantity = ...,
        method: Literal["swept", "position-difference"] = ...,
        patch_angle: Quantity = ...,
        patch_size: Quantity | None = ...,
        most_contacts: int = ...,
        recorded: int = ...,
        clearance: bool = ...,
        exponent: Quantity = ...,
        restitution: Quantity = ...,
    ) -> None: ...
    stiffness: Quantity
    between: Sequence[str] | None
    among: Sequence[str] | None
    friction: Quantity
    method: Literal["swept", "position-difference"]
    patch_angle: Quantity
    patch_size: Quantity | None
    most_contacts: int
    recorded: int
    clearance: bool
    exponent: Quantity
    restitution: Quantity

class ThesisLawCollision(Component):
    """The parameters of "Integrated simulation of ships and offshore structures (2018)": a spring and a damper.

    Parameters
    ----------
    name : text
        Name; the first part of its channels. With among those of the pairs are NAME_1, NAME_2, ...
    epsilon : compliance [m/N] > 0
        Compliance [m/N]: a spring of 1 / epsilon, whatever the step.
    between : 2 x text, optional
        Two surfaces that may touch; forces are recorded on the second.
    among : list of text, optional
        In place of between: all pairs of these surfaces that are not on one body, of which one can
        move.
    friction : number >= 0, default 0.0
        Coulomb's coefficient; 0 without.
    method : "swept", "position-difference", default "swept"
        swept: certified tests of the paths within a step; position-difference: as in "Integrated
        simulation of ships and offshore structures (2018)", section 2.6, which misses collisions; for
        comparison.
    patch_angle : angle [rad] > 0, < 3.14159, default 0.3141592653589793
        Contacts belong to one patch if their normals differ by less [rad].
    patch_size : length [m] > 0, optional
        And lie within this distance [m]; a tenth of the smaller surface, at least 1.5 times its mean
        edge, if absent.
    most_contacts : integer >= 1, <= 100000, default 512
        At once, of a pair; if there are more, the simulation stops. All pairs together have as many for
        each surface. With a frame or shell 64 at most.
    recorded : integer >= 0, <= 1000, default 8
        Contacts recorded one by one, those with the largest forces.
    clearance : true, false, default false
        Record the distance of the surfaces in gap, and its smallest value over all steps in gap_min,
        while they are far apart too; it costs a search for each record, and for each step in which they
        may have come nearer. So it is if a phase waits for it, or criteria, checks, references or the
        report name it. Otherwise both are not a number beyond the reach of the search, a few times the
        motion in a step.
    gamma : number >= 0, <= 1, default 1.0
        Above 0 up to 1: damping, with a time constant of h (1 / gamma - 1) / 4 at the step h. No
        restitution.

    Notes
    -----
    Channels: NAME.gap [m], NAME.contacts [1], NAME.patches [1], NAME.force [N], NAME.normal_force [N],
    NAME.largest_force [N], NAME.impulse [N s], NAME.point [m], NAME.slip [m/s], NAME.dissipated [J],
    NAME.impacts [1], NAME.impact_impulse [N s], NAME.normal_force_max [N], NAME.normal_force_min [N],
    NAME.gap_min [m], NAME.contact_1.point [m], NAME.contact_1.normal [1], NAME.contact_1.gap [m],
    NAME.contact_1.force [N], NAME.contact_1.friction [N], NAME.contact_1.impulse [N s],
    NAME.contact_1.patch [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        epsilon: Quantity,
        between: Sequence[str] | None = ...,
        among: Sequence[str] | None = ...,
        friction: Quantity = ...,
        method: Literal["swept", "position-difference"] = ...,
        patch_angle: Quantity = ...,
        patch_size: Quantity | None = ...,
        most_contacts: int = ...,
        recorded: int = ...,
        clearance: bool = ...,
        gamma: Quantity = ...,
    ) -> None: ...
    epsilon: Quantity
    between: Sequence[str] | None
    among: Sequence[str] | None
    friction: Quantity
    method: Literal["swept", "position-difference"]
    patch_angle: Quantity
    patch_size: Quantity | None
    most_contacts: int
    recorded: int
    clearance: bool
    gamma: Quantity

class Sea(Component):
    """Water, and what moves in it and above it.

    Parameters
    ----------
    density : density [kg/m^3] > 500, < 2000, default 1025.0
        Of the water [kg/m^3].
    gravity : acceleration [m/s^2] > 5, < 20, optional
        [m/s^2]; that of [gravity] if absent.
    level : length [m], default 0.0
        Height of the still water in the world [m].
    depth : length [m] > 0, optional
        [m]; deep water if absent.
    waves : table: RegularWaves, JonswapWaves, PiersonMoskowitzWaves, SpectrumWaves, ElevationWaves, optional
        A train of waves, or several that go through each other.
    ramp : time [s] >= 0, default 0.0
        Time in which waves, wind and current grow from nothing at the start [s].
    excitation : "summed", "series", default "summed"
        summed: every component of the waves at the low-passed place and heading of each hull; series:
        at the place and heading of the start, tabulated once, which is faster.
    wind : table: WindField, optional
        Wind; several with names of their own for loads that are far apart.
    current : table: CurrentField, optional
        Current.
    tide : table: Tide, optional
        Rise and fall of the still water.
    """

    def __init__(
        self,
        *,
        density: Quantity = ...,
        gravity: Quantity | None = ...,
        level: Quantity = ...,
        depth: Quantity | None = ...,
        waves: RegularWavesTable | Mapping[str, Any] | JonswapWavesTable | PiersonMoskowitzWavesTable | SpectrumWavesTable | ElevationWavesTable | Sequence[RegularWavesTable | Mapping[str, Any] | JonswapWavesTable | PiersonMoskowitzWavesTable | SpectrumWavesTable | ElevationWavesTable] = ...,
        ramp: Quantity = ...,
        excitation: Literal["summed", "series"] = ...,
        wind: WindFieldTable | Mapping[str, Any] | Sequence[WindFieldTable | Mapping[str, Any]] = ...,
        current: CurrentFieldTable | Mapping[str, Any] | Sequence[CurrentFieldTable | Mapping[str, Any]] = ...,
        tide: TideTable | Mapping[str, Any] | None = ...,
    ) -> None: ...
    density: Quantity
    gravity: Quantity | None
    level: Quantity
    depth: Quantity | None
    waves: RegularWavesTable | Mapping[str, Any] | JonswapWavesTable | PiersonMoskowitzWavesTable | SpectrumWavesTable | ElevationWavesTable | Sequence[RegularWavesTable | Mapping[str, Any] | JonswapWavesTable | PiersonMoskowitzWavesTable | SpectrumWavesTable | ElevationWavesTable]
    ramp: Quantity
    excitation: Literal["summed", "series"]
    wind: WindFieldTable | Mapping[str, Any] | Sequence[WindFieldTable | Mapping[str, Any]]
    current: CurrentFieldTable | Mapping[str, Any] | Sequence[CurrentFieldTable | Mapping[str, Any]]
    tide: TideTable | Mapping[str, Any] | None

class Hull(Component):
    """A rigid body that floats: its buoyancy, and its damping besides radiated waves.

    Parameters
    ----------
    name : text
        Name.
    surface : text, optional
        Name of a closed surface of this body, clipped by the still water.
    linear : table: LinearRestoring, optional
        In place of surface, linear restoring in numbers.
    restoring : "clipped", "linear", "none", optional
        clipped: of the surface at every instant, the default with one; linear: for small motions, of
        the numbers in linear or of the surface where it floats by itself; none: of a body whose weight
        is given under water.
    open_deck : length [m], optional
        Height in the coordinates of the geometry [m] from which on the surface may be open.
    hanging : table: Hanging, optional
        What hangs on ropes while it rests: for linear restoring, a database of the surface, and
        hydrostatics, which count what joints hold, and no ropes. In the run ropes pull as they do.
    reference : 3 x length [m], default [0.0, 0.0, 0.0]
        Point to which damping and database refer, in the coordinates of the geometry [m].
    damping : list of quantity or list of list of quantity, optional
        Six numbers, or 6 x 6, of surge to yaw in SI: in addition to that of radiated waves, along the
        heading.
    quadratic_damping : 6 x number >= 0, default [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        Force for the square of the velocity, of surge to yaw, in SI.
    low_pass : angular velocity [rad/s] > 0, < 1, default 0.05
        Cut-off of the filter of place and heading that the waves see [rad/s]; well below the waves.

    Notes
    -----
    Channels: NAME.displaced_volume [m^3], NAME.buoyancy_centre [m], NAME.ballast [kg],
    NAME.wave_elevation [m], NAME.wave_force [N], NAME.wave_moment [N m], NAME.radiation_force [N],
    NAME.radiation_moment [N m], NAME.water_level [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        surface: str | None = ...,
        linear: LinearRestoringTable | Mapping[str, Any] | None = ...,
        restoring: Literal["clipped", "linear", "none"] | None = ...,
        open_deck: Quantity | None = ...,
        hanging: HangingTable | Mapping[str, Any] | None = ...,
        reference: Numbers = ...,
        damping: Numbers | Sequence[Numbers] | NDArray[Any] | None = ...,
        quadratic_damping: Numbers = ...,
        low_pass: Quantity = ...,
    ) -> None: ...
    surface: str | None
    linear: LinearRestoringTable | Mapping[str, Any] | None
    restoring: Literal["clipped", "linear", "none"] | None
    open_deck: Quantity | None
    hanging: HangingTable | Mapping[str, Any] | None
    reference: Numbers
    damping: Numbers | Sequence[Numbers] | NDArray[Any] | None
    quadratic_damping: Numbers
    low_pass: Quantity

class Database(Component):
    """Added mass, damping and excitation of one hull, or of several that interact.

    Parameters
    ----------
    name : text
        Name.
    hulls : list of text
        Names of hulls, in the order of the database.
    file : text, optional
        netCDF of this program or of Capytaine (.nc), BEMIO (.h5), WAMIT (.1, with .3 and .hst beside
        it; or .out).
    compute : table: Compute, optional
        In place of file: computed in the mesh stage, which needs the extra heavylift[hydro].
    frequency_range : 2 x angular velocity [rad/s] > 0, optional
        Lowest and highest frequency that are used [rad/s]; all if absent.
    leave_out : list of angular velocity [rad/s] > 0, optional
        Frequencies that are left out [rad/s], in between is interpolated: irregular ones, or where a
        gap between hulls resonates and panels give no reciprocal matrix. Each is one that there is, to
        a tenth of their distance.
    symmetrise : true, false, default true
        Take symmetric parts where added mass or damping are further from symmetric than 5 % of the
        largest, and the nearest passive damping where it drives by more than 2 %; false: refuse both.
    tolerance : number > 0, < 0.5, default 0.1
        Of the largest: up to this matrices are repaired, and a limit of the added mass that is not that
        of the damping; beyond it they are refused.
    memory : "exponentials", "direct", "none", default "exponentials"
        Of radiated waves. exponentials: recursive and fast; direct: convolution, for fixed steps; none.
    memory_length : time [s] > 0, optional
        Length of the memory [s]; until the kernel has decayed if absent.
    fit_error : number > 0, < 0.5, default 0.001
        Of the kernel relative to its largest value in each coordinate, that the exponentials may have;
        coordinates that hardly radiate count as if they had a thousandth of the critical damping.
    drift : true, false, default false
        Whether mean drift forces of the database act, slowly varying by Newman's approximation.
    format : "netcdf", "bemio", "wamit", "wamit-out", optional
        Of the file; by its ending if absent.
    length_scale : length [m] > 0, optional
        ULEN of a WAMIT file [m]; 1 m if absent.
    first_column : "period", "frequency", optional
        Of WAMIT's numeric files; periods if absent.
    forces : "diffraction", "haskind", optional
        Which of the two sets of exciting forces of a WAMIT listing.
    time_convention : "exp(-i omega t)", "exp(+i omega t)", optional
        Of a netCDF file that does not state it.
    symmetric : true, false, optional
        Headings of half a turn represent their mirror images too, in a file that does not state it.
    reference_points : list of 3 x length [m], optional
        Of the hulls in the axes of the database [m], for a file that does not state them.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hulls: Sequence[str],
        file: str | None = ...,
        compute: ComputeTable | Mapping[str, Any] | None = ...,
        frequency_range: Numbers | None = ...,
        leave_out: Numbers = ...,
        symmetrise: bool = ...,
        tolerance: Quantity = ...,
        memory: Literal["exponentials", "direct", "none"] = ...,
        memory_length: Quantity | None = ...,
        fit_error: Quantity = ...,
        drift: bool = ...,
        format: Literal["netcdf", "bemio", "wamit", "wamit-out"] | None = ...,
        length_scale: Quantity | None = ...,
        first_column: Literal["period", "frequency"] | None = ...,
        forces: Literal["diffraction", "haskind"] | None = ...,
        time_convention: Literal["exp(-i omega t)", "exp(+i omega t)"] | None = ...,
        symmetric: bool | None = ...,
        reference_points: Sequence[Numbers] | NDArray[Any] | None = ...,
    ) -> None: ...
    hulls: Sequence[str]
    file: str | None
    compute: ComputeTable | Mapping[str, Any] | None
    frequency_range: Numbers | None
    leave_out: Numbers
    symmetrise: bool
    tolerance: Quantity
    memory: Literal["exponentials", "direct", "none"]
    memory_length: Quantity | None
    fit_error: Quantity
    drift: bool
    format: Literal["netcdf", "bemio", "wamit", "wamit-out"] | None
    length_scale: Quantity | None
    first_column: Literal["period", "frequency"] | None
    forces: Literal["diffraction", "haskind"] | None
    time_convention: Literal["exp(-i omega t)", "exp(+i omega t)"] | None
    symmetric: bool | None
    reference_points: Sequence[Numbers] | NDArray[Any] | None

class Tank(Component):
    """Ballast water: a point mass, a rectangular tank, or one by a table over its volume.

    Parameters
    ----------
    name : text
        Name.
    hull : text
        Hull that it is in.
    point : 3 x length [m] or text, optional
        Centre of the water, in the coordinates of the geometry [m], of a tank without size and volumes.
    mass : mass [kg] >= 0, optional
        [kg]; at the start, if pumps fill or empty it.
    times : list of time [s], optional
        In place of mass, a schedule: [s], increasing.
    masses : list of mass [kg] >= 0, optional
        [kg], one a time, linear between, held at the ends.
    free_surface : 2 x second moment of area [m^4] >= 0, default [0.0, 0.0]
        Second moments of its surface about its longitudinal and its transverse axis [m^4]: l b^3 / 12
        and b l^3 / 12; of a tank with point.
    density : density [kg/m^3] > 100, < 20000, optional
        Of its water [kg/m^3]; that of the sea if absent.
    floor : 3 x length [m], optional
        Of a rectangular tank, in place of point: the middle of its floor, in the coordinates of the
        geometry [m].
    size : 3 x length [m] > 0, optional
        Its length, breadth and height inside, along the axes of the body [m].
    permeability : number >= 0, <= 1, default 1.0
        Share of its space that water can take.
    volumes : list of volume [m^3] >= 0, optional
        In place of point, a table over the volume of the water [m^3]: from 0 to that of the full tank,
        increasing.
    centres : list of 3 x length [m], optional
        Centre of the water at each volume with the hull upright, in the coordinates of the geometry
        [m], linear between.
    surfaces : list of 2 x second moment of area [m^4] >= 0, optional
        Second moments of the free surface about its longitudinal and its transverse axis at each volume
        [m^4]; zero if absent.
    depths : list of length [m] >= 0, optional
        Depth of the water at each volume, for the record [m].

    Notes
    -----
    Channels: NAME.mass [kg], NAME.depth [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hull: str,
        point: Numbers | str | None = ...,
        mass: Quantity | None = ...,
        times: Numbers = ...,
        masses: Numbers = ...,
        free_surface: Numbers = ...,
        density: Quantity | None = ...,
        floor: Numbers | None = ...,
        size: Numbers | None = ...,
        permeability: Quantity = ...,
        volumes: Numbers = ...,
        centres: Sequence[Numbers] | NDArray[Any] | None = ...,
        surfaces: Sequence[Numbers] | NDArray[Any] | None = ...,
        depths: Numbers = ...,
    ) -> None: ...
    hull: str
    point: Numbers | str | None
    mass: Quantity | None
    times: Numbers
    masses: Numbers
    free_surface: Numbers
    density: Quantity | None
    floor: Numbers | None
    size: Numbers | None
    permeability: Quantity
    volumes: Numbers
    centres: Sequence[Numbers] | NDArray[Any] | None
    surfaces: Sequence[Numbers] | NDArray[Any] | None
    depths: Numbers

class Pump(Component):
    """Pump between two tanks, or a tank and the sea.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    source : text
        Tank that it takes water from, or "sea".
    target : text
        Tank that it gives water to, or "sea".
    rate : mass flow [kg/s] > 0
        Flow at most [kg/s].
    reversible : true, false, default false
        Whether it, or its valves, can move water from target to source as well.
    lag : time [s] >= 0, default 0.0
        Time constant [s] with which its flow follows the command.
    times : list of time [s], optional
        Of its plan [s], increasing; without one it stands still until a controller commands it.
    rates : list of mass flow [kg/s], optional
        Commanded flow from each time on [kg/s], nothing before the first; negative from target to
        source.

    Notes
    -----
    Channels: NAME.flow [kg/s], NAME.command [kg/s], NAME.pumped [kg].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        source: str,
        target: str,
        rate: Quantity,
        reversible: bool = ...,
        lag: Quantity = ...,
        times: Numbers = ...,
        rates: Numbers = ...,
    ) -> None: ...
    source: str
    target: str
    rate: Quantity
    reversible: bool
    lag: Quantity
    times: Numbers
    rates: Numbers

class Controller(Component):
    """What keeps a hull level by its pumps: it samples at intervals, and commands the pumps.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    hull : text
        Hull that it keeps.
    pumps : list of text
        Its pumps: all that are in its hands, each in those of one controller.
    gain : rate [1/s] > 0
        Rate at which an error is to vanish [1/s]: exp(-gain t).
    period : time [s] > 0, default 1.0
        Between two samples [s]; commands of the pumps are constant in between. Whole steps.
    filter : time [s] >= 0, default 0.0
        Time constant [s] of the two lags in series that filter its samples; 60 s suppress waves.
    heel : angle [rad], optional
        That is kept [rad], as roll of the hull.
    trim : angle [rad], optional
        That is kept [rad], as pitch of the hull: positive lowers the bow.
    draft : length [m], optional
        That is kept [m]: depth of draft_at under the still water.
    draft_at : 3 x length [m], optional
        Point at which the draft is read, in the coordinates of the geometry [m].
    levels : list of tables: LevelPoint, optional
        Points whose heights are kept.
    dead_band : length [m] >= 0, default 0.0
        Errors of drafts and heights that are left alone [m].
    dead_angle : angle [rad] >= 0, default 0.0
        Errors of heel and trim that are left alone [rad].
    tide_ahead : true, false, default false
        Pump ahead of the known tide, in addition to its errors: for heights over the ground.

    Notes
    -----
    Channels: NAME.error [1], NAME.share [1].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        hull: str,
        pumps: Sequence[str],
        gain: Quantity,
        period: Quantity = ...,
        filter: Quantity = ...,
        heel: Quantity | None = ...,
        trim: Quantity | None = ...,
        draft: Quantity | None = ...,
        draft_at: Numbers | None = ...,
        levels: Sequence[LevelPointTable | Mapping[str, Any]] = ...,
        dead_band: Quantity = ...,
        dead_angle: Quantity = ...,
        tide_ahead: bool = ...,
    ) -> None: ...
    hull: str
    pumps: Sequence[str]
    gain: Quantity
    period: Quantity
    filter: Quantity
    heel: Quantity | None
    trim: Quantity | None
    draft: Quantity | None
    draft_at: Numbers | None
    levels: Sequence[LevelPointTable | Mapping[str, Any]]
    dead_band: Quantity
    dead_angle: Quantity
    tide_ahead: bool

class CoefficientLoad(Component):
    """Horizontal force and yaw moment on a whole body, by coefficients over the direction of the relative flow.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body that is pushed on.
    point : 3 x length [m] or text
        Centre of pressure, in the coordinates of the geometry [m].
    area_x : area [m^2] >= 0
        Frontal area [m^2].
    area_y : area [m^2] >= 0
        Side area [m^2].
    length : length [m] > 0
        That of the moment [m].
    fluid : text, default "wind"
        Name of the wind or current.
    axis : 3 x number, default [1.0, 0.0, 0.0]
        Direction of the body that is its heading, in its coordinates.
    file : text, optional
        Comma-separated with the header angle,cx,cy,cn (rad) or angle_deg,cx,cy,cn.
    angles : list of angle [rad], optional
        In place of file: directions of the flow past the body [rad], from its heading, anticlockwise: 0
        comes from astern, 180 degrees is a head wind.
    cx : list of number, optional
        Coefficients of the force ahead, one an angle.
    cy : list of number, optional
        Of the force to port.
    cn : list of number, optional
        Of the yaw moment, anticlockwise; it refers to the side area and the length.
    symmetric : true, false, default false
        The table covers 0 to 180 degrees, and the other side is its mirror image.

    Notes
    -----
    Channels: NAME.force [N], NAME.yaw_moment [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        point: Numbers | str,
        area_x: Quantity,
        area_y: Quantity,
        length: Quantity,
        fluid: str = ...,
        axis: Numbers = ...,
        file: str | None = ...,
        angles: Numbers = ...,
        cx: Numbers = ...,
        cy: Numbers = ...,
        cn: Numbers = ...,
        symmetric: bool = ...,
    ) -> None: ...
    body: str
    point: Numbers | str
    area_x: Quantity
    area_y: Quantity
    length: Quantity
    fluid: str
    axis: Numbers
    file: str | None
    angles: Numbers
    cx: Numbers
    cy: Numbers
    cn: Numbers
    symmetric: bool

class Drag(Component):
    """Drag on the pieces of a body, each at its own height.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body that is pushed on.
    elements : list of tables: DragPiece
        The pieces; their forces are recorded as a sum.
    fluid : text, default "wind"
        Name of the wind or current.
    axis : 3 x number, default [1.0, 0.0, 0.0]
        Direction of the body that is its heading, in its coordinates.

    Notes
    -----
    Channels: NAME.force [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        elements: Sequence[DragPieceTable | Mapping[str, Any]],
        fluid: str = ...,
        axis: Numbers = ...,
    ) -> None: ...
    body: str
    elements: Sequence[DragPieceTable | Mapping[str, Any]]
    fluid: str
    axis: Numbers

class MooringLine(Component):
    """A line between an anchor and a fairlead, in equilibrium at every instant. A bottom holds the line from the anchor up to the first buoy or floating section; a bight beyond that would hang through it. If the anchor is above the bottom, on the ground or on a body, both ends hang and what lies between them is held; all of such a line sinks.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Bodies, or "ground", of its anchor and of its fairlead.
    points : 2 x 3 x length [m] or text
        Anchor and fairlead in the coordinates of the geometries; of the ground in the world [m].
    sections : list of tables: LineSection
        From the anchor to the fairlead.
    clumps : list of force [N], optional
        Weight [N] of what hangs at each joint of two sections, from the anchor; negative for a buoy.
    fairlead_tension : force [N] > 0, optional
        Tension at the fairlead at the start [N], from which the length of the one section without it
        follows.
    on_seabed : true, false, default false
        The anchor lies on the bottom of the sea, at the depth of [sea].
    seabed : length [m], optional
        In place of on_seabed: height of the bottom in the world [m], on which or above which the anchor
        is.
    seabed_slope : table: SeabedSlope, optional
        Slope of the bottom; level without it.
    friction : number >= 0, default 0.0
        Coefficient of the bottom along the line.
    strain_limit : number > 0, default 0.1
        Mean strain at which a simulation stops.

    Notes
    -----
    Channels: NAME.tension [N], NAME.anchor_tension [N], NAME.horizontal_tension [N], NAME.seabed_length
    [m], NAME.tension_max [N], NAME.tension_min [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        sections: Sequence[LineSectionTable | Mapping[str, Any]],
        clumps: Numbers = ...,
        fairlead_tension: Quantity | None = ...,
        on_seabed: bool = ...,
        seabed: Quantity | None = ...,
        seabed_slope: SeabedSlopeTable | Mapping[str, Any] | None = ...,
        friction: Quantity = ...,
        strain_limit: Quantity = ...,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    sections: Sequence[LineSectionTable | Mapping[str, Any]]
    clumps: Numbers
    fairlead_tension: Quantity | None
    on_seabed: bool
    seabed: Quantity | None
    seabed_slope: SeabedSlopeTable | Mapping[str, Any] | None
    friction: Quantity
    strain_limit: Quantity

class Fender(Component):
    """A one-sided spring on a plane face, which pushes two bodies apart.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Body, or "ground", that it is mounted on, and the one that presses it.
    points : 2 x 3 x length [m] or text
        Its tip when it is not compressed, and the point that presses it, in the coordinates of the
        geometries; of the ground in the world [m].
    direction : 3 x number
        Outward normal of its face in the axes of the first body.
    stiffness : stiffness [N/m] > 0, optional
        [N/m].
    damping : damping [N s/m] >= 0, default 0.0
        [N s/m]; limited so that it never pulls.
    compressions : list of length [m] >= 0, optional
        In place of stiffness, a table from 0 on [m].
    forces : list of force [N] >= 0, optional
        [N], one a compression.

    Notes
    -----
    Channels: NAME.force [N], NAME.compression [m], NAME.force_max [N], NAME.force_min [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        direction: Numbers,
        stiffness: Quantity | None = ...,
        damping: Quantity = ...,
        compressions: Numbers = ...,
        forces: Numbers = ...,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    direction: Numbers
    stiffness: Quantity | None
    damping: Quantity
    compressions: Numbers
    forces: Numbers

class Deck(Component):
    """A piece of a road, of one profile or a grid of heights; of several a wheel is on the uppermost.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text, default "ground"
        Body that carries it, or "ground".
    origin : 3 x length [m], default [0.0, 0.0, 0.0]
        Where station, offset and height are zero [m], in the coordinates of the geometry of the body;
        of the ground in the world.
    direction : 3 x number, default [1.0, 0.0, 0.0]
        Along which stations are counted, in the axes of the body.
    normal : 3 x number, default [0.0, 0.0, 1.0]
        Upwards, at a right angle to direction.
    sides : 2 x length [m], optional
        Right and left border [m], offsets to the left of the line of the origin; a grid has its own.
    stations : list of length [m], optional
        Of the corners of the profile [m], not falling: two alike are a vertical step. There is no road
        before the first and behind the last.
    heights : list of length [m], optional
        [m], one a station; straight between them.
    bump : table: Bump, optional
        In place of stations and heights.
    grid : table: HeightGrid, optional
        In place of stations, heights and sides.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str = ...,
        origin: Numbers = ...,
        direction: Numbers = ...,
        normal: Numbers = ...,
        sides: Numbers | None = ...,
        stations: Numbers = ...,
        heights: Numbers = ...,
        bump: BumpTable | Mapping[str, Any] | None = ...,
        grid: HeightGridTable | Mapping[str, Any] | None = ...,
    ) -> None: ...
    body: str
    origin: Numbers
    direction: Numbers
    normal: Numbers
    sides: Numbers | None
    stations: Numbers
    heights: Numbers
    bump: BumpTable | Mapping[str, Any] | None
    grid: HeightGridTable | Mapping[str, Any] | None

class Transporter(Component):
    """A body that rolls over all decks, on wheels whose hydraulic cylinders share their oil in groups.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body that rides on it: load and platform in one, or a platform to which fixed joints hold the
        load.
    groups : list of tables: BogieGroup
        Bogies, by the groups that share their oil.
    wheel_radius : length [m] >= 0, <= 5
        [m]; 0 of a point that follows the road.
    tyre_stiffness : stiffness [N/m] > 0
        Of all tyres of a bogie [N/m].
    direction : 3 x number, default [1.0, 0.0, 0.0]
        Forward direction in the axes of the body: roll is about it, pitch about the direction across
        it.
    tyre_damping : damping [N s/m] >= 0, default 0.0
        Of all tyres of a bogie [N s/m].
    line_damping : damping [N s/m] >= 0, default 0.0
        Force of a cylinder by the rate of its own stroke, of its pipe [N s/m].
    stroke_limits : 2 x length [m], optional
        Lowest and highest stroke from that of the start [m]; there only the tyre deflects. None if
        absent.
    bogie_mass : mass [kg] >= 0, default 0.0
        Of a bogie [kg]: adds to the load on the road, not to the inertia. Only if all decks are of the
        ground: on others it belongs to the body that rides.
    load_limit : force [N] > 0, optional
        Largest load of a bogie at the start, on the road [N].
    travel_speed : velocity [m/s], optional
        The wheels travel along all decks at this speed from their places at the start on, wherever the
        body is [m/s]; if absent they are where the body takes them.
    legs : list of tables: PathLeg, optional
        Legs of a path along which it is driven from its place at the start on, one after the other: its
        position and heading in the plane. On decks of several bodies it moves with them, by their
        shares in its load.
    handover : time [s] > 0, default 5.0
        Delay with which its path follows the shares of moving bodies in its load [s].
    steering_limit : angle [rad] >= 0, <= 3.14159, default 2.268928027592628
        Largest steering angle of a bogie to both sides [rad].
    drive : table: Drive, optional
        Motors and brakes; with a path.
    tyres : table: Tyres, optional
        With a path and a drive: side slip of its tyres. They hold the vehicle, which then leaves the
        path as far as they slip; absent, it follows its path whatever it takes.
    levelling : table: Levelling, optional
        What keeps it level; it stays as it is pumped if absent.
    accept_unstable : true, false, default false
        Run although the groups cannot hold the body upright: fewer than three, three in a line, or too
        soft.

    Notes
    -----
    Channels: NAME.heave [m], NAME.roll [rad], NAME.pitch [rad], NAME.least_share [1], NAME.load_max
    [N], NAME.load_min [N], NAME.stroke_max [m], NAME.stroke_min [m], NAME.group_force [N],
    NAME.wheel_load [N], NAME.road_under [m], NAME.stroke_of [m], NAME.path_way [m], NAME.off_path [m],
    NAME.off_heading [rad], NAME.push_along [N], NAME.push_across [N], NAME.push_turning [N m],
    NAME.steering [rad], NAME.rolling_speed [m/s], NAME.drive_demand [N], NAME.bogie_drive [N],
    NAME.bogie_drive_max [N], NAME.bogie_drive_min [N], NAME.traction_used_max [1], NAME.drive_used_max
    [1], NAME.brake_used_max [1], NAME.side_force [N], NAME.slip_angle [rad], NAME.levelled [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        groups: Sequence[BogieGroupTable | Mapping[str, Any]],
        wheel_radius: Quantity,
        tyre_stiffness: Quantity,
        direction: Numbers = ...,
        tyre_damping: Quantity = ...,
        line_damping: Quantity = ...,
        stroke_limits: Numbers | None = ...,
        bogie_mass: Quantity = ...,
        load_limit: Quantity | None = ...,
        travel_speed: Quantity | None = ...,
        legs: Sequence[PathLegTable | Mapping[str, Any]] = ...,
        handover: Quantity = ...,
        steering_limit: Quantity = ...,
        drive: DriveTable | Mapping[str, Any] | None = ...,
        tyres: TyresTable | Mapping[str, Any] | None = ...,
        levelling: LevellingTable | Mapping[str, Any] | None = ...,
        accept_unstable: bool = ...,
    ) -> None: ...
    body: str
    groups: Sequence[BogieGroupTable | Mapping[str, Any]]
    wheel_radius: Quantity
    tyre_stiffness: Quantity
    direction: Numbers
    tyre_damping: Quantity
    line_damping: Quantity
    stroke_limits: Numbers | None
    bogie_mass: Quantity
    load_limit: Quantity | None
    travel_speed: Quantity | None
    legs: Sequence[PathLegTable | Mapping[str, Any]]
    handover: Quantity
    steering_limit: Quantity
    drive: DriveTable | Mapping[str, Any] | None
    tyres: TyresTable | Mapping[str, Any] | None
    levelling: LevellingTable | Mapping[str, Any] | None
    accept_unstable: bool

class Sensor(Component):
    """A material point whose position and velocity are recorded.

    Parameters
    ----------
    name : text
        Name; its channels are NAME.position and NAME.velocity; checks may ask for the stress at it.
    body : text
        Body that carries it.
    point : 3 x length [m] or text
        Point in the coordinates of the geometry [m]; of a flexible body, frame or shell any point of
        its mesh, or the name of an interface.

    Notes
    -----
    Channels: NAME.position [m], NAME.velocity [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        point: Numbers | str,
    ) -> None: ...
    body: str
    point: Numbers | str

class RelativeMotion(Component):
    """Motion of the point of side b in the axes of side a, and the rotation of b against a. The axes are those of the geometries of the bodies, on the ground those of the world. A flexible body or a shell has those with which it has turned at the point.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    points : 2 x 3 x length [m] or text
        One point a side [m] in the coordinates of the geometry of the body, or the name of an interface
        of it; of the ground in the world.

    Notes
    -----
    Channels: NAME.position [m], NAME.velocity [m/s], NAME.distance [m], NAME.rotation [rad], NAME.angle
    [rad], NAME.tilt [rad], NAME.angular_velocity [rad/s], NAME.radius [m], NAME.position_max [m],
    NAME.velocity_max [m/s], NAME.distance_max [m], NAME.rotation_max [rad], NAME.angle_max [rad],
    NAME.tilt_max [rad], NAME.angular_velocity_max [rad/s], NAME.radius_max [m], NAME.position_min [m],
    NAME.velocity_min [m/s], NAME.distance_min [m], NAME.rotation_min [rad], NAME.angle_min [rad],
    NAME.tilt_min [rad], NAME.angular_velocity_min [rad/s], NAME.radius_min [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]

class FleetAngle(Component):
    """Angles of the line from the point of side a to that of side b against an axis and a plane of side a.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    between : 2 x text
        Its two sides a and b: names of bodies, or "ground" for the world.
    points : 2 x 3 x length [m] or text
        One point a side [m] in the coordinates of the geometry of the body, or the name of an interface
        of it; of the ground in the world.
    axis : 3 x number, default [0.0, 0.0, -1.0]
        Where the rope should point, down from a crown and up from a lug, in the coordinates of the
        geometry of side a; of the ground in the world; any length.
    normal : 3 x number, default [0.0, 1.0, 0.0]
        Normal of the plane of the sheaves or of the eye plate, perpendicular to axis, same coordinates;
        any length.

    Notes
    -----
    Channels: NAME.off_lead [rad], NAME.side_lead [rad], NAME.lead_angle [rad].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Numbers | str],
        axis: Numbers = ...,
        normal: Numbers = ...,
    ) -> None: ...
    between: Sequence[str]
    points: Sequence[Numbers | str]
    axis: Numbers
    normal: Numbers

class Lug(Component):
    """Force of a rope on a lug of a body, in the plane of the eye and across it, and its angle to that plane.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body with the lug.
    rope : text
        Rope of [[ropes]], or of a builder, that ends there.
    normal : 3 x number
        Normal of the plane of the eye, along its pin, in the coordinates of the geometry of the body;
        any length.
    place : integer >= 1, optional
        Number in the path of the rope, from 1 on, of the place that is the lug; its end on the body if
        absent.

    Notes
    -----
    Channels: NAME.force [N], NAME.in_plane [N], NAME.out_of_plane [N], NAME.angle [rad], NAME.force_max
    [N], NAME.in_plane_max [N], NAME.out_of_plane_max [N], NAME.angle_max [rad], NAME.force_min [N],
    NAME.in_plane_min [N], NAME.out_of_plane_min [N], NAME.angle_min [rad].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        rope: str,
        normal: Numbers,
        place: int | None = ...,
    ) -> None: ...
    body: str
    rope: str
    normal: Numbers
    place: int | None

class HookLoad(Component):
    """What hangs on a rigid body that ropes carry: on a hook block on its falls.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Rigid body with a free frame: the hook block, or a spreader.
    ropes : list of text
        Ropes that carry it, by names or patterns; what else is on the body hangs on it.

    Notes
    -----
    Channels: NAME.hook_load [N], NAME.rope_load [N], NAME.hook_load_max [N], NAME.rope_load_max [N],
    NAME.hook_load_min [N], NAME.rope_load_min [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        ropes: Sequence[str],
    ) -> None: ...
    body: str
    ropes: Sequence[str]

class RopeGroup(Component):
    """Tensions of ropes that share a load, or of the parts of a single one, at the ends of all steps.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    ropes : list of text
        Ropes of [[ropes]], or of builders, by names or patterns: ["sling_*"].
    breaking_load : force [N] > 0, optional
        Of one rope [N], for utilisation.

    Notes
    -----
    Channels: NAME.total_tension [N], NAME.largest_tension [N], NAME.smallest_tension [N], NAME.spread
    [1], NAME.utilisation [1], NAME.total_tension_max [N], NAME.largest_tension_max [N],
    NAME.smallest_tension_max [N], NAME.spread_max [1], NAME.utilisation_max [1], NAME.total_tension_min
    [N], NAME.largest_tension_min [N], NAME.smallest_tension_min [N], NAME.spread_min [1],
    NAME.utilisation_min [1], NAME.slack_time [s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        ropes: Sequence[str],
        breaking_load: Quantity | None = ...,
    ) -> None: ...
    ropes: Sequence[str]
    breaking_load: Quantity | None

class Fmu(Component):
    """A functional mock-up unit (FMI 2 or 3, co-simulation): a controller, a force, a machine from another program.

    Parameters
    ----------
    name : text
        For messages.
    file : text
        Its .fmu in the case folder, or the modelDescription.xml of an unpacked one; sources are
        compiled if there is no binary for this machine.
    sample_time : time [s] > 0
        Time between two exchanges [s]: a multiple of a fixed step, or of the output interval with a
        tolerance.
    reads : table, optional
        Its inputs, and the channel that each of them gets: { x = "module.position.x" }. Values are
        converted where the FMU gives a unit.
    writes : table, optional
        Its outputs, and the input of the case that each of them drives: { u = "gust" }.
    parameters : table, optional
        Values of its parameters, in its own units.
    coupling : "sequential", "iterated", default "sequential"
        sequential: the FMU makes its step with what it reads, constant, then the scene with what the
        FMU then writes; first order in the sample time. iterated: both repeat the interval until what
        they exchange fits at its end, linear in between; second order, for FMUs that can get and set
        their state.
    timeout : time [s] > 0, default 60.0
        Longest time of the clock [s] that a call of the FMU may take.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        file: str,
        sample_time: Quantity,
        reads: Mapping[str, str] = ...,
        writes: Mapping[str, str] = ...,
        parameters: Mapping[str, Quantity | bool] = ...,
        coupling: Literal["sequential", "iterated"] = ...,
        timeout: Quantity = ...,
    ) -> None: ...
    file: str
    sample_time: Quantity
    reads: Mapping[str, str]
    writes: Mapping[str, str]
    parameters: Mapping[str, Quantity | bool]
    coupling: Literal["sequential", "iterated"]
    timeout: Quantity

class DrivePositionInput(Component):
    """Angle or travel to which a drive of a hinge or a slider moves; begins with that at the start.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    joint : text
        A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts.
    smallest : quantity, optional
        Smallest value that it may be set to [rad] or [m].
    largest : quantity, optional
        Largest value that it may be set to [rad] or [m].

    Notes
    -----
    Channels: NAME.value [rad], NAME.value [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        joint: str,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    joint: str
    smallest: Quantity | None
    largest: Quantity | None

class DriveSpeedInput(Component):
    """Speed of the drive of a hinge or a slider, which stands without it.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    joint : text
        A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts.
    value : quantity, default 0.0
        At the start [rad/s] or [m/s]; held until it is set.
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.
    smallest : quantity, optional
        Smallest value that it may be set to.
    largest : quantity, optional
        Largest value that it may be set to.

    Notes
    -----
    Channels: NAME.value [rad/s], NAME.value [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        joint: str,
        value: Quantity = ...,
        interpolation: Literal["held", "linear"] = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    joint: str
    value: Quantity
    interpolation: Literal["held", "linear"]
    smallest: Quantity | None
    largest: Quantity | None

class FluidDirectionInput(Component):
    """Direction in which a wind or a current flows, from world x, anticlockwise; begins with theirs, no table.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    fluid : text, default "wind"
        Name of a wind or a current.
    smallest : angle [rad], optional
        Smallest value that it may be set to [rad].
    largest : angle [rad], optional
        Largest value that it may be set to [rad].

    Notes
    -----
    Channels: NAME.value [rad].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        fluid: str = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    fluid: str
    smallest: Quantity | None
    largest: Quantity | None

class FluidSpeedInput(Component):
    """Mean speed of a wind at 10 m, without fluctuation, or of a current with one at all depths; begins with theirs.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    fluid : text, default "wind"
        Name of a wind or a current.
    smallest : velocity [m/s] >= 0, optional
        Smallest value that it may be set to [m/s].
    largest : velocity [m/s] >= 0, optional
        Largest value that it may be set to [m/s].

    Notes
    -----
    Channels: NAME.value [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        fluid: str = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    fluid: str
    smallest: Quantity | None
    largest: Quantity | None

class ForceInput(Component):
    """A force on a point of a body, along a direction in the axes of the world or of the body.

    Parameters
    ----------
    name : text
        Its name; its channel is NAME.value.
    body : text
        Body that is loaded.
    point : 3 x length [m] or text
        Loaded point in the coordinates of the geometry [m]; of a flexible body, frame or shell any
        point of its mesh, or the name of an interface.
    value : force [N], default 0.0
        At the start [N]; held until it is set.
    smallest : force [N], optional
        Smallest value that it may be set to [N].
    largest : force [N], optional
        Largest value that it may be set to [N].
    direction : 3 x number, default [1.0, 0.0, 0.0]
        Along which it acts, of any length.
    frame : "world", "body", default "world"
        Axes of the direction: of the world, or of the body frame.
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.

    Notes
    -----
    Channels: NAME.value [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        point: Numbers | str,
        value: Quantity = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
        direction: Numbers = ...,
        frame: Literal["world", "body"] = ...,
        interpolation: Literal["held", "linear"] = ...,
    ) -> None: ...
    body: str
    point: Numbers | str
    value: Quantity
    smallest: Quantity | None
    largest: Quantity | None
    direction: Numbers
    frame: Literal["world", "body"]
    interpolation: Literal["held", "linear"]

class FrameAngleInput(Component):
    """Angle of a frame about the axis of its drive; begins with that at the start.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body whose frame is driven or fixed.
    smallest : angle [rad], optional
        Smallest value that it may be set to [rad].
    largest : angle [rad], optional
        Largest value that it may be set to [rad].

    Notes
    -----
    Channels: NAME.value [rad].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    body: str
    smallest: Quantity | None
    largest: Quantity | None

class FramePositionInput(Component):
    """Displacement of a frame along an axis of the world; begins with that at the start.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body whose frame is driven or fixed.
    axis : "x", "y", "z"
        Axis of the world along which it moves.
    smallest : length [m], optional
        Smallest value that it may be set to [m].
    largest : length [m], optional
        Largest value that it may be set to [m].

    Notes
    -----
    Channels: NAME.value [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        axis: Literal["x", "y", "z"],
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    body: str
    axis: Literal["x", "y", "z"]
    smallest: Quantity | None
    largest: Quantity | None

class FrameSpeedInput(Component):
    """Speed of a frame along an axis of the world, in which it stands without it.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body whose frame is driven or fixed.
    axis : "x", "y", "z"
        Axis of the world along which it moves.
    value : velocity [m/s], default 0.0
        At the start [m/s]; held until it is set.
    smallest : velocity [m/s], optional
        Smallest value that it may be set to [m/s].
    largest : velocity [m/s], optional
        Largest value that it may be set to [m/s].
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.

    Notes
    -----
    Channels: NAME.value [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        axis: Literal["x", "y", "z"],
        value: Quantity = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
        interpolation: Literal["held", "linear"] = ...,
    ) -> None: ...
    body: str
    axis: Literal["x", "y", "z"]
    value: Quantity
    smallest: Quantity | None
    largest: Quantity | None
    interpolation: Literal["held", "linear"]

class FrameTurnRateInput(Component):
    """Rate at which a frame turns about the axis of its drive.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    body : text
        Body whose frame is driven or fixed.
    value : angular velocity [rad/s], default 0.0
        At the start [rad/s]; held until it is set.
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.
    smallest : angular velocity [rad/s], optional
        Smallest value that it may be set to [rad/s].
    largest : angular velocity [rad/s], optional
        Largest value that it may be set to [rad/s].

    Notes
    -----
    Channels: NAME.value [rad/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        value: Quantity = ...,
        interpolation: Literal["held", "linear"] = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    body: str
    value: Quantity
    interpolation: Literal["held", "linear"]
    smallest: Quantity | None
    largest: Quantity | None

class HeightTargetInput(Component):
    """Draft, or height of a point, that a controller of ballast keeps; begins with that of the controller.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    controller : text
        Controller of ballast.
    keeps : "draft", "level_1", "level_2", "level_3"
        The draft, or the height of which of its levels.
    smallest : length [m], optional
        Smallest value that it may be set to [m].
    largest : length [m], optional
        Largest value that it may be set to [m].

    Notes
    -----
    Channels: NAME.value [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        controller: str,
        keeps: Literal["draft", "level_1", "level_2", "level_3"],
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    controller: str
    keeps: Literal["draft", "level_1", "level_2", "level_3"]
    smallest: Quantity | None
    largest: Quantity | None

class JointLoadInput(Component):
    """A torque or force of side a of a joint on its side b.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    joint : text
        A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts.
    coordinate : "angle", "travel", optional
        Of a joint that both turns and slides: what of it counts.
    value : quantity, default 0.0
        At the start [N m] or [N]; held until it is set.
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.
    smallest : quantity, optional
        Smallest value that it may be set to.
    largest : quantity, optional
        Largest value that it may be set to.

    Notes
    -----
    Channels: NAME.value [N m], NAME.value [N].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        joint: str,
        coordinate: Literal["angle", "travel"] | None = ...,
        value: Quantity = ...,
        interpolation: Literal["held", "linear"] = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    joint: str
    coordinate: Literal["angle", "travel"] | None
    value: Quantity
    interpolation: Literal["held", "linear"]
    smallest: Quantity | None
    largest: Quantity | None

class MomentInput(Component):
    """A moment on a body, about a direction in the axes of the world or of the body.

    Parameters
    ----------
    name : text
        Its name; its channel is NAME.value.
    body : text
        Body that is loaded.
    point : 3 x length [m] or text
        Where it acts, in the coordinates of the geometry [m]; of a rigid body any point.
    direction : 3 x number, default [0.0, 0.0, 1.0]
        About which it acts, of any length.
    frame : "world", "body", default "world"
        Axes of the direction: of the world, or of the body frame.
    value : moment or energy [N m], default 0.0
        At the start [N m]; held until it is set.
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.
    smallest : moment or energy [N m], optional
        Smallest value that it may be set to [N m].
    largest : moment or energy [N m], optional
        Largest value that it may be set to [N m].

    Notes
    -----
    Channels: NAME.value [N m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        point: Numbers | str,
        direction: Numbers = ...,
        frame: Literal["world", "body"] = ...,
        value: Quantity = ...,
        interpolation: Literal["held", "linear"] = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    body: str
    point: Numbers | str
    direction: Numbers
    frame: Literal["world", "body"]
    value: Quantity
    interpolation: Literal["held", "linear"]
    smallest: Quantity | None
    largest: Quantity | None

class TankRateInput(Component):
    """Water that is pumped into a tank, out of it if negative, until it is empty.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    tank : text
        Tank with a mass at the start, and without [[pumps]].
    value : mass flow [kg/s], default 0.0
        At the start [kg/s]; held until it is set.
    smallest : mass flow [kg/s], optional
        Smallest value that it may be set to [kg/s].
    largest : mass flow [kg/s], optional
        Largest value that it may be set to [kg/s].

    Notes
    -----
    Channels: NAME.value [kg/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        tank: str,
        value: Quantity = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    tank: str
    value: Quantity
    smallest: Quantity | None
    largest: Quantity | None

class TiltTargetInput(Component):
    """Heel or trim that a controller of ballast keeps; begins with that of the controller.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    controller : text
        Controller of ballast.
    keeps : "heel", "trim"
        Which of them.
    smallest : angle [rad], optional
        Smallest value that it may be set to [rad].
    largest : angle [rad], optional
        Largest value that it may be set to [rad].

    Notes
    -----
    Channels: NAME.value [rad].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        controller: str,
        keeps: Literal["heel", "trim"],
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    controller: str
    keeps: Literal["heel", "trim"]
    smallest: Quantity | None
    largest: Quantity | None

class WinchLengthInput(Component):
    """Unstretched length of a wire rope, which its winch changes; begins with that at the start.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    rope : text
        Name of a wire rope, whose winch has no plan of its own.
    smallest : length [m] > 0, optional
        Smallest value that it may be set to [m].
    largest : length [m] > 0, optional
        Largest value that it may be set to [m].

    Notes
    -----
    Channels: NAME.value [m].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        rope: str,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
    ) -> None: ...
    rope: str
    smallest: Quantity | None
    largest: Quantity | None

class WinchSpeedInput(Component):
    """Speed of the winch of a wire rope; hauls in if positive.

    Parameters
    ----------
    name : text
        Name; the first part of its channels.
    rope : text
        Name of a wire rope, whose winch has no plan of its own.
    value : velocity [m/s], default 0.0
        At the start [m/s]; held until it is set.
    smallest : velocity [m/s], optional
        Smallest value that it may be set to [m/s].
    largest : velocity [m/s], optional
        Largest value that it may be set to [m/s].
    interpolation : "held", "linear", default "held"
        Whether it jumps when it is set, or moves to what it is set to during the next exchange.

    Notes
    -----
    Channels: NAME.value [m/s].
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        rope: str,
        value: Quantity = ...,
        smallest: Quantity | None = ...,
        largest: Quantity | None = ...,
        interpolation: Literal["held", "linear"] = ...,
    ) -> None: ...
    rope: str
    value: Quantity
    smallest: Quantity | None
    largest: Quantity | None
    interpolation: Literal["held", "linear"]

class Scenario(Component):
    """Phases of an operation, one after the other.

    Parameters
    ----------
    phases : list of tables: Phase
        In order.
    tracks : list of tables: Track, optional
        Sequences of phases that run in parallel with these.
    prepared : list of text, optional
        Names of ropes that are not connected at the start.
    at_end : "go_on", "stop", default "go_on"
        Whether the run continues to its duration when the last phase is done, or stops there.
    """

    def __init__(
        self,
        *,
        phases: Sequence[PhaseTable | Mapping[str, Any]],
        tracks: Sequence[TrackTable | Mapping[str, Any]] = ...,
        prepared: Sequence[str] = ...,
        at_end: Literal["go_on", "stop"] = ...,
    ) -> None: ...
    phases: Sequence[PhaseTable | Mapping[str, Any]]
    tracks: Sequence[TrackTable | Mapping[str, Any]]
    prepared: Sequence[str]
    at_end: Literal["go_on", "stop"]

class Reference(Component):
    """A recorded history to compare a channel with: quantities deviation.NAME, deviation.NAME.rms.

    Parameters
    ----------
    name : text
        Its name.
    channel : text
        The channel it is of, e.g. "tip.position".
    file : text
        Its file in the case folder, SI: comma-separated with the header time and names of components,
        as in time,x,y,z; components that it does not have are not compared.
    scale : quantity > 0, optional
        Divides the distance, which then is a pure number; in the unit of the channel.
    until : time [s] > 0, optional
        Time [s] at which the history ends, if the simulation continues; both end together if absent.
    changes : true, false, default false
        Compare what has changed since the first time of the file, not the values themselves.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        channel: str,
        file: str,
        scale: Quantity | None = ...,
        until: Quantity | None = ...,
        changes: bool = ...,
    ) -> None: ...
    channel: str
    file: str
    scale: Quantity | None
    until: Quantity | None
    changes: bool

class Ballast(Component):
    """Stages for which heavylift ballast finds the fillings of tanks that pump least.

    Parameters
    ----------
    hull : text
        Hull that is kept.
    stages : list of tables: BallastStage
        In order; the fillings of the tanks at the start are those before the first.
    tanks : list of text, optional
        That may be filled and emptied; all of the hull if absent. Others keep what is in them.
    apart : list of text, optional
        Bodies that joints hold on the hull and that are not counted: what of their weight it bears is
        among the loads of the stages, as half of a link beam.
    draft : length [m] > 0, optional
        Of the middle of the keel [m]; if absent that of the filling with the least pumping.
    heel : angle [rad] > -0.5, < 0.5, default 0.0
        Positive lifts the side of positive y [rad].
    trim : angle [rad] > -0.5, < 0.5, default 0.0
        Positive lowers the end of positive x [rad].
    lightship : table: Lightship, optional
        Along the hull; if absent a trapezoid with the centre of mass of the hull.
    """

    def __init__(
        self,
        *,
        hull: str,
        stages: Sequence[BallastStageTable | Mapping[str, Any]],
        tanks: Sequence[str] = ...,
        apart: Sequence[str] = ...,
        draft: Quantity | None = ...,
        heel: Quantity = ...,
        trim: Quantity = ...,
        lightship: LightshipTable | Mapping[str, Any] | None = ...,
    ) -> None: ...
    hull: str
    stages: Sequence[BallastStageTable | Mapping[str, Any]]
    tanks: Sequence[str]
    apart: Sequence[str]
    draft: Quantity | None
    heel: Quantity
    trim: Quantity
    lightship: LightshipTable | Mapping[str, Any] | None

class Simulate(Component):
    """Time integration.

    Parameters
    ----------
    duration : time [s] >= 0
        Simulated time [s], a multiple of the output interval; with 0 only the start is computed and
        recorded.
    integrator : "dele2", "accurate", "thesis", "auto", default "dele2"
        dele2: second order, fixed step or by tolerance, the default; accurate: eighth order by
        tolerance; thesis: first order, as published; auto: the better one of the first two, by
        tolerance.
    step : time [s] > 0, optional
        Time step [s]: for thesis, and for dele2 and auto without a tolerance; if auto chooses accurate
        it is not used.
    tolerance : length [m] > 0, optional
        Error of the displacements in a step [m], by which the integrator chooses its steps: for dele2
        and auto without a step; 1e-7 m for accurate, 1e-5 m for auto if absent.
    output_interval : time [s] > 0, optional
        Time between recorded states [s], a multiple of a fixed step; needed with a duration.
    start : "check", "project", "equilibrium", "relax", default "check"
        check: a start that violates joints is refused; project: bodies are moved to close the joints
        first; equilibrium: and then to where they are in equilibrium, at rest; relax: the same by
        damped motion, for scenes whose equilibrium is hard to find. With contacts both are a damped
        motion, and what lies on something lies where its law carries it.
    """

    def __init__(
        self,
        *,
        duration: Quantity,
        integrator: Literal["dele2", "accurate", "thesis", "auto"] = ...,
        step: Quantity | None = ...,
        tolerance: Quantity | None = ...,
        output_interval: Quantity = ...,
        start: Literal["check", "project", "equilibrium", "relax"] = ...,
    ) -> None: ...
    duration: Quantity
    integrator: Literal["dele2", "accurate", "thesis", "auto"]
    step: Quantity | None
    tolerance: Quantity | None
    output_interval: Quantity
    start: Literal["check", "project", "equilibrium", "relax"]

class Report(Component):
    """Pictures and plots of the report.

    Parameters
    ----------
    modes : list of integer >= 1, default [1, 2, 3, 4, 5]
        Mode shapes that are pictured; those that the body does not have are left out.
    stress_modes : list of integer >= 1, default [1]
        Modes whose von Mises stress is pictured.
    stress_times : list of time [s] >= 0, optional
        Times [s] whose stress is pictured; if empty that of largest elastic energy, of frames and
        shells the end of the run and the time of largest recorded stress.
    shell_side : "largest", "top", "middle", "bottom", default "largest"
        Side of shells whose von Mises stress is pictured; the largest of the three by default.
    animation : table: Animation, optional
        Moving picture; none if absent.
    collision_times : list of time [s] >= 0, optional
        Times [s] at which colliding surfaces are pictured; if empty each collision at its largest force
        or impulse.
    deformation : number > 0, default 0.1
        Largest displacement drawn in pictures of mode shapes, relative to the size of the body.
    channels : list of text, optional
        Channels plotted over time, patterns as in "sling_*.tension" and combinations of channels; a
        choice is made if empty.
    spectra : list of text, optional
        Channels whose amplitude spectra are plotted, named likewise; the modal positions if empty.
    """

    def __init__(
        self,
        *,
        modes: Sequence[int] | NDArray[Any] = ...,
        stress_modes: Sequence[int] | NDArray[Any] = ...,
        stress_times: Numbers = ...,
        shell_side: Literal["largest", "top", "middle", "bottom"] = ...,
        animation: AnimationTable | Mapping[str, Any] | None = ...,
        collision_times: Numbers = ...,
        deformation: Quantity = ...,
        channels: Sequence[str] = ...,
        spectra: Sequence[str] = ...,
    ) -> None: ...
    modes: Sequence[int] | NDArray[Any]
    stress_modes: Sequence[int] | NDArray[Any]
    stress_times: Numbers
    shell_side: Literal["largest", "top", "middle", "bottom"]
    animation: AnimationTable | Mapping[str, Any] | None
    collision_times: Numbers
    deformation: Quantity
    channels: Sequence[str]
    spectra: Sequence[str]

class Converge(Component):
    """A convergence study: the case is run for several values of one parameter, or of one in each of several series.

    Parameters
    ----------
    quantity : text
        What is computed; of a channel without component, the whole vector; with a pattern, one
        component a name.
    reference : table: QuantityReference, RunReference
        Exact value, { quantity = ... } of the same run, or { run = VALUE }: the same quantity of a run
        with this (finer) value of the parameter.
    parameter : text, optional
        Dotted path of a key, e.g. "simulate.step".
    values : list of value, optional
        Values of the parameter, coarse to fine.
    relative : true, false, default true
        Whether the error is divided by the norm of the reference.
    runs : integer >= 1, <= 100, default 1
        How often each simulation is run; the median of the CPU times counts.
    series : list of tables: Series, optional
        In place of parameter and values: several series, compared by their errors and CPU times.
    """

    def __init__(
        self,
        *,
        quantity: str,
        reference: Quantity | QuantityReferenceTable | Mapping[str, Any] | RunReferenceTable,
        parameter: str | None = ...,
        values: Sequence[Any] | None = ...,
        relative: bool = ...,
        runs: int = ...,
        series: Sequence[SeriesTable | Mapping[str, Any]] = ...,
    ) -> None: ...
    quantity: str
    reference: Quantity | QuantityReferenceTable | Mapping[str, Any] | RunReferenceTable
    parameter: str | None
    values: Sequence[Any] | None
    relative: bool
    runs: int
    series: Sequence[SeriesTable | Mapping[str, Any]]

class Check(Component):
    """One number of the results against a reference, or within limits; of a group the worst one counts.

    Parameters
    ----------
    name : text
        Unique in the case.
    quantity : text
        What is computed; with a pattern in place of an owner, of all that fit:
        channel.sling_*.tension.max.
    reference : table: QuantityReference, optional
        Number in SI, string with a unit, or { quantity = ... }; of a group the member farthest from it
        counts.
    tolerance : table: Tolerance, optional
        Largest error that passes; needed with a reference.
    maximum : quantity, optional
        In place of a reference: largest value that passes, in the unit of the quantity.
    minimum : quantity, optional
        In place of a reference, or beside maximum: smallest value that passes.
    after : time [s] >= 0, optional
        Only records from this time of the run on [s] count for the statistic of a channel or a stress,
        and for that of a reference that is a quantity; from its start if absent.
    until : time [s] >= 0, optional
        Only records up to this time [s]; to the end if absent.
    source : text, optional
        Where the reference or limit comes from; needed with a reference.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        quantity: str,
        reference: Quantity | QuantityReferenceTable | Mapping[str, Any] | None = ...,
        tolerance: ToleranceTable | Mapping[str, Any] | None = ...,
        maximum: Quantity | None = ...,
        minimum: Quantity | None = ...,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        source: str | None = ...,
    ) -> None: ...
    quantity: str
    reference: Quantity | QuantityReferenceTable | Mapping[str, Any] | None
    tolerance: ToleranceTable | Mapping[str, Any] | None
    maximum: Quantity | None
    minimum: Quantity | None
    after: Quantity | None
    until: Quantity | None
    source: str | None

class CraneCriterion(Component):
    """Load of a crane over its capacity at the radius; off-lead and side-lead of its falls. The capacity of a crane may include dynamics of its own: see the document of the crane.

    Parameters
    ----------
    name : text
        Unique in the case.
    load : text
        Channel of the load: "fall.tension", "sum(fall_*.tension)".
    curve : table: Curve
        Capacity over radius.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    dynamic_factor : number >= 1, optional
        Dynamic amplification factor on the force at rest, at the time static_at; if absent the largest
        force of the run counts, in which the dynamics are, and no factor.
    static_at : number >= 0 or text, optional
        When the force is the one at rest: start, end, mean (over the time that counts), or a time [s].
    parts : number > 0, default 1.0
        Number of parts of a fall: what the channel is multiplied by.
    additional : quantity > 0, optional
        Rigging that hangs on the crane and is not in the run: force or mass.
    radius : length [m] > 0, optional
        Radius of a lift at one radius [m]; or radius_channel, or reach.
    radius_channel : text, optional
        Channel of the radius.
    reach : table: Reach, optional
        Points between which the radius is, horizontally; needed for off-lead and side-lead.
    hook : table: Place, optional
        Lower end of the falls, for off-lead and side-lead: angles of the line from the tip, in and
        across the plane of the boom, in the axes of the body of the centre.
    fall : text, optional
        Rope whose straight parts to the body of the hook are the falls, in place of the line from the
        tip: it leaves a sheave beside its centre, and that is no lead.
    off_lead : angle [rad] > 0, < 1.5708, optional
        Largest angle of the falls in the plane of the boom; 3 deg if absent.
    side_lead : angle [rad] > 0, < 1.5708, optional
        Largest angle of the falls across the plane of the boom; 3 deg if absent.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        load: str,
        curve: CurveTable | Mapping[str, Any],
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        dynamic_factor: Quantity | None = ...,
        static_at: Quantity | None = ...,
        parts: Quantity = ...,
        additional: Quantity | None = ...,
        radius: Quantity | None = ...,
        radius_channel: str | None = ...,
        reach: ReachTable | Mapping[str, Any] | None = ...,
        hook: PlaceTable | Mapping[str, Any] | None = ...,
        fall: str | None = ...,
        off_lead: Quantity | None = ...,
        side_lead: Quantity | None = ...,
    ) -> None: ...
    load: str
    curve: CurveTable | Mapping[str, Any]
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    dynamic_factor: Quantity | None
    static_at: Quantity | None
    parts: Quantity
    additional: Quantity | None
    radius: Quantity | None
    radius_channel: str | None
    reach: ReachTable | Mapping[str, Any] | None
    hook: PlaceTable | Mapping[str, Any] | None
    fall: str | None
    off_lead: Quantity | None
    side_lead: Quantity | None

class SlingCriterion(Component):
    """Force of slings and wire ropes times the safety factor over their breaking load; the worst one counts.

    Parameters
    ----------
    name : text
        Unique in the case.
    ropes : list of text
        Ropes, by names or patterns: ["sling_*"]. Of equalizers without masses of pulleys each line is
        judged.
    breaking_load : quantity > 0
        Minimum breaking load of one rope: force or mass.
    termination_factor : number >= 1
        Factor for the splice or socket at its ends: 1 of a socket, 1.25 where 80 % of the breaking load
        are left.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    dynamic_factor : number >= 1, optional
        Dynamic amplification factor on the force at rest, at the time static_at; if absent the largest
        force of the run counts, in which the dynamics are, and no factor.
    static_at : number >= 0 or text, optional
        When the force is the one at rest: start, end, mean (over the time that counts), or a time [s].
    skew_factor : number >= 1, default 1.0
        Skew load factor on the force; 1 where the run has the real lengths, or three points carry.
    yaw_factor : number >= 1, default 1.0
        Factor for yaw of lifts on two hooks, where the run does not have it.
    bending_ratio : number > 1, optional
        D/d of the smallest pin or sheave that it bends about; straight if absent.
    load_factor : number >= 1, default 1.3
        gamma_f.
    consequence_factor : number >= 1, default 1.3
        gamma_c.
    wear_factor : number >= 1, default 1.0
        gamma_w: 1.0, 1.1 or 1.2.
    material_factor : number >= 1, default 1.5
        gamma_m: 1.5, or 1.35 of a rope as new.
    twist_factor : number >= 1, default 1.0
        gamma_tw.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        ropes: Sequence[str],
        breaking_load: Quantity,
        termination_factor: Quantity,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        dynamic_factor: Quantity | None = ...,
        static_at: Quantity | None = ...,
        skew_factor: Quantity = ...,
        yaw_factor: Quantity = ...,
        bending_ratio: Quantity | None = ...,
        load_factor: Quantity = ...,
        consequence_factor: Quantity = ...,
        wear_factor: Quantity = ...,
        material_factor: Quantity = ...,
        twist_factor: Quantity = ...,
    ) -> None: ...
    ropes: Sequence[str]
    breaking_load: Quantity
    termination_factor: Quantity
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    dynamic_factor: Quantity | None
    static_at: Quantity | None
    skew_factor: Quantity
    yaw_factor: Quantity
    bending_ratio: Quantity | None
    load_factor: Quantity
    consequence_factor: Quantity
    wear_factor: Quantity
    material_factor: Quantity
    twist_factor: Quantity

class SlingAngleCriterion(Component):
    """Smallest angle of ropes to the horizontal while they carry.

    Parameters
    ----------
    name : text
        Unique in the case.
    ropes : list of text
        Ropes, by names or patterns.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    minimum : angle [rad] > 0, < 1.5708, default 0.5235987755982988
        Smallest angle that passes; 30 deg by default.
    warning : angle [rad] > 0, < 1.5708, default 0.7853981633974483
        Angle below which there is a warning; 45 deg by default.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        ropes: Sequence[str],
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        minimum: Quantity = ...,
        warning: Quantity = ...,
    ) -> None: ...
    ropes: Sequence[str]
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    minimum: Quantity
    warning: Quantity

class ShackleCriterion(Component):
    """Force of shackles over the least of what their three ratings allow. The working load limit is one for forces at rest: with static_at alone it is multiplied by the amplification of the run, without it the largest force counts against the limit as it is.

    Parameters
    ----------
    name : text
        Unique in the case.
    ropes : list of text
        Ropes at whose ends the shackles are, by names or patterns.
    working_load_limit : quantity > 0
        WLL of one shackle: force or mass.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    dynamic_factor : number >= 1, optional
        Dynamic amplification factor on the force at rest, at the time static_at; if absent the largest
        force of the run counts, in which the dynamics are, and no factor.
    static_at : number >= 0 or text, optional
        When the force is the one at rest: start, end, mean (over the time that counts), or a time [s].
    skew_factor : number >= 1, default 1.0
        Skew load factor on the force; 1 where the run has the real lengths, or three points carry.
    yaw_factor : number >= 1, default 1.0
        Factor for yaw of lifts on two hooks, where the run does not have it.
    breaking_load : quantity > 0, optional
        Minimum breaking load.
    proof_load : quantity > 0, optional
        Load of its proof test.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        ropes: Sequence[str],
        working_load_limit: Quantity,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        dynamic_factor: Quantity | None = ...,
        static_at: Quantity | None = ...,
        skew_factor: Quantity = ...,
        yaw_factor: Quantity = ...,
        breaking_load: Quantity | None = ...,
        proof_load: Quantity | None = ...,
    ) -> None: ...
    ropes: Sequence[str]
    working_load_limit: Quantity
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    dynamic_factor: Quantity | None
    static_at: Quantity | None
    skew_factor: Quantity
    yaw_factor: Quantity
    breaking_load: Quantity | None
    proof_load: Quantity | None

class LugCriterion(Component):
    """Forces of ropes on lugs, in the plane of the eye and across it, and their angle to that plane.

    Parameters
    ----------
    name : text
        Unique in the case.
    lugs : list of text
        Lugs of [[lugs]], by names or patterns: ["lug_*"].
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    dynamic_factor : number >= 1, optional
        Dynamic amplification factor on the force at rest, at the time static_at; if absent the largest
        force of the run counts, in which the dynamics are, and no factor.
    static_at : number >= 0 or text, optional
        When the force is the one at rest: start, end, mean (over the time that counts), or a time [s].
    skew_factor : number >= 1, default 1.0
        Skew load factor on the force; 1 where the run has the real lengths, or three points carry.
    yaw_factor : number >= 1, default 1.0
        Factor for yaw of lifts on two hooks, where the run does not have it.
    in_plane : quantity > 0, optional
        What a lug may carry in its plane; not judged if absent.
    out_of_plane : quantity > 0, optional
        What a lug may carry across its plane; not judged if absent.
    lateral_share : number >= 0, <= 1, default 0.03
        Least lateral force relative to the force of the rope, where that of the run is smaller; 0.05
        afloat.
    maximum_angle : angle [rad] > 0, < 1.5708, default 0.08726646259971647
        Largest angle to the plane of the eye while the rope carries; 5 deg by default.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        lugs: Sequence[str],
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        dynamic_factor: Quantity | None = ...,
        static_at: Quantity | None = ...,
        skew_factor: Quantity = ...,
        yaw_factor: Quantity = ...,
        in_plane: Quantity | None = ...,
        out_of_plane: Quantity | None = ...,
        lateral_share: Quantity = ...,
        maximum_angle: Quantity = ...,
    ) -> None: ...
    lugs: Sequence[str]
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    dynamic_factor: Quantity | None
    static_at: Quantity | None
    skew_factor: Quantity
    yaw_factor: Quantity
    in_plane: Quantity | None
    out_of_plane: Quantity | None
    lateral_share: Quantity
    maximum_angle: Quantity

class DynamicsCriterion(Component):
    """Largest load of a hook relative to that at rest, beside the factor of the table for lifts in air.

    Parameters
    ----------
    name : text
        Unique in the case.
    load : text
        Channel of the load, as for crane.
    operation : "onshore", "inshore", "offshore"
        Column of the table.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    parts : number > 0, default 1.0
        Number of parts of a fall.
    static_load : quantity > 0, optional
        Load at rest: force or mass; or static_at.
    static_at : number >= 0 or text, optional
        When the load is the one at rest: start, end, mean or a time [s].
    maximum : number >= 1, optional
        Limit in place of that of the table.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        load: str,
        operation: Literal["onshore", "inshore", "offshore"],
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        parts: Quantity = ...,
        static_load: Quantity | None = ...,
        static_at: Quantity | None = ...,
        maximum: Quantity | None = ...,
    ) -> None: ...
    load: str
    operation: Literal["onshore", "inshore", "offshore"]
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    parts: Quantity
    static_load: Quantity | None
    static_at: Quantity | None
    maximum: Quantity | None

class ClearanceCriterion(Component):
    """Smallest distance: a gap of surfaces, a relative motion, a difference of heights.

    Parameters
    ----------
    name : text
        Unique in the case.
    distance : text
        Channel, or pattern of channels: "landing.gap", "swing.distance", "hook.position.z".
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    place : "to_boom", "under_load", "near_final_place", "on_barge", "sideways", optional
        What the distance is, by which the limit is chosen: 3, 3, 1.5, 5 and 3 m.
    minimum : length [m], optional
        Smallest distance that passes [m], in place of that of place.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        distance: str,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        place: Literal["to_boom", "under_load", "near_final_place", "on_barge", "sideways"] | None = ...,
        minimum: Quantity | None = ...,
    ) -> None: ...
    distance: str
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    place: Literal["to_boom", "under_load", "near_final_place", "on_barge", "sideways"] | None
    minimum: Quantity | None

class TiltCriterion(Component):
    """Angle of an axis of a body to the vertical.

    Parameters
    ----------
    name : text
        Unique in the case.
    body : text
        Rigid or flexible body.
    maximum : angle [rad] > 0, < 3.14159
        Largest angle.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    axis : 3 x number, default [0.0, 0.0, 1.0]
        Axis that is upright when the body is level, in the coordinates of its geometry.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        maximum: Quantity,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        axis: Numbers = ...,
    ) -> None: ...
    body: str
    maximum: Quantity
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    axis: Numbers

class SlackCriterion(Component):
    """Smallest tension of ropes; with static_at also how much of the tension at rest the dynamics take away.

    Parameters
    ----------
    name : text
        Unique in the case.
    ropes : list of text
        Ropes, by names or patterns.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    minimum : force [N] >= 0, default 0.0
        Tension that all must exceed [N].
    static_at : number >= 0 or text, optional
        When the tension is the one at rest.
    dynamic_share : number > 0, < 1, default 0.9
        Largest part of the tension at rest that the dynamics may take away.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        ropes: Sequence[str],
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        minimum: Quantity = ...,
        static_at: Quantity | None = ...,
        dynamic_share: Quantity = ...,
    ) -> None: ...
    ropes: Sequence[str]
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    minimum: Quantity
    static_at: Quantity | None
    dynamic_share: Quantity

class TransportCriterion(Component):
    """A transporter: how far it is from tipping over, and what its bogies, drives and brakes have left.

    Parameters
    ----------
    name : text
        Unique in the case.
    transporter : text
        Transporter that is judged.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    static_tipping : angle [rad] >= 0, <= 1.5, default 0.12217304763960307
        Least tilt of the road at which it tips over on rigid groups.
    tipping : angle [rad] >= 0, <= 1.5, default 0.03490658503988659
        Least tilt of the road at which it tips over on compliant groups.
    group_share : number > 0, < 0.5, default 0.0
        Share of the weight that every group must exceed in the run.
    stroke_reserve : length [m] >= 0, default 0.0
        That strokes must keep from stroke_limits [m], if the transporter has them.
    drive_share : number > 0, < 1, default 0.8
        Largest part of what drives can give, if the transporter has a drive with a table.
    traction_share : number > 0, < 1, default 1.0
        Largest part of what friction of driven bogies allows, if it has a drive.
    brake_share : number > 0, < 1, default 1.0
        Largest part of what brakes hold at rest, if it has a drive with a brake_force.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        transporter: str,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        static_tipping: Quantity = ...,
        tipping: Quantity = ...,
        group_share: Quantity = ...,
        stroke_reserve: Quantity = ...,
        drive_share: Quantity = ...,
        traction_share: Quantity = ...,
        brake_share: Quantity = ...,
    ) -> None: ...
    transporter: str
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    static_tipping: Quantity
    tipping: Quantity
    group_share: Quantity
    stroke_reserve: Quantity
    drive_share: Quantity
    traction_share: Quantity
    brake_share: Quantity

class YieldCriterion(Component):
    """Von Mises stress over the yield strength, of groups of a flexible body with a table stress.

    Parameters
    ----------
    name : text
        Unique in the case.
    body : text
        Flexible body with a table stress.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    groups : list of text, optional
        Groups of that table, or properties of a structure; all that have a yield strength if empty.
    stress : "whole", "centre", default "whole"
        whole: both sides of plates, solids and corners of beams; centre: the membrane of plates at the
        centres of their elements, as for the strength of the whole block.
    maximum : number > 0, default 1.0
        Largest utilisation, the partial factor of the table included.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        body: str,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        groups: Sequence[str] = ...,
        stress: Literal["whole", "centre"] = ...,
        maximum: Quantity = ...,
    ) -> None: ...
    body: str
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    groups: Sequence[str]
    stress: Literal["whole", "centre"]
    maximum: Quantity

class LimitCriterion(Component):
    """Any quantity of checks within limits.

    Parameters
    ----------
    name : text
        Unique in the case.
    quantity : text
        As in checks, patterns included: "channel.barge.angular_velocity.x.rms"; the worst of a group
        counts.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    maximum : quantity, optional
        Largest value that passes, in the unit of the quantity.
    minimum : quantity, optional
        Smallest value that passes, in place of maximum.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        quantity: str,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
        maximum: Quantity | None = ...,
        minimum: Quantity | None = ...,
    ) -> None: ...
    quantity: str
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
    maximum: Quantity | None
    minimum: Quantity | None

class SpreadCriterion(Component):
    """Largest difference between the tensions of ropes relative to their mean, while they carry.

    Parameters
    ----------
    name : text
        Unique in the case.
    ropes : list of text
        Two ropes or more, by names or patterns. Of equalizers without masses of pulleys each line is
        judged.
    maximum : number > 0
        Largest difference that passes, in parts of the mean.
    after : time [s] >= 0, optional
        Only from this time of the run on [s]; from its start if absent.
    until : time [s] >= 0, optional
        Only up to this time [s]; to the end if absent.
    phases : list of text, optional
        Only in these phases of the operation, by name; in all if absent.
    source : text, optional
        Where the limit comes from; if absent the clause that the kind of criterion has, with its
        status.
    """

    def __init__(
        self,
        name: str,
        /,
        *,
        ropes: Sequence[str],
        maximum: Quantity,
        after: Quantity | None = ...,
        until: Quantity | None = ...,
        phases: Sequence[str] = ...,
        source: str | None = ...,
    ) -> None: ...
    ropes: Sequence[str]
    maximum: Quantity
    after: Quantity | None
    until: Quantity | None
    phases: Sequence[str]
    source: str | None
