"""Measurements; run them with scripts/bench. Nothing here is a test."""
