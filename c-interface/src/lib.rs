//! The C interface of `spectral-core` and `disk-sampling`; what it offers is written in `include/spectral.h`.
//!
//! Every function is there for `float` (`_f32`) and for `double` (`_f64`), gives the bits that the Rust function gives, and does
//! three things beside calling it: it checks pointers, lengths and numbers; it answers with a [`SpectralStatus`]; and it
//! writes nothing unless that is `Ok`.
//!
//! Each module has generic functions over raw pointers, and a list of their exported names. The header is generated from
//! that list by `cargo test --release --test header`.
#![cfg_attr(target_os = "none", no_std)]
#![allow(
    unsafe_op_in_unsafe_fn,
    clippy::missing_safety_doc,
    clippy::too_many_arguments,
    reason = "every function is a boundary to C: the header's rules for pointers are the contract of all of them, and C has no slices"
)]
#![allow(rustdoc::broken_intra_doc_links, reason = "what is exported is documented for Doxygen: its [out] is no link")]

mod boundary;
mod codes;
mod colour;
mod disk;
mod factor;
mod light;
mod operators;
mod product;
mod reflectance;
mod spectrum;

pub use boundary::{SpectralStatus, spectral_status_text};
pub use codes::{
    SpectralCctStatus, SpectralEstimateStatus, SpectralEvaluationStatus, SpectralMode, SpectralObserver,
    SpectralOutside, SpectralPartition, SpectralRgbSpace, SpectralSmits, SpectralTensorKind, SpectralWardModel,
};
pub use colour::*;
pub use disk::*;
pub use factor::*;
pub use light::*;
pub use operators::*;
pub use product::*;
pub use reflectance::*;
pub use spectrum::*;

#[cfg(all(target_os = "none", not(feature = "panic-gate")))]
#[panic_handler]
fn halt(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(all(target_os = "none", feature = "panic-gate"))]
#[panic_handler]
fn gate(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn spectral_has_a_way_to_panic() -> !;
    }
    unsafe { spectral_has_a_way_to_panic() }
}
