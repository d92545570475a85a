//! Choices, from a seed or from bytes that somebody else chose.

/// Splitmix64 (Steele, Lea, Flood 2014); as long as there are bytes each choice is made by two of them, so that a coverage-guided
/// fuzzer can change one choice and leave the others.
#[derive(Debug, Clone)]
pub struct Random<'a> {
    state: u64,
    bytes: &'a [u8],
}

fn mixed(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random<'_> {
    /// The choices of a target, told apart by its name, for one seed.
    pub fn new(target: &str, seed: u64) -> Self {
        let name = target.bytes().fold(0_u64, |hash, byte| mixed(hash ^ u64::from(byte)).wrapping_add(1));
        Random { state: mixed(name ^ mixed(seed)), bytes: &[] }
    }
}

impl<'a> Random<'a> {
    /// The choices that `bytes` make.
    pub fn of(bytes: &'a [u8]) -> Self {
        Random { state: 0, bytes }
    }

    /// Any number.
    pub fn number(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        match self.bytes {
            [low, high, rest @ ..] => {
                self.bytes = rest;
                mixed(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(1 + u64::from(u16::from_le_bytes([*low, *high]))))
            }
            _ => mixed(self.state),
        }
    }

    /// A number below `n`, which is 1 or more.
    pub fn below(&mut self, n: usize) -> usize {
        (self.number() % n.max(1) as u64) as usize
    }

    /// One of these.
    pub fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// True so many times of a hundred.
    pub fn percent(&mut self, share: usize) -> bool {
        self.below(100) < share
    }

    /// A number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.number() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// A power of ten, of an exponent between two.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }
}
