"""What rigid bodies, hulls and bodies with modes share: a frame that moves, and those whose motion is given."""
