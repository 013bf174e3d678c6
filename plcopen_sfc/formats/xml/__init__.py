"""What all XML formats share: safe parsing, the text of a source file, and minimal edits of it."""
