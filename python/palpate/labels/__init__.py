"""Segments from files: label maps, segmentations of Slicer and DICOM, contours, mask folders."""
