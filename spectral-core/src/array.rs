//! Component by component, without indices: no bounds are left to check, however little a compiler inlines.

/// `f` of the components of two vectors.
#[inline(always)]
pub(crate) fn zip<A, B, C>([a0, a1, a2]: [A; 3], [b0, b1, b2]: [B; 3], mut f: impl FnMut(A, B) -> C) -> [C; 3] {
    [f(a0, b0), f(a1, b1), f(a2, b2)]
}

/// The columns of a matrix as rows.
#[inline(always)]
pub(crate) fn transposed<A>([[a, b, c], [d, e, f], [g, h, i]]: [[A; 3]; 3]) -> [[A; 3]; 3] {
    [[a, d, g], [b, e, h], [c, f, i]]
}
