//! From the ways of a multipolygon to closed rings.
//!
//! A way is a list of node numbers; two belong together where they end at the same node. A ring is returned without
//! its first node repeated. What does not close is left out.

use glam::DVec2;
use std::collections::HashMap;

/// The rings that lines of nodes make, each line used at most once.
pub fn rings(lines: &[&[i64]]) -> Vec<Vec<i64>> {
    let mut at_end: HashMap<i64, Vec<usize>> = HashMap::new();
    let mut used = vec![false; lines.len()];
    let mut found = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        match line {
            [first, .., last] if first == last => {
                used[number] = true;
                found.push(line[..line.len() - 1].to_vec());
            }
            [first, .., last] => {
                at_end.entry(*first).or_default().push(number);
                at_end.entry(*last).or_default().push(number);
            }
            _ => used[number] = true,
        }
    }
    for number in 0..lines.len() {
        if std::mem::replace(&mut used[number], true) {
            continue;
        }
        let mut ring = lines[number].to_vec();
        while let (Some(&first), Some(&last)) = (ring.first(), ring.last())
            && first != last
            && let Some(next) = next_line(&mut at_end, &used, last)
        {
            used[next] = true;
            let line = lines[next];
            if line.first() == Some(&last) {
                ring.extend(&line[1..]);
            } else {
                ring.extend(line[..line.len() - 1].iter().rev());
            }
        }
        if ring.first() == ring.last() && ring.len() > 3 {
            ring.pop();
            found.push(ring);
        }
    }
    found
}

/// A line that ends at a node and is not used; those used are forgotten, so all of it takes linear time.
fn next_line(at_end: &mut HashMap<i64, Vec<usize>>, used: &[bool], node: i64) -> Option<usize> {
    let lines = at_end.get_mut(&node)?;
    while let Some(line) = lines.pop() {
        if !used[line] {
            return Some(line);
        }
    }
    None
}

/// Whether a ring holds a point, by the even-odd rule.
pub fn holds(ring: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    let ends = ring.iter().cycle().skip(1);
    for (a, b) in ring.iter().zip(ends) {
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_in_any_order_and_direction_make_rings() {
        let lines: [&[i64]; 6] = [&[1, 2, 3], &[5, 4, 3], &[5, 1], &[7, 8, 9, 7], &[20, 21], &[]];
        let mut found = rings(&lines);
        found.iter_mut().for_each(|ring| ring.sort_unstable());
        found.sort();
        assert_eq!(found, [vec![1, 2, 3, 4, 5], vec![7, 8, 9]]);
    }

    #[test]
    fn a_point_is_inside_by_even_odd() {
        let ring = [DVec2::new(0.0, 0.0), DVec2::new(4.0, 0.0), DVec2::new(4.0, 4.0), DVec2::new(0.0, 4.0)];
        assert!(holds(&ring, DVec2::new(1.0, 2.0)) && !holds(&ring, DVec2::new(5.0, 2.0)));
        assert!(!holds(&[], DVec2::ZERO));
    }
}
