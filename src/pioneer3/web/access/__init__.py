"""Access to the page: pairing, roles, sessions, rate limits, host names, certificates."""
