"""Copies of ROS bags with topics added to them. All names are private; `copied_bag` in copied.py is what others use."""
