"""ROS 2 by the installation of ROS on this computer: any middleware, by rclpy."""
