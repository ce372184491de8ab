"""Tampered answers against the certificate: none may pass with a wrong torque."""
