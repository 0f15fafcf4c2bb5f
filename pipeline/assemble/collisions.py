"""From the surfaces and collisions of a case to what the solver integrates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.pipeline.assemble.described import spec_of
from heavylift.pipeline.case.places import located

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene import collisions as c
    from heavylift.solver.scene.contacts import ContactLaw
    from heavylift.solver.scene.scene import AnyBody

__all__ = ["assemble_collisions", "assemble_surfaces", "collision_law", "collision_notes"]


def assemble_surfaces(
    case: Case, bodies: Sequence[AnyBody], sides: Mapping[str, Side], folder: OutputFolder
) -> tuple[c.CollisionSurface, ...]:
    """Surfaces of a case in the frames of their bodies.

    Parameters
    ----------
    case
        The case.
    bodies, sides
        Its bodies, and where they are at the start, by name.
    folder
        Output folder: what the mesh stage has stored is read, if it is of the same inputs.

    Raises
    ------
    InputError
        See `heavylift.pipeline.assemble.surfaces.make_surface` and `own_surface`.
    """
    from heavylift.pipeline.assemble.surfaces import own_surface, stored_surface
    from heavylift.preprocess.surfaces.triangle_surface import placed
    from heavylift.solver.scene.collisions import CollisionSurface

    found = []
    modal: Mapping[str, Any] = {body.name: body for body in bodies if body.MODAL}
    colliding = {name for _, pair in case.collided.values() for name in pair}
    floating = {hull.surface for hull in case.hulls.values()} - colliding
    for index, section in enumerate(case.surfaces):
        if section.name in floating:
            continue  # water alone touches it
        surface = nodes = None
        if section.body in modal:
            with located(case, f"surfaces.{index}"):
                reduced, origin = modal[section.body].reduced, sides[section.body].origin
                surface, nodes = own_surface(section, reduced, origin, case.folder)
        elif section.body not in case.meshes:
            surface = stored_surface(case, index, folder).surface
            surface = placed(surface, position=-sides[section.body].origin)
        found.append(
            CollisionSurface(
                name=section.name,
                body=section.body,
                surface=surface,
                facets=section.facets or 2,
                nodes=nodes,
            )
        )
    return tuple(found)


def assemble_collisions(case: Case) -> tuple[c.Collision, ...]:
    """Collisions of a case, one a pair of surfaces."""
    from heavylift.solver.scene import collisions as c

    found = []
    for name, (index, pair) in case.collided.items():
        section = case.collisions[index]
        spec = spec_of(section, c.Collision)
        spec["clearance"] = section.clearance or name in case.measured_gaps
        found.append(c.Collision(name=name, surfaces=pair, law=collision_law(case, section), **spec))
    return tuple(found)


def collision_law(case: Case, section: Any) -> ContactLaw:
    """Law of a collision as the solver takes it; that of the thesis becomes a spring and a damper."""
    law = section.DESCRIBED(**spec_of(section, section.DESCRIBED))
    taken: ContactLaw = law.at_step(_step(case)) if section.law == "thesis" else law
    return taken


def collision_notes(case: Case) -> list[str]:
    """What the parameters of laws ``"thesis"`` really mean, a sentence a table."""
    notes: list[str] = []
    if case.simulate is None:
        return notes
    for section in case.collisions:
        if section.law != "thesis":
            continue
        from heavylift.pipeline.results.words import number_words
        from heavylift.solver.scene.contacts import ThesisLaw

        step = _step(case)
        law = ThesisLaw(section.epsilon, section.gamma)
        numbers = law.at_step(step)
        notes.append(
            f"{section.name}: epsilon = {section.epsilon:g} m/N is a spring of "
            f"{number_words(numbers.stiffness, 'N/m')} a patch, whatever the step; gamma = {section.gamma:g} is no "
            f"restitution coefficient but, at the step of {number_words(step, 's')}, a damper of "
            f"{number_words(numbers.damping, 'N s/m')} (time constant {number_words(law.time_constant(step), 's')})"
        )
    return notes


def _step(case: Case) -> float:
    """Fixed step [s] that a law ``"thesis"`` depends on; without a simulation any."""
    return 1.0 if case.simulate is None or case.simulate.step is None else case.simulate.step
