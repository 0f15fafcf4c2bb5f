"""Mooring lines and fenders."""
