"""Rows with a law: ropes, springs, stops, friction and motors."""
