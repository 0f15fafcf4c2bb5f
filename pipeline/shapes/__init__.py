"""Simple shapes of surfaces: each file describes one, and makes its triangles."""
