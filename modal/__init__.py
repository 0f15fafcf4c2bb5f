"""A finite element model becomes a small set of deformation shapes."""
