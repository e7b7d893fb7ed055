//! The library inside an FMU.

/// The folder of this platform in `binaries/` (FMI 2.0.4, 2.3); `None` where the standard and its tools have no name for it.
pub const PLATFORM: Option<&str> = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
    Some("linux64")
} else if cfg!(all(target_os = "linux", target_arch = "aarch64")) {
    Some("aarch64-linux")
} else if cfg!(all(target_os = "windows", target_arch = "x86_64")) {
    Some("win64")
} else if cfg!(target_os = "macos") {
    Some("darwin64")
} else {
    None
};

/// What the file of the library is called.
pub const LIBRARY: &str = if cfg!(target_os = "windows") {
    "springpot_capi.dll"
} else if cfg!(target_os = "macos") {
    "libspringpot_capi.dylib"
} else {
    "libspringpot_capi.so"
};

/// What stands in every library of this version.
#[used]
static MARK: [u8; MARK_TEXT.len()] = {
    let (mut mark, mut k) = ([0; MARK_TEXT.len()], 0);
    while k < mark.len() {
        mark[k] = MARK_TEXT.as_bytes()[k];
        k += 1;
    }
    mark
};
const MARK_TEXT: &str = concat!("springpot-capi for FMUs, version ", env!("CARGO_PKG_VERSION"), ";");

/// Whether these are the bytes of a shared library with the functions of an FMU, of the version of this one.
pub fn is_this_library(bytes: &[u8]) -> bool {
    let holds = |text: &[u8]| bytes.windows(text.len()).any(|window| window == text);
    let heads: [&[u8]; 4] = [b"\x7fELF", b"MZ", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"];
    heads.iter().any(|head| bytes.starts_with(head)) && holds(&MARK) && holds(b"fmi2DoStep")
}
