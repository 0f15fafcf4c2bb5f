"""Phases of an operation in the loop: what waits for channels, commands winches, lets ropes go and takes them up."""
