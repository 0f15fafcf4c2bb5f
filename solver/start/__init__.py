"""Before time starts: what joints leave free or hold twice, and starts that fit them."""
