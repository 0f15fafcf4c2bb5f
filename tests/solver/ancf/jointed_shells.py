"""Shells on joints: parts of scenes that all share one compiled step."""

from __future__ import annotations

from typing import Any

import numpy as np
from jointed_frames import Part, on, rod
from scipy.spatial.transform import Rotation

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.edges import EdgeClamp, EdgeHinge
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.mesh_shapes import ShellMesh, rectangle
from heavylift.solver.scene.meshes import ShellBody, ShellSection, Support

HALF, WHOLE, PANEL = rectangle(0.5, 0.6, 2, 3), rectangle(1.0, 0.6, 4, 3), rectangle(0.5, 0.6, 2, 2)
TURN = Rotation.from_euler("xyz", [0.1, 0.2, 0.9])
AWAY = np.array([0.0, 6.0, 0.0])
CLAMPED = {"position": "xyz", "slope_y": "xyz", "slope_x": "z", "twist": "z"}
"""What `EdgeClamp` keeps of an edge along y, and the stretch along it, of which it leaves nothing."""


def sheet(name: str, mesh: ShellMesh, thickness: float, modulus: float, **more: Any) -> ShellBody:
    """Of the density of steel."""
    return ShellBody(
        name=name,
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(thickness, 7850.0, modulus, 0.3),),
        **more,
    )


def hung_plate(modulus: float = 2.1e11, **more: Any) -> Part:
    """3 x 2 m x 5 mm, level, on four hooks of 20 kg that hang on one hinge and three balls."""
    bodies: list[Any] = [sheet("plate", rectangle(3.0, 2.0, 4, 3), 5e-3, modulus, **more)]
    joints: list[Any] = []
    for i, (x, y) in enumerate(((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0))):
        low = np.array([x, y, 0.0])
        top = low + np.array([0.1 if x == 0.0 else -0.1, 0.05, 1.0])
        hook = rod(f"hook{i}", low, top, 20.0)
        bodies.append(hook)
        joints.append(
            Ball(
                name=f"low{i}",
                body_a="plate",
                body_b=hook.name,
                frame_a=JointFrame(low),
                frame_b=on(hook, low, np.eye(3)),
            )
        )
        kind, axes = (Hinge, axes_about(np.array([1.0, 1.0, 0.0]))) if i == 0 else (Ball, np.eye(3))
        joints.append(
            kind(
                name=f"top{i}",
                body_a=GROUND,
                body_b=hook.name,
                frame_a=JointFrame(top, axes),
                frame_b=on(hook, top, axes),
            )
        )
    return bodies, joints


def clamped_plates(modulus: float, **more: Any) -> Part:
    """A plate clamped by supports, and one of two halves, clamped by joints to the ground and to each other."""
    more["orientation"] = TURN.as_quat(scalar_first=True)
    support = (Support(WHOLE.edges["x_min"], CLAMPED),)
    bodies: list[Any] = [
        sheet("whole", WHOLE, 1e-2, modulus, position=AWAY, supports=support, **more),
        sheet("left", HALF, 1e-2, modulus, position=AWAY, **more),
        sheet("right", HALF, 1e-2, modulus, position=AWAY + TURN.apply([0.5, 0.0, 0.0]), **more),
    ]
    joints: list[Any] = [
        EdgeClamp(name="base", body_a="left", body_b=GROUND, nodes_a=HALF.edges["x_min"]),
        EdgeClamp(
            name="seam",
            body_a="left",
            body_b="right",
            nodes_a=HALF.edges["x_max"],
            nodes_b=HALF.edges["x_min"],
        ),
    ]
    return bodies, joints


ANGLES = np.radians([30.0, 75.0])
"""Of the panels below the horizontal, at the start."""


def folding_panels(modulus: float, **more: Any) -> Part:
    """Two panels, the first hinged to the ground, the second to the first."""
    turns = [Rotation.from_euler("y", angle) for angle in ANGLES]
    place = -0.5 * AWAY
    bodies: list[Any] = []
    for name, turn in zip(("first", "second"), turns, strict=True):
        bodies.append(
            sheet(
                name,
                PANEL,
                1e-2,
                modulus,
                position=place,
                orientation=turn.as_quat(scalar_first=True),
                **more,
            )
        )
        place = place + turn.apply([0.5, 0.0, 0.0])
    joints: list[Any] = [
        EdgeHinge(name="pin", body_a="first", body_b=GROUND, nodes_a=PANEL.edges["x_min"]),
        EdgeHinge(
            name="fold",
            body_a="first",
            body_b="second",
            nodes_a=PANEL.edges["x_max"],
            nodes_b=PANEL.edges["x_min"],
        ),
    ]
    return bodies, joints
