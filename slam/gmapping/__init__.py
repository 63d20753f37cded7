"""GMapping: the Rao-Blackwellized particle filter of Grisetti, Stachniss and Burgard (2007)."""
