"""PLCopen TC6 XML 1.01, 2.0 and 2.01."""
