"""Geometry and data become meshes and finite element matrices."""
