"""Where somebody is and goes, from echoes of sonars; pure."""
