"""Systems of rows: what joints, springs and ropes write, assembled, factored and solved in a step."""
