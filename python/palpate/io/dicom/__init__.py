"""Reading of DICOM: headers, series, geometry and pixels."""
