"""What holds for all tests."""

import os
from pathlib import Path

# Mesh laws that tests compute stay out of the user's cache.
os.environ["LOADSHARE_CACHE"] = str(Path(__file__).parent.parent / ".pytest_cache" / "laws")
