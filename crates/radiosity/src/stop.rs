//! Ending long work early.

/// Asked now and then by long work, from any thread, whether to end: `true` once it should. It must be quick.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Work that goes on to its end.
pub const NEVER: Stop<'static> = &|| false;
