"""From keys, sticks and fingers to what the robot shall do."""
