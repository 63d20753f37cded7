"""Graph SLAM of Cartographer's kind (Hess, Kohler, Rapp, Andor 2016): local submaps, loop closure, pose adjustment.

The path of a scan, file by file:

    engine.py                         predict, match, insert, add node, close loops: the order of all that follows
    ../local/local_slam.py            local SLAM: predict by odometry, match on the older growing submap
                                      (`scan_to_grid`), insert where the robot has moved (motion_filter.py,
                                      active_submaps.py, submap.py, sweep.py)
    ../local/switching_motion.py      whether the odometry tells the truth (odometry_soundness.py)
    ../local/match_monitor.py         notices scans that contradict the submap
    recovery/kidnap_recovery.py       where they do, one after the other: is the robot where it is thought to be
                                      (doubt.py), by the map of before (node_map.py)? If it turns out to be elsewhere,
                                      all since is taken back and mapped again there
    loops/drive_mapping.py            local SLAM, graph and record, which take scans and take them back
    loops/global_slam.py              an inserted scan is a node of the graph (submap_graph.py); it is matched with near
                                      submaps (loop_search.py, node_matching.py, constraints.py), and all poses are
                                      adjusted (optimisation.py)
    loops/final_optimisation.py       at the end of a drive: every node with every near submap, submaps straightened
    loops/trimming.py                 what was seen again often enough leaves the graph
    loops/drive_record.py             poses of all scans from those of the nodes (between_nodes.py)

Frames: odom (as reported), local (continuous, drifts), global or map (loop-closed); T_global_local joins the last two.
"""
