//! Names of temporary files, which tell whether the process that writes one is still running.
//!
//! ```text
//!     .bunny.mres.3f2a9c01-1c2f-8d41b2-0.multires.tmp
//!      target     |        |    |      |
//!                 |        |    |      number of the file in its process
//!                 |        |    when the process started, ticks since the machine did
//!                 |        number of the process
//!                 where such numbers are unique: hash of the machine's start and of the namespace of processes
//! ```
//!
//! All three are what Linux shows in `/proc`; 0 where it is missing. A number alone would not do: it is given again, and a
//! directory may be shared by machines.

use std::ffi::OsStr;
use std::fs;
use std::time::Duration;

use twox_hash::XxHash3_64;

const END: &str = ".multires.tmp";
/// Age of a file that nobody still writes, whoever began it.
const OLD: Duration = Duration::from_secs(24 * 60 * 60);

/// A process that writes temporary files, and where its number is unique; 0 where unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Writer {
    space: u32,
    process: u32,
    started: u64,
}

impl Writer {
    /// Returns this process.
    pub fn this() -> Self {
        let process = std::process::id();
        Self { space: space().unwrap_or(0), process, started: started(process).unwrap_or(0) }
    }

    /// Returns the process that wrote a temporary file of this name; `None` for other names.
    pub fn of_file(name: &str) -> Option<Self> {
        let (_, numbers) = name.strip_prefix('.')?.strip_suffix(END)?.rsplit_once('.')?;
        let mut numbers = numbers.split('-').map(|digits| u64::from_str_radix(digits, 16).ok());
        let [space, process, started, number] = [(); 4].map(|()| numbers.next().flatten());
        number?;
        let writer =
            Self { space: space?.try_into().ok()?, process: process?.try_into().ok()?, started: started? };
        numbers.next().is_none().then_some(writer)
    }

    /// Returns the name of a temporary file for a target.
    pub fn name_for(&self, target: &OsStr, number: u64) -> String {
        let mut name = String::from(".");
        // Long names are cut: the temporary name fits where the target's name fits.
        name.extend(target.to_string_lossy().chars().take(30));
        let Self { space, process, started } = self;
        name + &format!(".{space:08x}-{process:x}-{started:x}-{number:x}{END}")
    }

    /// Whether a temporary file of the process is written no more: the process has ended, or the file is a day old.
    pub fn has_abandoned(&self, file: &fs::Metadata) -> bool {
        let age = file.modified().ok().and_then(|at| at.elapsed().ok());
        // Processes of other users may be hidden.
        is_of_this_user(file) && self.has_ended() || age.is_some_and(|age| age > OLD)
    }

    /// Whether the process is known to have ended.
    fn has_ended(&self) -> bool {
        let here = Self::this();
        let is_known = here.space != 0 && here.started != 0 && self.space == here.space;
        is_known && started(self.process) != Some(self.started)
    }
}

#[cfg(unix)]
fn is_of_this_user(file: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    fs::metadata("/proc/self").is_ok_and(|process| process.uid() == file.uid())
}

#[cfg(not(unix))]
fn is_of_this_user(_: &fs::Metadata) -> bool {
    true
}

/// Returns a hash of the machine's start and of the namespace of processes, not 0; `None` where there is no `/proc`.
fn space() -> Option<u32> {
    let boot = fs::read("/proc/sys/kernel/random/boot_id").ok()?;
    let processes = fs::read_link("/proc/self/ns/pid").ok()?;
    let all = [&boot, processes.as_os_str().as_encoded_bytes()].concat();
    Some((XxHash3_64::oneshot(&all) as u32).max(1))
}

/// Returns when a running process started, ticks since the machine did; `None` if there is no such process, or no `/proc`.
fn started(process: u32) -> Option<u64> {
    let line = fs::read(format!("/proc/{process}/stat")).ok()?;
    // The program's name, in brackets, may hold anything. The start is the 20th field after it.
    let end = line.iter().rposition(|&byte| byte == b')')?;
    std::str::from_utf8(&line[end + 1..]).ok()?.split_ascii_whitespace().nth(19)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_whose_they_are() {
        let this = Writer::this();
        assert_eq!(Writer::of_file(&this.name_for(OsStr::new("a.mres"), 7)), Some(this));
        assert!(!this.has_ended());
        for other in
            ["a.mres", ".a.mres.tmp", ".multires.tmp", ".1-2-3-4.multires.tmp", ".a.1-2-3.multires.tmp"]
        {
            assert_eq!(Writer::of_file(other), None, "{other}");
        }
        assert!(!Writer { space: this.space ^ 1, started: 1, ..this }.has_ended(), "of another machine");
        let again = Writer { started: this.started ^ 1, ..this };
        assert_eq!(again.has_ended(), this.space != 0, "the number is given again");
        let long = this.name_for(OsStr::new(&"\u{10348}".repeat(60)), u64::MAX);
        assert!(long.len() < 220, "{}", long.len());
    }
}
