//! The positions and faces of a Wavefront OBJ text; polygons are cut into fans, everything else is skipped.

use crate::input::Soup;

/// Positions and triangles.
///
/// # Errors
/// The line that does not parse, or that names a vertex that does not exist so far (`f` lines may not look ahead).
pub(crate) fn read(text: &str) -> Result<Soup, String> {
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut triangles = Vec::new();
    let mut corners: Vec<u32> = Vec::new();
    for (line, content) in text.lines().enumerate() {
        let wrong = || format!("line {}: {content:?}", line + 1);
        let mut words = content.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || words.next().and_then(|w| w.parse().ok()).ok_or_else(wrong);
                positions.push([next()?, next()?, next()?]);
            }
            Some("f") => {
                corners.clear();
                for word in words {
                    let index: i64 = word.split('/').next().and_then(|w| w.parse().ok()).ok_or_else(wrong)?;
                    let count = positions.len() as i64;
                    let vertex = if index < 0 { count.saturating_add(index) } else { index - 1 };
                    let known = (0..count).contains(&vertex);
                    corners.push(u32::try_from(vertex).ok().filter(|_| known).ok_or_else(wrong)?);
                }
                if corners.len() < 3 {
                    return Err(wrong());
                }
                triangles.extend(corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]));
            }
            _ => {}
        }
    }
    Ok((positions, triangles))
}

#[cfg(test)]
mod tests {
    #[test]
    fn polygons_become_fans_and_negative_indices_count_back() {
        let (positions, triangles) =
            super::read("v 0 0 0\nv 1 0 0\r\nv 1 1 0\nv 0 1 0\nf 1/1 2//3 3 4\nf -4 -2 -1\n").unwrap();
        assert_eq!(positions.len(), 4);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        for text in
            ["v 0 0\n", "v 0 0 0\nf 1 1 2\n", "v 0 0 0\nf 1 1 0\n", "v 0 0 0\nf 1 1 -2\n", "v 0 0 0\nf 1 1\n"]
        {
            assert!(super::read(text).unwrap_err().starts_with("line "), "{text:?}");
        }
    }
}
