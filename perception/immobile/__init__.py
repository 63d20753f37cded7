"""The immobile-area map of laser and camera: recognition decides what enters it."""
