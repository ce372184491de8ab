"""How one gear's teeth yield: from finite elements, or fast from coupled slices."""
