"""Surfaces of triangles: trees, lists of pairs, swept tests, gaps of features."""
