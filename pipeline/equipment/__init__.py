"""Builders of lifting equipment: a table of a dozen lines that stands for bodies, joints and ropes of the same case."""
