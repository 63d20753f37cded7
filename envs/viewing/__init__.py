"""Moments of an episode shown in a viewer: written into a recording, or live. All names are private."""
