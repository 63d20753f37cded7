"""How followers are learned: demonstrations, imitation, reinforcement, export. Needs the extra `learn`."""
