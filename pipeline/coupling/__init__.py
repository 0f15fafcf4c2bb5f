"""Systems that advance side by side and exchange inputs and outputs: scenes, and functional mock-up units of others."""
