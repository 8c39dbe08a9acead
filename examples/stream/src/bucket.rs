//! A token bucket: holds a rate of bytes a second. Time is an argument, so tests and simulations bring a clock of their own.

use std::time::Duration;

/// Longest wait for a rate that is tiny, seconds.
const LONGEST: f64 = 3_600.0;
/// Time that a packet takes on the line, seconds: a new view waits no longer.
const SLICE: f64 = 0.05;
/// Least and most bytes of a packet.
const PACKET: [f64; 2] = [256.0, 16_384.0];

/// Returns the bytes of a packet for a line of `rate` bytes a second: 50 ms of the line, 256 to 16,384.
pub fn packet_bytes(rate: f64) -> usize {
    (rate * SLICE).clamp(PACKET[0], PACKET[1]) as usize
}

/// Holds a rate. Tokens are bytes: `rate` tokens come in a second, and at most `burst` are kept. A packet goes while the count is not
/// below zero, and takes its bytes from the count. The next packet waits until the count is back at zero.
///
/// Over any time `t`, at most `rate * t + burst + (the last packet)` bytes go.
///
/// ```
/// use std::time::Duration;
/// use multires_stream_example::bucket::Bucket;
///
/// let mut bucket = Bucket::new(1_000.0, 500.0);
/// assert_eq!(bucket.wait(Duration::ZERO), Duration::ZERO);
/// bucket.spend(1_500);
/// assert_eq!(bucket.wait(Duration::ZERO), Duration::from_secs(1));
/// assert_eq!(bucket.wait(Duration::from_secs(1)), Duration::ZERO);
/// ```
#[derive(Debug, Clone)]
pub struct Bucket {
    rate: f64,
    burst: f64,
    tokens: f64,
    now: Duration,
}

impl Bucket {
    /// Creates a full bucket. `rate` in bytes a second and `burst` in bytes are raised to 1 where they are less; an infinite
    /// rate never waits.
    pub fn new(rate: f64, burst: f64) -> Self {
        let burst = burst.max(1.0);
        Self { rate: rate.max(1.0), burst, tokens: burst, now: Duration::ZERO }
    }

    /// Returns the time from `now` until the next packet may go. `now` counts from any moment, and never runs backwards.
    pub fn wait(&mut self, now: Duration) -> Duration {
        let passed = now.saturating_sub(self.now).as_secs_f64();
        self.now = self.now.max(now);
        if self.rate.is_infinite() {
            return Duration::ZERO;
        }
        self.tokens = (self.tokens + passed * self.rate).min(self.burst);
        Duration::from_secs_f64((-self.tokens / self.rate).clamp(0.0, LONGEST))
    }

    /// Takes the tokens of a packet that goes at the time of the last [`wait`](Bucket::wait).
    pub fn spend(&mut self, bytes: usize) {
        self.tokens -= bytes as f64;
    }
}
