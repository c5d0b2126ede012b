//! The `spectral` command.

extern crate alloc;

mod command;

fn main() -> std::process::ExitCode {
    command::run()
}
