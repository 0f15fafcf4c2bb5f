"""What only watches several bodies: one sort a file."""
