//! The smooth surface on models like those of the paper.

mod input;
mod models;
mod nets;
mod targets;
mod whole;
