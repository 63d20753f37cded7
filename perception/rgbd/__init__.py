"""What an RGB-D camera on the robot sees: frames, planes, objects."""
