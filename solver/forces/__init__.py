"""One kind of force a file."""
