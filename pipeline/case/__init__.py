"""Case files: their tables, checked with file, key and value, and what is made of the descriptions of kinds."""
