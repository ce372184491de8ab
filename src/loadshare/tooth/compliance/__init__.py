"""Compliance of one gear's teeth: from finite elements, or faster from coupled slices."""
