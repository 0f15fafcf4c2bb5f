"""Loads of shells, one a file."""
