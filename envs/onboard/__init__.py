"""The robot's onboard stack: people tracker, leader, map and camera; sensors go in, beliefs come out."""
