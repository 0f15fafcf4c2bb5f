"""Hydrodynamic databases: read, computed, checked, and the memory of radiated waves that follows from them."""
