"""Time: kinds of bodies and forces, the step, the integrators."""
