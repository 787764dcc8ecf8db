"""Benchmarks: what they measure, the goals they are held against, and how they report."""
