"""Cables and chains as masses on a line with springs between them."""
