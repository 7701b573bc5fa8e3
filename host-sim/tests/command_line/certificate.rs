//! The certificate: what it states, who may change it, and what its check finds.

mod bench;
mod checked;
mod details;
mod numbers;
