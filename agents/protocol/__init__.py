"""What every follower is, scripted or learned, and how one that was told nothing learns its environment's scales."""
