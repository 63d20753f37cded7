"""People seen by the robot's sensors: legs, tracks, and the filter that keeps people out of maps."""
