"""How one gear's teeth yield: from finite elements, or fast from coupled slices."""

from loadshare.tooth.compliance.interface import Compliance, Flank
from loadshare.tooth.compliance.middle import MiddleSurface

__all__ = ["Compliance", "Flank", "MiddleSurface"]
