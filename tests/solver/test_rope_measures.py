"""Hook loads, lugs and groups of ropes: against geometry, balances of momentum, and runs that record every step."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.equalized import SharedLines
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.sensors.hook_loads import HookLoad
from heavylift.solver.sensors.lugs import Lug
from heavylift.solver.sensors.rope_groups import RopeGroup
from heavylift.solver.simulation import Simulation

G = 9.81
HOOK = np.array([0.2, 0.0, -1.0])
LUGS = {"s1": (2.0, 0.0, 1.0), "s2": (-2.0, 1.5, 1.0), "s3": (-2.0, -1.0, 1.0)}
NORMAL = np.array([1.0, -2.0, 0.5])
Y = np.array([0.0, 1.0, 0.0])


def at(body, *point, **more):
    return RopePoint(body, np.array(point, dtype=np.float64), **more)


def hung(name, x, **sheave):
    """A pulley of radius 0.5 m on a rope with two vertical parts of some 10 m."""
    return Rope(
        name=name,
        path=(
            at(GROUND, x - 0.5, 0, 10),
            at(name[:-5], 0, 0, 0, radius=0.5, axis=-Y, **sheave),
            at(GROUND, x + 0.5, 0, 10),
        ),
        axial_stiffness=4e6,
        damping=1e4,
        winch=Winch(times=np.array([0.0, 0.2, 0.8, 1.0]), speeds=np.array([0.0, 0.6, 0.6, 0.0])),
    )


def scene() -> Scene:
    """A load on three slings below a block; pulleys on a rope with an efficiency, and on lines of one force."""
    still = 3.0 * np.eye(3)
    bodies = (
        RigidBody("block", 500.0, 40.0 * np.eye(3), centre_of_mass=np.array([0.1, 0.0, -0.3])),
        RigidBody("load", 5e3, 9e3 * np.eye(3), position=np.array([0.0, 0.0, -6.0])),
        RigidBody(
            "rub",
            800.0,
            90.0 * np.eye(3),
            position=np.array([20.0, 0.0, 0.0]),
            velocity=np.array([0, 0, 0.3]),
        ),
        RigidBody("even", 900.0, 900.0 * np.eye(3), position=np.array([40.0, 0.0, -3.0])),
        RigidBody(
            "thrown", 100.0, still, position=np.array([60.0, 0.0, 0.0]), velocity=np.array([0.0, 0.0, 3.0])
        ),
    )
    slings = [
        Rope(name=name, path=(at("block", *HOOK), at("load", *lug)), axial_stiffness=3e6, damping=5e3)
        for name, lug in LUGS.items()
    ]
    lines = SharedLines(
        name="lines",
        path=tuple(
            at(body, 38 + 2 * k if body == GROUND else 2 * k - 2, 0, z)
            for k in range(3)
            for body, z in ((GROUND, 8), ("even", 1))
        ),
        lengths=np.array([8.0, 7.6, 8.3]),
        depth=2.0,
        up=1.5,
        down=1.5,
        axial_stiffness=4e6,
        rope_length=20.0,
        line_stiffness=4e6,
        damping=2e3,
    )
    slack = Rope(
        name="slack", path=(at(GROUND, 60, 0, 5), at("thrown", 0, 0, 0)), axial_stiffness=1e6, length=40.0
    )
    measures = (
        HookLoad(name="hook", body="block", ropes=("block_rope",)),
        HookLoad(name="under_hook", body="load", ropes=tuple(LUGS)),
        HookLoad(name="bare", body="rub", ropes=("rub_rope",)),
        HookLoad(name="shared", body="even", ropes=("lines",)),
        HookLoad(name="free", body="thrown", ropes=("slack",)),
        Lug(name="eye", body="load", rope="s2", normal=NORMAL),
        Lug(name="middle", body="even", rope="lines", place=4, normal=Y),
        RopeGroup(name="slings", ropes=tuple(LUGS), breaking_load=1e5),
        RopeGroup(name="of_lines", ropes=("lines",)),
        RopeGroup(name="parts", ropes=("rub_rope",)),
        RopeGroup(name="loose", ropes=("s1", "slack")),
    )
    ropes = (hung("block_rope", 0.0), hung("rub_rope", 20.0, efficiency=0.95), *slings, lines, slack)
    return Scene(bodies, forces=(Gravity(np.array([0.0, 0.0, -G])), *measures), ropes=ropes)


@cache
def histories(step: float, every: int = 1, count: int = 300):
    run = Simulation(scene(), step=step, record_every=every)
    first = run.record()
    times, rows = run.advance(count)
    rows = np.vstack([first, rows])
    found = {c.name: rows[:, c.column : c.column + len(c.components)] for c in run.channels}
    return np.concatenate([[0.0], times]), {k: v[:, 0] if v.shape[1] == 1 else v for k, v in found.items()}


def turned(found, body, point):
    q = found[f"{body}.orientation"][:, [1, 2, 3, 0]]
    return Rotation.from_quat(q).apply(np.asarray(point))


def sling(found, name):
    """Vector from the lug to the hook, all times."""
    top = found["block.position"] + turned(found, "block", HOOK)
    return top - found["load.position"] - turned(found, "load", LUGS[name])


def test_a_lug_has_the_force_of_its_rope_in_its_plane_and_across():
    _, found = histories(0.004)
    way, tension = sling(found, "s2"), found["s2.tension"]
    force = (tension / np.linalg.norm(way, axis=1))[:, None] * way
    across = np.sum(force * turned(found, "load", NORMAL / np.linalg.norm(NORMAL)), axis=1)
    np.testing.assert_allclose(found["eye.force"], tension, rtol=1e-9)
    np.testing.assert_allclose(found["eye.out_of_plane"], across, rtol=0.0, atol=1e-8 * tension.max())
    inside = np.sqrt(tension**2 - across**2)
    np.testing.assert_allclose(found["eye.in_plane"], inside, rtol=0.0, atol=1e-6 * tension.max())
    angle = np.where(tension > 0.0, np.arctan2(across, inside), 0.0)
    np.testing.assert_allclose(found["eye.angle"], angle, rtol=0.0, atol=1e-6)
    assert np.ptp(found["eye.angle"][1:]) > 1e-3


def test_the_hook_load_is_what_the_slings_pull_down():
    """Two expressions: ropes above less weight and inertia, slings below. They differ by the square of the step."""
    missing = []
    for step, count in ((0.004, 300), (0.002, 600)):
        times, found = histories(step, 1, count)
        below = np.zeros(count + 1)
        for name in LUGS:
            way = sling(found, name)
            below += found[f"{name}.tension"] * way[:, 2] / np.linalg.norm(way, axis=1)
        np.testing.assert_allclose(found["under_hook.rope_load"], below, rtol=1e-9, atol=1e-6)
        smooth = (times > 0.5) & (times < 0.79)  # after the jumps of the start, before the winch slows down
        missing.append(np.abs(found["hook.hook_load"] - below)[smooth].max() / below[smooth].mean())
        assert np.ptp(below[smooth]) > 0.1 * below[smooth].mean()
    assert missing[0] < 0.003
    assert missing[1] < missing[0] / 3.0


@pytest.mark.parametrize("hook", ["under_hook", "bare", "shared", "free"])
def test_nothing_hangs_on_what_has_nothing_below(hook):
    """Balance of momentum of a load, of a pulley whose rope has two tensions, of lines of one force, of free flight."""
    _, found = histories(0.002, 1, 600)
    scale = max(found[f"{hook}.rope_load"].max(), 100.0 * G)
    assert np.abs(found[f"{hook}.hook_load"][300:]).max() < 0.01 * scale
    if hook == "free":
        assert np.abs(found["free.hook_load"]).max() < 1e-6 * scale
    if hook == "bare":
        both = found["rub_rope.segment_tension"]
        assert np.abs(both[:, 0] - both[:, 1]).max() > 0.02 * both.max()
        np.testing.assert_allclose(found["bare.rope_load"][1:], both.sum(axis=1)[1:], rtol=1e-3)


def test_lines_of_one_force_pull_their_lugs():
    _, found = histories(0.004)
    lines = found["lines.segment_tension"]
    np.testing.assert_allclose(found["middle.force"], lines[:, 1], rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(found["of_lines.total_tension"], lines.sum(axis=1), rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(found["of_lines.largest_tension"], lines.max(axis=1), rtol=1e-12)
    taut = lines.mean(axis=1) > 0.0
    spread = np.ptp(lines[taut], axis=1) / lines[taut].mean(axis=1)
    np.testing.assert_allclose(found["of_lines.spread"][taut], spread, rtol=1e-9, atol=1e-12)


def test_groups_of_ropes_and_of_the_parts_of_one():
    times, found = histories(0.004)
    tensions = np.stack([found[f"{s}.tension"] for s in LUGS])
    np.testing.assert_allclose(found["slings.total_tension"], tensions.sum(axis=0), rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(found["slings.smallest_tension"], tensions.min(axis=0))
    np.testing.assert_allclose(found["slings.utilisation"], tensions.max(axis=0) / 1e5, rtol=1e-12)
    parts = found["rub_rope.segment_tension"]
    np.testing.assert_array_equal(found["parts.smallest_tension"], parts.min(axis=1))
    np.testing.assert_array_equal(found["parts.total_tension"], parts.max(axis=1))
    np.testing.assert_array_equal(found["parts.utilisation"], 0.0)
    assert found["loose.slack_time"][-1] == pytest.approx(times[-1])
    slack = 0.004 * np.cumsum(tensions.min(axis=0) <= 0.0)
    np.testing.assert_allclose(found["slings.slack_time"][1:], slack[1:] - slack[0], atol=1e-12)


def test_extremes_are_those_of_all_steps_between_records():
    """Bit for bit those of a run that records every step."""
    _, dense = histories(0.004)
    _, sparse = histories(0.004, 25)
    missed = 0
    for name in (
        "hook.hook_load",
        "bare.rope_load",
        "shared.rope_load",
        "eye.angle",
        "eye.in_plane",
        "middle.force",
        "slings.spread",
        "of_lines.smallest_tension",
        "parts.spread",
    ):
        for side, extreme in (("max", np.max), ("min", np.min)):
            wanted = [extreme(dense[name][25 * k + 1 : 25 * k + 26]) for k in range(12)]
            np.testing.assert_array_equal(sparse[f"{name}_{side}"][1:], wanted)
            ends = [dense[name][25 * k + 25] for k in range(12)]
            missed += int(np.any(np.array(wanted) != ends))
    assert missed == 18
    for rope, group in (("rub_rope", "parts"), ("lines", "of_lines")):
        for side, which, extreme in (("max", "largest", np.max), ("min", "smallest", np.min)):
            of_parts = extreme(sparse[f"{rope}.segment_tension_{side}"], axis=1)
            np.testing.assert_array_equal(of_parts, sparse[f"{group}.{which}_tension_{side}"])


def test_measures_change_nothing():
    whole = scene()
    plain = Scene(whole.bodies, forces=whole.forces[:1], ropes=whole.ropes)
    watched, alone = (Simulation(one, step=0.004, record_every=50) for one in (whole, plain))
    seen, free = watched.advance(300)[1], alone.advance(300)[1]
    columns = {c.name: c for c in watched.channels}
    for c in alone.channels:
        if c.name.startswith(("energy", "monitor")):
            continue
        other = columns[c.name].column
        width = len(c.components)
        np.testing.assert_array_equal(seen[:, other : other + width], free[:, c.column : c.column + width])


def with_measure(measure, integrator="dele2", gravity=True):
    whole = scene()
    forces = (Gravity(np.array([0.0, 0.0, -G])),) if gravity else ()
    apart = {"lines"} if integrator == "dele2" else {"lines", "rub_rope"}
    ropes = tuple(rope for rope in whole.ropes if rope.name not in apart)
    return Simulation(
        Scene(whole.bodies, forces=(*forces, measure), ropes=ropes), step=0.01, integrator=integrator
    )


@pytest.mark.parametrize(
    ("measure", "options", "words"),
    [
        (HookLoad(name="a", body="block", ropes=("s9",)), {}, "there is no rope 's9'"),
        (HookLoad(name="a", body="block", ropes=("rub_rope",)), {}, "'rub_rope' has no place on 'block'"),
        (HookLoad(name="a", body="block", ropes=("s1",)), {"gravity": False}, "no weight without gravity"),
        (HookLoad(name="a", body="block", ropes=("s1",)), {"integrator": "accurate"}, "the steps of 'dele2'"),
        (RopeGroup(name="a", ropes=("s1",)), {"integrator": "accurate"}, "the steps of 'dele2'"),
        (Lug(name="a", body="rub", rope="s1", normal=Y), {}, "'s1' has no place on 'rub'"),
        (Lug(name="a", body="load", rope="s1", normal=Y, place=1), {}, "place 1 of 's1' is not on 'load'"),
        (Lug(name="a", body="load", rope="s7", normal=Y), {}, "there is no rope 's7'"),
    ],
)
def test_what_cannot_be_watched_is_refused(measure, options, words):
    with pytest.raises(InputError, match=words):
        with_measure(measure, **options)


def test_each_rope_counts_once():
    with pytest.raises(InputError, match="'s1' twice"):
        check_object(RopeGroup(name="a", ropes=("s1", "s1")))


def test_a_lug_of_ropes_as_forces():
    """Where ropes are forces on markers, records show the same; the start is that of the other integrator."""
    whole = scene()
    ropes = tuple(rope for rope in whole.ropes if rope.name not in {"lines", "rub_rope"})
    forces = (whole.forces[0], Lug(name="eye", body="load", rope="s2", normal=NORMAL))
    run = Simulation(
        Scene(whole.bodies, forces=forces, ropes=ropes), step=0.004, integrator="accurate", tolerance=1e-8
    )
    rows = run.advance(100)[1]
    columns = {c.name: c.column for c in run.channels}
    np.testing.assert_allclose(
        rows[:, columns["eye.force"]], rows[:, columns["s2.tension"]], rtol=1e-9, atol=1e-6
    )
    angle = math.atan2(rows[-1, columns["eye.out_of_plane"]], rows[-1, columns["eye.in_plane"]])
    assert rows[-1, columns["eye.angle"]] == pytest.approx(angle)
