"""What happens at one contact: normal force, friction, restitution."""
