"""Each sort of thing that stands in a scene is drawn by every painter: pictures, page, exported files."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
import pytest

from heavylift.pipeline.drawn.build import EXACT, PAGE, Sources, draw_scene, elements
from heavylift.pipeline.drawn.moments import Moment
from heavylift.pipeline.page.exchange import write_glb, write_vtkhdf
from heavylift.pipeline.page.packing import Block
from heavylift.pipeline.page.page import drawn_header
from heavylift.pipeline.pictures.scene_view import SceneView
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.force_elements.equalized import SharedLines
from heavylift.solver.force_elements.wire_rope import Rope, SpringRope
from heavylift.solver.forces.spring import Spring
from heavylift.solver.forces.tugger import Tugger
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.bodies import Placed
from heavylift.solver.scene.collisions import CollisionSurface
from heavylift.solver.scene.connections import FORCES, GROUND, JOINTS, ROPES, JointFrame, RopePoint
from heavylift.solver.scene.contacts import BoxShape, CircleShape, Contact, PointShape
from heavylift.solver.scene.drawn import At, Mark, NodalShape, Strut
from heavylift.solver.scene.moorings import MOORINGS, LineSection
from heavylift.solver.scene.outlines import box
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Sea, Tank, Water
from heavylift.solver.scene.transport import TRANSPORT, BogieGroup
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.transporters import Transporter
from heavylift.solver.water.lines.fenders import Fender
from heavylift.solver.water.lines.mooring_lines import MooringLine

O = np.zeros(3)


def at(x, y=0.0, z=0.0):
    return np.array([x, y, z], dtype=float)


def cube(side):
    outline = box(3 * [side], np.eye(3))
    return TriangleSurface(outline.points, outline.triangles)


@dataclass(frozen=True, eq=False)
class Cable(Placed):
    """A sort of body that no painter has heard of."""

    name: str

    def drawn(self):
        points = np.array([at(k, 30.0) for k in range(4)])
        yield NodalShape(
            name=self.name,
            role="rope",
            points=points,
            positions="cable.node_position",
            tension="cable.tension",
        )


@dataclass(frozen=True, eq=False)
class Clutch:
    """A sort of force that no painter has heard of."""

    name: str

    def drawn(self):
        yield Strut(name=self.name, role="spring", ends=(At("block", at(0.5)), At("cable", at(3.0, 30.0))))


BODIES = (RigidBody("block", 1.0, np.eye(3)), RigidBody("hull", 9.0, np.eye(3)), Cable("cable"))
THINGS = {
    "wall": ("surfaces", CollisionSurface(name="wall", body=GROUND, surface=cube(2.0))),
    "road": (
        "decks",
        Deck(name="road", sides=np.array([-1.0, 1.0]), stations=np.array([0.0, 5.0]), heights=np.zeros(2)),
    ),
    "sling": (
        "ropes",
        SpringRope(
            name="sling",
            path=(RopePoint("block", O), RopePoint(GROUND, at(0, 0, 9))),
            stiffness=1.0,
            length=1.0,
        ),
    ),
    "reeved": (
        "ropes",
        Rope(
            name="reeved",
            path=(
                RopePoint(GROUND, at(0, 0, 9)),
                RopePoint("block", O, 0.3, at(0, 1)),
                RopePoint(GROUND, at(2, 0, 9)),
            ),
            axial_stiffness=1.0,
        ),
    ),
    "shared": (
        "ropes",
        SharedLines(
            name="shared",
            path=tuple(RopePoint(*end) for k in (1, 2) for end in ((GROUND, at(k, 1, 9)), ("block", at(k)))),
            lengths=np.ones(2),
            depth=2.0,
            up=1.0,
            down=1.0,
            axial_stiffness=1.0,
            rope_length=9.0,
            line_stiffness=1.0,
        ),
    ),
    "coil": (
        "forces",
        Spring(name="coil", body_a="block", point_a=O, body_b=GROUND, point_b=at(3), length=1.0),
    ),
    "hawser": (
        "forces",
        Tugger(name="hawser", body_a="block", point_a=O, body_b=GROUND, point_b=at(0, 3), tension=1.0),
    ),
    "clutch": ("forces", Clutch("clutch")),
    "pin": ("joints", Ball(name="pin", body_a="block", body_b="hull", frame_b=JointFrame(at(4)))),
    "foot": ("contacts", Contact(name="foot", contour="c", body="block", shape=BoxShape(np.ones(3), 0.1))),
    "rim": ("contacts", Contact(name="rim", contour="c", body="block", shape=CircleShape(0.5, at(0, 0, 1)))),
    "tip": ("contacts", Contact(name="tip", contour="c", body="block", shape=PointShape())),
    "spmt": (
        "transporters",
        Transporter(
            name="spmt",
            body="block",
            groups=(BogieGroup("g", np.array([at(1), at(-1)]), oil_stiffness=1.0),),
            wheel_radius=0.4,
            tyre_stiffness=1.0,
        ),
    ),
    "bow": (
        "lines",
        MooringLine(
            name="bow",
            body_a=GROUND,
            point_a=at(-70, 0, -10),
            body_b="hull",
            point_b=O,
            seabed=-10.0,
            sections=(LineSection(length=75.0, weight=100.0, axial_stiffness=1e8),),
        ),
    ),
    "quay": (
        "fenders",
        Fender(
            name="quay",
            body_a=GROUND,
            point_a=at(0, 9),
            body_b="hull",
            point_b=O,
            direction=at(0, -1),
            stiffness=1.0,
        ),
    ),
    "ballast": ("tanks", Tank(name="ballast", hull="hull", point=at(0, 0, 1), mass=1000.0)),
}
"""One of each sort, by its name: where it stands in a scene or its sea."""
OF_BODIES = {"block", "hull", "cable"}


class Recorded(dict):
    """Two records in which the middle of the cable sags by a metre."""

    time = np.array([0.0, 1.0])
    meshes: ClassVar = {}


def records():
    straight = np.array([at(k, 30.0) for k in range(4)])
    sagging = straight - np.array([O, at(0, 0, 1), at(0, 0, 1), O])
    return Recorded(
        {
            "cable.node_position": np.array([straight.ravel(), sagging.ravel()]),
            "cable.tension": np.array([[1.0, 2.0], [3.0, 5.0]]),
            "foot.force": np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 4.0]]),
            "foot.point": np.zeros((2, 3)),
        }
    )


@pytest.fixture(scope="module")
def zoo():
    of = {}
    for where, thing in THINGS.values():
        of.setdefault(where, []).append(thing)
    sea = Sea(
        water=Water(), hulls=(Hull(body="hull", restoring=cube(3.0)),),
        **{where: tuple(of.pop(where)) for where in ("lines", "fenders", "tanks")},
    )  # fmt: skip
    return Scene(BODIES, sea=sea, **{where: tuple(things) for where, things in of.items()})


def drawn(zoo, detail, **more):
    return draw_scene(zoo, records(), up=at(0, 0, 1), sources=Sources(water=True), detail=detail, **more)


def named(scene):
    """Names of what is in a scene to draw."""
    return {one.name for part in (scene.surfaces, scene.lines, scene.discs, scene.dots) for one in part}


def test_all_things_of_the_zoo_are_in_the_scene_to_draw(zoo):
    assert named(drawn(zoo, EXACT)) >= set(THINGS) | OF_BODIES


def test_every_list_of_things_is_asked():
    """A thing that stands in any list of a scene or its sea, but for laws, controls, fields and databases."""

    class Probe:
        def __init__(self, name):
            self.name = name

        def drawn(self):
            yield Mark(name=self.name, role="joint", at=At(GROUND, O))

    def probed(owner):
        return {one.name: (Probe(one.name),) for one in fields(owner) if one.default == ()}

    asked = {one.name for one in elements(Scene(BODIES, sea=Sea(**probed(Sea)), **probed(Scene)))}
    assert (set(probed(Scene)) | set(probed(Sea))) - asked == {
        "collisions", "radiation", "pumps", "controllers", "fields", "loads",
    }  # fmt: skip


@pytest.mark.parametrize(
    "family", [JOINTS, FORCES, ROPES, MOORINGS, TRANSPORT], ids=lambda family: family.package
)
def test_every_description_answers(family):
    """No sort of thing is invisible because nobody asked what it looks like."""
    assert [word for word in family.words if not hasattr(family.get(word), "drawn")] == []


@pytest.mark.parametrize("name", sorted({*THINGS, *OF_BODIES}))
def test_each_thing_is_drawn_by_every_painter(zoo, name, tmp_path):
    """Without it, fewer of its pixels, less of the page, fewer names in a file."""
    page, few = drawn(zoo, PAGE), drawn(zoo, EXACT)
    header = drawn_header(page, Block())
    assert name in {one["name"] for part in ("surfaces", "lines") for one in header[part]}
    write_vtkhdf(tmp_path / "zoo.vtkhdf", page)
    write_glb(tmp_path / "zoo.glb", page, title="zoo", generator="test")
    in_lines = {line.name for line in page.lines if line.radius}
    if name in in_lines | {one.name for one in page.solids}:
        import h5py

        with h5py.File(tmp_path / "zoo.vtkhdf") as file:
            assert name in json.loads(file["VTKHDF"].attrs["object_names"])
        assert f'"{name}"'.encode() in (tmp_path / "zoo.glb").read_bytes()
    assert amount(SceneView(few)) > amount(SceneView(without(few, name)))


@pytest.mark.parametrize("detail", [EXACT, PAGE])
def test_what_is_attached_to_nodes_moves_with_the_nearest_one(detail):
    """A strut from the world to 0.3 m beside the second node of the cable, which sags by a metre."""
    ends = (At(GROUND, at(0, 0, 5)), At("cable", at(1.2, 30.2)))

    class Hanger:
        def drawn(self):
            yield Strut(name="hanger", role="spring", ends=ends)

    scene = draw_scene(Scene(BODIES[2:], forces=(Hanger(),)), records(), detail=detail)
    cable, hanger = (next(line for line in scene.lines if line.name == name) for name in ("cable", "hanger"))
    for record, sag in ((0, 0.0), (1, 1.0)):
        for now in (Moment(scene, pose=record), Moment(scene, time=float(record))):
            np.testing.assert_allclose(
                now.line(cable).ravel(), records()["cable.node_position"][record], atol=1e-12
            )
            np.testing.assert_allclose(now.line(hanger), [at(0, 0, 5), at(1.2, 30.2, -sag)], atol=1e-12)
    np.testing.assert_array_equal(cable.tension, [2.0, 5.0])
    np.testing.assert_allclose(Moment(scene, time=0.5).line(hanger)[1], at(1.2, 30.2, -0.5), atol=1e-12)


def amount(view):
    """Points of all that a renderer is handed."""
    seen = view.seen(1)
    groups = (seen.lines, seen.patches, seen.marks, seen.around)
    return sum(len(part.points) for group in groups for part in group)


def without(scene, name):
    """The same scene to draw without what has a name; surfaces keep their numbers."""
    kept = {
        part: [one for one in getattr(scene, part) if one.name != name] for part in ("lines", "discs", "dots")
    }
    surfaces = [
        one if one.name != name else type(one)(**{**vars(one), "triangles": one.triangles[:0]})
        for one in scene.surfaces
    ]
    return type(scene)(**{**vars(scene), **kept, "surfaces": surfaces})
