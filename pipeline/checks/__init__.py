"""Numbers that results are judged by: quantities, references, criteria of lifts, studies of convergence."""
