"""What every layer shares: compiled kernels and their cache, rotations, small blocks, outcomes."""
