"""Surfaces of triangles: from files and simple shapes, cleaned, refined, cut and reported."""
