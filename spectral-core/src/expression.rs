//! The rendering expression: a flat postfix program of sums, scalings, products and Schlick terms over spectra.
//!
//! A program is checked once, when a [`Program`] is made of it; evaluating it for one interval is then one linear pass over
//! a stack that the caller owns. Leaves are spectra known beforehand ([`Sources::leaf`]); *deferred* leaves
//! ([`Sources::deferred`]) are found out only when an interval is asked for: light that was refracted, or a caustic
//! (Iehl–Péroche §2, §4).

use crate::Real;
use crate::interval::{Interval, Node, Weight};

/// One instruction of a postfix program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op<R> {
    /// Pushes the spectrum of this number.
    Leaf(u32),
    /// Pushes the deferred spectrum of this number.
    Deferred(u32),
    /// Multiplies the topmost spectrum by a finite number.
    Scale(R),
    /// Replaces the two topmost spectra by their sum.
    Sum,
    /// Replaces the two topmost spectra by their product.
    Product,
    /// Replaces the topmost spectrum C by Schlick's C + (1 − C) f, f in [0, 1].
    Schlick(R),
}

/// Where a program's spectra come from.
pub trait Sources<R: Real> {
    /// The spectrum of a leaf on a part of the visible domain; `None` when there is no such leaf or part.
    fn leaf(&self, id: u32, node: Node) -> Option<&Interval<R>>;

    /// The spectrum of a deferred leaf on a part of the visible domain; `None` when there is no such leaf or part.
    fn deferred(&mut self, id: u32, node: Node) -> Option<Interval<R>> {
        let _ = (id, node);
        None
    }
}

/// The leaves of a program are the spectra of a slice.
impl<R: Real> Sources<R> for &[crate::interval::Pyramid<'_, R>] {
    fn leaf(&self, id: u32, node: Node) -> Option<&Interval<R>> {
        self.get(usize::try_from(id).ok()?)?.get(node)
    }
}

/// Why a program was refused, or could not be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExpressionError {
    /// The program is empty, or leaves more than one spectrum on the stack.
    Unbalanced,
    /// The instruction at this place finds too few spectra on the stack.
    Underflow {
        /// Place of the instruction, from 0.
        index: usize,
    },
    /// The instruction at this place has a factor that is not finite, or a Schlick factor outside [0, 1].
    Factor {
        /// Place of the instruction, from 0.
        index: usize,
    },
    /// The caller's stack is smaller than [`Program::stack_size`].
    StackTooSmall {
        /// How many entries are needed.
        needed: usize,
    },
    /// The sources have no such spectrum on the interval asked for.
    MissingSource {
        /// The number of the leaf.
        id: u32,
    },
    /// A buffer for pieces of the visible domain has no entry.
    NoPieces,
}

impl core::fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unbalanced => write!(f, "the program does not leave exactly one spectrum"),
            Self::Underflow { index } => {
                write!(f, "instruction {index} finds too few spectra on the stack")
            }
            Self::Factor { index } => {
                write!(f, "instruction {index} has a factor outside its domain")
            }
            Self::StackTooSmall { needed } => {
                write!(f, "the stack is too small: {needed} entries are needed")
            }
            Self::MissingSource { id } => {
                write!(f, "there is no spectrum number {id} on the interval asked for")
            }
            Self::NoPieces => write!(f, "the buffer for pieces is empty"),
        }
    }
}

impl core::error::Error for ExpressionError {}

/// How products are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// To first order, without radii: Iehl and Péroche's operators.
    First,
    /// With the second-order term and a radius that holds.
    Certified,
}

/// A checked postfix program.
#[derive(Clone, Copy, Debug)]
pub struct Program<'a, R> {
    ops: &'a [Op<R>],
    stack_size: usize,
}

impl<'a, R: Real> Program<'a, R> {
    /// Checks a program.
    ///
    /// # Errors
    /// [`ExpressionError::Unbalanced`], [`ExpressionError::Underflow`] and [`ExpressionError::Factor`].
    pub fn new(ops: &'a [Op<R>]) -> Result<Self, ExpressionError> {
        let mut height = 0_usize;
        let mut stack_size = 0;
        for (index, op) in ops.iter().enumerate() {
            let takes = match op {
                Op::Leaf(_) | Op::Deferred(_) => 0,
                Op::Scale(_) | Op::Schlick(_) => 1,
                Op::Sum | Op::Product => 2,
            };
            let in_domain = match *op {
                Op::Scale(factor) => factor.is_finite(),
                Op::Schlick(fresnel) => fresnel >= R::ZERO && fresnel <= R::ONE,
                _ => true,
            };
            if !in_domain {
                return Err(ExpressionError::Factor { index });
            }
            height = height.checked_sub(takes).ok_or(ExpressionError::Underflow { index })? + 1;
            stack_size = stack_size.max(height);
        }
        if height == 1 { Ok(Self { ops, stack_size }) } else { Err(ExpressionError::Unbalanced) }
    }

    /// The instructions.
    pub const fn ops(&self) -> &'a [Op<R>] {
        self.ops
    }

    /// How many entries the stack needs.
    pub const fn stack_size(&self) -> usize {
        self.stack_size
    }

    /// The program's spectrum on one part of the visible domain.
    ///
    /// # Errors
    /// [`ExpressionError::StackTooSmall`] and [`ExpressionError::MissingSource`].
    pub fn evaluate<S: Sources<R> + ?Sized>(
        &self,
        node: Node,
        weight: &Weight<R>,
        order: Order,
        sources: &mut S,
        stack: &mut [Interval<R>],
    ) -> Result<Interval<R>, ExpressionError> {
        let small = ExpressionError::StackTooSmall { needed: self.stack_size };
        let mut top = 0_usize;
        for op in self.ops {
            let (place, value) = match *op {
                Op::Leaf(id) => (top, *sources.leaf(id, node).ok_or(ExpressionError::MissingSource { id })?),
                Op::Deferred(id) => (top, sources.deferred(id, node).ok_or(ExpressionError::MissingSource { id })?),
                Op::Scale(_) | Op::Schlick(_) => {
                    let place = top.checked_sub(1).ok_or(small)?;
                    (place, unary(*op, stack.get(place).ok_or(small)?, weight, order))
                }
                Op::Sum | Op::Product => {
                    let place = top.checked_sub(2).ok_or(small)?;
                    let (left, right) = (stack.get(place).ok_or(small)?, stack.get(place + 1).ok_or(small)?);
                    (place, binary(*op, left, right, weight, order))
                }
            };
            *stack.get_mut(place).ok_or(small)? = value;
            top = place + 1;
        }
        stack.first().copied().ok_or(small)
    }
}

#[inline]
fn unary<R: Real>(op: Op<R>, operand: &Interval<R>, weight: &Weight<R>, order: Order) -> Interval<R> {
    match (op, order) {
        (Op::Scale(factor), Order::First) => operand.scale_first_order(factor),
        (Op::Scale(factor), Order::Certified) => operand.scale(factor, weight),
        (Op::Schlick(fresnel), Order::First) => operand.schlick_first_order(fresnel),
        (Op::Schlick(fresnel), Order::Certified) => operand.schlick(fresnel, weight),
        _ => *operand,
    }
}

#[inline]
fn binary<R: Real>(
    op: Op<R>,
    left: &Interval<R>,
    right: &Interval<R>,
    weight: &Weight<R>,
    order: Order,
) -> Interval<R> {
    match (op, order) {
        (Op::Product, Order::First) => left.product_first_order(right),
        (Op::Product, Order::Certified) => left.product(right, weight),
        (_, Order::First) => left.sum_first_order(right),
        (_, Order::Certified) => left.sum(right, weight),
    }
}
