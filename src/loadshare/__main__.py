"""`python -m loadshare`: the command line."""

from loadshare.cli.main import main

if __name__ == "__main__":
    main()
