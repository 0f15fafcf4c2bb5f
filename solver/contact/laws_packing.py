"""Laws of contacts as numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.contact import layout as told
from heavylift.solver.contact.kind import DAMPING, EXPONENT, REST_SPEED, RESTITUTION, STIFFNESS
from heavylift.solver.contacts import ContactLaw, HertzLaw, HuntCrossleyLaw, LinearLaw, RigidLaw

__all__ = ["force_law", "put_law"]


def force_law(law: ContactLaw) -> int:
    """Number of a compliant law for the solver."""
    kinds: dict[type, int] = {
        LinearLaw: told.LINEAR,
        HertzLaw: told.HERTZ,
        HuntCrossleyLaw: told.HUNT_CROSSLEY,
    }
    return kinds[type(law)]


def put_law(law: ContactLaw, values: NDArray[np.float64]) -> None:
    """Numbers of a law into the values of a contact."""
    if isinstance(law, RigidLaw):
        values[RESTITUTION], values[REST_SPEED] = law.restitution, law.rest_speed
    elif isinstance(law, LinearLaw):
        values[STIFFNESS], values[DAMPING], values[EXPONENT] = law.stiffness, law.damping, 1.0
    elif isinstance(law, HertzLaw):
        values[STIFFNESS], values[EXPONENT] = law.stiffness, 1.5
    elif isinstance(law, HuntCrossleyLaw):
        values[STIFFNESS], values[EXPONENT], values[RESTITUTION] = (
            law.stiffness,
            law.exponent,
            law.restitution,
        )
