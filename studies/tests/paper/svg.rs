//! Reading pictures.

use std::collections::BTreeMap;

/// The texts of an SVG picture, which must be well-formed.
pub fn texts(svg: &str) -> Vec<&str> {
    let (mut open, mut texts) = (Vec::new(), Vec::new());
    let mut rest = svg;
    while let Some(at) = rest.find('<') {
        let (text, tag) = rest.split_at(at);
        let escaped = |rest: &str| ["lt;", "gt;", "amp;", "quot;", "apos;"].iter().any(|name| rest.starts_with(name));
        assert!(!text.contains('>') && text.split('&').skip(1).all(escaped), "{text}");
        texts.push(text.trim());
        let (tag, after) = tag[1..].split_once('>').unwrap();
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        let (name, attributes) = tag.trim_end_matches('/').split_once(' ').unwrap();
        // Attributes: name="value", none twice.
        let mut values = BTreeMap::new();
        let mut attributes = attributes.trim();
        while !attributes.is_empty() {
            let (key, value) = attributes.split_once("=\"").unwrap();
            let (value, more) = value.split_once('"').unwrap();
            assert!(values.insert(key, value).is_none() && !value.contains("NaN"), "{tag}");
            attributes = more.trim_start();
        }
        if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty() && rest.trim().is_empty());
    texts.retain(|text| !text.is_empty());
    texts
}
