//! Naive oracles first, then answers known on paper.

mod baselines;
mod brute;
mod cache;
mod paper;
mod scenes;
