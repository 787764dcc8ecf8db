"""Scenarios: drilling, needle insertion and palpation without a device."""
