//! The program's commands, settings and reports, and the house's own rules.

mod cli;
mod config;
mod controllers;
mod house;
mod logs;
mod outputs;
mod pages;
mod report;
mod strangers;
mod timing;
