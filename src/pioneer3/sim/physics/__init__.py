"""Robots with mass, motors and tires among walls with height, by MuJoCo."""
