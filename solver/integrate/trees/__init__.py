"""Trees of rigid bodies in joint coordinates, in the accurate integrator."""
