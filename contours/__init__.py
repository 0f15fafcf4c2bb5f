"""Surfaces of bodies that touch, and where they touch."""
