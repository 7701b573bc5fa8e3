//! Programs and their files, one module each: a writer of the file, and a reader of it.

pub(crate) mod australis;
pub(crate) mod colmap;
mod conventions;
pub(crate) mod dji;
pub(crate) mod inpho;
pub(crate) mod kalibr;
pub(crate) mod metashape;
pub(crate) mod micmac;
pub mod model;
mod name;
pub(crate) mod opencv;
pub(crate) mod opensfm;
pub(crate) mod opentrackio;
pub(crate) mod opf;
pub(crate) mod photomodeler;
pub(crate) mod pix4d;
pub(crate) mod ros;
pub(crate) mod usgs;

pub use conventions::Conventions;
pub use name::Program;
pub use opencv::Container;
