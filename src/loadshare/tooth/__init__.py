"""Tooth geometry, contact without load and loaded tooth contact analysis of a gear pair."""

from loadshare.tooth.law.meshes import affects_laws, resolve, with_own_laws, written_in

__all__ = ["affects_laws", "resolve", "with_own_laws", "written_in"]
