"""Inputs: numbers that are set from outside while a scene runs, and what they drive; each type is a description."""
