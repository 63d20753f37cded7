"""Graph SLAM of Cartographer's kind (Hess, Kohler, Rapp, Andor 2016): local submaps, loop closure, pose adjustment.

The path of a scan, file by file:

    engine.py                         predict, match, insert, add node, close loops: the order of all that follows
    local/local_slam.py               local SLAM: predict by odometry, match on the older growing submap
                                      (`scan_to_grid`), insert where the robot has moved (motion_filter.py,
                                      active_submaps.py, submap.py, sweep.py)
    local/match_monitor.py            rejects matches where the scan contradicts the submap
    recovery/kidnap_recovery.py       after rejected matches, or where a scan is inconsistent with the one before
                                      (scan_consistency.py): collect scans (kidnap_hypothesis.py), compare the place
                                      with all others (place_comparison.py), decide (verdict.py), and begin a drive
                                      segment that relocalization.py places on the map (node_map.py) again
    loops/global_slam.py              an inserted scan is a node of the graph (submap_graph.py); it is matched with near
                                      submaps (loop_schedule.py, node_matching.py, constraints.py), and all poses are
                                      adjusted (optimisation.py)
    loops/final_optimisation.py       at the end of a drive: every node with every near submap, submaps straightened
    loops/trimming.py                 what was seen again often enough leaves the graph
    loops/drive_record.py             poses of all scans from those of the nodes (between_nodes.py)

Frames: odom (as reported), local (continuous, drifts), global or map (loop-closed); T_global_local joins the last two.
"""
