"""What the commands do: functions that are given a screen and return the exit code."""
