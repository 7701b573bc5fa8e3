//! Points of many frames and their answers, block by block: CSV, arrays of NumPy, or Parquet.

mod answers;
mod block;
mod csv_header;
mod csv_rows;
mod frame_key;
mod image_list;
mod list_program;
mod npy_layout;
mod npy_rows;
mod parquet_answers;
mod parquet_column;
mod parquet_rows;
mod parquet_schema;
mod read_ahead;
mod source;

pub use answers::{AnsweredBlock, Flag, FrameAnswers, OutColumns};
pub use block::FrameBlock;
pub use csv_header::IdColumn;
pub use frame_key::FrameFinder;
pub use image_list::ImageList;
pub use list_program::ListProgram;
pub use read_ahead::FrameBlocks;
pub use source::{FrameSource, RowWriter};
