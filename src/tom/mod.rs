//! Totally ordered mesh.
