"""Series of DICOMweb services: searching (QIDO-RS) and fetching (WADO-RS)."""
