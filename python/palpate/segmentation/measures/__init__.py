"""What is measured of segments: volumes and values, agreement, landmarks, places on them."""
