"""A class of students with a robot each: seats, permissions, and the runs they hand in."""
