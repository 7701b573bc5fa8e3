//! The functions of the page against those of the PC.

#[cfg(test)]
mod budget;
#[cfg(test)]
mod storage;
