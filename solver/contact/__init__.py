"""Contact of bodies, independent of how it was found: force laws and the solver of all contacts at once."""
