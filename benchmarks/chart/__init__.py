"""Speed against accuracy: measured side by side, drawn, and reported."""
