"""ROS 2 over rclpy, DDS or Zenoh."""
