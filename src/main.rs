//! The program: parse, choose the command, print the error chain, exit code.
fn main() {}
