"""What leg detector and tracker get wrong, as a statistical model: `people="modelled"`."""
