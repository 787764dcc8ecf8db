"""The server: what pages load, ask for and are told."""
