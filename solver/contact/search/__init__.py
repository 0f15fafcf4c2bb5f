"""Where a contour is touched: searches for points, balls, rings and primitives, and the rows of what they find."""
