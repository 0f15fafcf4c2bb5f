"""A case that someone else advances: inputs, steps, outputs, states, copies."""
