//! What a client tells its server: what it wants to see, and which packets it has.
//!
//! ```text
//!     offset  bytes   of the content
//!          0      1   flags: 1 packets are missing, 2 keep what no view asks for
//!          1      1   number of views
//!          2      2   zeros
//!          4      4   share of all splits to be cached, a float
//!          8      8   most triangles
//!         16      8   history: a hash of all packets that came
//!         24  v x 288 views: 36 numbers of 8 bytes each
//! ```

use crate::view::ObjectView;

use super::error::StreamError;
use super::packet::{self, Kind};
use super::plan::Wish;

/// Most views of a request.
pub(super) const MOST_VIEWS: usize = 16;
const FIXED: usize = 24;
const VIEW: usize = 8 * ObjectView::NUMBERS;

/// A request.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Request {
    /// The stream that the client has; 0 if it has none.
    pub stream: u32,
    /// The first packet that is missing.
    pub next: u32,
    /// Whether packets sent before are missing.
    pub missing: bool,
    pub cache_share: f32,
    /// The [history](packet::history) of the packets that came; 0 if none did.
    pub history: u64,
    pub wish: Wish,
}

impl Request {
    pub fn write(&self) -> Vec<u8> {
        let mut out = packet::start(Kind::Request, self.stream, self.next);
        let views = &self.wish.views[..self.wish.views.len().min(MOST_VIEWS)];
        out.extend([u8::from(self.missing) | u8::from(self.wish.keeps) << 1, views.len() as u8, 0, 0]);
        out.extend(self.cache_share.to_le_bytes());
        out.extend((self.wish.triangles as u64).to_le_bytes());
        out.extend(self.history.to_le_bytes());
        for view in views {
            view.to_numbers().iter().for_each(|number| out.extend(number.to_le_bytes()));
        }
        packet::finish(&mut out);
        out
    }

    pub fn read(bytes: &[u8]) -> Result<Self, StreamError> {
        let frame = packet::open(Kind::Request, bytes)?;
        let damaged = |what| Err(StreamError::Damaged { what });
        let Some((fixed, views)) = frame.content.split_first_chunk::<FIXED>() else {
            return damaged("the request is cut");
        };
        let count = usize::from(fixed[1]);
        if fixed[0] > 3 || count > MOST_VIEWS || views.len() != count * VIEW {
            return damaged("the request has no such flags or views");
        }
        let cache_share = f32::from_le_bytes([fixed[4], fixed[5], fixed[6], fixed[7]]);
        if !(0.0..=1.0).contains(&cache_share) {
            return damaged("the share to be cached is not 0 to 1");
        }
        let [triangles, history] =
            [8, 16].map(|first| u64::from_le_bytes(std::array::from_fn(|at| fixed[first + at])));
        let mut wish = Wish {
            views: Vec::new(),
            triangles: usize::try_from(triangles).unwrap_or(usize::MAX),
            keeps: fixed[0] & 2 != 0,
        };
        for view in views.chunks_exact(VIEW) {
            let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|byte| view[8 * at + byte]));
            match ObjectView::from_numbers(std::array::from_fn(number)) {
                Some(view) => wish.views.push(view),
                None => return damaged("a view is no view"),
            }
        }
        let missing = fixed[0] & 1 != 0;
        Ok(Self { stream: frame.stream, next: frame.number, missing, cache_share, history, wish })
    }
}
