//! Where does the model fail, and which effect is missing? Comparison of a plant model with measurements.
