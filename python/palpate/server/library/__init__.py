"""Scans that pages find, upload and open: routes below ``/api/library``."""
