"""Whether the databases of a case fit its sea, its hulls and what these carry: asked of every assembled scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.pipeline.assemble.loading import scene_loading
from heavylift.solver.layout_sea import floating_hulls
from heavylift.solver.water.hulls.database_fit import check_databases, weight_words

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scene.scene import Scene

__all__ = ["check_afloat", "draught_notes"]


def check_afloat(case: Case, scene: Scene) -> list[str]:
    """Refuse databases of another water, another hull or another draught.

    Returns
    -------
    list
        Sentences about what differs and is not refused.

    Raises
    ------
    InputError
        See `database_fit.check_databases` and `draught_notes`.
    """
    if scene.sea is None or not scene.sea.radiation:
        return []
    return [*check_databases(floating_hulls(scene), scene.sea), *draught_notes(case, scene)]


def draught_notes(case: Case, scene: Scene) -> list[str]:
    """Compare the displacement of hulls that carry their mass, tanks and what joints hold with their databases.

    Returns
    -------
    list
        Sentences about what differs and is not refused. Where something else loads a hull, as ropes and contacts do,
        nothing is refused: an equilibrium knows it.

    Raises
    ------
    InputError
        If a hull floats at another draught than in its database.
    """
    sea = scene.sea
    if sea is None or not sea.radiation:
        return []
    hulls = floating_hulls(scene)
    names, found = [body.name for body in hulls], []
    for body in hulls:
        loading = scene_loading(scene, names, body.name)
        mass = loading.mass + sum(tank.start_mass for tank in sea.tanks if tank.hull == body.name)
        hanging = case.hulls[body.name].hanging
        mass += 0.0 if hanging is None else hanging.mass
        unknown = [*loading.left_out, *_other_loads(scene, {body.name, *loading.bodies})]
        if case.ballast is not None and case.ballast.hull == body.name:
            unknown.append("what [ballast] fills")
        volume = mass / sea.water.density
        at = "by its mass, its tanks and what joints hold on it"
        found.append(weight_words(hulls, sea, body.name, volume, unknown=", ".join(unknown), at=at))
    return [words for words in found if words]


def _other_loads(scene: Scene, group: set[str]) -> list[str]:
    """Words for what loads bodies and is no joint."""
    sea = scene.sea
    assert sea is not None
    kinds: dict[str, Any] = {
        "ropes": scene.ropes,
        "forces": scene.forces,
        "mooring lines": sea.lines,
        "fenders": sea.fenders,
    }
    found = [word for word, items in kinds.items() if any(_sides(one) & group for one in items)]
    if scene.touches or scene.decks or scene.transporters:
        found.append("what lies or stands on something")
    return found


def _sides(one: Any) -> set[str]:
    """Bodies on which a rope or a force acts, but for what acts within one alone."""
    path = getattr(one, "path", None)
    if path is not None:
        return {stop.body for stop in path}
    return {
        getattr(one, key) for key in ("body", "body_a", "body_b") if isinstance(getattr(one, key, None), str)
    }
