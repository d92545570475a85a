//! Rows of a prototype of the same method, from prototype.txt.

/// Node, weight, gap, normal, shares of the master.
pub type Row = (usize, f64, f64, [f64; 3], Vec<(usize, f64)>);

/// The rows below the heading `name`.
pub fn rows(name: &str) -> Vec<Row> {
    let (_, rest) = include_str!("prototype.txt").split_once(&format!("# {name}\n")).unwrap();
    let mut rows: Vec<Row> = Vec::new();
    for line in rest.lines().take_while(|line| !line.is_empty()) {
        let words = line.split_whitespace();
        if line.starts_with(' ') {
            let shares = words.map(|word| word.split_once(':').unwrap());
            rows.last_mut().unwrap().4.extend(shares.map(|(n, c)| (n.parse::<usize>().unwrap(), c.parse().unwrap())));
        } else {
            let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
            let [node, weight, gap, x, y, z] = numbers[..] else { panic!("{line}") };
            rows.push((node as usize, weight, gap, [x, y, z], Vec::new()));
        }
    }
    rows
}
