"""Scenarios: drilling, needle and palpation without a device."""
