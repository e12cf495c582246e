//! glTF files made in memory: what is read is what was written, what is damaged is named.

mod document;
mod geometry;
mod materials;
mod nodes;
mod refusals;
