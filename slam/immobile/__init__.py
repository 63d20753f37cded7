"""The immobile-area map: layers of evidence from laser and camera (Ye et al., immobile area grid map)."""
