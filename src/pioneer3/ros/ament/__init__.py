"""The ROS 2 package that `ros2 run` and `ros2 launch` find, without a build."""
