"""Tampered answers against the certificate: none may pass whose torque is wrong."""
