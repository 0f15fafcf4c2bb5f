"""One type of joint a file."""
