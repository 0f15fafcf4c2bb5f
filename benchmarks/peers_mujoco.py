"""MuJoCo: joint trees, loops closed by stiff equality constraints, fixed steps."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from peers_measure import SAMPLES, History, Ladder
from peers_problems import GROUND, Mechanism, Problem, Vector

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["NAME", "VERSION", "ladders"]

NAME = "MuJoCo"
VERSION = mujoco.__version__

mujoco.set_mju_user_warning(lambda _: None)  # steps that are too large are found by their result; no log file

TINY = 1e-14
"""Smallest inertia that the compiler takes for none [kg m2]."""


def ladders(problem: Problem) -> list[Ladder]:
    """Solvers worth running on a problem; numbers of steps from cheap to dear."""
    settings: dict[str, dict[str, Iterable[int]]] = {
        "A01": {"RK4": (60, 80, 100, 150, 200, 400, 600)},
        "A02": {"implicitfast": (1000, 2000, 4000, 10000), "RK4": (2000, 5000, 10000)},
        "A03": {"RK4": (100, 150, 200, 500, 700, 1000, 1500, 2000, 5000)},
        "A04": {"RK4": (50, 70, 100, 200, 300, 500, 1000, 2000, 3000)},
        "A05": {"Euler": (30000, 40000, 50000), "RK4": (26000, 28000, 30000, 40000)},
        "chain": {"RK4": (40, 50, 60, 70, 100, 150, 200, 300, 400, 700)},
    }
    return [
        Ladder(NAME, solver, tuple(partial(_Run, problem, solver, count) for count in counts))
        for solver, counts in settings[problem.name.split("-")[0]].items()
    ]


def _numbers(*values: float) -> str:
    return '"' + " ".join(f"{value:.17g}" for value in values) + '"'


def model_text(mechanism: Mechanism, step: float) -> str:
    """The model as MJCF. Constraints get the stiffest time constant that is safe, two steps, and full impedance."""
    sites: dict[int, list[str]] = {number: [] for number in range(GROUND, len(mechanism.links))}
    equalities, tendons = [], []

    def site(link: int, point: Vector) -> str:
        name = f"site{sum(map(len, sites.values()))}"
        sites[link].append(f'<site name="{name}" pos={_numbers(*point)}/>')
        return name

    for closure in mechanism.closures:
        shifts = [(0.0, 0.0, 0.0)] if closure.axis is None else [(0.0, 0.0, 0.0), closure.axis]
        for shift in shifts:  # a hinge is closed by two points on its axis
            first, second = (
                site(link, tuple(x + d for x, d in zip(point, shift, strict=True)))  # type: ignore[arg-type]
                for link, point in zip(closure.links, closure.points, strict=True)
            )
            equalities.append(f'<connect site1="{first}" site2="{second}"/>')
    for spring in mechanism.springs:
        first, second = (site(*end) for end in zip(spring.links, spring.points, strict=True))
        values = f"stiffness={_numbers(spring.stiffness)} damping={_numbers(spring.damping)}"
        path = f'<site site="{first}"/><site site="{second}"/>'
        tendons.append(f"<spatial {values} springlength={_numbers(spring.length)}>{path}</spatial>")
    sites[mechanism.marked].append(f'<site name="marked" pos={_numbers(*mechanism.point)}/>')

    def body(number: int) -> str:
        link = mechanism.links[number]
        kind = "slide" if link.slides else "hinge"
        inertia = _numbers(*(max(value, TINY) for value in link.inertia))
        children = (body(k) for k, other in enumerate(mechanism.links) if other.parent == number)
        return (
            f'<body pos={_numbers(*link.offset)}><joint name="joint{number}" type="{kind}" '
            f"axis={_numbers(*link.axis)}/><inertial mass={_numbers(link.mass)} pos={_numbers(*link.centre)} "
            f"diaginertia={inertia}/>{''.join(sites[number])}{''.join(children)}</body>"
        )

    roots = "".join(body(k) for k, link in enumerate(mechanism.links) if link.parent == GROUND)
    return (
        '<mujoco><compiler angle="radian" boundmass="0" boundinertia="0"/>'
        f'<option timestep={_numbers(step)} gravity={_numbers(*mechanism.gravity)} solver="Newton" '
        'tolerance="1e-12" iterations="100"><flag contact="disable"/></option>'
        f"<default><equality solref={_numbers(2.0 * step, 1.0)} "
        f"solimp={_numbers(0.9999, 0.9999, 0.001, 0.5, 2.0)}/></default>"
        f"<worldbody>{''.join(sites[GROUND])}{roots}</worldbody><tendon>{''.join(tendons)}</tendon>"
        f"<equality>{''.join(equalities)}</equality></mujoco>"
    )


class _Run:
    """A number of equal steps."""

    def __init__(self, problem: Problem, solver: str, steps: int) -> None:
        mechanism = problem.mechanism()
        self.setting = f"{steps} steps"
        self._duration, self._steps = problem.duration, steps
        self._model = mujoco.MjModel.from_xml_string(model_text(mechanism, problem.duration / steps))
        self._model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{solver.upper()}")
        self._data = mujoco.MjData(self._model)
        joints = [self._model.joint(f"joint{k}") for k in range(len(mechanism.links))]
        self._positions = np.zeros(self._model.nq)
        self._speeds = np.zeros(self._model.nv)
        for joint, link in zip(joints, mechanism.links, strict=True):
            self._positions[joint.qposadr[0]] = link.start
            self._speeds[joint.dofadr[0]] = link.rate
        self._load = np.zeros(self._model.nv)
        self._load[joints[0].dofadr[0]] = mechanism.torque

    def reset(self) -> None:
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:], self._data.qvel[:] = self._positions, self._speeds
        self._data.qfrc_applied[:] = self._load

    def go(self) -> None:
        mujoco.mj_step(self._model, self._data, nstep=self._steps)

    def history(self) -> History:
        model, data = self._model, self._data
        self.reset()
        stride = self._steps // (SAMPLES - 1) if self._steps % (SAMPLES - 1) == 0 else 1
        marked = model.site("marked").id
        rows = np.empty((self._steps // stride + 1, 6))
        velocity = np.empty(6)
        for k in range(len(rows)):
            if k:
                mujoco.mj_step(model, data, nstep=stride)
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, marked, velocity, 0)
            rows[k, :3], rows[k, 3:] = data.site_xpos[marked], velocity[3:]
        kinds = (getattr(mujoco.mjtWarning, f"mjWARN_BADQ{what}") for what in ("POS", "VEL", "ACC"))
        if any(data.warning[kind].number for kind in kinds):  # it starts again from the initial state
            rows[:] = math.nan
        return History(np.linspace(0.0, self._duration, len(rows)), rows[:, :3], rows[:, 3:])
