//! The bilinear product of colours in a fragment shader: an iridescent sphere, rendered off-screen.
//!
//! Section 7.3 of Granier and Damez (INRIA RR-5227, 2004) adds the product to a shader for a material whose colours change
//! with direction and component, where a matrix for each pair of components would be the alternative. Here the product's
//! text is written by [`write_operator`](spectral_core::bilinear::write_operator).

pub mod instructions;
pub mod model;
pub mod picture;
pub mod renderer;
pub mod shader;
