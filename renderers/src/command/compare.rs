//! `spectral compare`: how far two pictures are apart.
use clap::Args;
use super::{Answer, Failure};
#[derive(Debug, Args)]
pub(super) struct Arguments {
}
impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> { Err(Failure("x".into())) }
}
