//! The command line: arguments, commands, exit codes. The names are a contract (README, "Commands").
