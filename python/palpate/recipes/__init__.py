"""Recipes: a whole pipeline described in one YAML file."""
