"""From keys and sticks to commands."""
