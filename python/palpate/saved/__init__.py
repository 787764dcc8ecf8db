"""What is kept on disk: scene files, the journal, autosaves and recent scans."""
