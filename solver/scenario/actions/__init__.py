"""Actions of the phases of an operation: each is one file with its keys, its checks and what an actuator gets."""
