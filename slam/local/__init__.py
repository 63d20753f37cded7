"""Local SLAM: scans matched on the submaps that they fill, without loop closure."""
