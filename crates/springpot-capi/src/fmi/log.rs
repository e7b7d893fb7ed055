//! Messages to whoever made an instance.

use std::ffi::{CString, c_char, c_int, c_void};

/// `fmi2CallbackLogger`: a message is a format of `printf`.
pub(super) type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// Where the messages of an instance go.
#[derive(Debug, Clone)]
pub(super) struct Log {
    pub(super) logger: Option<Logger>,
    /// The caller's own, handed back.
    pub(super) environment: *mut c_void,
    pub(super) instance: CString,
}

// SAFETY: the environment is handed back as it is; the standard lets functions of one instance be called from any thread, one at a time.
unsafe impl Send for Log {}
// SAFETY: as above; nothing of it changes.
unsafe impl Sync for Log {}

impl Log {
    /// Tells a message of a category with a status of the standard.
    pub(super) fn tell(&self, status: c_int, category: &str, message: &str) {
        let Some(logger) = self.logger else { return };
        let text = |text: &str| CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default();
        let (category, message) = (text(category), text(&message.replace('%', "%%")));
        // SAFETY: a function of the standard, with texts that end; there is nothing in the message to be filled in.
        unsafe {
            logger(self.environment, self.instance.as_ptr(), status, category.as_ptr(), message.as_ptr());
        }
    }
}
