//! Why a progressive mesh is refused.

/// An inconsistency in a [`ProgressiveMesh`](super::ProgressiveMesh).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgressiveError {
    /// A table's length differs from the length required by the others, or exceeds the maximum.
    #[error("there are {found} {what} where {expected} are needed")]
    Length {
        /// Counted elements.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number needed, or the maximum supported.
        expected: usize,
    },
    /// A running count falls where it should grow, or grows where it should fall.
    #[error("the {what} are out of order at entry {entry}")]
    Order {
        /// Name of the count.
        what: &'static str,
        /// First entry out of order.
        entry: usize,
    },
    /// An order names an input vertex or triangle out of range or twice.
    #[error("the order of {what} names {index} at place {place}, which is not there or named before")]
    NotPermutation {
        /// "vertices" or "triangles".
        what: &'static str,
        /// The place.
        place: usize,
        /// Index named at the place.
        index: u32,
    },
    /// A slot lies at a non-finite position, before or after a step.
    #[error("slot {slot} has a non-finite position")]
    NonFinitePosition {
        /// The slot.
        slot: usize,
    },
    /// A pair `[k, l]` is out of turn: `l` must count up from the base, and `k <= l`.
    #[error("pair {pair} parts slot {k} into {l}, which is out of turn")]
    Pair {
        /// Index among all pairs, from the base up.
        pair: usize,
        /// Slot kept.
        k: u32,
        /// Slot added.
        l: u32,
    },
    /// An added triangle names a slot not present yet.
    #[error("triangle {triangle} names slot {slot}, which is not there when it comes")]
    Triangle {
        /// The triangle's place.
        triangle: usize,
        /// The slot.
        slot: u32,
    },
    /// A moved corner is not present yet, is not at the slot it moves from, or moves twice in a step.
    #[error("corner {corner} of pair {pair} is not at the slot that it moves from")]
    Corner {
        /// Index of the pair.
        pair: usize,
        /// `3 * triangle + i`, `i` from 0 to 2.
        corner: u32,
    },
    /// A moved slot is not present yet, is not at the position it moves from, does not change its position, or moves
    /// twice in a step.
    #[error("move {place} does not start where slot {slot} lies, or is not its only one")]
    Place {
        /// Index among all moves.
        place: usize,
        /// The slot.
        slot: u32,
    },
    /// The current triangles or positions differ from the level given by `steps`.
    #[error("the mesh shown is not that after {steps} steps")]
    Level {
        /// Number of steps of the level claimed.
        steps: usize,
    },
}
