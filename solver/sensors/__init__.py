"""Sensors that watch several bodies: one type a file."""
