"""Who may come in, and what they may do: pairing, roles, sessions, host names, certificates."""
