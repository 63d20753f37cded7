"""From leg detections to people with an identity."""
