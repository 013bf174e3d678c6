"""The commands: functions that are given a screen and return the exit code."""
