"""Flexible bodies with modes in a floating frame."""
