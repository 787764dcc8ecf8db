"""Reading of medical volumes into patient space."""
