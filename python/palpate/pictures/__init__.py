"""Pictures of scans, drawn by the engine: cameras, appearances, and what is made of them."""
