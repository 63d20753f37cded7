"""Global SLAM: the pose graph of submaps and scans, the search for loop closures, and the adjustment."""
