"""Messages between a session and its pages: one file per subject, and the table of handlers."""
