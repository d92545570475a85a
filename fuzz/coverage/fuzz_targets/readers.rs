//! The first byte chooses the reader, the rest is its text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_fuzz::readers::ALL;

fuzz_target!(|bytes: &[u8]| {
    if let [first, text @ ..] = bytes {
        let reader = ALL[usize::from(*first) % ALL.len()];
        if let Err(wrong) = reader.check(text) {
            panic!("{}: {wrong}", reader.name);
        }
    }
});
