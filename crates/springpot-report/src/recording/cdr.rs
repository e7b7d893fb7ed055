//! Messages as ROS 2 writes them: CDR of the OMG (version 1), little-endian.

/// What stands before a message: CDR, little-endian, no options.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// One message after the other, in one buffer.
#[derive(Debug)]
pub(super) struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    pub(super) fn new() -> Self {
        Self { bytes: HEAD.to_vec() }
    }

    /// A new message in the place of the last one.
    pub(super) fn begin(&mut self) -> &mut Self {
        self.bytes.truncate(HEAD.len());
        self
    }

    /// The message.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Numbers stand at multiples of their size, counted from behind the head.
    fn align(&mut self, size: usize) {
        let written = self.bytes.len() - HEAD.len();
        self.bytes.resize(HEAD.len() + written.next_multiple_of(size), 0);
    }

    pub(super) fn u32(&mut self, value: u32) -> &mut Self {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    pub(super) fn i32(&mut self, value: i32) -> &mut Self {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    pub(super) fn f64(&mut self, value: f64) -> &mut Self {
        self.align(8);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// A text with its length and the zero behind it, which counts.
    pub(super) fn string(&mut self, text: &str) -> &mut Self {
        self.length(text.len() + 1);
        self.bytes.extend(text.bytes().map(|byte| if byte == 0 { b' ' } else { byte }));
        self.bytes.push(0);
        self
    }

    /// How long what follows is.
    pub(super) fn length(&mut self, length: usize) -> &mut Self {
        self.u32(u32::try_from(length).unwrap_or(u32::MAX))
    }

    /// A sequence of numbers.
    pub(super) fn numbers(&mut self, numbers: impl ExactSizeIterator<Item = f64>) -> &mut Self {
        self.length(numbers.len());
        for number in numbers {
            self.f64(number);
        }
        self
    }

    /// `std_msgs/Header`.
    pub(super) fn header(&mut self, stamp: Stamp, frame: &str) -> &mut Self {
        self.i32(i32::try_from(stamp.seconds).unwrap_or(i32::MAX)).u32(stamp.nanoseconds).string(frame)
    }
}

/// A time in whole nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    pub(super) seconds: u64,
    pub(super) nanoseconds: u32,
}

impl Stamp {
    /// The nearest to a time in s; 0 for what is none.
    pub(super) fn new(t: f64) -> Self {
        let t = if t > 0.0 { t.min(1e9) } else { 0.0 };
        // The fraction of a binary number is exact.
        let nanoseconds = ((t - t.floor()) * 1e9).round() as u32;
        Self {
            seconds: t.floor() as u64 + u64::from(nanoseconds / 1_000_000_000),
            nanoseconds: nanoseconds % 1_000_000_000,
        }
    }

    /// ns from 0.
    pub(super) fn total(self) -> u64 {
        self.seconds * 1_000_000_000 + u64::from(self.nanoseconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_multiples_of_their_size_behind_the_head() {
        let mut cdr = Cdr::new();
        cdr.begin().u32(7).string("ab").f64(1.5).numbers([].into_iter()).numbers([2.0].into_iter());
        let mut expected = vec![0, 1, 0, 0, 7, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0];
        // 12 bytes behind the head, then 4 of padding.
        expected.extend([0; 4]);
        expected.extend(1.5_f64.to_le_bytes());
        // The empty sequence is its length alone.
        expected.extend([0, 0, 0, 0, 1, 0, 0, 0]);
        expected.extend(2.0_f64.to_le_bytes());
        assert_eq!(cdr.bytes(), expected);
        assert_eq!(cdr.begin().string("x\0y").bytes(), [0, 1, 0, 0, 4, 0, 0, 0, b'x', b' ', b'y', 0]);
    }

    #[test]
    fn stamps_are_the_nearest_nanosecond() {
        let total = |t: f64| Stamp::new(t).total();
        assert_eq!((total(0.0), total(0.1), total(1.0 / 3.0)), (0, 100_000_000, 333_333_333));
        assert_eq!((total(1.999_999_999_9), total(-1.0), total(f64::NAN)), (2_000_000_000, 0, 0));
        assert_eq!(total(f64::INFINITY), 1_000_000_000_000_000_000);
    }
}
