"""ROS 2 over Zenoh, on the wire as rmw_zenoh_cpp."""
