//! A name for what is built: a hash of the sources, the compiler and what it is told.
//!
//! Checkpoints say which build wrote them, since another one may round differently in the last digit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let mut files = Vec::new();
    // Engine and scenario stand beside this crate in the workspace; of published crates the versions in Cargo.toml tell.
    for folder in [".", "../springpot", "../springpot-scenario"].map(Path::new).into_iter().filter(|path| path.is_dir())
    {
        for part in ["src", "Cargo.toml"] {
            println!("cargo:rerun-if-changed={}", folder.join(part).display());
        }
        files.push(folder.join("Cargo.toml"));
        below(&folder.join("src"), &mut files);
    }
    files.sort();
    // FNV-1a, 64 bits.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut take = |bytes: &[u8]| {
        for byte in bytes.iter().chain(&[0]) {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    };
    for file in &files {
        let name: Vec<_> = file.iter().map(|part| part.to_string_lossy()).collect();
        take(name.join("/").as_bytes());
        take(&fs::read(file).unwrap_or_default());
    }
    for name in ["TARGET", "OPT_LEVEL", "DEBUG", "CARGO_CFG_TARGET_FEATURE", "CARGO_ENCODED_RUSTFLAGS"] {
        take(std::env::var(name).unwrap_or_default().as_bytes());
    }
    let compiler = std::env::var_os("RUSTC").unwrap_or("rustc".into());
    take(&Command::new(compiler).arg("-V").output().map(|said| said.stdout).unwrap_or_default());
    println!("cargo:rustc-env=SPRINGPOT_BUILD={hash:016x}");
}

fn below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            below(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
}
