//! Packages of Python with their versions, so that a new one cannot change what is tested.

/// Builder of the wheel, and what its tests use besides the packages of the step `exchange`.
pub(super) const TESTS: [&str; 8] = [
    "duckdb==2.0.1",
    "hypothesis==6.170.17",
    "maturin==1.16.0",
    "mypy==2.4.1",
    "pandas==3.1.1",
    "polars==2.1.0",
    "pyarrow==26.0.1",
    "pytest==9.2.0",
];

/// Linker of wheels for other systems than this one.
pub(super) const ZIG: [&str; 1] = ["ziglang==0.17.1"];

/// Spark, which brings its programs for Java.
pub(super) const SPARK: [&str; 1] = ["pyspark==4.3.0"];
