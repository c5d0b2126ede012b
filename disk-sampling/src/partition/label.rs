//! Where a part is in the hierarchy, as a number: labels and what follows from them in constant time.

use super::Method;

/// The label of a part: its level, its sector of the hexagon, and one digit per further subdivision (two bits for the
/// quarters of a triangle, numbered as by Lee and Samet 1998 and in fig. 2.3 of the thesis: 0, 1, 3 at the corners, 2
/// in the middle; one bit for the halves of a square).
///
/// Position, next label, parent, children and neighbours all follow from the bits with a fixed number of word
/// operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Label {
    sector: u8,
    level: u8,
    path: u32,
    triangular: bool,
}

/// A side of a triangle by the corner opposite to it, in the numbering of the digits; parts that share a side call it
/// the same, but for parts of different sectors, where what is `One` to the earlier sector is `Three` to the later one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Opposite to corner 0: in upright triangles, the side away from the disk's centre.
    Zero,
    /// Opposite to corner 1.
    One,
    /// Opposite to corner 3.
    Three,
}

impl Side {
    /// The three sides.
    pub const ALL: [Self; 3] = [Self::Zero, Self::One, Self::Three];
}

/// The bits at even places.
const EVEN: u32 = 0x5555_5555;

impl Label {
    /// The undivided disk.
    pub const fn root(method: Method) -> Self {
        Self { sector: 0, level: 0, path: 0, triangular: method.is_triangular() }
    }

    pub(crate) const fn is_triangular(self) -> bool {
        self.triangular
    }

    /// How many subdivisions lead here; 0 for the undivided disk, 1 for a sector of the hexagon or half of a square.
    pub const fn level(self) -> u32 {
        self.level as u32
    }

    /// The sector of the hexagon, 0 to 5; 0 for squares.
    pub const fn sector(self) -> usize {
        self.sector as usize
    }

    /// The digits, the first subdivision's highest: two bits each for triangles, one for squares.
    pub const fn path(self) -> u32 {
        self.path
    }

    /// How many children a subdivision makes: six sectors, four quarters or two halves.
    pub const fn children(self) -> u8 {
        match (self.triangular, self.level) {
            (true, 0) => 6,
            (true, _) => 4,
            (false, _) => 2,
        }
    }

    /// A child by its number (taken modulo their number); `None` where the label is full.
    pub const fn child(self, number: u8) -> Option<Self> {
        let number = number % self.children();
        let level = self.level + 1;
        if level > if self.triangular { 16 } else { 31 } {
            return None;
        }
        Some(match (self.triangular, self.level) {
            (true, 0) => Self { sector: number, level, ..self },
            (true, _) => Self { level, path: self.path << 2 | number as u32, ..self },
            (false, _) => Self { level, path: self.path << 1 | number as u32, ..self },
        })
    }

    /// The part that this one was split from; `None` for the undivided disk.
    pub const fn parent(self) -> Option<Self> {
        match (self.triangular, self.level) {
            (_, 0) => None,
            (true, 1) => Some(Self { sector: 0, level: 0, ..self }),
            (true, _) => Some(Self { level: self.level - 1, path: self.path >> 2, ..self }),
            (false, _) => Some(Self { level: self.level - 1, path: self.path >> 1, ..self }),
        }
    }

    /// The largest part that begins where this one ends, in the order of the labels; `None` after the last.
    ///
    /// Adding one to the digits carries over those that were the last child; these are then cut off.
    pub const fn successor(self) -> Option<Self> {
        if self.level == 0 {
            return None;
        }
        let bits = if self.triangular { 2 } else { 1 };
        let digits = if self.triangular { self.level as u32 - 1 } else { self.level as u32 };
        let next = self.path as u64 + 1;
        let zeros = next.trailing_zeros() / bits;
        if zeros < digits {
            // The carry stopped within the digits: what is left fits where the path was.
            let path = self.path.wrapping_add(1) >> (zeros * bits);
            #[allow(clippy::cast_possible_truncation, reason = "below the number of digits, at most 31")]
            return Some(Self { level: self.level - zeros as u8, path, ..self });
        }
        if self.triangular && self.sector < 5 {
            return Some(Self { sector: self.sector + 1, level: 1, path: 0, triangular: true });
        }
        None
    }

    /// The triangle of the same level across a side; `None` outside the hexagon, for the undivided disk and for
    /// squares.
    ///
    /// Across side c, digits c and 2 change places, the other two digits pass the question on to the parent and change
    /// places: all of it is one exclusive or (after Lee and Samet's constant-time neighbour finding).
    pub const fn neighbour(self, side: Side) -> Option<Self> {
        if !self.triangular || self.level == 0 {
            return None;
        }
        // `swap` turns digit c into 2 and the others into each other; `decisive` are the low bits of digits that are c
        // or 2.
        let digits = 2 * (self.level as u32 - 1);
        let (high, low) = (self.path >> 1 & EVEN, self.path & EVEN);
        let (swap, decisive) = match side {
            Side::Zero => (0b10, !low),
            Side::One => (0b11, high ^ low),
            Side::Three => (0b01, high),
        };
        let place = (decisive & EVEN).trailing_zeros();
        if place < digits {
            let reach = u32::MAX >> (30 - place);
            return Some(Self { path: self.path ^ ((EVEN * swap) & reach), ..self });
        }
        // The sector's own side: mirrored into the next or the previous sector, where corners 1 and 3 change places.
        let all = match digits {
            0 => 0,
            n => u32::MAX >> (32 - n),
        };
        match side {
            Side::Zero => None,
            Side::One => Some(Self { sector: (self.sector + 1) % 6, path: self.path & EVEN & all, ..self }),
            Side::Three => {
                Some(Self { sector: (self.sector + 5) % 6, path: self.path | (self.path << 1 & all), ..self })
            }
        }
    }

    /// A triangle's right-angled corner and leg in units of 2^−(level − 1) (eq. 2.4 to 2.7): [x, y] and whether the leg
    /// is negative.
    pub(crate) const fn corner(self) -> ([i32; 2], bool) {
        let (high, low) = (self.path >> 1 & EVEN, self.path & EVEN);
        let reversing = high & !low;
        // Reversals at or before each digit, by parity of all higher digits; then those before it.
        let mut parity = reversing;
        parity ^= parity >> 2;
        parity ^= parity >> 4;
        parity ^= parity >> 8;
        parity ^= parity >> 16;
        let before = parity ^ reversing;
        let x = signed_sum(high ^ low, before);
        let y = signed_sum(high, before);
        ([x, y], parity & 1 == 1)
    }

    /// The same part counted from its ancestor `generations` up instead of from its sector.
    pub(crate) const fn within(self, generations: u8) -> Self {
        let kept = self.path & ((1 << (2 * generations)) - 1);
        Self { sector: 0, level: generations + 1, path: kept, triangular: true }
    }

    /// A square part's column and row in units of its own sides.
    pub(crate) const fn cell(self) -> [u32; 2] {
        let (last, other) = (compact(self.path & EVEN), compact(self.path >> 1 & EVEN));
        if self.level % 2 == 1 { [last, other] } else { [other, last] }
    }
}

/// The sum of bits' values, negative where `minus` is set.
#[allow(clippy::cast_possible_wrap, reason = "16 bits")]
const fn signed_sum(bits: u32, minus: u32) -> i32 {
    compact(bits & !minus) as i32 - compact(bits & minus) as i32
}

/// The bits at even places, moved together.
const fn compact(bits: u32) -> u32 {
    let x = (bits | bits >> 1) & 0x3333_3333;
    let x = (x | x >> 2) & 0x0f0f_0f0f;
    let x = (x | x >> 4) & 0x00ff_00ff;
    (x | x >> 8) & 0x0000_ffff
}
