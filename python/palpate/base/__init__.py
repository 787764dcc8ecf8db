"""What every other part stands on: errors, progress, the console, whole files, the state folder."""
