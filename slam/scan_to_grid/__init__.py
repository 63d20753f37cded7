"""Matching scans to occupancy grids: prediction, thinning, correlative search and least squares on a spline."""
