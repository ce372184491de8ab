"""Steps of a march: friction that remembers its slip."""
