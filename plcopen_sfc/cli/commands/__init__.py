"""What the commands do, one module each: ``run(screen, ..) -> exit code``."""
