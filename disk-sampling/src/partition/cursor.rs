//! The walk through a hierarchy.

use spectral_core::Real;

use super::{Label, MAX_DEPTH, Method, PartitionError, Subsource};
use crate::shape::Disk;

/// An iterator over the subsources of a disk, in the order of their labels; nothing is stored but the label that is
/// next.
#[derive(Clone, Debug)]
pub struct Partition<R> {
    method: Method,
    levels: u32,
    /// The receiver in disk radii and the threshold; without them, everything is subdivided to the last level.
    criterion: Option<([R; 3], R)>,
    next: Option<Label>,
}

impl<R: Real> Partition<R> {
    /// All parts of a depth: [`Method::parts`] of them. Depth 0 is the undivided disk.
    ///
    /// # Errors
    /// [`PartitionError::Depth`] above [`MAX_DEPTH`].
    pub const fn full(method: Method, depth: u32) -> Result<Self, PartitionError> {
        if depth > MAX_DEPTH {
            return Err(PartitionError::Depth);
        }
        Ok(Self { method, levels: method.levels(depth), criterion: None, next: Some(Label::root(method)) })
    }

    /// The parts that algorithms 2.1 and 2.2 leave: a part is subdivided while its [extent](Subsource::extent) over the
    /// distance from the receiver to its [position](Subsource::position) is above `threshold` (`-ds`) and the depth
    /// allows it ([`Method::parts`]). Before it is mapped, for [`Method::MappedSquare`], as Radiance does it.
    /// `threshold` 0 switches subdivision off.
    ///
    /// # Errors
    /// [`PartitionError::Depth`] above [`MAX_DEPTH`], [`PartitionError::Threshold`] for a threshold that is negative or
    /// not finite, [`PartitionError::NotFinite`] for such a receiver.
    pub fn adaptive(
        method: Method,
        depth: u32,
        disk: &Disk<R>,
        receiver: [R; 3],
        threshold: R,
    ) -> Result<Self, PartitionError> {
        if !(threshold >= R::ZERO && threshold.is_finite()) {
            return Err(PartitionError::Threshold);
        }
        if !receiver.iter().all(|x| x.is_finite()) {
            return Err(PartitionError::NotFinite);
        }
        let mut partition = Self::full(method, depth)?;
        partition.criterion = Some((disk.local(receiver), threshold));
        Ok(partition)
    }

    /// Writes the subsources to the caller's buffer and returns how many there are.
    ///
    /// # Errors
    /// [`PartitionError::Buffer`] with their number when the buffer is smaller; it is then full of the first ones.
    pub fn write(self, buffer: &mut [Subsource<R>]) -> Result<usize, PartitionError> {
        let mut written = 0;
        let mut needed = 0;
        for subsource in self {
            if let Some(slot) = buffer.get_mut(written) {
                *slot = subsource;
                written += 1;
            }
            needed += 1;
        }
        if needed > written as u64 { Err(PartitionError::Buffer { needed }) } else { Ok(written) }
    }

    fn is_too_large(&self, label: Label) -> bool {
        let Some(([x, y, z], threshold)) = self.criterion else { return true };
        let method = if self.method == Method::MappedSquare { Method::Square } else { self.method };
        let part = Subsource::new(method, label);
        let [u, v]: [R; 2] = part.position();
        let distance = (u - x).hypot(v - y).hypot(z);
        threshold > R::ZERO && part.extent() > threshold * distance
    }
}

impl<R: Real> Iterator for Partition<R> {
    type Item = Subsource<R>;

    fn next(&mut self) -> Option<Subsource<R>> {
        let mut label = self.next?;
        while label.level() < self.levels && self.is_too_large(label) {
            label = label.child(0)?;
        }
        self.next = label.successor();
        Some(Subsource::new(self.method, label))
    }
}
