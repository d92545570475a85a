//! The bytes are the choices that make a scene, two for each.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_fuzz::random::Random;
use stickslip_fuzz::runs::{Case, check_case};

fuzz_target!(|bytes: &[u8]| {
    if let Err(wrong) = check_case(&Case::random(&mut Random::of(bytes))) {
        panic!("{wrong}");
    }
});
