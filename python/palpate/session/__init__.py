"""Sessions: a scene, a device and the engine between them; tools, settings and recordings."""
