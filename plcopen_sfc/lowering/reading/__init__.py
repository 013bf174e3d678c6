"""Reading a chart for lowering."""
