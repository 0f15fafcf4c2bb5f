"""Laws of contacts as numbers."""

from __future__ import annotations

from heavylift.solver.contact import layout
from heavylift.solver.contact.kind import ContactValues
from heavylift.solver.scene.contacts import ContactLaw, HertzLaw, HuntCrossleyLaw, LinearLaw, RigidLaw

__all__ = ["force_law", "put_law"]


def force_law(law: ContactLaw) -> int:
    """Number of a compliant law for the solver."""
    kinds: dict[type, int] = {
        LinearLaw: layout.LINEAR,
        HertzLaw: layout.HERTZ,
        HuntCrossleyLaw: layout.HUNT_CROSSLEY,
    }
    return kinds[type(law)]


def put_law(law: ContactLaw, values: ContactValues) -> None:
    """Numbers of a law into the values of a contact."""
    if isinstance(law, RigidLaw):
        values.restitution, values.rest_speed = law.restitution, law.rest_speed
    elif isinstance(law, LinearLaw):
        values.stiffness, values.damping, values.exponent = law.stiffness, law.damping, 1.0
    elif isinstance(law, HertzLaw):
        values.stiffness, values.exponent = law.stiffness, 1.5
    elif isinstance(law, HuntCrossleyLaw):
        values.stiffness, values.exponent, values.restitution = (
            law.stiffness,
            law.exponent,
            law.restitution,
        )
