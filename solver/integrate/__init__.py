"""One integrator a file."""
