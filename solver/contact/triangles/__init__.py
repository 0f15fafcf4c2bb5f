"""Pairs of surfaces of triangles: their contacts come and go."""
