//! Sound texts made unsound: in bytes, in lines, in numbers and in words.

use std::ops::Range;

use crate::random::Random;

/// Numbers at which things break.
const NUMBERS: [&str; 32] = [
    "0",
    "-0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "1e-9",
    "-1e-3",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e50",
    "1.0001e50",
    "1e-50",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1e999",
    "0x10",
    "1_000",
    ".5",
    "1.",
    "",
    "0.49999999999999994",
];

/// `text` with one to four changes; `words` may come in place of its own, and parts of `other` into it.
pub fn mutated(random: &mut Random, text: &[u8], other: &[u8], words: &[String]) -> Vec<u8> {
    let mut text = text.to_vec();
    for _ in 0..=random.below(4) {
        change(random, &mut text, other, words);
    }
    text
}

fn change(random: &mut Random, text: &mut Vec<u8>, other: &[u8], words: &[String]) {
    match random.below(16) {
        0 => with_byte(random, text, |byte, random| byte ^ (1 << random.below(8))),
        1 => with_byte(random, text, |_, random| random.below(256) as u8),
        2 => {
            let at = random.below(text.len() + 1);
            let count = 1 + random.below(4);
            let bytes: Vec<u8> = (0..count).map(|_| random.one(b"[]{}=\"',.#\n -+eE0x1\xff\xc3\0:*/^()")).collect();
            text.splice(at..at, bytes);
        }
        3 => {
            let range = random_range(random, text.len(), 20);
            text.drain(range);
        }
        4 => {
            let range = random_range(random, text.len(), 40);
            let at = random.below(text.len() + 1);
            let bytes = text[range].to_vec();
            text.splice(at..at, bytes);
        }
        5 => text.truncate(random.below(text.len() + 1)),
        6 => {
            let (at, part) = (random.below(text.len() + 1), random_range(random, other.len(), 200));
            text.splice(at..at, other[part].to_vec());
        }
        7 | 8 => {
            if let Some(range) = line(random, text) {
                text.drain(range);
            }
        }
        9 => {
            if let Some(range) = line(random, text) {
                let bytes = text[range.clone()].to_vec();
                text.splice(range.end..range.end, bytes);
            }
        }
        10 => {
            if let (Some(one), Some(two)) = (line(random, text), line(random, text)) {
                let (first, second) = if one.start < two.start { (one, two) } else { (two, one) };
                if first.end <= second.start {
                    let [a, b] = [first.clone(), second.clone()].map(|range| text[range].to_vec());
                    text.splice(second, a);
                    text.splice(first, b);
                }
            }
        }
        11..=13 => {
            if let Some(range) = token(random, text, |byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte)) {
                let number =
                    if random.percent(30) { random.below(300).to_string() } else { random.one(&NUMBERS).to_string() };
                text.splice(range, number.into_bytes());
            }
        }
        _ => {
            let range = token(random, text, |byte| byte.is_ascii_alphabetic() || b"_-".contains(&byte));
            if let (Some(range), false) = (range, words.is_empty()) {
                let word = &words[random.below(words.len())];
                text.splice(range, word.bytes());
            }
        }
    }
}

fn with_byte(random: &mut Random, text: &mut [u8], change: impl Fn(u8, &mut Random) -> u8) {
    if !text.is_empty() {
        let at = random.below(text.len());
        text[at] = change(text[at], random);
    }
}

fn random_range(random: &mut Random, length: usize, most: usize) -> Range<usize> {
    let start = random.below(length + 1);
    start..(start + random.below(most + 1)).min(length)
}

/// A line with its end.
fn line(random: &mut Random, text: &[u8]) -> Option<Range<usize>> {
    if text.is_empty() {
        return None;
    }
    let at = random.below(text.len());
    let start = text[..at].iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let end = text[at..].iter().position(|&byte| byte == b'\n').map_or(text.len(), |end| at + end + 1);
    Some(start..end.max(start))
}

/// Bytes of this kind that stand together, and nothing of this kind beside them.
fn token(random: &mut Random, text: &[u8], is: impl Fn(u8) -> bool) -> Option<Range<usize>> {
    if text.is_empty() {
        return None;
    }
    let at = random.below(text.len());
    let within = (at..text.len()).chain(0..at).find(|&k| is(text[k]))?;
    let start = text[..within].iter().rposition(|&byte| !is(byte)).map_or(0, |before| before + 1);
    let end = text[within..].iter().position(|&byte| !is(byte)).map_or(text.len(), |after| within + after);
    Some(start..end)
}
