"""The simulated building, its people, the robot and its sensors, as a Gymnasium environment."""
