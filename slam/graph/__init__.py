"""Graph SLAM of Cartographer's kind (Hess et al. 2016): local submaps, loop closure, pose adjustment."""
