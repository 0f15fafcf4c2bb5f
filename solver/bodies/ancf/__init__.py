"""Bodies of ANCF elements: frames and shells with large deformation."""
