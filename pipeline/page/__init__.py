"""The interactive page of a report: a scene in time, plots beside it, and the same scene for other programs."""
