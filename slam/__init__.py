"""Ground floor: geometry, scans, grids, matching, SLAM engines, map quality and logs."""
