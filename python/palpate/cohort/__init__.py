"""Cohorts: one recipe over many scans, each case in a process and a folder of its own."""
