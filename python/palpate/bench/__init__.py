"""Benchmarks: what they measure, their goals, and their reports."""
