//! Suggestion of the probably intended name.

use strsim::levenshtein;

/// Maximum length of a word; a longer one is no misspelled name.
const WORD_CHARACTERS: usize = 80;

/// Returns the candidate with the fewest edits to `word`, if fewer than half of its letters change.
pub fn nearest_name<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    if word.chars().nth(WORD_CHARACTERS).is_some() {
        return None;
    }
    candidates
        .map(|candidate| (levenshtein(word, candidate), candidate))
        .min()
        .filter(|(edits, candidate)| 2 * edits < candidate.len())
        .map(|(_, candidate)| candidate)
}

/// Returns the probably intended `names`: the one nearest to `word`, or otherwise those that contain it.
pub fn names_meant<'a>(word: &str, names: impl Iterator<Item = &'a str> + Clone) -> Vec<&'a str> {
    match nearest_name(word, names.clone()) {
        Some(name) => vec![name],
        None => names
            .filter(|name| name.split('_').any(|part| part == word))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_name_and_nonsense_none() {
        let names = || ["chamber_leak", "coil_heating", "dead_volume"].into_iter();
        assert_eq!(nearest_name("chamber_leek", names()), Some("chamber_leak"));
        assert_eq!(nearest_name("leak_chamber", names()), None);
        assert_eq!(nearest_name("deadvolume", names()), Some("dead_volume"));
        assert_eq!(nearest_name(&"chamber_leak".repeat(9), names()), None);
    }

    #[test]
    fn a_part_of_names_finds_all_of_them() {
        let names = || ["chamber_leak", "supply_seat_leak", "dead_volume"].into_iter();
        assert_eq!(
            names_meant("leak", names()),
            ["chamber_leak", "supply_seat_leak"]
        );
        assert_eq!(names_meant("chamber_leek", names()), ["chamber_leak"]);
        assert_eq!(names_meant("lea", names()), [""; 0]);
    }
}
