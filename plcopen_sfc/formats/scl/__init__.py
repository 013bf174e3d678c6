"""External sources of Siemens SCL."""
