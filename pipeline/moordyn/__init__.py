"""Dynamic tension of mooring lines by MoorDyn: its input, lines along a motion, a simulation coupled with it."""
