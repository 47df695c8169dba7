//! The name that was probably meant.

/// The candidate with the fewest edits to `word`, if fewer than half of its letters change.
pub(super) fn nearest<'a>(
    word: &str,
    candidates: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    candidates
        .map(|candidate| (edits(word, candidate), candidate))
        .min()
        .filter(|(edits, candidate)| 2 * edits < candidate.len())
        .map(|(_, candidate)| candidate)
}

/// Those of `names` that `word` probably means: the nearest one, or else those that it is a part of.
pub(super) fn meant<'a>(word: &str, names: impl Iterator<Item = &'a str> + Clone) -> Vec<&'a str> {
    match nearest(word, names.clone()) {
        Some(name) => vec![name],
        None => names
            .filter(|name| name.split('_').any(|part| part == word))
            .collect(),
    }
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.chars().count()).collect();
    for (i, from) in a.chars().take(80).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.chars().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[row.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_name_and_nonsense_none() {
        let names = || ["chamber_leak", "coil_heating", "dead_volume"].into_iter();
        assert_eq!(nearest("chamber_leek", names()), Some("chamber_leak"));
        assert_eq!(nearest("leak_chamber", names()), None);
        assert_eq!(nearest("deadvolume", names()), Some("dead_volume"));
        assert_eq!(edits("kitten", "sitting"), 3);
    }

    #[test]
    fn a_part_of_names_finds_all_of_them() {
        let names = || ["chamber_leak", "supply_seat_leak", "dead_volume"].into_iter();
        assert_eq!(meant("leak", names()), ["chamber_leak", "supply_seat_leak"]);
        assert_eq!(meant("chamber_leek", names()), ["chamber_leak"]);
        assert_eq!(meant("lea", names()), [""; 0]);
    }
}
