"""What a run leaves on disk, read again: time histories, models, and statistics of channels."""
