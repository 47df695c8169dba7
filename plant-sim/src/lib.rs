//! What does the physical world do? Event-driven simulator of PWM-driven on/off solenoid valves and a pressure chamber.
