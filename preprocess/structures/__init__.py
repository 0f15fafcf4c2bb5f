"""Plates, stiffeners and frames as finite elements: linear shells and beams, rigid elements, masses."""
