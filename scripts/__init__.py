"""The command line, figures, experiments and training."""
