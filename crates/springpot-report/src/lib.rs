//! Figures of Springpot results.
