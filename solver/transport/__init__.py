"""Roads, and vehicles that roll over them on bogies whose cylinders share their oil."""
