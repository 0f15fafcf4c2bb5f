"""Scenes that run apart and exchange forces and positions: how they meet, and whether that is stable."""
