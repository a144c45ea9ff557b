"""The driver: sessions, limits, snapshots, reconnecting."""
