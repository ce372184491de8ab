"""Critical values of random paths against dense scans."""
