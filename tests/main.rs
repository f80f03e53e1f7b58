
mod mbs;
