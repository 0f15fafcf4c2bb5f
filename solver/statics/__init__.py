"""Where a scene comes to rest: equilibrium before time starts."""
