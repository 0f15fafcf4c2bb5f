"""Contact: force laws, the solver of all contacts at once, and the system of rows of contacts on contours."""
