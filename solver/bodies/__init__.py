"""One kind of body a file."""
