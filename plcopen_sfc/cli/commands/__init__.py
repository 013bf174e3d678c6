"""The commands, one module each: ``run(screen, ..) -> exit code``."""
