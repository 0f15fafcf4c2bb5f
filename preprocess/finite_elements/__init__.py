"""Solids become meshes, and meshes matrices of stiffness and mass; data of other programs are read."""
