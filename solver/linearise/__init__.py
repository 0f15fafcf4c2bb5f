"""Small motions of a scene about a state: matrices, eigenvalues, shapes of its modes."""
