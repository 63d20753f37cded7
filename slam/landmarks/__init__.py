"""Objects in laser scans: four ways to cluster points, and mean, covariance and ellipse of each cluster."""
