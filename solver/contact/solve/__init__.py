"""All contacts at once: impulses in the middle of the step and at its end, and what they do to the bodies."""
