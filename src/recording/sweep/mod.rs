//! Delays over all settings: which of them move, with what, and which settings agree.
//!
//! A page per joint shows all its steps at all settings and stays as it is; a cursor on the
//! timeline `setting` (a tick per run) and one on `segment` (a tick per step) go through it.

mod map;
mod recording;
mod sheet;
mod swept;
mod words;
