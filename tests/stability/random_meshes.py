"""Frames and shells of random shape, size, material, support, load and step, alone and hung on rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from mechanisms import STANDARD_GRAVITY

from heavylift.numerics.rotation import quaternion_from_rotation_vector
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.mesh_shapes import arc, line, quadrilateral, rectangle
from heavylift.solver.scene.meshes import (
    DistributedLoad,
    FollowerLoad,
    FrameBody,
    FrameSection,
    ShellBody,
    ShellSection,
    Support,
)
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene

if TYPE_CHECKING:
    from numpy.random import Generator

__all__ = ["Trial", "random_frame", "random_linkage", "random_shell"]


@dataclass(frozen=True)
class Trial:
    """A scene and the step it is given [s]."""

    scene: Scene
    step: float


def _round_section(density: float, modulus: float, diameter: float) -> FrameSection:
    return FrameSection(
        density, modulus, np.pi * diameter**2 / 4.0, np.pi * diameter**4 / 64.0, diameter / 2.0
    )


def _material(rng: Generator) -> tuple[float, float]:
    """Density [kg/m3] and modulus [Pa]: foam to more than diamond."""
    return float(10.0 ** rng.uniform(2.0, 4.0)), float(10.0 ** rng.uniform(3.0, 12.0))


def _step(rng: Generator, size: float) -> float:
    """A tenth to ten times what the fall of the body asks for: 5 ms a metre."""
    return float(0.005 * np.sqrt(size / STANDARD_GRAVITY) * 10.0 ** rng.uniform(-1.0, 1.0))


def _frame_parts(rng: Generator) -> tuple[dict[str, Any], float]:
    """Mesh, sections and model of a frame, straight or an arc, and its weight per length [N/m]."""
    length, curved, count = 10.0 ** rng.uniform(-1.0, 2.0), rng.random() < 0.4, int(rng.integers(2, 5))
    diameter = length * 10.0 ** rng.uniform(-4.0, -1.3)
    if curved:
        angle = rng.uniform(0.3, 3.0)
        mesh = arc(np.zeros(3), length / angle, 0.0, angle, count)
    else:
        mesh = line(np.zeros(3), (length, 0.0, 0.0), count)
    density, modulus = _material(rng)
    sections = [_round_section(density, modulus, diameter)]
    numbers = np.zeros(count, dtype=np.int64)
    if rng.random() < 0.4:  # a part that is up to 100 times thinner
        thin = diameter * 10.0 ** rng.uniform(-2.0, 0.0)
        sections.append(_round_section(density, modulus * 10.0 ** rng.uniform(-1.0, 1.0), thin))
        numbers[-1] = 1
    parts = {
        "nodes": mesh.nodes,
        "tangents": mesh.tangents,
        "elements": mesh.elements,
        "sections": tuple(sections),
        "element_sections": numbers,
        "model": "exact" if curved or rng.random() < 0.3 else "green-lagrange",
    }
    return parts, density * sections[0].area * STANDARD_GRAVITY


def _shell_parts(rng: Generator) -> tuple[dict[str, Any], float, Any]:
    """Mesh and sections of a shell, its weight per area [N/m2], and the grid it was cut from."""
    length, slim = 10.0 ** rng.uniform(-1.0, 2.0), 10.0 ** rng.uniform(-0.7, 0.0)
    corners = length * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, slim, 0.0], [0.0, slim, 0.0]])
    if rng.random() < 0.6:
        corners[:, :2] += length * slim * rng.uniform(-0.15, 0.15, (4, 2))
    mesh = quadrilateral(corners, *(int(n) for n in rng.integers(1, 4, 2)))
    kept = np.arange(len(mesh.elements)) != (4 if len(mesh.elements) == 9 else -1)  # a hole in the middle
    density, modulus = _material(rng)
    thickness = length * 10.0 ** rng.uniform(-4.0, -1.3)
    sections = [ShellSection(thickness, density, modulus, rng.uniform(0.0, 0.45))]
    numbers = np.zeros(len(mesh.elements), dtype=np.int64)
    if rng.random() < 0.4:
        thin = thickness * 10.0 ** rng.uniform(-2.0, 0.0)
        sections.append(ShellSection(thin, density, modulus * 10.0 ** rng.uniform(-1.0, 1.0), 0.3))
        numbers[rng.integers(len(numbers))] = 1
    parts = {
        "nodes": mesh.nodes,
        "slopes": mesh.slopes,
        "elements": mesh.elements[kept],
        "lengths": mesh.lengths[kept],
        "sections": tuple(sections),
        "element_sections": numbers[kept],
    }
    return parts, density * thickness * STANDARD_GRAVITY, mesh


def _loads(rng: Generator, weight: float) -> tuple[DistributedLoad | FollowerLoad, ...]:
    """None, or one of a thousandth to three times the weight."""
    share, which = weight * 10.0 ** rng.uniform(-3.0, 0.5), rng.random()
    if which < 0.3:
        return (DistributedLoad(share * rng.standard_normal(3)),)
    return (FollowerLoad(normal=share),) if which < 0.5 else ()


def _trial(rng: Generator, of: type, parts: dict[str, Any], weight: float, holds: list[Support]) -> Trial:
    size = float(np.linalg.norm(np.ptp(parts["nodes"], axis=0)))
    which = int(rng.integers(len(holds) + 1))
    more: dict[str, Any] = {"supports": (holds[which],)} if which < len(holds) else {}
    if not more:
        more["velocity"] = rng.standard_normal(3)
        more["angular_velocity"] = rng.standard_normal(3) * np.sqrt(STANDARD_GRAVITY / size)
    body = of(
        name="body",
        **parts,
        **more,
        loads=_loads(rng, weight),
        orientation=quaternion_from_rotation_vector(rng.standard_normal(3)),
        viscous_damping=float(rng.choice([0.0, 0.0, 0.1, 10.0])),
        stiffness_damping=float(rng.choice([0.0, 0.0, 0.0, 1e-3, 1e-1])),
    )
    still = "supports" in more and not body.loads
    gravity = STANDARD_GRAVITY if still or rng.random() < 0.6 else 0.0
    return Trial(Scene((body,), (Gravity(np.array([0.0, 0.0, -gravity])),)), _step(rng, size))


def random_frame(seed: int) -> Trial:
    """One frame: free, on a pin, clamped, or on two pins."""
    rng = np.random.default_rng(seed)
    parts, weight = _frame_parts(rng)
    ends = np.array([0, len(parts["nodes"]) - 1])
    holds = [
        Support(ends[:1], {"position": "xyz"}),
        Support(ends[:1], {"position": "xyz", "tangent": "yz"}),
        Support(ends, {"position": "xyz"}),
    ]
    return _trial(rng, FrameBody, parts, weight, holds)


def random_shell(seed: int) -> Trial:
    """One shell: free, hung by a corner or by two, or clamped along an edge."""
    rng = np.random.default_rng(seed)
    parts, weight, mesh = _shell_parts(rng)
    holds = [
        Support(mesh.corners[:1], {"position": "xyz"}),
        Support(mesh.corners[:2], {"position": "xyz"}),
        Support(mesh.edges["x_min"], {"position": "xyz", "slope_x": "z", "twist": "z"}),
    ]
    return _trial(rng, ShellBody, parts, weight, holds)


def random_linkage(seed: int) -> Trial:
    """A rigid block welded to a frame that a ball joint holds somewhere, and a shell hung on the block."""
    rng = np.random.default_rng(seed)
    length = 10.0 ** rng.uniform(-0.5, 1.2)
    mass, side = 10.0 ** rng.uniform(-1.0, 4.0), 0.3 * length
    spin = 0.3 * np.sqrt(STANDARD_GRAVITY / length) * rng.standard_normal(3)
    block = RigidBody("block", mass, mass * side**2 / 6.0 * np.eye(3), angular_velocity=spin)
    density = 10.0 ** rng.uniform(2.0, 4.0)
    beam, sheet = (
        line(np.zeros(3), (length, 0.0, 0.0), int(rng.integers(1, 5))),
        rectangle(length, 0.6 * length, 2, 2),
    )
    diameter, thickness = length * 10.0 ** rng.uniform(-3.0, -1.5, 2)
    frame = FrameBody(
        name="frame",
        nodes=beam.nodes,
        tangents=beam.tangents,
        elements=beam.elements,
        sections=(_round_section(density, 10.0 ** rng.uniform(5.0, 12.0), diameter),),
        position=np.array([0.5 * side, 0.0, 0.0]),
    )
    shell = ShellBody(
        name="shell",
        nodes=sheet.nodes,
        slopes=sheet.slopes,
        elements=sheet.elements,
        lengths=sheet.lengths,
        sections=(ShellSection(thickness, density, 10.0 ** rng.uniform(5.0, 12.0), 0.3),),
        position=np.array([-0.5 * side - length, 0.0, 0.0]),
    )
    pin, eye = np.array([length * rng.uniform(0.05, 0.95), 0.0, 0.0]), np.array([length, 0.2 * length, 0.0])
    joints = (
        Ball(
            name="pin",
            body_a="frame",
            body_b=GROUND,
            frame_a=JointFrame(pin),
            frame_b=JointFrame(frame.position + pin),
        ),
        FixedJoint(name="weld", body_a="block", body_b="frame", frame_a=JointFrame(frame.position)),
        Ball(
            name="eye",
            body_a="block",
            body_b="shell",
            frame_a=JointFrame(shell.position + eye),
            frame_b=JointFrame(eye),
        ),
    )
    gravity = Gravity(np.array([0.0, 0.0, -STANDARD_GRAVITY]))
    return Trial(Scene((block, frame, shell), (gravity,), (), joints), _step(rng, length))
