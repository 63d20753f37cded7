"""Extended Kalman filters over landmarks: localization on a map of objects, and EKF-SLAM."""
