"""Loads of frames, one a file."""
