//! What comes out of a run: rows, the sinks that take them, the summary and the timing.

pub mod csv_sink;
pub mod frame;
pub mod number;
pub mod parquet_sink;
pub mod parquet_table;
pub mod summary;
pub mod table_format;
