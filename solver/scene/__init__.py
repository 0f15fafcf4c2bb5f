"""What a user says: scenes as frozen dataclasses in SI units, without a word of how they are integrated."""
