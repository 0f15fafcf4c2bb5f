"""Criteria that a lift is judged by: each kind is one file with its keys and how it is judged."""
