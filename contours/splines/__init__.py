"""Contours as splines: made, evaluated, and searched for the point that is touched."""
