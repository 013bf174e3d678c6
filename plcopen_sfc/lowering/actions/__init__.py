"""What lowered code executes, and when."""
