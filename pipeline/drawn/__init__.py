"""One scene to draw, made of what things answer and of records: pictures, the page and exported files show it."""
