//! Resampling: bits on every instruction set, grey values and ramps against double precision.
