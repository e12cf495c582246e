//! What the system knows of this program: memory, and processor time thread by thread.

use std::collections::BTreeMap;
use std::path::Path;

/// Clock ticks of a second, as Linux counts processor time for programs whatever the kernel's own are.
const TICKS: f64 = 100.0;

/// Bytes of memory that are resident; `None` where the system does not say.
pub fn resident_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

/// Seconds of processor time so far by the names of threads; threads whose names differ only by numbers are one. Empty
/// where the system does not say.
pub fn cpu_by_threads() -> BTreeMap<String, f64> {
    let mut seconds = BTreeMap::new();
    let Ok(threads) = std::fs::read_dir("/proc/self/task") else {
        return seconds;
    };
    for thread in threads.flatten() {
        if let Some((name, time)) = cpu_of_thread(&thread.path()) {
            *seconds.entry(name).or_default() += time;
        }
    }
    seconds
}

fn cpu_of_thread(folder: &Path) -> Option<(String, f64)> {
    parse_stat(&std::fs::read_to_string(folder.join("stat")).ok()?)
}

/// A line `id (name) state ...`: the name may hold anything, the times in user and kernel mode are the 12th and 13th
/// field after it.
fn parse_stat(line: &str) -> Option<(String, f64)> {
    let (_, rest) = line.split_once('(')?;
    let (name, rest) = rest.rsplit_once(')')?;
    let mut fields = rest.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    let time = (ticks()? + ticks()?) / TICKS;
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit() || " -:".contains(c));
    Some((name.to_owned(), time))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_system_is_understood() {
        let line = "7 (llvmpipe-12) S 1 2 3 4 5 6 7 8 9 10 250 50 0 0 20 0 1 0";
        assert_eq!(
            parse_stat(line),
            Some((String::from("llvmpipe"), 3.0)),
            "2.5 s + 0.5 s"
        );
        let odd = "7 (a) b (1) R 1 2 3 4 5 6 7 8 9 10 0 1 0";
        assert_eq!(
            parse_stat(odd),
            Some((String::from("a) b ("), 0.01)),
            "names hold what they like"
        );
        assert_eq!(parse_stat("7 (x) S 1 2"), None, "cut off");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_program_has_memory_and_threads() {
        assert!(
            resident_memory().is_some_and(|bytes| bytes > 1 << 20),
            "more than a megabyte"
        );
        assert!(!cpu_by_threads().is_empty(), "this one at least");
    }
}
