//! The frame log's writer.
