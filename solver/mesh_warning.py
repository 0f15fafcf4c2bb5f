"""What the user should know of how frames and shells were stepped."""

from __future__ import annotations

from heavylift.solver.layout import Layout

__all__ = ["explicit_limit", "mesh_warning"]


LARGEST_RINGING = 0.05
"""Energy of what rings over the largest of the motion that is worth a warning."""


def mesh_warning(layout: Layout) -> str:
    """Meshes whose carried strains drifted too far, as a sentence; empty if none.

    Parameters
    ----------
    layout
        Packed scene after a run. Scenes without meshes import nothing for this.
    """
    parts = []
    for kind in layout.bodies:
        if "strain" not in kind._fields:
            continue
        from heavylift.solver.bodies.ancf.kind import CARRIED

        for line, numbers in zip(kind.table, kind.body, strict=True):
            name = layout.body_names[line.number]
            if numbers.largest_ringing > LARGEST_RINGING * numbers.largest_motion:
                share = numbers.largest_ringing / numbers.largest_motion
                parts.append(
                    f"{name!r} rings: velocities at the ends of steps change their sign from step to step, with up to"
                    f" {share:.1%} of the largest energy of its motion; recorded velocities and kinetic energies have"
                    " it, its path and the forces on it have not: take a smaller step, or more damping"
                )
            if numbers.changed_over:
                parts.append(
                    f"{name!r} changed over to the energy-momentum scheme at t = {numbers.change_time:.6g} s,"
                    f" where its carried strains had drifted by more than {numbers.drift_tolerance:g}"
                )
            elif line.scheme == CARRIED and numbers.largest_drift > numbers.drift_tolerance:
                parts.append(
                    f"the carried strains of {name!r} drifted by up to {numbers.largest_drift:.3g} from those of its"
                    " shape: its stresses are wrong by as much times the modulus; take a smaller step, or elasticity"
                    " 'auto'"
                )
    return "; ".join(parts)


def explicit_limit(layout: Layout) -> str:
    """What would have helped the body that stopped, if its step was explicit; empty if not.

    Parameters
    ----------
    layout
        Packed scene whose status names the body.
    """
    for kind in layout.bodies:
        if "strain" not in kind._fields:
            continue

        for line, numbers in zip(kind.table, kind.body, strict=True):
            if line.number == layout.work.status.body:
                return f"a step below {numbers.step_limit:.3g} s, the limit of explicit elastic forces"
    return ""
