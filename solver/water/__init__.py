"""What water and air do to bodies."""
