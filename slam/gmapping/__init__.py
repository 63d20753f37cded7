"""GMapping: a Rao-Blackwellized particle filter that maps with a planar laser (Grisetti, Stachniss, Burgard 2007).

The path of a matched scan, file by file:

    tracking.py        where each scan, matched or not, has the robot on the best particle's map, beginning with the
                       odometry; where the map contradicts that, look around (alignment.py, fit_kernels.py)
    motion.py          odometry since the last matched scan: mean and covariance
    matcher.py         points thinned (thinning_kernel.py), start among samples of that covariance (search_kernels.py),
                       then Gauss-Newton steps on the distance to lines through mean hit points, odometry as a prior
                       (match_kernels.py); the result is the Gaussian of the improved proposal
    engine.py          draw from it, weigh, resample when few particles carry the weight (resampling.py)
    tile_maps.py       write the scan into each particle's counted cells, shared copy-on-write (tile_kernels.py)
    paths.py           remember where each particle came from
    path_covariance.py how far off the path may be by now
    reference.py       the kernels in plain numpy, for the tests

Where it leaves the original, and what that gave (relation error on Intel every 5th, ATE on ACES and Belgioioso,
30 particles; the original 0.056 m, 0.95 m, 0.122 m):
    - The alignment is point-to-line Gauss-Newton on the same cells instead of hill climbing: faster,
      and its normal equations are the covariance of the proposal, which the original's code does not sample.
    - It starts from the best of 128 samples of the odometry's error (256, and without a tracked start: 0.03, 0.3 and
      0.08 m; without any 0.077, 1.8 and 0.15 m).
    - Odometry errors keep their sign between matched scans (motion.py), and the odometry stays a prior of the match.
    - Scans are matched every 0.5 m or 0.3 rad (ROS: 1.0 m, 0.5 rad); points are thinned to one a cell, so that a wall
      beside the robot does not outvote one far ahead.
    - Every scan is followed on the best particle's map: headings between matched scans are right (full Intel and CSAIL
      logs 0.25 and 0.34 deg, left to the odometry 1 to 2.3), and an odometry that freezes, jumps or lags is noticed.
      A drive is matched where it has moved by its scans, not by what its odometry says.
    - `map()` draws a log-odds map anew from the best path and its scans: at any resolution (`map_at`), each cell
      updated once a scan. `live_map()` is the original's counted map.
"""
