"""Reading and writing of recorded drives, trajectories and maps."""
