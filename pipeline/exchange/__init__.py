"""A simulation that another process drives: the message format, the server, and clients in Python and C."""
