//! Made-up scans.
