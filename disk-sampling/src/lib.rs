//! Disk lights: subdivision, sampling and closed-form illuminance: `no_std`, no heap, no panic, `libm` only.
#![no_std]
