"""Descriptions: scenes as frozen dataclasses in SI units, independent of how they are integrated."""
