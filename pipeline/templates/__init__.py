"""Cases to begin with, a folder each, that ``heavylift new`` copies; their comments teach the case file."""
