//! Names the build by all that decides what a tick computes: the sources of touch, the versions of
//! what it is built on, the compiler and the machine it is built for. A recording that is replayed
//! by a build of another name may differ, and is told so.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The crates that a tick runs through.
const CRATES: [&str; 3] = ["volume", "haptics", "engine"];

fn main() {
    // asked now: a build folder may be used from another checkout than that which compiled this
    let crates = Path::new(&variable("CARGO_MANIFEST_DIR")).join("..");
    let mut hash = Hash::default();
    let lock = crates.join("..").join("Cargo.lock");
    hash.add(&fs::read(&lock).unwrap_or_default());
    println!("cargo::rerun-if-changed={}", lock.display());

    for name in CRATES {
        let folder = crates.join(name).join("src");
        println!("cargo::rerun-if-changed={}", folder.display());
        let mut files = Vec::new();
        collect(&folder, &mut files);
        files.sort();
        for file in files {
            hash.add(&fs::read(&file).expect("a source that is there can be read"));
        }
    }
    hash.add(compiler().as_bytes());
    hash.add(variable("TARGET").as_bytes());
    println!("cargo::rustc-env=PALPATE_BUILD={:016x}", hash.0);
}

/// All sources of a folder.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).expect("the sources are beside this crate");
    for entry in entries {
        let path = entry.expect("the sources can be listed").path();
        if path.is_dir() {
            collect(&path, files);
        } else {
            files.push(path);
        }
    }
}

/// What the compiler calls itself.
fn compiler() -> String {
    let asked = Command::new(variable("RUSTC")).arg("--version").output();
    asked.map_or_else(
        |_| String::new(),
        |output| String::from_utf8_lossy(&output.stdout).into_owned(),
    )
}

fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_default()
}

/// FNV-1a with 64 bits (Fowler, Noll, Vo, 1991).
struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// Adds bytes, and their number, so that what one file ends with cannot begin the next.
    fn add(&mut self, bytes: &[u8]) {
        let length = (bytes.len() as u64).to_le_bytes();
        for byte in length.iter().chain(bytes) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
