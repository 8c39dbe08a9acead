//! Mode TRIANGLES: a byte for a triangle that shares an edge with one of the triangles just before.
//!
//! ```text
//!     0xe1 | code of each triangle | data | table of 16 bytes
//!     code: X Y, 4 bits each
//!       X < 15   an edge, X edges back, and a corner c:      b ---- c      new edges c b, a c
//!                Y = 0: next; 1..=12: Y vertices back;        \    /
//!                13, 14: last - 1, last + 1; 15: data          \  /
//!       X = 15   three corners: Y < 14: byte Y of the table;    a           new edges b a, c b, a c
//!                14, 15: a byte of the data
//! ```
//!
//! `next` counts the vertices that came for the first time; `last` is the last index from the data.

use super::stream::{Bytes, Fault, HEADER, parts, put, unzigzag};

const VERSION: u8 = 0xe1;
const TABLE: usize = 16;

/// Returns the least number of bytes that a stream of `count` indices has.
pub(super) fn least(count: usize) -> usize {
    1 + count / 3 + TABLE
}

/// The last 16 items.
struct Recent<T> {
    items: [T; 16],
    count: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Self { items: [T::default(); 16], count: 0 }
    }

    fn push(&mut self, item: T) {
        self.items[self.count % 16] = item;
        self.count += 1;
    }

    /// Returns the item pushed before `back` others.
    fn get(&self, back: u8) -> Result<T, Fault> {
        let place = self.count.checked_sub(1 + usize::from(back));
        Ok(self.items[place.ok_or("a triangle refers to one before the first")? % 16])
    }
}

struct Decoder<'a> {
    next: u32,
    last: u32,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    data: Bytes<'a>,
}

impl Decoder<'_> {
    fn take_next(&mut self) -> u32 {
        let next = self.next;
        self.next = next.wrapping_add(1);
        next
    }

    fn explicit(&mut self) -> Result<u32, Fault> {
        self.last = self.last.wrapping_add(unzigzag(self.data.number()?));
        Ok(self.last)
    }

    /// Returns a corner by 4 bits, and whether it is to be remembered: 0 next, 15 from the data, others so many vertices back.
    fn corner(&mut self, bits: u8) -> Result<(u32, bool), Fault> {
        Ok(match bits {
            0 => (self.take_next(), true),
            15 => (self.explicit()?, true),
            _ => (self.vertices.get(bits - 1)?, false),
        })
    }

    /// Decodes a triangle that shares an edge, `back` edges ago.
    fn shared(&mut self, back: u8, corner: u8) -> Result<[u32; 3], Fault> {
        let [a, b] = self.edges.get(back)?;
        let (c, is_kept) = match corner {
            0 => (self.take_next(), true),
            13 | 14 => {
                self.last = if corner == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                (self.last, true)
            }
            15 => (self.explicit()?, true),
            _ => (self.vertices.get(corner)?, false),
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if is_kept {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// Decodes a triangle of three corners: `first` is 0 or 15, `others` two times 4 bits.
    fn free(&mut self, first: u8, others: u8) -> Result<[u32; 3], Fault> {
        let (a, _) = self.corner(first)?;
        let (b, keeps_b) = self.corner(others >> 4)?;
        let (c, keeps_c) = self.corner(others & 15)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        self.vertices.push(a);
        for (vertex, _) in [(b, keeps_b), (c, keeps_c)].into_iter().filter(|v| v.1) {
            self.vertices.push(vertex);
        }
        Ok([a, b, c])
    }
}

/// Appends the indices of a stream. `count`: a multiple of 3; `stride`: 2 or 4.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize, to: &mut Vec<u8>) -> Result<(), Fault> {
    let (header, mut data, table) = parts(stream, TABLE)?;
    if header != VERSION {
        return Err(HEADER);
    }
    if table[14..] != [0, 0] || table.iter().any(|entry| entry >> 4 == 15 || entry & 15 == 15) {
        return Err("the table of triangles is none");
    }
    let codes = data.take(count / 3)?;
    let (edges, vertices) = (Recent::new(), Recent::new());
    let mut decoder = Decoder { next: 0, last: 0, edges, vertices, data };
    for &code in codes {
        let triangle = match (code >> 4, code & 15) {
            (15, low @ 0..14) => decoder.free(0, table[usize::from(low)])?,
            (15, low) => {
                let others = decoder.data.byte()?;
                if others == 0 {
                    decoder.next = 0;
                }
                decoder.free(if low == 14 { 0 } else { 15 }, others)?
            }
            (back, corner) => decoder.shared(back, corner)?,
        };
        triangle.into_iter().for_each(|index| put(to, index, stride));
    }
    decoder.data.end()
}
