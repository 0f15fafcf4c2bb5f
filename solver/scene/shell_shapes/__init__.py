"""Outlines of shells: each file describes one, and cuts it into elements."""
