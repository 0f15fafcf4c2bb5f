"""Lines of frames: each file describes one, and cuts it into elements."""
