"""Rust from interfaces: a crate without dependencies and unsafe code, which reads and writes CDR."""
