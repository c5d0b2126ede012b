//! A four-wide bounding-volume hierarchy: obvhs builds a binary one (PLOC with reinsertion), which is collapsed so that
//! one visit tests four boxes, and one leaf holds up to four pairs of triangles that are tested together.
//!
//! Boxes are tested conservatively with respect to the triangle test: the origin is moved apart for near and far planes
//! by the error of the test's shear (Woop, Benthin & Wald 2013, section 4.2), and the far distance is raised by
//! 2·γ₃ (T. Ize, "Robust BVH Ray Traversal", *JCGT* 2(2), 2013). Directions with zero components need no special case.

use core::time::Duration;

use glam::{BVec4A, DVec3, Vec3A, Vec4};
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, bvh2::builder::build_bvh2};

use super::packet::{Half, Packet, PacketHit, Pair, Sheared};
use super::ray::{NO_PRIMITIVE, Ray};
use super::round::Round;

/// The bit of a child reference that marks a leaf.
const LEAF: u32 = 1 << 31;
/// The first leaf is empty: it is what places without child refer to.
const EMPTY: u32 = LEAF;
/// Subtrees with at most this many items become leaves.
const LEAF_ITEMS: usize = 4;
/// Traversal stacks: small worlds need the first. What would need more than the second, such as thousands of coincident
/// triangles, is put in one leaf.
const SMALL_STACK: usize = 32;
const LARGE_STACK: usize = 192;

/// The triangles of a packet: half and lane.
const PLACES: [(usize, usize); 8] = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (1, 2), (1, 3)];

/// What a hierarchy is built over.
#[derive(Clone, Copy, Debug)]
pub(super) enum Item {
    /// One or two triangles.
    Triangles(Pair),
    /// A round surface and the index of its primitive.
    Round(Round, u32),
}

impl Item {
    fn bounds(&self) -> Aabb {
        match self {
            Self::Triangles(pair) => Aabb::from_points(&pair.vertices),
            Self::Round(round, _) => {
                let [low, high] = round.bounds();
                Aabb::new(low, high)
            }
        }
    }
}

/// Four boxes, axis by axis, and what is in them.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: [Vec4; 3],
    high: [Vec4; 3],
    children: [u32; 4],
}

/// A run of packets and of round surfaces.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    packets: [u32; 2],
    rounds: [u32; 2],
}

/// What is wanted of a triangle only once it is hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    /// Unit normal n of the plane n·x = `height`.
    pub(super) normal: DVec3,
    pub(super) height: f64,
    /// Smallest barycentric weights of a point that is surely off the edges, by its rounding.
    pub(super) least: [f32; 3],
    pub(super) half: Half,
}

impl Detail {
    /// Half by half and lane by lane.
    fn of_packet(pairs: &[Pair]) -> impl Iterator<Item = Self> {
        let pair = |lane: usize| pairs.get(lane).or(pairs.last());
        PLACES.into_iter().filter_map(move |(half, lane)| pair(lane).map(|pair| Self::new(pair, half)))
    }

    #[allow(clippy::cast_possible_truncation, reason = "the weights are wanted in f32")]
    fn new(pair: &Pair, half: usize) -> Self {
        let [a, b, c] = pair.triangle(half).map(Vec3A::as_dvec3);
        let normal = (b - a).cross(c - a);
        let size = a.abs().max(b.abs()).max(c.abs()).max_element();
        let rounding = 2.0 * f64::from(f32::EPSILON) * size / normal.length();
        let least = [c - b, a - c, b - a].map(|edge| (edge.length() * rounding).min(0.1) as f32);
        let normal = normal.normalize_or_zero();
        Self { normal, height: normal.dot((a + b + c) / 3.0), least, half: pair.halves[half] }
    }
}

/// A hit before it is refined.
#[derive(Clone, Copy, Debug)]
pub(super) enum RawHit {
    /// Packet and lane.
    Triangle(u32, PacketHit),
    /// Round surface and ray parameter.
    Round(u32, f64),
}

/// The hierarchy with its primitives.
#[derive(Clone, Debug, Default)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    packets: Vec<Packet>,
    /// Eight for each packet, in the order of [`PLACES`].
    details: Vec<Detail>,
    rounds: Vec<(Round, u32)>,
    /// The nodes that can wait on the stack at once.
    stack: usize,
    low: Vec3A,
    high: Vec3A,
}

/// A ray with what the box test derives from it once.
struct BoxRay {
    inverse: [Vec4; 3],
    inverse_far: [Vec4; 3],
    near_origin: [Vec4; 3],
    far_origin: [Vec4; 3],
    backward: [bool; 3],
}

impl BoxRay {
    fn new(ray: &Ray, low: Vec3A, high: Vec3A, longest: usize) -> Self {
        const EDGE: f32 = 5.0 * f32::EPSILON / 2.0;
        const FAR: f32 = 1.0 + 4.0 * f32::EPSILON;
        let reach = (low - ray.origin).abs().max((high - ray.origin).abs());
        let error = (reach + Vec3A::splat(reach[longest])) * EDGE;
        let inverse = ray.direction.recip();
        let shift = error.copysign(inverse);
        let (near, far) = (ray.origin + shift, ray.origin - shift);
        let splat = |v: Vec3A| v.to_array().map(Vec4::splat);
        Self {
            inverse: splat(inverse),
            inverse_far: splat(inverse * FAR),
            near_origin: splat(near),
            far_origin: splat(far),
            backward: inverse.to_array().map(f32::is_sign_negative),
        }
    }

    /// The near distances of four boxes, and which are hit before `t_max`.
    #[inline(always)]
    fn hits(&self, node: &Node, t_max: f32) -> (Vec4, BVec4A) {
        let mut near = Vec4::ZERO;
        let mut far = Vec4::splat(t_max);
        for axis in 0..3 {
            let (mut first, mut second) = (node.low[axis], node.high[axis]);
            if self.backward[axis] {
                core::mem::swap(&mut first, &mut second);
            }
            // A plane that holds the whole ray gives NaN, which these orders of operands ignore.
            near = ((first - self.near_origin[axis]) * self.inverse[axis]).max(near);
            far = ((second - self.far_origin[axis]) * self.inverse_far[axis]).min(far);
        }
        (near, near.cmple(far))
    }
}

/// A stack of nodes yet to visit, with their near distances.
struct Stack<const N: usize> {
    entries: [(u32, f32); N],
    len: usize,
}

impl<const N: usize> Stack<N> {
    fn new() -> Self {
        Self { entries: [(EMPTY, 0.0); N], len: 0 }
    }

    #[inline(always)]
    fn push(&mut self, child: u32, near: f32) {
        if let Some(entry) = self.entries.get_mut(self.len) {
            *entry = (child, near);
            self.len += 1;
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(u32, f32)> {
        self.len = self.len.checked_sub(1)?;
        self.entries.get(self.len).copied()
    }
}

impl Bvh {
    /// Builds the hierarchy.
    pub(super) fn build(items: &[Item]) -> Self {
        let boxes: Vec<Aabb> = items.iter().map(Item::bounds).collect();
        let whole = boxes.iter().fold(Aabb::empty(), |whole, one| whole.union(one));
        if items.is_empty() {
            return Self::default();
        }
        let leaves = vec![Leaf { packets: [0; 2], rounds: [0; 2] }];
        let bvh = Self { low: whole.min, high: whole.max, leaves, ..Self::default() };
        let parameters = BvhBuildParams { pre_split: false, max_prims_per_leaf: 1, ..BvhBuildParams::slow_build() };
        let binary = build_bvh2(&boxes, parameters, &mut Duration::default());
        let mut collapse = Collapse { items, binary: &binary, counts: vec![0; binary.nodes.len()], bvh };
        collapse.count(0);
        collapse.root();
        collapse.bvh
    }

    /// The corners of the box around everything; both zero if there is nothing.
    pub(super) fn bounds(&self) -> [Vec3A; 2] {
        [self.low, self.high]
    }

    /// A packet by its index in a [`RawHit`].
    pub(super) fn packet(&self, index: u32) -> &Packet {
        &self.packets[index as usize]
    }

    /// What else is known of a triangle of a packet.
    pub(super) fn detail(&self, packet: u32, hit: &PacketHit) -> &Detail {
        self.detail_of(packet, hit.half, hit.lane)
    }

    /// The same by its place in the packet.
    pub(super) fn detail_of(&self, packet: u32, half: usize, lane: usize) -> &Detail {
        &self.details[8 * packet as usize + 4 * half + lane]
    }

    /// A round surface and its primitive, by its index in a [`RawHit`].
    pub(super) fn round(&self, index: u32) -> &(Round, u32) {
        &self.rounds[index as usize]
    }

    /// The nearest hit.
    pub(super) fn closest(&self, ray: &Ray) -> Option<RawHit> {
        let small = self.stack <= SMALL_STACK;
        match longest_axis(ray.direction) {
            0 if small => self.closest_along::<0, SMALL_STACK>(ray),
            1 if small => self.closest_along::<1, SMALL_STACK>(ray),
            2 if small => self.closest_along::<2, SMALL_STACK>(ray),
            0 => self.closest_along::<0, LARGE_STACK>(ray),
            1 => self.closest_along::<1, LARGE_STACK>(ray),
            _ => self.closest_along::<2, LARGE_STACK>(ray),
        }
    }

    /// Whether there is any hit.
    pub(super) fn any(&self, ray: &Ray) -> bool {
        let small = self.stack <= SMALL_STACK;
        match longest_axis(ray.direction) {
            0 if small => self.any_along::<0, SMALL_STACK>(ray),
            1 if small => self.any_along::<1, SMALL_STACK>(ray),
            2 if small => self.any_along::<2, SMALL_STACK>(ray),
            0 => self.any_along::<0, LARGE_STACK>(ray),
            1 => self.any_along::<1, LARGE_STACK>(ray),
            _ => self.any_along::<2, LARGE_STACK>(ray),
        }
    }

    fn closest_along<const KZ: usize, const N: usize>(&self, ray: &Ray) -> Option<RawHit> {
        let sheared = Sheared::new::<KZ>(*ray);
        let box_ray = BoxRay::new(ray, self.low, self.high, KZ);
        let mut stack = Stack::<N>::new();
        let mut best = None;
        let mut t_max = ray.t_max;
        let mut next = if self.leaves.is_empty() { None } else { Some((self.root(), 0.0)) };
        while let Some((child, near)) = next {
            if !(near < t_max || near == 0.0) {
                next = stack.pop();
                continue;
            }
            if child & LEAF != 0 {
                self.closest_in_leaf::<KZ>(child, &sheared, &mut t_max, &mut best);
                next = stack.pop();
                continue;
            }
            let node = &self.nodes[child as usize];
            let (near, hit) = box_ray.hits(node, t_max);
            next = push_ordered(&mut stack, node, near, hit.bitmask());
        }
        best
    }

    fn any_along<const KZ: usize, const N: usize>(&self, ray: &Ray) -> bool {
        let sheared = Sheared::new::<KZ>(*ray);
        let box_ray = BoxRay::new(ray, self.low, self.high, KZ);
        let mut stack = Stack::<N>::new();
        let mut next = if self.leaves.is_empty() { None } else { Some((self.root(), 0.0)) };
        while let Some((child, _)) = next {
            if child & LEAF != 0 {
                if self.any_in_leaf::<KZ>(child, &sheared) {
                    return true;
                }
            } else {
                let node = &self.nodes[child as usize];
                let mut lanes = box_ray.hits(node, ray.t_max).1.bitmask();
                while lanes != 0 {
                    stack.push(node.children[lanes.trailing_zeros() as usize & 3], 0.0);
                    lanes &= lanes - 1;
                }
            }
            next = stack.pop();
        }
        false
    }

    /// Whether a packet or round surface blocks, of those in boxes that `meets` keeps: it returns a bit for each of four boxes,
    /// given axis by axis.
    pub(super) fn any_item(
        &self,
        meets: impl Fn(&[Vec4; 3], &[Vec4; 3]) -> u32,
        mut packet_blocks: impl FnMut(&Packet) -> bool,
        mut round_blocks: impl FnMut(&Round, u32) -> bool,
    ) -> bool {
        let mut stack = Stack::<LARGE_STACK>::new();
        let mut next = if self.leaves.is_empty() { None } else { Some((self.root(), 0.0)) };
        while let Some((child, _)) = next {
            if child & LEAF != 0 {
                let leaf = &self.leaves[(child & !LEAF) as usize];
                let packets = &self.packets[leaf.packets[0] as usize..leaf.packets[1] as usize];
                let rounds = &self.rounds[leaf.rounds[0] as usize..leaf.rounds[1] as usize];
                if packets.iter().any(&mut packet_blocks) || rounds.iter().any(|(round, i)| round_blocks(round, *i)) {
                    return true;
                }
            } else {
                let node = &self.nodes[child as usize];
                let mut lanes = meets(&node.low, &node.high);
                while lanes != 0 {
                    stack.push(node.children[lanes.trailing_zeros() as usize & 3], 0.0);
                    lanes &= lanes - 1;
                }
            }
            next = stack.pop();
        }
        false
    }

    /// For each primitive below `primitives`, the index of its packet and its lane, or `None` for a round one.
    pub(super) fn places(&self, primitives: usize) -> Vec<Option<(u32, u8)>> {
        let mut places = vec![None; primitives];
        for (index, packet) in (0..).zip(&self.packets) {
            for (half, lane) in PLACES {
                if let Some(place) = places.get_mut(packet.primitive(half, lane) as usize) {
                    *place = Some((index, u8::try_from(lane).unwrap_or(0)));
                }
            }
        }
        places
    }

    /// The reference of the root: a node, or the only leaf.
    fn root(&self) -> u32 {
        if self.nodes.is_empty() { LEAF | 1 } else { 0 }
    }

    #[inline(always)]
    fn closest_in_leaf<const KZ: usize>(&self, child: u32, ray: &Sheared, t_max: &mut f32, best: &mut Option<RawHit>) {
        let leaf = &self.leaves[(child & !LEAF) as usize];
        for index in leaf.packets[0]..leaf.packets[1] {
            if let Some(hit) = self.packets[index as usize].closest::<KZ>(ray, *t_max) {
                *t_max = hit.t;
                *best = Some(RawHit::Triangle(index, hit));
            }
        }
        for index in leaf.rounds[0]..leaf.rounds[1] {
            if let Some(t) = self.round_distance(index, &ray.ray, *t_max) {
                *t_max = to_f32(t);
                *best = Some(RawHit::Round(index, t));
            }
        }
    }

    #[inline(always)]
    fn any_in_leaf<const KZ: usize>(&self, child: u32, ray: &Sheared) -> bool {
        let leaf = &self.leaves[(child & !LEAF) as usize];
        let t_max = ray.ray.t_max;
        // A loop, because it is inlined where an iterator's method is not.
        for packet in &self.packets[leaf.packets[0] as usize..leaf.packets[1] as usize] {
            if packet.any::<KZ>(ray, t_max) {
                return true;
            }
        }
        (leaf.rounds[0]..leaf.rounds[1]).any(|i| self.round_distance(i, &ray.ray, t_max).is_some())
    }

    fn round_distance(&self, index: u32, ray: &Ray, t_max: f32) -> Option<f64> {
        let (round, primitive) = &self.rounds[index as usize];
        if ray.exclude.contains(primitive) { None } else { round.distance(ray, t_max) }
    }

    /// Whether every primitive below `primitives` is in the leaves, and every box holds what is in it.
    pub(super) fn is_consistent(&self, primitives: u32) -> bool {
        let mut seen = vec![false; primitives as usize];
        let mut mark = |primitive: u32| seen.get_mut(primitive as usize).map(|s| *s = true).is_some();
        let lanes = |packet: &Packet| PLACES.map(|(half, lane)| packet.primitive(half, lane));
        let mut in_packets = self.packets.iter().flat_map(lanes).filter(|p| *p != NO_PRIMITIVE);
        let known = in_packets.all(&mut mark) && self.rounds.iter().all(|(_, primitive)| mark(*primitive));
        let nested = self.leaves.is_empty() || self.is_nested(self.root(), self.low, self.high);
        known && nested && seen.iter().all(|s| *s)
    }

    fn is_nested(&self, child: u32, low: Vec3A, high: Vec3A) -> bool {
        let holds = |p: Vec3A| p.cmpge(low).all() && p.cmple(high).all();
        if child & LEAF != 0 {
            let Some(leaf) = self.leaves.get((child & !LEAF) as usize) else { return false };
            let mut packets = leaf.packets[0]..leaf.packets[1];
            let mut rounds = leaf.rounds[0]..leaf.rounds[1];
            let vertices = |i: u32| PLACES.map(|(half, lane)| self.packet(i).triangle(half, lane));
            return packets.all(|i| vertices(i).as_flattened().iter().all(|v| holds(*v)))
                && rounds.all(|i| self.round(i).0.bounds().into_iter().all(holds));
        }
        let Some(node) = self.nodes.get(child as usize) else { return false };
        (0..4).filter(|i| node.children[*i] != EMPTY).all(|i| {
            let corner = |planes: &[Vec4; 3]| Vec3A::new(planes[0][i], planes[1][i], planes[2][i]);
            let (inner_low, inner_high) = (corner(&node.low), corner(&node.high));
            holds(inner_low) && holds(inner_high) && self.is_nested(node.children[i], inner_low, inner_high)
        })
    }
}

/// The axis along which a direction is longest.
#[inline(always)]
fn longest_axis(direction: Vec3A) -> usize {
    let d = direction.abs();
    if d.x > d.y {
        if d.x > d.z { 0 } else { 2 }
    } else if d.y > d.z {
        1
    } else {
        2
    }
}

#[allow(clippy::cast_possible_truncation, reason = "the distance is wanted in f32")]
fn to_f32(t: f64) -> f32 {
    t as f32
}

/// Returns the nearest of the children that are hit and pushes the others, the nearer the later.
#[inline(always)]
fn push_ordered<const N: usize>(stack: &mut Stack<N>, node: &Node, near: Vec4, mut lanes: u32) -> Option<(u32, f32)> {
    if lanes == 0 {
        return stack.pop();
    }
    let near = near.to_array();
    let mut take = || {
        let lane = lanes.trailing_zeros() as usize & 3;
        lanes &= lanes - 1;
        ((node.children[lane], near[lane]), lanes != 0)
    };
    let (mut first, mut more) = take();
    let floor = stack.len;
    while more {
        let (mut other, again) = take();
        more = again;
        if other.1 < first.1 {
            core::mem::swap(&mut first, &mut other);
        }
        stack.push(other.0, other.1);
    }
    sort_descending(stack.entries.get_mut(floor..stack.len));
    Some(first)
}

/// Sorts two or three stack entries by falling distance.
#[inline(always)]
fn sort_descending(entries: Option<&mut [(u32, f32)]>) {
    let Some(entries) = entries else { return };
    for end in 1..entries.len() {
        let mut i = end;
        while i > 0 && entries[i - 1].1 < entries[i].1 {
            entries.swap(i - 1, i);
            i -= 1;
        }
    }
}

/// The collapse of a binary hierarchy.
struct Collapse<'a> {
    items: &'a [Item],
    binary: &'a Bvh2,
    /// Items below each binary node.
    counts: Vec<usize>,
    bvh: Bvh,
}

impl Collapse<'_> {
    /// Counts the items below every node, without recursion: children come in pairs after some parent.
    fn count(&mut self, root: usize) {
        let mut order = vec![root];
        let mut i = 0;
        while let Some(&index) = order.get(i) {
            let node = &self.binary.nodes[index];
            if !node.is_leaf() {
                order.extend([node.first_index as usize, node.first_index as usize + 1]);
            }
            i += 1;
        }
        for &index in order.iter().rev() {
            let node = &self.binary.nodes[index];
            let first = node.first_index as usize;
            self.counts[index] =
                if node.is_leaf() { node.prim_count as usize } else { self.counts[first] + self.counts[first + 1] };
        }
    }

    fn root(&mut self) {
        if self.is_leaf(0) {
            self.leaf(0);
        } else {
            self.node(0, 0);
        }
    }

    fn is_leaf(&self, index: usize) -> bool {
        self.counts[index] <= LEAF_ITEMS || self.binary.nodes[index].is_leaf()
    }

    /// Appends the node for a binary subtree, `waiting` being what is on the stack when it is visited.
    fn node(&mut self, index: usize, waiting: usize) -> u32 {
        let members = self.open(index);
        let place = self.bvh.nodes.len();
        let mut node = Node { low: [Vec4::INFINITY; 3], high: [Vec4::NEG_INFINITY; 3], children: [EMPTY; 4] };
        for (lane, member) in members.iter().enumerate() {
            let bounds = self.binary.nodes[*member].aabb();
            for axis in 0..3 {
                node.low[axis][lane] = bounds.min[axis];
                node.high[axis][lane] = bounds.max[axis];
            }
        }
        self.bvh.nodes.push(node);
        let waiting = waiting + members.len();
        self.bvh.stack = self.bvh.stack.max(waiting);
        for (lane, member) in members.into_iter().enumerate() {
            let too_deep = waiting + 3 > LARGE_STACK;
            let leaf = too_deep || self.is_leaf(member);
            let child = if leaf { self.leaf(member) } else { self.node(member, waiting - 1) };
            self.bvh.nodes[place].children[lane] = child;
        }
        u32::try_from(place).unwrap_or(u32::MAX)
    }

    /// Up to four subtrees: the largest box that is not a leaf is opened first.
    fn open(&self, index: usize) -> Vec<usize> {
        let mut members = vec![index];
        while members.len() < 4 {
            let area = |i: usize| self.binary.nodes[i].aabb().half_area();
            let inner = (0..members.len()).filter(|i| !self.is_leaf(members[*i]));
            let Some(largest) = inner.max_by(|i, j| area(members[*i]).total_cmp(&area(members[*j]))) else {
                break;
            };
            let first = self.binary.nodes[members[largest]].first_index as usize;
            members[largest] = first;
            members.push(first + 1);
        }
        members
    }

    /// Appends the leaf with everything below a binary node.
    fn leaf(&mut self, index: usize) -> u32 {
        let mut pairs = Vec::new();
        let starts = (self.bvh.packets.len(), self.bvh.rounds.len());
        let mut open = vec![index];
        while let Some(i) = open.pop() {
            let node = &self.binary.nodes[i];
            let first = node.first_index as usize;
            if !node.is_leaf() {
                open.extend([first + 1, first]);
                continue;
            }
            for &item in &self.binary.primitive_indices[first..first + node.prim_count as usize] {
                match self.items[item as usize] {
                    Item::Triangles(pair) => pairs.push(pair),
                    Item::Round(round, primitive) => self.bvh.rounds.push((round, primitive)),
                }
            }
        }
        for four in pairs.chunks(4) {
            self.bvh.packets.extend(Packet::new(four));
            self.bvh.details.extend(Detail::of_packet(four));
        }
        let range = |from: usize, to: usize| [from, to].map(|i| u32::try_from(i).unwrap_or(u32::MAX));
        let (packets, rounds) = (range(starts.0, self.bvh.packets.len()), range(starts.1, self.bvh.rounds.len()));
        self.bvh.leaves.push(Leaf { packets, rounds });
        LEAF | u32::try_from(self.bvh.leaves.len() - 1).unwrap_or(u32::MAX)
    }
}
