//! Report of statistics over random missions.

pub mod html;
pub mod missions_csv;
pub mod summary;
pub mod text;
