"""Every sort of body with everything that can act on it: balances of momentum and energy, or a refusal that says why.

Each body hangs, lies, floats or is driven for a hundred steps under its weight and one thing more. The impulse of the
recorded force and of the weight must be the change of the recorded momentum; of hulls, with the buoyancy of a box whose
sides are upright and the momentum of the water by the added mass of its database. The table of `docs/combinations.md`
is written from `CASES` by ``python tests/verification/test_combinations.py``.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "solver"))
sys.path.append(str(Path(__file__).resolve().parents[1] / "solver" / "contact"))
sys.path.append(str(Path(__file__).resolve().parents[1] / "solver" / "water"))
import flexible_scenes
import flexible_surfaces
import test_contacts_of_hulls as barges

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.bodies.lumped_cable.lumped_cable import LumpedCable
from heavylift.solver.contact.triangles.kind import GoneContacts
from heavylift.solver.force_elements.maxwell_rope import MaxwellRope
from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.forces.spring import Spring
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.bodies import Harmonic
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint, axes_about
from heavylift.solver.scene.contacts import Contact, Contour, LinearLaw, PointShape
from heavylift.solver.scene.mesh_shapes import line, rectangle
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.scene.scene import Driven, FlexibleBody, Gravity, Profile, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Sea, Water
from heavylift.solver.scene.wind_loads import WindField
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.mooring_lines import MooringLine
from heavylift.solver.water.wind.drag import Drag, DragPiece

ROOT = Path(__file__).resolve().parents[2]
G, STEPS = 9.81, 100
BODIES = (
    "rigid body",
    "flexible body",
    "frame mesh",
    "shell mesh",
    "hull",
    "hull with shared database",
    "lumped cable",
)
THINGS = (
    "joint",
    "hinge",
    "rope",
    "rope that creeps",
    "spring",
    "contour contact",
    "triangle contact",
    "mooring line",
    "fluid load",
    "drive",
)
HULLS = BODIES[4:6]
LIFT, HIGH = 0.2, 5.0
"""Heights [m] at which hulls are let go, above their floating position, and all else, above the water: in the wind."""

REFUSED = {
    ("frame mesh", "drive"): "its supports hold nodes in the world; drive what a joint ties it to",
    ("shell mesh", "drive"): "its supports hold nodes in the world; drive what a joint ties it to",
    ("hull", "drive"): "the motion of 'a' is prescribed",
    ("hull with shared database", "drive"): "the motion of 'a' is prescribed",
    ("lumped cable", "hinge"): "a direction on 'body', a cable of lumped masses, which has none",
    ("lumped cable", "triangle contact"): "no triangles on 'body'",
    ("lumped cable", "drive"): "it has no frame; drive what a joint ties it to",
}
"""What is refused, and words of the reason. Meshes and cables have no motion to prescribe: the class takes none."""

CASES = [(body, thing) for body in BODIES for thing in THINGS]


@dataclass(frozen=True, eq=False)
class Subject:
    """A body alone: keys of its scene, name, points that are held and that touch, skin, mass [kg], step [s]."""

    keys: dict[str, Any]
    name: str
    point: Any
    lowest: Any
    skin: Any
    mass: float
    step: float = 1e-3


def subject(body: str, thing: str = "") -> Subject:
    if body == "rigid body":
        one: Any = RigidBody("body", 100.0, 16.0 * np.eye(3), position=np.array([0.0, 0.0, HIGH]))
        point, low = np.array([0.3, 0.0, 0.5]), np.array([0.3, 0.0, -0.5])
        return Subject({"bodies": (one,)}, "body", point, low, box_surface(1.0), 100.0)
    if (body, thing) == ("flexible body", "triangle contact"):  # a solid, which has a surface
        reduced = flexible_surfaces.bar(modes=3)
        one = flexible_surfaces.flexible("body", reduced, [0.0, 0.0, HIGH])
        low = np.array([0.0, 0.0, reduced.nodes[:, 2].min()])
        skin = flexible_surfaces.skin("body", reduced)
        return Subject({"bodies": (one,)}, "body", low, low, skin, reduced.integrals.mass, 2e-4)
    if body == "flexible body":
        plate = flexible_scenes.plate(free=True)
        place = {"position": np.array([0.0, 0.0, HIGH])}
        one = FlexibleBody("body", plate.cloud.reduced(), damping_ratio=np.zeros(3), **place)
        point = plate.cloud.nodes[flexible_scenes.CENTRE]
        return Subject({"bodies": (one,)}, "body", point, point, None, flexible_scenes.PLATE_MASS)
    if body == "frame mesh":
        bar, area = line([-1.0, 0.0, HIGH], [1.0, 0.0, HIGH], 6), np.pi * 0.03**2
        section = FrameSection(10.0 / area, 2e9, area, area * 0.03**2 / 4.0)
        one = FrameBody(
            name="body", nodes=bar.nodes, tangents=bar.tangents, elements=bar.elements, sections=(section,)
        )
        point = np.array([1.0 / 3.0, 0.0, HIGH])
        return Subject({"bodies": (one,)}, "body", point, point - [0.0, 0.0, 0.03], None, 20.0)
    if body == "shell mesh":
        flat = rectangle(1.0, 1.0, 2, 2)
        one = ShellBody(
            name="body",
            nodes=flat.nodes + np.array([0.0, 0.0, HIGH]),
            slopes=flat.slopes,
            elements=flat.elements,
            lengths=flat.lengths,
            sections=(ShellSection(0.02, 1000.0, 1e9, 0.3),),
        )
        point = np.array([0.5, 0.5, HIGH])
        return Subject({"bodies": (one,)}, "body", point, point - [0.0, 0.0, 0.01], None, 20.0)
    if body == "lumped cable":
        ends = np.array([[-1.0, 0.0, HIGH], [1.0, 0.0, HIGH]])
        one = LumpedCable(name="body", points=ends, segments=6, mass=20.0, axial_stiffness=1e5)
        point = np.array([1.0 / 3.0, 0.0, HIGH])
        return Subject({"bodies": (one,)}, "body", point, point, None, 20.0)
    up = np.array([0.0, 0.0, LIFT])
    point, low = np.array([10.0, 5.0, 2.0]), np.array([10.0, 5.0, -barges.DRAFT])
    one = barges.floating("a", up)
    if body == "hull":
        hull = Hull(body="a", restoring=barges.skin(), reference=barges.REFERENCE)
        keys = {
            "bodies": (one,),
            "sea": Sea(water=Water(density=barges.RHO, gravity=G), hulls=(hull,)),
        }
    else:
        both = barges.afloat(barges.added_mass(1.0), one, barges.floating("b", barges.AWAY))
        keys = {"bodies": both.bodies, "sea": both.sea}
    return Subject(keys, "a", point, low, barges.skin(), barges.MASS, 1e-2)


def combined(of: Subject, thing: str) -> Scene:
    """The body under its weight with one thing more, called "link", to the ground."""
    stiffness, keys = 400.0 * of.mass, dict(of.keys)
    damping = 0.02 * stiffness
    first = keys["bodies"][0]
    if thing == "hinge" and isinstance(first, FlexibleBody):  # at a place that modes turn
        keys["bodies"] = (replace(first, reduced=replace(first.reduced, continuum=True)),)
        of = replace(of, point=first.reduced.nodes[0])
    lift = getattr(keys["bodies"][0], "position", np.zeros(3))  # coordinates of meshes are those of the world
    place, hook = of.point + lift, of.point + lift + [0.0, 0.0, 2.0]
    forces: list[Any] = [Gravity(np.array([0.0, 0.0, -G]))]
    sea = keys.get("sea") or Sea()
    floor = float((of.lowest + lift)[2]) - 1e-3
    if thing == "joint":
        ends = {"frame_a": JointFrame(place), "frame_b": JointFrame(of.point)}
        keys["joints"] = (Ball(name="link", body_a=GROUND, body_b=of.name, **ends),)
    elif thing == "hinge":
        axes = axes_about(np.array([0.0, 1.0, 0.0]))
        ends = {"frame_a": JointFrame(place, axes), "frame_b": JointFrame(of.point, axes)}
        keys["joints"] = (Hinge(name="link", body_a=GROUND, body_b=of.name, **ends),)
    elif thing == "rope":
        path = (RopePoint(GROUND, hook), RopePoint(of.name, of.point))
        keys["ropes"] = (
            SpringRope(name="link", path=path, length=1.99, stiffness=stiffness, damping=damping),
        )
    elif thing == "rope that creeps":
        path = (RopePoint(GROUND, hook), RopePoint(of.name, of.point))
        rope = MaxwellRope(name="link", path=path, length=1.99, stiffness=stiffness, viscosity=2.0 * damping)
        keys["ropes"] = (rope,)
    elif thing == "spring":
        ends = {"body_a": GROUND, "point_a": hook, "body_b": of.name, "point_b": of.point}
        forces.append(Spring(name="link", length=1.99, stiffness=stiffness, damping=damping, **ends))
    elif thing == "contour contact":
        x, y = np.meshgrid(np.linspace(-20.0, 20.0, 6), np.linspace(-20.0, 20.0, 6), indexing="ij")
        flat = neutral_surface(np.stack([x, y, np.full_like(x, floor)], -1))
        keys["contours"] = (Contour(name="floor", body=GROUND, neutral=flat),)
        point = of.point if of.skin is None else of.lowest  # nodes of meshes are on their middle surface
        if of.skin is None:
            flat = neutral_surface(np.stack([x, y, np.full_like(x, float(place[2]) - 1e-3)], -1))
            keys["contours"] = (Contour(name="floor", body=GROUND, neutral=flat),)
        law = LinearLaw(stiffness, damping)
        keys["contacts"] = (
            Contact(name="link", contour="floor", body=of.name, point=point, shape=PointShape(), law=law),
        )
    elif thing == "triangle contact":
        flat = plane_surface(60.0)
        flat = replace(flat, points=flat.points + np.array([0.0, 0.0, floor]))
        keys["surfaces"] = (
            CollisionSurface(name="floor", body=GROUND, surface=flat),
            of.skin
            if isinstance(of.skin, CollisionSurface)
            else CollisionSurface(name="skin", body=of.name, surface=of.skin),
        )
        law = LinearLaw(stiffness, damping)
        keys["collisions"] = (Collision(name="link", surfaces=("floor", keys["surfaces"][1].name), law=law),)
    elif thing == "mooring line":
        section = LineSection(length=33.0, weight=0.05 * of.mass, axial_stiffness=1e4 * of.mass)
        ends = {"point_a": place + np.array([30.0, 0.0, 10.0]), "body_b": of.name, "point_b": of.point}
        keys["sea"] = replace(
            sea, lines=(MooringLine(name="link", body_a=GROUND, sections=(section,), **ends),)
        )
    elif thing == "fluid load":
        pieces = (DragPiece(point=of.point, area=0.01 * of.mass, coefficient=1.0, vertical=True),)
        load = Drag(name="link", body=of.name, elements=pieces)
        keys["sea"] = replace(sea, fields=(WindField(speed=20.0),), loads=load.pieces())
    else:
        motion = Driven(z=Profile(harmonics=(Harmonic(0.01, 1.0, 0.0),)))
        keys["bodies"] = (replace(keys["bodies"][0], motion=motion), *keys["bodies"][1:])
    return Scene(forces=tuple(forces), **keys)


class Found:
    """Records of every step, the start included."""

    def __init__(self, scene: Scene, step: float, *, driven: bool, gains: bool = False) -> None:
        simulation = Simulation(scene, step, start="project" if driven else "check")
        first = simulation.record()
        _, records = simulation.advance(STEPS)
        assert simulation.outcome is Outcome.COMPLETED, simulation.message
        assert gains or not re.search("energy (grew|.*were lost)", simulation.warning)
        self.records = np.vstack([first, records])
        self.channels = {channel.name: channel for channel in simulation.channels}
        self.simulation = simulation

    @property
    def jumps(self) -> float:
        """What the contacts of triangles have stored less by jumps [J]."""
        (pair,) = self.simulation._layout.systems[1].placed[-2:-1].view(GoneContacts.layout)[:, 0]
        return float(pair["jumps"])

    def __getitem__(self, name: str) -> Any:
        channel = self.channels[name]
        return self.records[:, channel.column : channel.column + len(channel.components)]


def link_forces(found: Found, of: Subject, thing: str) -> list[Any]:
    """What "link" does to the body upwards [N]; of a line, whose vertical part is of either sign, both."""
    if thing == "mooring line":
        upward = np.sqrt(found["link.tension"][:, 0] ** 2 - found["link.horizontal_tension"][:, 0] ** 2)
        return [upward, -upward]
    names = {
        "joint": "link.reaction_force",
        "hinge": "link.reaction_force",
        "rope": "link.tension",
        "rope that creeps": "link.tension",
        "spring": "link.force",
        "contour contact": "link.force",
        "triangle contact": "link.force",
        "fluid load": "link.force",
        "drive": f"{of.name}.reaction_force",
    }
    return [found[names[thing]][:, -1]]


def moving_with_water(found: Found) -> Any:
    """Momentum upwards of hull "a" and of the water that both hulls move [kg m/s], for small turns."""
    velocity = []
    for name in "ab":
        spin = found[f"{name}.angular_velocity"]
        velocity += [found[f"{name}.velocity"] + np.cross(spin, barges.REFERENCE), spin]
    centre = np.array([0.0, 0.0, barges.CENTRE[2]])
    own = barges.MASS * (found["a.velocity"] + np.cross(found["a.angular_velocity"], centre))[:, 2]
    return own + np.hstack(velocity) @ barges.added_mass(1.0)[2]


def impulse(force: Any, step: float) -> float:
    return float(step * (force.sum() - 0.5 * (force[0] + force[-1])))


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize(("body", "thing"), CASES)
def test_balances(body: str, thing: str) -> None:
    of = subject(body, thing)
    if (body, thing) in REFUSED:
        expected = REFUSED[body, thing]
        if thing == "drive" and body not in HULLS:
            assert "motion" not in type(of.keys["bodies"][0]).__dataclass_fields__
            return
        with pytest.raises(InputError, match=expected):
            Simulation(combined(of, thing), of.step)
        return
    gains = (body, thing) == (
        "shell mesh",
        "triangle contact",
    )  # 2 % while its corners land one after the other
    found = Found(combined(of, thing), of.step, driven=thing == "drive", gains=gains)
    balance = found["energy.balance"]
    turned_over = max(np.ptp(found["energy.kinetic"]), np.ptp(found["energy.elastic"]))
    allowed = (5e-4 if thing == "drive" else 2e-5) * turned_over
    if thing == "triangle contact" and np.ptp(balance) > allowed:
        # corners that touch one after the other share a stiffness: what they store more by that comes from nowhere
        assert np.ptp(balance) < 5e-2 * turned_over
        assert abs(balance[-1, 0] - balance[0, 0] - max(-found.jumps, 0.0)) < allowed
    else:
        assert np.ptp(balance) < allowed
    momentum = found["momentum.linear"][:, 2].copy()
    outer = np.zeros(STEPS + 1) - G * of.mass
    if body in HULLS:
        # small turns of a box whose sides are upright: its water-plane is where the middle of it is
        rotation = found["a.orientation"]
        middle = found["a.position"][:, 2]
        area = barges.LENGTH * barges.BREADTH
        upright = 1.0 - 2.0 * (rotation[:, 1:3] ** 2).sum(1)
        outer += barges.RHO * G * area * (barges.DRAFT - middle / upright)
    if body == HULLS[1]:
        momentum = moving_with_water(found)
    change = momentum[-1] - momentum[0]
    wanted = impulse(outer, of.step)
    left = [change - wanted - impulse(force, of.step) for force in link_forces(found, of, thing)]
    assert np.abs(left).min() < 2e-3 * G * of.mass * of.step * STEPS
    assert any(np.abs(force).max() > 1e-3 * G * of.mass for force in link_forces(found, of, thing))


def test_the_table_in_the_docs_is_that_of_the_cases() -> None:
    assert (ROOT / "docs" / "combinations.md").read_text() == table()


def table() -> str:
    """Markdown of what works and what is refused."""
    rows = [
        "# What acts on what",
        "",
        "Each of these pairs is a scene of `tests/verification/test_combinations.py`, in which momentum and energy are",
        "balanced from what is recorded; or it is refused, with the reason.",
        "",
        "| | " + " | ".join(THINGS) + " |",
        "|---|" + "---|" * len(THINGS),
    ]
    for body in BODIES:
        cells = ["refused" if (body, thing) in REFUSED else "balanced" for thing in THINGS]
        rows.append(f"| {body} | " + " | ".join(cells) + " |")
    rows.append("")
    rows += [f"- {body}, {thing}: {reason}." for (body, thing), reason in REFUSED.items()]
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    (ROOT / "docs" / "combinations.md").write_text(table())
