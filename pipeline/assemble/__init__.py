"""From a case that has been read to what the solver integrates."""
