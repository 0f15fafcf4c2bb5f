"""Numbers that results are judged by: quantities, reference values and histories, studies of convergence."""
