"""Stages of a run: mesh, modes, simulate, report; each skipped if it is up to date, and continued if it was stopped."""
