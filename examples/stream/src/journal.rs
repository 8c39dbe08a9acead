//! Packets on disk, so that a client that was killed goes on where it was.
//!
//! ```text
//!     open     reads packets as far as they are whole and in order; cuts off the rest
//!     append   before the packet is acknowledged: the server forgets acknowledged packets
//!     restart  the server began a new stream: the old packets are of no use
//! ```
//!
//! The file holds the packets of one stream, one after another, and grows as long as the stream lives. The file outlives the
//! process. After a crash of the operating system its end may be lost: the client then resumes if the server still has the lost
//! packets, and begins anew otherwise.

use std::fs::{File, OpenOptions};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use multires::stream::message_length;

use crate::messages::MOST_PACKET;

/// Bytes by which the length of a message is known.
const HEAD: u64 = 32;

/// A file of packets.
#[derive(Debug)]
pub struct Journal {
    file: File,
}

impl Journal {
    /// Opens a file, or creates it, and calls `take` for every packet until the file ends, is damaged, or `take` returns false.
    /// Cuts off packets that were not taken.
    ///
    /// # Errors
    /// The operating system reports an error. Damage is none.
    pub fn open(path: &Path, mut take: impl FnMut(&[u8]) -> bool) -> io::Result<Self> {
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        let mut reader = BufReader::new(&mut file);
        let (mut good, mut packet) = (0, Vec::new());
        while read_packet(&mut reader, &mut packet)? && take(&packet) {
            good += packet.len() as u64;
        }
        file.set_len(good)?;
        file.seek(SeekFrom::Start(good))?;
        Ok(Self { file })
    }

    /// Appends a packet.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn append(&mut self, packet: &[u8]) -> io::Result<()> {
        self.file.write_all(packet)
    }

    /// Empties the file.
    ///
    /// # Errors
    /// The operating system reports an error.
    pub fn restart(&mut self) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.rewind()
    }
}

/// Reads a packet. Returns whether a whole packet was there. Does not test the checksum: the client does.
fn read_packet(reader: &mut impl Read, packet: &mut Vec<u8>) -> io::Result<bool> {
    packet.clear();
    reader.by_ref().take(HEAD).read_to_end(packet)?;
    let Ok(Some(length)) = message_length(packet) else { return Ok(false) };
    if length > MOST_PACKET {
        return Ok(false);
    }
    reader.by_ref().take((length - packet.len()) as u64).read_to_end(packet)?;
    Ok(packet.len() == length)
}
