"""A second, planar simulator: buildings, lasers, drives and people drawn at random, without MuJoCo."""
