"""The command line: words in; text, files and an exit code out. No mechanics."""
