"""TypeScript from interfaces: ES modules without dependencies, which read and write CDR."""
